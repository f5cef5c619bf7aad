#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "veridyn/aircraft/model/atmosphere.hpp"
#include "veridyn/aircraft/model/flight_dynamics.hpp"
#include "veridyn/aircraft/simulation/dryden.hpp"
#include "veridyn/core/constants.hpp"
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

/// What the filters estimate: one type for all of them. A filter that does not estimate the errors of sensors or of
/// the force model holds them where they are.
template <typename Scalar>
struct AirDataState {
  Eigen::Quaternion<Scalar> attitude = Eigen::Quaternion<Scalar>(Scalar(1.0), Scalar(0.0), Scalar(0.0), Scalar(0.0));
  Eigen::Matrix<Scalar, 3, 1> velocity = Eigen::Matrix<Scalar, 3, 1>::Zero();
  Eigen::Matrix<Scalar, 5, 1> gust = Eigen::Matrix<Scalar, 5, 1>::Zero();
  Eigen::Matrix<Scalar, 3, 1> wind = Eigen::Matrix<Scalar, 3, 1>::Zero();
  Eigen::Matrix<Scalar, 6, 1> imu_bias = Eigen::Matrix<Scalar, 6, 1>::Zero();           ///< gyro, accelerometer
  Eigen::Matrix<Scalar, 6, 1> imu_scale = Eigen::Matrix<Scalar, 6, 1>::Zero();          ///< gyro, accelerometer
  Eigen::Matrix<Scalar, 5, 1> air_error = Eigen::Matrix<Scalar, 5, 1>::Zero();          ///< see AirDataErrorVector
  Eigen::Matrix<Scalar, 3, 1> coefficient_error = Eigen::Matrix<Scalar, 3, 1>::Zero();  ///< of CL, CD, CY
};

/// What drives a filter over a step.
struct AirDataInput {
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();            ///< rad/s
  Eigen::Vector3d specific_force = Eigen::Vector3d::Zero();  ///< m/s^2
  double airspeed = 0.0;                                     ///< for the gusts' dynamics [m/s]
  double imu_noise_factor = 1.0;                             ///< on the variance: > 1 across missing samples
  Controls<double> controls{};                               ///< for the model-based filter
  double air_density = kSeaLevelDensity;                     ///< for the model-based filter [kg/m^3]
};

/// The error vector that all filters share: attitude (body axes, rad) 0..2, velocity 3..5, gust 6..10, slow wind
/// 11..13, biases (14..19) and scale factors (20..25) of gyro and accelerometer, errors of CL, CD, CY (26..28). The
/// error vector of one filter leaves out what it does not estimate, in the same order.
struct AirDataErrorVector {
  static constexpr int kAttitude = 0;
  static constexpr int kVelocity = 3;
  static constexpr int kGust = 6;
  static constexpr int kWind = 11;
  static constexpr int kCore = 14;
  static constexpr int kImuErrors = 12;
  static constexpr int kFull = 29;
  static constexpr int kDynamic = 11;

  /// Errors of the air data, which are known along a run: `kAlphaBias`, `kBetaBias` [rad], `kAlphaScale`,
  /// `kPitotScale` [-], `kPitotBias` [Pa].
  enum AirDataErrorIndex { kAlphaBias, kBetaBias, kAlphaScale, kPitotScale, kPitotBias };
};

/// What a sensor should show, and how that changes with the error vector that all filters share.
struct Prediction {
  double value = 0.0;
  Eigen::Matrix<double, AirDataErrorVector::kCore, 1> core =
      Eigen::Matrix<double, AirDataErrorVector::kCore, 1>::Zero();
  /// By the errors of gyro and accelerometer and of CL, CD, CY; zero where `by_sensor_errors` is
  /// not.
  Eigen::Matrix<double, AirDataErrorVector::kFull - AirDataErrorVector::kCore, 1> further =
      Eigen::Matrix<double, AirDataErrorVector::kFull - AirDataErrorVector::kCore, 1>::Zero();
  bool by_sensor_errors = false;
};

/// Kinematics of an aircraft in moving air: what a filter knows that does not know the aircraft.
///
/// The specification's state [u_r v_r w_r W_N W_E W_D], driven by accelerometer, gyro and Euler angles, is the
/// difference of three things that change for different reasons; here each is a separate state:
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
/// An inertial sensor shows y = (1 + scale) true + bias. A scale factor or bias that is zero changes no bit.
struct AirDataMotion : AirDataErrorVector {
  template <typename Scalar>
  using State = AirDataState<Scalar>;
  using Input = AirDataInput;
  using CoreRows = Eigen::Matrix<double, kDynamic, kCore>;
  using ImuRows = Eigen::Matrix<double, kDynamic, kImuErrors>;

  DrydenSettings spectrum;
  AirDataNoise noise;

  static constexpr double kLead = 1.0 - 0.57735026918962576;  // 1 - 1/sqrt(3)
  static constexpr double kSqrt3 = 1.7320508075688773;

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
    omega -= x.imu_bias.template head<3>();
    for (int i = 0; i < 3; ++i) omega(i) /= S(1.0) + x.imu_scale(i);
    return omega;
  }

  /// Specific force [m/s^2] that an accelerometer means by `measured`.
  template <typename S>
  [[nodiscard]] static Eigen::Matrix<S, 3, 1> true_force(const State<S>& x, const Eigen::Vector3d& measured) {
    Eigen::Matrix<S, 3, 1> force = measured.template cast<S>();
    force -= x.imu_bias.template tail<3>();
    for (int i = 0; i < 3; ++i) force(i) /= S(1.0) + x.imu_scale(3 + i);
    return force;
  }

  template <typename S>
  [[nodiscard]] State<S> propagate(const State<S>& x, const Input& u, double dt) const {
    return advance<S>(x, rates<S>(x, u.gyro), true_force<S>(x, u.specific_force), u.airspeed, dt);
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

  /// The first 11 rows of d(error after) / d(error before) of `advance`, for the columns of attitude, velocity, gust
  /// and wind: the attitude error turns with the body and tilts the specific force.
  [[nodiscard]] CoreRows core_rows(const State<double>& x, const Eigen::Vector3d& omega, const Eigen::Vector3d& force,
                                   double airspeed, double dt) const;
  /// The same for the errors of gyro and accelerometer, which act through the right Jacobian of the rotation group;
  /// where the specific force does not come from the accelerometer, its columns stay zero.
  [[nodiscard]] ImuRows imu_rows(const State<double>& x, const Eigen::Vector3d& omega, const Eigen::Vector3d& force,
                                 double dt, bool measured_force) const;
  /// d(velocity after) / d(specific force) of `advance`.
  [[nodiscard]] Eigen::Matrix3d velocity_by_force(const State<double>& x, const Eigen::Vector3d& omega,
                                                  double dt) const;

  /// Adds the covariance of the noise over `dt` to that of a filter of `states` errors, stored by columns.
  void add_noise(const Input& u, double dt, double* P, int states, bool has_imu_errors) const;

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
  [[nodiscard]] Eigen::Matrix<double, 3, kCore> air_velocity_jacobian(const State<double>& x) const;

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

 private:
  struct Decay {
    double u, v, w, step_v, step_w;
  };
  [[nodiscard]] Decay decay(double airspeed, double dt) const;
};

/// The model-free filter's system (see estimation::SystemModel): with or without the errors of the inertial sensors as
/// states. Where they are states but not all are estimated, the others are held by a variance of zero.
template <bool kHasImu>
struct AirDataModel : AirDataMotion {
  static constexpr bool kHasImuErrors = kHasImu;
  static constexpr int kImuError = kHasImu ? kCore : -1;
  static constexpr int kCoefficientError = -1;
  static constexpr int kStates = kCore + (kHasImu ? kImuErrors : 0);
  using Vector = Eigen::Matrix<double, kStates, 1>;
  using Covariance = Eigen::Matrix<double, kStates, kStates>;

  template <typename S>
  [[nodiscard]] static State<S> retract(const State<double>& x, const Eigen::Matrix<S, kStates, 1>& e) {
    State<S> moved;
    moved.attitude = x.attitude.template cast<S>() * rotation<S>(e.template segment<3>(kAttitude));
    moved.velocity = x.velocity.template cast<S>() + e.template segment<3>(kVelocity);
    moved.gust = x.gust.template cast<S>() + e.template segment<5>(kGust);
    moved.wind = x.wind.template cast<S>() + e.template segment<3>(kWind);
    moved.imu_bias = x.imu_bias.template cast<S>();
    moved.imu_scale = x.imu_scale.template cast<S>();
    if constexpr (kHasImu) {
      moved.imu_bias += e.template segment<6>(kImuError);
      moved.imu_scale += e.template segment<6>(kImuError + 6);
    }
    moved.air_error = x.air_error.template cast<S>();
    moved.coefficient_error = x.coefficient_error.template cast<S>();
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
    if constexpr (kHasImu) {
      e.template segment<6>(kImuError) = to.imu_bias - from.imu_bias.template cast<S>();
      e.template segment<6>(kImuError + 6) = to.imu_scale - from.imu_scale.template cast<S>();
    }
    return e;
  }

  /// Jacobian of `propagate`, dynamic rows, in closed form.
  [[nodiscard]] Eigen::Matrix<double, kDynamic, kStates> transition_rows(const State<double>& x, const Input& u,
                                                                         double dt, State<double>& after) const {
    const Eigen::Vector3d omega = rates<double>(x, u.gyro), force = true_force<double>(x, u.specific_force);
    after = advance<double>(x, omega, force, u.airspeed, dt);
    if constexpr (kHasImu) {
      Eigen::Matrix<double, kDynamic, kStates> F;
      F.template leftCols<kCore>() = core_rows(x, omega, force, u.airspeed, dt);
      F.template rightCols<kImuErrors>() = imu_rows(x, omega, force, dt, true);
      return F;
    } else {
      return core_rows(x, omega, force, u.airspeed, dt);
    }
  }

  void add_process_noise(const State<double>&, const Input& u, double dt, Covariance& P) const {
    add_noise(u, dt, P.data(), kStates, kHasImu);
  }

  /// The row of a filter of this kind from the row that all share.
  [[nodiscard]] static Vector row(const Prediction& p) {
    if constexpr (kHasImu) {
      Vector H;
      H.template head<kCore>() = p.core;
      if (p.by_sensor_errors) {
        H.template tail<kImuErrors>() = p.further.template head<kImuErrors>();
      } else {
        H.template tail<kImuErrors>().setZero();
      }
      return H;
    } else {
      return p.core;
    }
  }
};

/// Velocity over ground along north, east or down (axis 0, 1, 2) [m/s].
[[nodiscard]] Prediction predict_ground_velocity(const AirDataState<double>& x, int axis);

/// Roll, pitch or yaw (axis 0, 1, 2) [rad]; nothing near pitch +-90 deg, where Euler angles end.
[[nodiscard]] std::optional<Prediction> predict_euler_angle(const AirDataState<double>& x, int axis);

/// Dynamic pressure of the pitot tube [Pa]: (1 + scale) rho |v_r|^2 / 2 + bias.
[[nodiscard]] Prediction predict_dynamic_pressure(const AirDataMotion& model, const AirDataState<double>& x,
                                                  double air_density);

/// True airspeed [m/s]: sqrt(1 + scale) |v_r|, the pressure's scale (its bias has no constant effect here).
[[nodiscard]] Prediction predict_airspeed(const AirDataMotion& model, const AirDataState<double>& x);

/// Angle-of-attack vane [rad]: (1 + scale) atan2(w, u) + bias, at a vane that moves with `arm_velocity` = omega x r
/// relative to the centre of gravity [m/s, body axes]. The scale is the upwash slope.
[[nodiscard]] Prediction predict_alpha(const AirDataMotion& model, const AirDataState<double>& x,
                                       const Eigen::Vector3d& arm_velocity);

/// Sideslip vane [rad], plus its bias: asin(v / |v_r|), or the flank angle atan2(v, u) that a vane on a boom turns by
/// when `flank`.
[[nodiscard]] Prediction predict_beta(const AirDataMotion& model, const AirDataState<double>& x,
                                      const Eigen::Vector3d& arm_velocity, bool flank);

}  // namespace veridyn::aircraft
