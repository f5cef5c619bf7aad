#include "veridyn/vehicle/identification/fit/vehicle_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/index.hpp"

namespace veridyn::vehicle {

const estimation::Parameter* VehicleEstimate::find(std::string_view name) const {
  return estimation::find_parameter(parameters, name);
}

const VehicleEstimate* find_estimate(std::span<const VehicleEstimate> estimates, VehicleMethod method) {
  for (const VehicleEstimate& e : estimates) {
    if (e.method == method) return &e;
  }
  return nullptr;
}

VehicleEstimate with_covariance(VehicleEstimate estimate, Eigen::MatrixXd grown, double significance) {
  for (std::size_t i = 0; i < estimate.parameters.size(); ++i) {
    const Eigen::Index row = signed_index(i);
    const double before = estimate.covariance(row, row);
    if (before > 0.0 && std::isfinite(before))
      estimation::widen(estimate.parameters[i], grown(row, row) / before, estimate.degrees_of_freedom, significance);
  }
  estimate.covariance = std::move(grown);
  return estimate;
}

double understeer_gradient(const VehicleParameters<double>& p) {
  return 0.5 * p.mass / p.wheelbase() * (p.b / p.C_f - p.a / p.C_r);
}

}  // namespace veridyn::vehicle
