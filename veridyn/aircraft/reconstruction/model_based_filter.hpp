#pragma once

#include <ceres/jet.h>

#include <array>

#include "veridyn/aircraft/reconstruction/air_data_filter.hpp"
#include "veridyn/aircraft/model/atmosphere.hpp"
#include "veridyn/aircraft/model/flight_dynamics.hpp"
#include "veridyn/aircraft/model/subject.hpp"

namespace veridyn::aircraft {

/// How far the coefficients of a model may be off, in the order CL, CD, CY: a constant that is not known beforehand,
/// and how it wanders (alpha and beta come close to their bound only while that is slow).
struct ModelError {
  std::array<double, 3> initial{0.02, 0.005, 0.01};  ///< 1 sigma at the start [-]
  std::array<double, 3> walk{5e-4, 2e-4, 2e-4};      ///< [1/sqrt(s)]
  std::array<bool, 3> modelled{true, true, true};    ///< false: nothing is known of it, the accelerometer tells it
  static constexpr double kUnknownInitial = 1.0;     ///< where it is not modelled
  static constexpr double kUnknownWalk = 0.5;        ///< [1/sqrt(s)]
  [[nodiscard]] double sigma(std::size_t i) const { return modelled[i] ? initial[i] : kUnknownInitial; }
  [[nodiscard]] double density(std::size_t i) const { return modelled[i] ? walk[i] : kUnknownWalk; }
};

/// Motion of an aircraft whose aerodynamics are known, in moving air.
///
/// The specification's state [Va alpha beta W] with the wind-axes equations of section 8 holds in air that moves
/// uniformly. In gusts, the velocity relative to the air also changes because the air does:
///     v_r' = f/m + R' g - omega x v_r - (gust' + omega x gust) - R' W'
/// and Dryden's gust' is white in part. So the state is the one of `AirDataModel` (attitude, velocity over ground,
/// gusts with Dryden's dynamics, slow wind), from which v_r = R'(v - W) - gust and with it Va, alpha and beta follow
/// exactly; between them and the specification's state lies a smooth one-to-one map, and no derivative of a gust is
/// needed. What is new against the model-free filter:
/// - v' = R f/m + g, with the aerodynamic force and thrust f of the subject's model at v_r, the rates and the
///   deflections, integrated by the midpoint rule;
/// - the accelerometer measures f/m;
/// - errors of CL, CD and CY (random walks: a wrong model must not make the filter sure of itself), which act in f.
/// In air at rest d(Va, alpha, beta)/dt is `wind_axes_rate` (a test compares them).
///
/// The Jacobian of `propagate` comes by automatic differentiation; that of the accelerometer too, with respect to v_r,
/// rates and coefficient errors. The velocity carries white force noise of the accelerometer's size: what the model
/// does not say of the force from sample to sample.
///
/// The error vector is that of `AirDataModel`, then the errors of CL, CD, CY.
template <int kImuErrors, bool kAirDataErrors>
struct ModelBasedAirData : AirDataModel<kImuErrors, kAirDataErrors> {
  using Base = AirDataModel<kImuErrors, kAirDataErrors>;
  static constexpr int kCoefficientError = Base::kStates;
  static constexpr int kStates = Base::kStates + 3;
  static constexpr int kDynamic = Base::kDynamic;
  static constexpr bool kHasAerodynamics = true;

  using Vector = Eigen::Matrix<double, kStates, 1>;
  using Covariance = Eigen::Matrix<double, kStates, kStates>;

  template <typename Scalar>
  struct State : Base::template State<Scalar> {
    Eigen::Matrix<Scalar, 3, 1> coefficient_error = Eigen::Matrix<Scalar, 3, 1>::Zero();
  };

  struct Input : Base::Input {
    Controls<double> controls;
    double air_density = kSeaLevelDensity;
  };

  /// Whose force model it is; moments are not used. Never null when used.
  const Subject* subject = nullptr;
  ModelError error;

  /// Specific force [m/s^2, body axes] at a velocity relative to the air, rates and coefficient errors.
  template <typename S>
  [[nodiscard]] Eigen::Matrix<S, 3, 1> specific_force(const Eigen::Matrix<S, 3, 1>& v_r,
                                                      const Eigen::Matrix<S, 3, 1>& omega,
                                                      const Eigen::Matrix<S, 3, 1>& coefficient_error,
                                                      const Controls<double>& controls, double air_density) const {
    using std::cos;
    using std::sin;
    Controls<S> c;
    c.de = S(controls.de);
    c.da = S(controls.da);
    c.dr = S(controls.dr);
    c.throttle = S(controls.throttle);
    c.rotor_speed = S(controls.rotor_speed);
    const AeroLoads<S> loads = aero_loads<S>(*subject, v_r, omega, c, S(air_density));
    const S qS = loads.dynamic_pressure * S(subject->wing_area / subject->mass);
    const S ca = cos(loads.air.alpha), sa = sin(loads.air.alpha);
    const auto& e = coefficient_error;
    Eigen::Matrix<S, 3, 1> a = loads.force * S(1.0 / subject->mass);
    a(0) += qS * (e(0) * sa - e(1) * ca);
    a(1) += qS * e(2);
    a(2) -= qS * (e(1) * sa + e(0) * ca);
    return a;
  }

  template <typename S>
  [[nodiscard]] Eigen::Matrix<S, 3, 1> specific_force(const State<S>& x, const Input& u) const {
    return specific_force<S>(this->template air_velocity<S>(x), Base::template rates<S>(x, u.gyro), x.coefficient_error,
                             u.controls, u.air_density);
  }

  template <typename S>
  [[nodiscard]] State<S> propagate(const State<S>& x, const Input& u, double dt) const {
    const Eigen::Matrix<S, 3, 1> omega = Base::template rates<S>(x, u.gyro);
    State<S> middle = x;
    as_base(middle) = this->template advance<S>(x, omega, specific_force<S>(x, u), u.airspeed, 0.5 * dt);
    State<S> next = x;
    as_base(next) = this->template advance<S>(x, omega, specific_force<S>(middle, u), u.airspeed, dt);
    return next;
  }

  template <typename S>
  [[nodiscard]] static State<S> retract(const State<double>& x, const Eigen::Matrix<S, kStates, 1>& e) {
    State<S> moved;
    as_base(moved) = Base::template retract<S>(x, e.template head<Base::kStates>());
    moved.coefficient_error = x.coefficient_error.template cast<S>() + e.template tail<3>();
    return moved;
  }

  template <typename S>
  [[nodiscard]] static Eigen::Matrix<S, kStates, 1> local(const State<double>& from, const State<S>& to) {
    Eigen::Matrix<S, kStates, 1> e;
    e.template head<Base::kStates>() = Base::template local<S>(from, to);
    e.template tail<3>() = to.coefficient_error - from.coefficient_error.template cast<S>();
    return e;
  }

  template <class Matrix>
  void add_process_noise(const State<double>& x, const Input& u, double dt, Matrix& P) const {
    Base::add_process_noise(x, u, dt, P);
    for (int i = 0; i < 3; ++i) {
      double& variance = P(kCoefficientError + i, kCoefficientError + i);
      const double walk = error.density(static_cast<std::size_t>(i));
      if (variance > 0.0) variance += walk * walk * dt;
    }
  }

  [[nodiscard]] Eigen::Matrix<double, 3, kStates> air_velocity_jacobian(const State<double>& x) const {
    Eigen::Matrix<double, 3, kStates> J = Eigen::Matrix<double, 3, kStates>::Zero();
    J.template leftCols<Base::kStates>() = Base::air_velocity_jacobian(x);
    return J;
  }

  /// The closed form is the model-free filter's; here the Jacobian is automatic.
  void transition_rows() const = delete;

 private:
  template <typename S>
  [[nodiscard]] static typename Base::template State<S>& as_base(State<S>& x) {
    return x;
  }
};

/// Accelerometer at the centre of gravity along body axis 0, 1, 2: (1 + scale) f/m + bias [m/s^2]. `gyro` are the
/// measured rates; their noise enters through the rate derivatives, as `noise_variance` for a gyro of standard
/// deviation `gyro_sigma` a sample.
template <class Model>
[[nodiscard]] Prediction<Model> predict_specific_force(const Model& model,
                                                       const typename Model::template State<double>& x,
                                                       const typename Model::Input& u, int axis, double gyro_sigma,
                                                       double& noise_variance) {
  using Jet = ceres::Jet<double, 9>;
  const Eigen::Vector3d v = model.template air_velocity<double>(x);
  const Eigen::Vector3d omega = Model::template rates<double>(x, u.gyro);
  Eigen::Matrix<Jet, 3, 1> v_jet, omega_jet, error_jet;
  for (int i = 0; i < 3; ++i) {
    v_jet(i) = Jet(v(i), i);
    omega_jet(i) = Jet(omega(i), 3 + i);
    error_jet(i) = Jet(x.coefficient_error(i), 6 + i);
  }
  const Jet f = model.template specific_force<Jet>(v_jet, omega_jet, error_jet, u.controls, u.air_density)(axis);
  double gain = 1.0;
  if constexpr (Model::kHasImuScales) gain += x.imu_scale(3 + axis);
  Prediction<Model> p;
  p.value = gain * f.a + x.imu_bias(3 + axis);
  p.H = model.air_velocity_jacobian(x).transpose() * (gain * f.v.template head<3>());
  p.H.template segment<3>(Model::kCoefficientError) = gain * f.v.template tail<3>();
  const Eigen::Vector3d by_rate = gain * f.v.template segment<3>(3);
  if constexpr (Model::kHasImuBiases) {
    for (int i = 0; i < 3; ++i) {
      double gyro_gain = 1.0;
      if constexpr (Model::kHasImuScales) {
        gyro_gain = 1.0 / (1.0 + x.imu_scale(i));
        p.H(Model::kImuScale + i) = -by_rate(i) * omega(i) * gyro_gain;
      }
      p.H(Model::kImuBias + i) = -by_rate(i) * gyro_gain;
    }
    p.H(Model::kImuBias + 3 + axis) = 1.0;
    if constexpr (Model::kHasImuScales) p.H(Model::kImuScale + 3 + axis) = f.a;
  }
  noise_variance = by_rate.squaredNorm() * gyro_sigma * gyro_sigma;
  return p;
}

}  // namespace veridyn::aircraft
