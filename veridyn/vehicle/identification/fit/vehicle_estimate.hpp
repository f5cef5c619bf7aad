#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/estimation/result/parameter.hpp"
#include "veridyn/vehicle/identification/options/drive_model_options.hpp"
#include "veridyn/vehicle/identification/options/vehicle_method.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"

namespace veridyn::vehicle {

/// The vehicle's parameters by one method.
struct VehicleEstimate {
  VehicleMethod method = VehicleMethod::kNone;
  bool usable = false;
  std::string message;
  /// C_f, C_r, I_z [, mu, ...], understeer_gradient [rad/(m/s^2)], nuisances: sensors' biases; of
  /// equation error `steer_offset`, what the biases of steering, gyro and accelerometer add up to as a steer angle.
  std::vector<estimation::Parameter> parameters;
  Eigen::MatrixXd covariance;  ///< in their order
  /// The part of it that more of the same drive would not make smaller, what is not known of mass, a, b and the
  /// steering's scale, and the model's error on a noise-free drive; empty: none.
  Eigen::MatrixXd given_covariance = {};
  /// How the parameters of output error move with one standard deviation of the steering's scale; empty: not at all.
  Eigen::VectorXd by_steer_scale = {};
  double degrees_of_freedom = 1.0;
  /// Null where the method does not estimate it.
  [[nodiscard]] const estimation::Parameter* find(std::string_view name) const;
};

/// The estimate by a method, or null.
[[nodiscard]] const VehicleEstimate* find_estimate(std::span<const VehicleEstimate> estimates, VehicleMethod method);

/// An estimate whose covariance has grown: intervals and status of each parameter follow its variance.
[[nodiscard]] VehicleEstimate with_covariance(VehicleEstimate estimate, Eigen::MatrixXd grown, double significance);

/// The parameter that is no unknown of a model, but follows from them.
inline constexpr std::string_view kUndersteerGradient = "understeer_gradient";
/// Whether a parameter is the vehicle's, not the day's.
[[nodiscard]] constexpr bool is_of_vehicle(std::string_view parameter) {
  return parameter == kUndersteerGradient || is_one_of(parameter, kVehicleUnknowns);
}

/// m/(2 L) (b/C_f - a/C_r) [rad/(m/s^2)]: extra steer angle per lateral acceleration of the linear bicycle. Positive:
/// understeer.
[[nodiscard]] double understeer_gradient(const VehicleParameters<double>& p);

}  // namespace veridyn::vehicle
