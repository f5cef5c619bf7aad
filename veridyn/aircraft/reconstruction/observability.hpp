#pragma once

#include <string>

namespace veridyn::aircraft {

/// How much the data say about a quantity.
enum class Observability {
  kObservable,    ///< median posterior sigma below 0.35 of what was assumed beforehand
  kWeak,          ///< below 0.8
  kNotObservable  ///< the data add nothing worth naming: the estimate is the assumption
};
[[nodiscard]] const char* to_string(Observability observability);
[[nodiscard]] Observability observability_of(double sigma, double prior_sigma);

/// A number and its unit for a sentence: "0.3 deg", angles in degrees.
[[nodiscard]] double shown(double value, const std::string& unit);
[[nodiscard]] std::string shown_unit(const std::string& unit);

}  // namespace veridyn::aircraft
