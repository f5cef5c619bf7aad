#include "veridyn/aircraft/measured_coefficients.hpp"

#include <ceres/jet.h>

namespace veridyn::aircraft {

CoefficientRow coefficient_row(const CoefficientModel& model, const FlightSample<double>& sample,
                               const Subject& subject, double rho) {
  using Jet = ceres::Jet<double, static_cast<int>(kFlightSignals)>;
  FlightSample<Jet> s;
  for (std::size_t i = 0; i < kFlightSignals; ++i) s.value[i] = Jet(sample.value[i], static_cast<int>(i));
  const auto n = static_cast<Eigen::Index>(model.size());
  const Eigen::Matrix<Jet, Eigen::Dynamic, 1> x = model.regressors(aero_variables(s, subject, rho));
  const Jet z = select(measured_coefficients(s, subject, rho), model.coefficient);
  CoefficientRow result;
  result.row.resize(n + 1);
  result.jacobian.resize(n + 1, static_cast<Eigen::Index>(kFlightSignals));
  for (Eigen::Index i = 0; i < n; ++i) {
    result.row(i) = x(i).a;
    result.jacobian.row(i) = x(i).v.transpose();
  }
  result.row(n) = z.a;
  result.jacobian.row(n) = z.v.transpose();
  return result;
}

}  // namespace veridyn::aircraft
