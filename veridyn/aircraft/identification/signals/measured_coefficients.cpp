#include "veridyn/aircraft/identification/signals/measured_coefficients.hpp"

#include <ceres/jet.h>

#include "veridyn/core/index.hpp"

namespace veridyn::aircraft {

bool per_unit_inertia(Coefficient c, const Subject& subject) {
  return !subject.inertia && (c == Coefficient::kCl || c == Coefficient::kCm || c == Coefficient::kCn);
}

std::string regressed_name(Coefficient c, const Subject& subject) {
  std::string name(name_of(c));
  if (!per_unit_inertia(c, subject)) return name;
  return name + (c == Coefficient::kCl ? "/Jx" : c == Coefficient::kCm ? "/Jy" : "/Jz");
}

std::string regressed_parameter_name(Coefficient c, const Term& term, const Subject& subject) {
  return regressed_name(c, subject) + parameter_name(c, term).substr(name_of(c).size());
}

std::string regressed_parameter_unit(Coefficient c, const Term& term, const Subject& subject) {
  const std::string unit = term.parameter_unit();
  return per_unit_inertia(c, subject) ? unit + "/kg/m^2" : unit;
}

CoefficientRow coefficient_row(const CoefficientModel& model, const FlightSample<double>& sample,
                               const Subject& subject, double rho) {
  using Jet = ceres::Jet<double, static_cast<int>(kFlightSignals)>;
  FlightSample<Jet> s;
  for (std::size_t i = 0; i < kFlightSignals; ++i) s.value[i] = Jet(sample.value[i], static_cast<int>(i));
  const auto n = signed_index(model.size());
  const Eigen::Matrix<Jet, Eigen::Dynamic, 1> x = model.regressors(aero_variables(s, subject, rho));
  const Jet z = select(regressed_coefficients(s, subject, rho), model.coefficient);
  CoefficientRow result;
  result.row.resize(n + 1);
  result.jacobian.resize(n + 1, kFlightSignals);
  for (Eigen::Index i = 0; i < n; ++i) {
    result.row(i) = x(i).a;
    result.jacobian.row(i) = x(i).v.transpose();
  }
  result.row(n) = z.a;
  result.jacobian.row(n) = z.v.transpose();
  return result;
}

}  // namespace veridyn::aircraft
