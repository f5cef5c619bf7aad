#include "veridyn/estimation/judgement/unfinished_search.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::estimation {

std::vector<Evidence> unfinished_rows(const UnfinishedSearch& search) {
  if (search.empty()) return {};
  const Outcome of_parameters = search.converged ? Outcome::kCare : Outcome::kFailed;
  return {row_of(Check::kInterruption, "", of_parameters)
              .with("left_out", fmt::format("{}", fmt::join(search.left_out, "; "))),
          row_of(Check::kInterruptedPrediction, "", Outcome::kCare)};
}

}  // namespace veridyn::estimation
