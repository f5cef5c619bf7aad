#include "veridyn/estimation/result/parameter.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::estimation {

std::string_view to_string(ParameterStatus status) {
  switch (status) {
    case ParameterStatus::kIdentified:
      return "identified";
    case ParameterStatus::kInsignificant:
      return "insignificant";
    case ParameterStatus::kWeak:
      return "weak";
    case ParameterStatus::kImplausible:
      return "implausible";
    case ParameterStatus::kAtBound:
      return "at_bound";
    case ParameterStatus::kEffective:
      return "effective";
    case ParameterStatus::kNotExcited:
      return "not_excited";
    case ParameterStatus::kRejected:
      return "rejected";
    case ParameterStatus::kFixed:
      return "fixed";
  }
  return "";
}

const Parameter* find_parameter(std::span<const Parameter> parameters, std::string_view name) {
  const auto found = std::ranges::find(parameters, name, &Parameter::name);
  return found == parameters.end() ? nullptr : &*found;
}

void set_interval(Parameter& parameter, double degrees_of_freedom) {
  Parameter& p = parameter;
  const double quantile95 = numerics::student_t_quantile(0.975, degrees_of_freedom);
  p.low95 = p.value - quantile95 * p.sigma;
  p.high95 = p.value + quantile95 * p.sigma;
  if (p.status == ParameterStatus::kFixed) {
    p.p_value = kNaN;
    return;
  }
  p.t = p.sigma > 0.0 ? p.value / p.sigma : std::copysign(kInfinity, p.value);
  p.p_value = numerics::student_t_two_sided_p(p.t, degrees_of_freedom);
}

void widen(Parameter& p, double variance_factor, double degrees_of_freedom, double significance) {
  if (!(variance_factor > 1.0) || !(p.sigma > 0.0) || !std::isfinite(p.sigma)) return;
  const double factor = std::sqrt(variance_factor);
  p.sigma *= factor;
  p.low95 = p.value + factor * (p.low95 - p.value);
  p.high95 = p.value + factor * (p.high95 - p.value);
  p.t = p.value / p.sigma;
  p.p_value = numerics::student_t_two_sided_p(p.t, degrees_of_freedom);
  if (p.status == ParameterStatus::kIdentified && !(p.p_value < significance))
    p.status = ParameterStatus::kInsignificant;
}

}  // namespace veridyn::estimation
