#pragma once

#include <string>

namespace veridyn::aircraft {

/// How much the data determine a quantity.
enum class Observability {
  kObservable,    ///< median posterior sigma below 0.35 of what was assumed beforehand
  kWeak,          ///< below 0.8
  kNotObservable  ///< the data add nothing worth naming: the estimate is the assumption
};
[[nodiscard]] const char* to_string(Observability observability);
/// By the standard deviation after the flight and the one assumed beforehand.
[[nodiscard]] Observability observability_of(double sigma, double prior_sigma);

/// A number and its unit for a sentence, angles in degrees: 0.3 and " deg".
[[nodiscard]] double display_value(double value, const std::string& unit);
/// With a leading space; empty for "1".
[[nodiscard]] std::string display_unit(const std::string& unit);

}  // namespace veridyn::aircraft
