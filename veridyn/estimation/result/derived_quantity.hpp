#pragma once

#include <string>

#include "veridyn/core/constants.hpp"

namespace veridyn::estimation {

/// What follows from the parameters and is asked for by its own name: a natural frequency, a stall speed.
struct DerivedQuantity {
  std::string group;  ///< what it is part of: "short period"
  std::string name;   ///< "short_period.damping"
  double value = kNaN;
  double low95 = kNaN, high95 = kNaN;  ///< of the parameters' covariance; infinite: without an end, NaN: not known
  std::string unit = "1";
  std::string note = {};  ///< what it means or rests on; may be empty
};

}  // namespace veridyn::estimation
