#pragma once

#include <array>

#include "veridyn/aircraft/model/atmosphere.hpp"
#include "veridyn/aircraft/model/flight_dynamics.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/aircraft/reconstruction/air_data_filter.hpp"

namespace veridyn::aircraft {

/// How far the coefficients of a model may be off, in the order CL, CD, CY: a constant that is not known beforehand,
/// and how it wanders (alpha and beta come close to their bound only while that is slow).
struct ModelError {
  std::array<double, 3> initial{0.02, 0.005, 0.01};  ///< 1 sigma at the start [-]
  std::array<double, 3> walk{5e-4, 2e-4, 2e-4};      ///< [1/sqrt(s)]
  std::array<bool, 3> modelled{true, true, true};    ///< false: nothing is known of it, the accelerometer measures it
  static constexpr double kUnknownInitial = 1.0;     ///< where it is not modelled
  static constexpr double kUnknownWalk = 0.5;        ///< [1/sqrt(s)]
  [[nodiscard]] double sigma(std::size_t i) const { return modelled[i] ? initial[i] : kUnknownInitial; }
  [[nodiscard]] double density(std::size_t i) const { return modelled[i] ? walk[i] : kUnknownWalk; }
};

/// View of a subject, whose aerodynamics are known, moving through air that moves: the subject must outlive it.
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
/// The Jacobian of `propagate` is composed of those of the kinematics, in closed form, and of the specific force, by
/// automatic differentiation with respect to v_r, rates and coefficient errors. The velocity carries white force noise
/// of the accelerometer's size: what the model leaves out of the force from sample to sample.
struct ModelBasedMotion : AirDataMotion {
  /// Whose force model it is; moments are not used. Never null when used.
  const Subject* subject = nullptr;
  ModelError error;

  /// Specific force [m/s^2, body axes] and its derivatives.
  struct SpecificForce {
    Eigen::Vector3d value;
    Eigen::Matrix3d by_velocity, by_rates, by_coefficient_error;
  };
  /// At a velocity relative to the air, rates and coefficient errors.
  [[nodiscard]] Eigen::Vector3d specific_force(const Eigen::Vector3d& v_r, const Eigen::Vector3d& omega,
                                               const Eigen::Vector3d& coefficient_error, const Input& u) const;
  [[nodiscard]] SpecificForce specific_force_derivatives(const Eigen::Vector3d& v_r, const Eigen::Vector3d& omega,
                                                         const Eigen::Vector3d& coefficient_error,
                                                         const Input& u) const;

  /// Over `dt` [s] by the midpoint rule.
  [[nodiscard]] State<double> propagate(const State<double>& x, const Input& u, double dt) const;

  using FullRows = Eigen::Matrix<double, kDynamic, kFull>;
  /// The first 11 rows of d(error after) / d(error before), in the error vector that all filters share; the columns of
  /// the inertial sensors' errors are left zero where those are not estimated.
  [[nodiscard]] FullRows full_rows(const State<double>& x, const Input& u, double dt, bool has_imu_errors,
                                   State<double>& after) const;
};

/// The model-based filter's system (see estimation::SystemModel): the error vector is that of `AirDataModel`, then the
/// errors of CL, CD, CY.
template <bool kHasImu>
struct ModelBasedAirData : ModelBasedMotion {
  using Free = AirDataModel<kHasImu>;
  static constexpr bool kHasImuErrors = kHasImu;
  static constexpr int kImuError = Free::kImuError;
  static constexpr int kCoefficientError = Free::kStates;
  static constexpr int kStates = Free::kStates + 3;
  using Vector = Eigen::Matrix<double, kStates, 1>;
  using Covariance = Eigen::Matrix<double, kStates, kStates>;

  /// `S` is double; a template as estimation::SystemModel asks for.
  template <typename S>
  [[nodiscard]] State<S> propagate(const State<S>& x, const Input& u, double dt) const {
    return ModelBasedMotion::propagate(x, u, dt);
  }

  template <typename S>
  [[nodiscard]] static State<S> retract(const State<double>& x, const Eigen::Matrix<S, kStates, 1>& e) {
    State<S> moved = Free::template retract<S>(x, e.template head<Free::kStates>());
    moved.coefficient_error += e.template tail<3>();
    return moved;
  }

  template <typename S>
  [[nodiscard]] static Eigen::Matrix<S, kStates, 1> local(const State<double>& from, const State<S>& to) {
    Eigen::Matrix<S, kStates, 1> e;
    e.template head<Free::kStates>() = Free::template local<S>(from, to);
    e.template tail<3>() = to.coefficient_error - from.coefficient_error.template cast<S>();
    return e;
  }

  [[nodiscard]] Eigen::Matrix<double, kDynamic, kStates> transition_rows(const State<double>& x, const Input& u,
                                                                         double dt, State<double>& after) const {
    FullRows all = full_rows(x, u, dt, kHasImu, after);
    if constexpr (kHasImu) {
      return all;
    } else {
      Eigen::Matrix<double, kDynamic, kStates> F;
      F.template leftCols<kCore>() = all.leftCols<kCore>();
      F.template rightCols<3>() = all.rightCols<3>();
      return F;
    }
  }

  void add_process_noise(const State<double>&, const Input& u, double dt, Covariance& P) const {
    add_noise(u, dt, P.data(), kStates, kHasImu);
    for (int i = 0; i < 3; ++i) {
      double& variance = P(kCoefficientError + i, kCoefficientError + i);
      const double walk = error.density(static_cast<std::size_t>(i));
      if (variance > 0.0) variance += walk * walk * dt;
    }
  }

  /// The row of a filter of this kind from the row that all share.
  [[nodiscard]] static Vector row(const Prediction& p) {
    Vector H;
    H.template head<Free::kStates>() = Free::row(p);
    if (p.by_sensor_errors) {
      H.template tail<3>() = p.further.template tail<3>();
    } else {
      H.template tail<3>().setZero();
    }
    return H;
  }
};

/// Accelerometer at the centre of gravity along body axis 0, 1, 2: (1 + scale) f/m + bias [m/s^2]. `u` holds the
/// measured rates; their noise enters through the rate derivatives, as `noise_variance` for a gyro of standard
/// deviation `gyro_sigma` a sample.
[[nodiscard]] Prediction predict_specific_force(const ModelBasedMotion& model, const AirDataState<double>& x,
                                                const AirDataInput& u, int axis, double gyro_sigma,
                                                double& noise_variance);

}  // namespace veridyn::aircraft
