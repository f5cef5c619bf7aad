#pragma once

#include <string>
#include <vector>

#include "veridyn/estimation/judgement/evidence.hpp"

namespace veridyn::estimation {

/// What an interruption kept from an estimate: the best that was found by then is delivered, and says so.
struct UnfinishedSearch {
  bool converged = false;                  ///< in values and in the structure of the model
  std::vector<std::string> left_out = {};  ///< "profiles were not followed"; empty: nothing was interrupted

  [[nodiscard]] bool empty() const { return left_out.empty(); }
};

/// The rows of it: parameters with care where the search had converged, no where it had not; prediction with care.
/// None where nothing was left out.
[[nodiscard]] std::vector<Evidence> unfinished_rows(const UnfinishedSearch& search);

}  // namespace veridyn::estimation
