#pragma once

#include <Eigen/Core>
#include <complex>
#include <string>
#include <vector>

#include "veridyn/vehicle/model/bicycle_analysis.hpp"
#include "veridyn/vehicle/model/four_wheel_model.hpp"

namespace veridyn::vehicle {

/// The four-wheel model about straight running at a constant speed on a flat road: x' = A x + B delta, y = C x + D
/// delta with y = (r, a_y, beta, roll). States are v, r, heave, roll, pitch, their rates, the four wheels' heights and
/// rates, and with a relaxation length the four lagged slip angles.
struct LinearFourWheel {
  std::vector<Eigen::Index> states;  ///< of `FourWheelState`
  Eigen::MatrixXd A;
  Eigen::VectorXd B;
  Eigen::Matrix<double, 4, Eigen::Dynamic> C;
  Eigen::Vector4d D;
  double u = 0.0;
  Eigen::VectorXd inertia;  ///< kinetic energy of a state's rate is inertia |rate|^2/2; 0 for positions
};

/// A mode of the four-wheel model and what moves in it.
struct FourWheelMode : Mode {
  /// "lateral and yaw", "heave", "roll", "pitch", "front wheel hop", "rear wheel hop" (both axles' wheels "in phase" or
  /// "opposed"), or "tyre lag": where most of the kinetic energy is. Modes are mixtures: `share` says how much.
  std::string name;
  double share = 0.0;
};
/// Slowest first. Modes without any motion of masses are left out only if they are zero.
[[nodiscard]] std::vector<FourWheelMode> modes(const LinearFourWheel& model);

/// Response to steer at one frequency.
struct FourWheelResponse {
  double frequency_Hz = 0.0;
  std::complex<double> yaw_rate;              ///< [1/s]
  std::complex<double> lateral_acceleration;  ///< [m/s^2/rad]
  std::complex<double> sideslip;              ///< [1]
  std::complex<double> roll;                  ///< [1]
};
/// Steady response of a stable model; undefined on an eigenvalue.
[[nodiscard]] FourWheelResponse frequency_response(const LinearFourWheel& model, double frequency_Hz);

/// What a small steady turn needs and does, per lateral acceleration: with everything that steers and rolls in it.
struct SteadyCornering {
  double understeer_gradient = 0.0;  ///< K of yaw rate/steer = u/(L + K u^2) [rad s^2/m]
  double roll_gradient = 0.0;        ///< [rad s^2/m]
};
/// Of a model that is not on an eigenvalue of 0.
[[nodiscard]] SteadyCornering steady_cornering(const LinearFourWheel& model, double wheelbase);

/// By central differences of 1e-6 (m, rad, m/s, rad/s): relative errors of 1e-9. Longitudinal dynamics are left out.
template <typename Tyre>
[[nodiscard]] LinearFourWheel linearise(const FourWheelModel<double, Tyre>& model, double u);

namespace internal {
/// Everything but A, B, C and D.
[[nodiscard]] LinearFourWheel linear_four_wheel_frame(const VehicleParameters<double>& parameters, double u,
                                                      bool lagged_slip);
}  // namespace internal

template <typename Tyre>
LinearFourWheel linearise(const FourWheelModel<double, Tyre>& with_options, double u) {
  FourWheelOptions options = with_options.options();
  options.longitudinal.reset();
  const FourWheelModel<double, Tyre> model(with_options.parameters(), with_options.tyres(), options);
  LinearFourWheel out = internal::linear_four_wheel_frame(model.parameters(), u, options.relaxation_length > 0.0);
  const auto n = static_cast<Eigen::Index>(out.states.size());
  constexpr double kStep = 1e-6;
  const FourWheelState<double> start = model.steady_start(u);
  /// Rates of the states, then r, a_y, v and roll.
  const auto at = [&](Eigen::Index moved, double by) {
    FourWheelState<double> s = start;
    double steer = 0.0;
    (moved < n ? s(out.states[moved]) : steer) += by;
    FourWheelRates<double> rates;
    model.rates(s, model.wheel_controls(steer), {}, rates);
    Eigen::VectorXd all(n + 4);
    for (Eigen::Index i = 0; i < n; ++i) all(i) = rates.derivative(out.states[i]);
    all.tail<4>() << s(kR), rates.lateral_acceleration, s(kV) / u, s(kRoll);
    return all;
  };
  Eigen::MatrixXd J(n + 4, n + 1);
  for (Eigen::Index j = 0; j <= n; ++j) J.col(j) = (at(j, kStep) - at(j, -kStep)) / (2.0 * kStep);
  out.A = J.topLeftCorner(n, n);
  out.B = J.topRightCorner(n, 1);
  out.C = J.bottomLeftCorner(4, n);
  out.D = J.bottomRightCorner(4, 1);
  return out;
}

}  // namespace veridyn::vehicle
