#include "veridyn/estimation/judgement/unfinished_search.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "veridyn/core/constants.hpp"

namespace veridyn::estimation {

std::vector<Evidence> unfinished_rows(const UnfinishedSearch& search) {
  if (search.empty()) return {};
  const Evidence row{.name = "interruption", .value = kNaN, .limit = kNaN, .advice = "run it again to its end"};
  Evidence parameters = row, prediction = row;
  parameters.outcome = search.converged ? Outcome::kCare : Outcome::kFailed;
  parameters.text = fmt::format("the search was interrupted {}: {}",
                                search.converged ? "after it had converged"
                                                 : "before it converged, and the values are "
                                                   "those where it stood",
                                fmt::join(search.left_out, "; "));
  parameters.bears_on = Purpose::kParameters;
  prediction.outcome = Outcome::kCare;
  prediction.text = "the search was interrupted: its model predicts as it stood, and its bands are no wider for that";
  prediction.bears_on = Purpose::kPrediction;
  return {parameters, prediction};
}

}  // namespace veridyn::estimation
