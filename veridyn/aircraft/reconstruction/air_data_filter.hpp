#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/simulation/dryden.hpp"
#include "veridyn/estimation/kalman/kalman_model.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::aircraft {

/// Power of what drives the model: each is the square root of a power spectral density, so that white noise of standard
/// deviation sigma sampled every T seconds has sigma sqrt(T).
struct AirDataNoise {
  double gyro = 6.1e-4;           ///< rad/s sqrt(s)
  double accelerometer = 5e-3;    ///< m/s^2 sqrt(s)
  double wind_walk = 0.02;        ///< of the slow wind, horizontal [m/s / sqrt(s)]
  double wind_down_walk = 0.01;   ///< of the slow wind, vertical
  double gyro_bias_walk = 1e-5;   ///< rad/s / sqrt(s)
  double accel_bias_walk = 1e-3;  ///< m/s^2 / sqrt(s)
};

/// Kinematics of an aircraft in moving air: what a filter knows that does not know the aircraft.
///
/// The specification's state [u_r v_r w_r W_N W_E W_D], driven by accelerometer, gyro and Euler angles, is the
/// difference of three things that change for different reasons; here each is a state of its own:
/// - attitude (quaternion, body to NED), driven by the gyro: corrected by the Euler angles of the AHRS, whose white
///   error of 0.75 deg is averaged down to a few hundredths of a degree instead of entering every step;
/// - velocity over ground v [m/s, NED], driven by the accelerometer: v' = R a + g;
/// - the air's velocity: a slow wind W [m/s, NED], a random walk, plus gusts along the body axes with the dynamics of
///   Dryden's spectra. Gusts as states, not as noise on W, are what makes the estimate as good as the sensors allow.
/// Then v_r = R' (v - W) - gust, and every equation of the specification's section 5 follows by differentiation.
///
/// Gust states are dimensionless with stationary covariances that do not depend on the airspeed; with a = Va / L:
///     u:     x' = -a_u x + sqrt(2 a_u) n,            gust_u = sigma_u x,                       E x^2 = 1
///     v, w:  z' = -a z + sqrt(a) n,  r' = a (z - r), gust = sigma sqrt(3) (z - (1 - 1/sqrt 3) r),
///            E z^2 = 1/2, E z r = E r^2 = 1/4, hence E gust^2 = sigma^2
/// which are the transfer functions Hu and Hv exactly. The discretisation is exact for a step of constant airspeed, so
/// the covariance stays stationary for any step. (The dependence of a on the estimated airspeed is not differentiated.)
///
/// The error vector: attitude (body axes, rad) 0..2, velocity 3..5, gust 6..10, slow wind 11..13, then, where asked
/// for, `kImuErrors` errors of the inertial sensors (6: biases of gyro and accelerometer; 12: their scale factors
/// behind them) and errors of the air data (5): `kAlphaBias` [rad], `kBetaBias` [rad], `kAlphaScale`, `kPitotScale`
/// [-], `kPitotBias` [Pa]. An inertial sensor shows y = (1 + scale) true + bias.
template <int kImuErrors, bool kAirDataErrors>
struct AirDataModel {
  static_assert(kImuErrors == 0 || kImuErrors == 6 || kImuErrors == 12);
  static constexpr int kAttitude = 0;
  static constexpr int kVelocity = 3;
  static constexpr int kGust = 6;
  static constexpr int kWind = 11;
  static constexpr int kImuBias = 14;
  static constexpr int kImuScale = 20;
  static constexpr int kAirDataError = 14 + kImuErrors;
  static constexpr int kStates = kAirDataError + (kAirDataErrors ? 5 : 0);
  static constexpr int kDynamic = 11;
  static constexpr bool kHasImuBiases = kImuErrors > 0;
  static constexpr bool kHasImuScales = kImuErrors > 6;
  static constexpr bool kHasAirDataErrors = kAirDataErrors;
  static constexpr bool kHasAerodynamics = false;

  enum AirDataErrorIndex { kAlphaBias, kBetaBias, kAlphaScale, kPitotScale, kPitotBias };

  using Vector = Eigen::Matrix<double, kStates, 1>;
  using Covariance = Eigen::Matrix<double, kStates, kStates>;

  template <typename Scalar>
  struct State {
    Eigen::Quaternion<Scalar> attitude = Eigen::Quaternion<Scalar>(Scalar(1.0), Scalar(0.0), Scalar(0.0), Scalar(0.0));
    Eigen::Matrix<Scalar, 3, 1> velocity = Eigen::Matrix<Scalar, 3, 1>::Zero();
    Eigen::Matrix<Scalar, 5, 1> gust = Eigen::Matrix<Scalar, 5, 1>::Zero();
    Eigen::Matrix<Scalar, 3, 1> wind = Eigen::Matrix<Scalar, 3, 1>::Zero();
    Eigen::Matrix<Scalar, 6, 1> imu_bias = Eigen::Matrix<Scalar, 6, 1>::Zero();
    Eigen::Matrix<Scalar, 6, 1> imu_scale = Eigen::Matrix<Scalar, 6, 1>::Zero();
    Eigen::Matrix<Scalar, 5, 1> air_error = Eigen::Matrix<Scalar, 5, 1>::Zero();
  };

  struct Input {
    Eigen::Vector3d gyro = Eigen::Vector3d::Zero();            ///< rad/s
    Eigen::Vector3d specific_force = Eigen::Vector3d::Zero();  ///< m/s^2
    double airspeed = 0.0;                                     ///< for the gusts' dynamics [m/s]
    double imu_noise_factor = 1.0;                             ///< on the variance: > 1 across missing samples
  };

  static constexpr double kGravity = 9.80665;
  static constexpr double kLead = 1.0 - 0.57735026918962576;  // 1 - 1/sqrt(3)
  static constexpr double kSqrt3 = 1.7320508075688773;

  DrydenSettings spectrum;
  AirDataNoise noise;

  /// Gust along the body axes [m/s].
  template <typename S>
  [[nodiscard]] Eigen::Matrix<S, 3, 1> gust_velocity(const State<S>& x) const {
    return {spectrum.sigma_u * x.gust(0), (spectrum.sigma_v * kSqrt3) * (x.gust(1) - kLead * x.gust(2)),
            (spectrum.sigma_w * kSqrt3) * (x.gust(3) - kLead * x.gust(4))};
  }

  /// Velocity relative to the air [m/s, body axes].
  template <typename S>
  [[nodiscard]] Eigen::Matrix<S, 3, 1> air_velocity(const State<S>& x) const {
    return x.attitude.conjugate() * Eigen::Matrix<S, 3, 1>(x.velocity - x.wind) - gust_velocity(x);
  }

  /// Body rates [rad/s] that a gyro means by `gyro`.
  template <typename S>
  [[nodiscard]] static Eigen::Matrix<S, 3, 1> rates(const State<S>& x, const Eigen::Vector3d& gyro) {
    Eigen::Matrix<S, 3, 1> omega = gyro.template cast<S>();
    if constexpr (kHasImuBiases) omega -= x.imu_bias.template head<3>();
    if constexpr (kHasImuScales) {
      for (int i = 0; i < 3; ++i) omega(i) /= S(1.0) + x.imu_scale(i);
    }
    return omega;
  }

  template <typename S>
  [[nodiscard]] State<S> propagate(const State<S>& x, const Input& u, double dt) const {
    Eigen::Matrix<S, 3, 1> force = u.specific_force.template cast<S>();
    if constexpr (kHasImuBiases) force -= x.imu_bias.template tail<3>();
    if constexpr (kHasImuScales) {
      for (int i = 0; i < 3; ++i) force(i) /= S(1.0) + x.imu_scale(3 + i);
    }
    return advance<S>(x, rates<S>(x, u.gyro), force, u.airspeed, dt);
  }

  /// The same from true rates `omega` and specific force.
  template <typename S>
  [[nodiscard]] State<S> advance(const State<S>& x, const Eigen::Matrix<S, 3, 1>& omega,
                                 const Eigen::Matrix<S, 3, 1>& force, double airspeed, double dt) const {
    State<S> next = x;
    // Midpoint rule: the attitude half-way turns the specific force.
    const Eigen::Quaternion<S> half = rotation<S>(omega * S(0.5 * dt));
    const Eigen::Quaternion<S> middle = x.attitude * half;
    next.attitude = middle * half;
    next.velocity += (middle * force) * S(dt);
    next.velocity(2) += S(kGravity * dt);
    const Decay d = decay(airspeed, dt);
    next.gust(0) = S(d.u) * x.gust(0);
    next.gust(1) = S(d.v) * x.gust(1);
    next.gust(2) = S(d.v) * (x.gust(2) + S(d.step_v) * x.gust(1));
    next.gust(3) = S(d.w) * x.gust(3);
    next.gust(4) = S(d.w) * (x.gust(4) + S(d.step_w) * x.gust(3));
    return next;
  }

  template <typename S>
  [[nodiscard]] static State<S> retract(const State<double>& x, const Eigen::Matrix<S, kStates, 1>& e) {
    State<S> moved;
    moved.attitude = x.attitude.template cast<S>() * rotation<S>(e.template segment<3>(kAttitude));
    moved.velocity = x.velocity.template cast<S>() + e.template segment<3>(kVelocity);
    moved.gust = x.gust.template cast<S>() + e.template segment<5>(kGust);
    moved.wind = x.wind.template cast<S>() + e.template segment<3>(kWind);
    if constexpr (kHasImuBiases) moved.imu_bias = x.imu_bias.template cast<S>() + e.template segment<6>(kImuBias);
    if constexpr (kHasImuScales) moved.imu_scale = x.imu_scale.template cast<S>() + e.template segment<6>(kImuScale);
    moved.air_error = x.air_error.template cast<S>();
    if constexpr (kAirDataErrors) moved.air_error += e.template segment<5>(kAirDataError);
    return moved;
  }

  template <typename S>
  [[nodiscard]] static Eigen::Matrix<S, kStates, 1> local(const State<double>& from, const State<S>& to) {
    Eigen::Matrix<S, kStates, 1> e;
    const Eigen::Quaternion<S> turn = from.attitude.conjugate().template cast<S>() * to.attitude;
    const S two = turn.w() < S(0.0) ? S(-2.0) : S(2.0);
    e.template segment<3>(kAttitude) = turn.vec() * two;
    e.template segment<3>(kVelocity) = to.velocity - from.velocity.template cast<S>();
    e.template segment<5>(kGust) = to.gust - from.gust.template cast<S>();
    e.template segment<3>(kWind) = to.wind - from.wind.template cast<S>();
    if constexpr (kHasImuBiases) e.template segment<6>(kImuBias) = to.imu_bias - from.imu_bias.template cast<S>();
    if constexpr (kHasImuScales) e.template segment<6>(kImuScale) = to.imu_scale - from.imu_scale.template cast<S>();
    if constexpr (kAirDataErrors)
      e.template segment<5>(kAirDataError) = to.air_error - from.air_error.template cast<S>();
    return e;
  }

  /// Jacobian of `propagate`, dynamic rows, in closed form: the attitude error turns with the body, tilts the specific
  /// force, and the biases act through the right Jacobian of the rotation group.
  [[nodiscard]] Eigen::Matrix<double, kDynamic, kStates> transition_rows(const State<double>& x, const Input& u,
                                                                         double dt, State<double>& after) const {
    after = propagate<double>(x, u, dt);
    const Eigen::Vector3d omega = rates<double>(x, u.gyro);
    Eigen::Vector3d force = u.specific_force;
    if constexpr (kHasImuBiases) force -= x.imu_bias.template tail<3>();
    if constexpr (kHasImuScales) force.array() /= 1.0 + x.imu_scale.template tail<3>().array();
    const Eigen::Matrix3d R_half = rotation<double>(omega * (0.5 * dt)).toRotationMatrix();
    const Eigen::Matrix3d R_NB = x.attitude.toRotationMatrix();
    Eigen::Matrix<double, kDynamic, kStates> F = Eigen::Matrix<double, kDynamic, kStates>::Zero();
    F.template block<3, 3>(kAttitude, kAttitude) = R_half.transpose() * R_half.transpose();
    F.template block<3, 3>(kVelocity, kAttitude) = R_NB * cross_matrix(R_half * force) * -dt;
    F.template block<3, 3>(kVelocity, kVelocity).setIdentity();
    if constexpr (kHasImuBiases) {
      const Eigen::Matrix3d by_rate_attitude = right_jacobian(omega * dt) * -dt;
      const Eigen::Matrix3d by_rate_velocity =
          R_NB * R_half * cross_matrix(force) * right_jacobian(omega * (0.5 * dt)) * (0.5 * dt * dt);
      const Eigen::Matrix3d by_force = R_NB * R_half * -dt;
      // d(true)/d(bias) = -1/(1 + scale), d(true)/d(scale) = -true/(1 + scale); the minus is in the matrices above.
      for (int i = 0; i < 3; ++i) {
        double gyro_gain = 1.0, accel_gain = 1.0;
        if constexpr (kHasImuScales) {
          gyro_gain = 1.0 / (1.0 + x.imu_scale(i));
          accel_gain = 1.0 / (1.0 + x.imu_scale(3 + i));
          F.template block<3, 1>(kAttitude, kImuScale + i) = by_rate_attitude.col(i) * (omega(i) * gyro_gain);
          F.template block<3, 1>(kVelocity, kImuScale + i) = by_rate_velocity.col(i) * (omega(i) * gyro_gain);
          F.template block<3, 1>(kVelocity, kImuScale + 3 + i) = by_force.col(i) * (force(i) * accel_gain);
        }
        F.template block<3, 1>(kAttitude, kImuBias + i) = by_rate_attitude.col(i) * gyro_gain;
        F.template block<3, 1>(kVelocity, kImuBias + i) = by_rate_velocity.col(i) * gyro_gain;
        F.template block<3, 1>(kVelocity, kImuBias + 3 + i) = by_force.col(i) * accel_gain;
      }
    }
    const Decay d = decay(u.airspeed, dt);
    F(kGust, kGust) = d.u;
    F(kGust + 1, kGust + 1) = F(kGust + 2, kGust + 2) = d.v;
    F(kGust + 2, kGust + 1) = d.v * d.step_v;
    F(kGust + 3, kGust + 3) = F(kGust + 4, kGust + 4) = d.w;
    F(kGust + 4, kGust + 3) = d.w * d.step_w;
    return F;
  }

  template <class Matrix>
  void add_process_noise(const State<double>&, const Input& u, double dt, Matrix& P) const {
    const double gyro = noise.gyro * noise.gyro * dt * u.imu_noise_factor;
    const double force = noise.accelerometer * noise.accelerometer * dt * u.imu_noise_factor;
    for (int i = 0; i < 3; ++i) {
      P(kAttitude + i, kAttitude + i) += gyro;
      P(kVelocity + i, kVelocity + i) += force;
    }
    // Q = Pi - F Pi F' with the stationary covariance Pi keeps the gusts stationary for any step.
    const Decay d = decay(u.airspeed, dt);
    P(kGust, kGust) += 1.0 - d.u * d.u;
    add_pair(P, kGust + 1, d.v, d.step_v);
    add_pair(P, kGust + 3, d.w, d.step_w);
    const double walk = noise.wind_walk * noise.wind_walk * dt;
    P(kWind, kWind) += walk;
    P(kWind + 1, kWind + 1) += walk;
    P(kWind + 2, kWind + 2) += noise.wind_down_walk * noise.wind_down_walk * dt;
    if constexpr (kHasImuBiases) {
      for (int i = 0; i < 3; ++i) {
        if (P(kImuBias + i, kImuBias + i) > 0.0)
          P(kImuBias + i, kImuBias + i) += noise.gyro_bias_walk * noise.gyro_bias_walk * dt;
        if (P(kImuBias + 3 + i, kImuBias + 3 + i) > 0.0)
          P(kImuBias + 3 + i, kImuBias + 3 + i) += noise.accel_bias_walk * noise.accel_bias_walk * dt;
      }
    }
  }

  /// Stationary covariance of the five gust states.
  [[nodiscard]] static Eigen::Matrix<double, 5, 5> stationary_gust_covariance() {
    Eigen::Matrix<double, 5, 5> Pi = Eigen::Matrix<double, 5, 5>::Zero();
    Pi(0, 0) = 1.0;
    for (const int i : {1, 3}) {
      Pi(i, i) = 0.5;
      Pi(i, i + 1) = Pi(i + 1, i) = Pi(i + 1, i + 1) = 0.25;
    }
    return Pi;
  }

  /// d(v_r) / d(error), of which only the columns of attitude, velocity, gust and wind are not zero.
  [[nodiscard]] Eigen::Matrix<double, 3, kStates> air_velocity_jacobian(const State<double>& x) const {
    Eigen::Matrix<double, 3, kStates> J = Eigen::Matrix<double, 3, kStates>::Zero();
    const Eigen::Matrix3d R_BN = x.attitude.conjugate().toRotationMatrix();
    const Eigen::Vector3d v = R_BN * (x.velocity - x.wind);
    J(0, kAttitude + 1) = -v.z();
    J(0, kAttitude + 2) = v.y();
    J(1, kAttitude) = v.z();
    J(1, kAttitude + 2) = -v.x();
    J(2, kAttitude) = -v.y();
    J(2, kAttitude + 1) = v.x();
    J.template middleCols<3>(kVelocity) = R_BN;
    J.template middleCols<3>(kWind) = -R_BN;
    J(0, kGust) = -spectrum.sigma_u;
    J(1, kGust + 1) = -spectrum.sigma_v * kSqrt3;
    J(1, kGust + 2) = spectrum.sigma_v * kSqrt3 * kLead;
    J(2, kGust + 3) = -spectrum.sigma_w * kSqrt3;
    J(2, kGust + 4) = spectrum.sigma_w * kSqrt3 * kLead;
    return J;
  }

 private:
  struct Decay {
    double u, v, w, step_v, step_w;
  };
  [[nodiscard]] Decay decay(double airspeed, double dt) const {
    const double path = airspeed * dt;
    const double v = std::exp(-path / spectrum.Lv);
    const double w = spectrum.Lw == spectrum.Lv ? v : std::exp(-path / spectrum.Lw);
    const double u = spectrum.Lu == spectrum.Lv ? v : std::exp(-path / spectrum.Lu);
    return {u, v, w, path / spectrum.Lv, path / spectrum.Lw};
  }

  [[nodiscard]] static Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
    Eigen::Matrix3d m;
    m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
    return m;
  }

  /// exp(phi + d) = exp(phi) exp(J d) to first order.
  [[nodiscard]] static Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& phi) {
    const double square = phi.squaredNorm();
    double a = 0.5 - square * (1.0 / 24.0 - square / 720.0);
    double b = 1.0 / 6.0 - square * (1.0 / 120.0 - square / 5040.0);
    if (square > 1e-2) {
      const double angle = std::sqrt(square);
      a = (1.0 - std::cos(angle)) / square;
      b = (angle - std::sin(angle)) / (square * angle);
    }
    const Eigen::Matrix3d X = cross_matrix(phi);
    return Eigen::Matrix3d::Identity() - a * X + b * X * X;
  }

  template <class Matrix>
  static void add_pair(Matrix& P, int i, double e, double step) {
    const double e2 = e * e;
    P(i, i) += 0.5 * (1.0 - e2);
    const double cross = 0.25 - e2 * (0.5 * step + 0.25);
    P(i, i + 1) += cross;
    P(i + 1, i) += cross;
    P(i + 1, i + 1) += 0.25 - e2 * (0.25 + 0.5 * step + 0.5 * step * step);
  }

  /// Unit quaternion of a rotation vector.
  template <typename S>
  [[nodiscard]] static Eigen::Quaternion<S> rotation(const Eigen::Matrix<S, 3, 1>& r) {
    using std::cos;
    using std::sin;
    using std::sqrt;
    const S square = r.squaredNorm();
    if (square < S(1e-4)) {  // next terms are below 1e-15; regular for derivatives at zero
      const S k = S(0.5) - square * (S(1.0 / 48.0) - square * S(1.0 / 3840.0));
      const S w = S(1.0) - square * (S(1.0 / 8.0) - square * (S(1.0 / 384.0) - square * S(1.0 / 46080.0)));
      return {w, k * r(0), k * r(1), k * r(2)};
    }
    const S angle = sqrt(square);
    const S k = sin(S(0.5) * angle) / angle;
    return {cos(S(0.5) * angle), k * r(0), k * r(1), k * r(2)};
  }
};

/// What a sensor should show, and how that changes with the state's error.
template <class Model>
struct Prediction {
  double value = 0.0;
  typename Model::Vector H = Model::Vector::Zero();
};

/// Velocity over ground along north, east or down (axis 0, 1, 2) [m/s].
template <class Model>
[[nodiscard]] Prediction<Model> predict_ground_velocity(const typename Model::template State<double>& x, int axis) {
  Prediction<Model> p;
  p.value = x.velocity(axis);
  p.H(Model::kVelocity + axis) = 1.0;
  return p;
}

/// Roll, pitch or yaw (axis 0, 1, 2) [rad]. Near pitch +-90 deg, where Euler angles end, `usable` is false.
template <class Model>
[[nodiscard]] Prediction<Model> predict_euler_angle(const typename Model::template State<double>& x, int axis,
                                                    bool& usable) {
  const auto e = numerics::euler_from_quaternion(x.attitude);
  const double cf = std::cos(e.phi), sf = std::sin(e.phi), ct = std::cos(e.theta);
  usable = std::abs(ct) > 0.17;
  Prediction<Model> p;
  if (!usable) return p;
  const double tt = std::sin(e.theta) / ct;
  switch (axis) {
    case 0:
      p.value = e.phi;
      p.H.template head<3>() << 1.0, sf * tt, cf * tt;
      break;
    case 1:
      p.value = e.theta;
      p.H.template head<3>() << 0.0, cf, -sf;
      break;
    default:
      p.value = e.psi;
      p.H.template head<3>() << 0.0, sf / ct, cf / ct;
      break;
  }
  return p;
}

/// Dynamic pressure of the pitot tube [Pa]: (1 + scale) rho |v_r|^2 / 2 + bias.
template <class Model>
[[nodiscard]] Prediction<Model> predict_dynamic_pressure(const Model& model,
                                                         const typename Model::template State<double>& x,
                                                         double air_density) {
  const Eigen::Vector3d v = model.air_velocity(x);
  const double pressure = 0.5 * air_density * v.squaredNorm();
  const double gain = 1.0 + x.air_error(Model::kPitotScale);
  Prediction<Model> p;
  p.value = gain * pressure + x.air_error(Model::kPitotBias);
  p.H = model.air_velocity_jacobian(x).transpose() * (gain * air_density * v);
  if constexpr (Model::kHasAirDataErrors) {
    p.H(Model::kAirDataError + Model::kPitotScale) = pressure;
    p.H(Model::kAirDataError + Model::kPitotBias) = 1.0;
  }
  return p;
}

/// True airspeed [m/s]: sqrt(1 + scale) |v_r|, the pressure's scale (its bias has no constant effect here).
template <class Model>
[[nodiscard]] Prediction<Model> predict_airspeed(const Model& model, const typename Model::template State<double>& x) {
  const Eigen::Vector3d v = model.air_velocity(x);
  const double speed = std::max(v.norm(), 1e-3);
  const double gain = std::sqrt(std::max(1.0 + x.air_error(Model::kPitotScale), 0.01));
  Prediction<Model> p;
  p.value = gain * speed;
  p.H = model.air_velocity_jacobian(x).transpose() * (v * (gain / speed));
  if constexpr (Model::kHasAirDataErrors) p.H(Model::kAirDataError + Model::kPitotScale) = 0.5 * speed / gain;
  return p;
}

/// Angle-of-attack vane [rad]: (1 + scale) atan2(w, u) + bias, at a vane that moves with `arm_velocity` = omega x r
/// relative to the centre of gravity [m/s, body axes]. The scale is the upwash slope.
template <class Model>
[[nodiscard]] Prediction<Model> predict_alpha(const Model& model, const typename Model::template State<double>& x,
                                              const Eigen::Vector3d& arm_velocity) {
  const Eigen::Vector3d v = model.air_velocity(x) + arm_velocity;
  const double square = std::max(v.x() * v.x() + v.z() * v.z(), 1e-6);
  const double alpha = std::atan2(v.z(), v.x());
  const double gain = 1.0 + x.air_error(Model::kAlphaScale);
  Prediction<Model> p;
  p.value = gain * alpha + x.air_error(Model::kAlphaBias);
  p.H = model.air_velocity_jacobian(x).transpose() * Eigen::Vector3d(-v.z(), 0.0, v.x()) * (gain / square);
  if constexpr (Model::kHasAirDataErrors) {
    p.H(Model::kAirDataError + Model::kAlphaScale) = alpha;
    p.H(Model::kAirDataError + Model::kAlphaBias) = 1.0;
  }
  return p;
}

/// Sideslip vane [rad], plus its bias: asin(v / |v_r|), or the flank angle atan2(v, u) that a vane on a boom turns by
/// when `flank`.
template <class Model>
[[nodiscard]] Prediction<Model> predict_beta(const Model& model, const typename Model::template State<double>& x,
                                             const Eigen::Vector3d& arm_velocity, bool flank) {
  const Eigen::Vector3d v = model.air_velocity(x) + arm_velocity;
  Eigen::Vector3d gradient;
  Prediction<Model> p;
  if (flank) {
    p.value = std::atan2(v.y(), v.x());
    gradient = Eigen::Vector3d(-v.y(), v.x(), 0.0) / std::max(v.x() * v.x() + v.y() * v.y(), 1e-6);
  } else {
    const double square = std::max(v.squaredNorm(), 1e-6);
    const double plane = std::max(std::hypot(v.x(), v.z()), 1e-3);
    p.value = std::atan2(v.y(), plane);
    gradient = Eigen::Vector3d(-v.x() * v.y() / plane, plane, -v.z() * v.y() / plane) / square;
  }
  p.value += x.air_error(Model::kBetaBias);
  p.H = model.air_velocity_jacobian(x).transpose() * gradient;
  if constexpr (Model::kHasAirDataErrors) p.H(Model::kAirDataError + Model::kBetaBias) = 1.0;
  return p;
}

}  // namespace veridyn::aircraft
