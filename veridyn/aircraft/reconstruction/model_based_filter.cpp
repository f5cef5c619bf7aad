#include "veridyn/aircraft/reconstruction/model_based_filter.hpp"

#include <ceres/jet.h>

namespace veridyn::aircraft {
namespace {

using Jet = ceres::Jet<double, 9>;

template <typename S>
Eigen::Matrix<S, 3, 1> force_over_mass(const Subject& subject, const Eigen::Matrix<S, 3, 1>& v_r,
                                       const Eigen::Matrix<S, 3, 1>& omega, const Eigen::Matrix<S, 3, 1>& error,
                                       const AirDataInput& u) {
  using std::cos;
  using std::sin;
  Controls<S> c;
  c.de = S(u.controls.de);
  c.da = S(u.controls.da);
  c.dr = S(u.controls.dr);
  c.throttle = S(u.controls.throttle);
  c.rotor_speed = S(u.controls.rotor_speed);
  const AeroLoads<S> loads = aero_loads<S>(subject, v_r, omega, c, S(u.air_density));
  const S qS = loads.dynamic_pressure * S(subject.wing_area / subject.mass);
  const S ca = cos(loads.air.alpha), sa = sin(loads.air.alpha);
  Eigen::Matrix<S, 3, 1> a = loads.force * S(1.0 / subject.mass);
  a(0) += qS * (error(0) * sa - error(1) * ca);
  a(1) += qS * error(2);
  a(2) -= qS * (error(1) * sa + error(0) * ca);
  return a;
}

/// d(true rates) / d(errors of gyro and accelerometer).
Eigen::Matrix<double, 3, AirDataMotion::kImuErrors> rates_by_imu_errors(const AirDataState<double>& x,
                                                                        const Eigen::Vector3d& omega) {
  Eigen::Matrix<double, 3, AirDataMotion::kImuErrors> D = Eigen::Matrix<double, 3, AirDataMotion::kImuErrors>::Zero();
  for (int i = 0; i < 3; ++i) {
    const double gain = 1.0 / (1.0 + x.imu_scale(i));
    D(i, i) = -gain;
    D(i, 6 + i) = -omega(i) * gain;
  }
  return D;
}

}  // namespace

Eigen::Vector3d ModelBasedMotion::specific_force(const Eigen::Vector3d& v_r, const Eigen::Vector3d& omega,
                                                 const Eigen::Vector3d& coefficient_error, const Input& u) const {
  return force_over_mass<double>(*subject, v_r, omega, coefficient_error, u);
}

ModelBasedMotion::SpecificForce ModelBasedMotion::specific_force_derivatives(const Eigen::Vector3d& v_r,
                                                                             const Eigen::Vector3d& omega,
                                                                             const Eigen::Vector3d& coefficient_error,
                                                                             const Input& u) const {
  Eigen::Matrix<Jet, 3, 1> v_jet, omega_jet, error_jet;
  for (int i = 0; i < 3; ++i) {
    v_jet(i) = Jet(v_r(i), i);
    omega_jet(i) = Jet(omega(i), 3 + i);
    error_jet(i) = Jet(coefficient_error(i), 6 + i);
  }
  const Eigen::Matrix<Jet, 3, 1> f = force_over_mass<Jet>(*subject, v_jet, omega_jet, error_jet, u);
  SpecificForce out;
  for (int i = 0; i < 3; ++i) {
    out.value(i) = f(i).a;
    out.by_velocity.row(i) = f(i).v.head<3>().transpose();
    out.by_rates.row(i) = f(i).v.segment<3>(3).transpose();
    out.by_coefficient_error.row(i) = f(i).v.tail<3>().transpose();
  }
  return out;
}

AirDataState<double> ModelBasedMotion::propagate(const State<double>& x, const Input& u, double dt) const {
  const Eigen::Vector3d omega = rates<double>(x, u.gyro);
  const auto force = [&](const State<double>& at) {
    return specific_force(air_velocity<double>(at), omega, at.coefficient_error, u);
  };
  const State<double> middle = advance<double>(x, omega, force(x), u.airspeed, 0.5 * dt);
  return advance<double>(x, omega, force(middle), u.airspeed, dt);
}

ModelBasedMotion::FullRows ModelBasedMotion::full_rows(const State<double>& x, const Input& u, double dt,
                                                       bool has_imu_errors, State<double>& after) const {
  const Eigen::Vector3d omega = rates<double>(x, u.gyro);
  const Eigen::Matrix<double, 3, kImuErrors> D = rates_by_imu_errors(x, omega);
  using ForceRows = Eigen::Matrix<double, 3, kFull>;
  // d(force) / d(error before) from the rows of d(v_r) / d(error before).
  const auto force_rows = [&](const SpecificForce& f, const ForceRows& by_error) {
    ForceRows rows = f.by_velocity * by_error;
    if (has_imu_errors) rows.middleCols<kImuErrors>(kCore) += f.by_rates * D;
    rows.rightCols<3>() += f.by_coefficient_error;
    return rows;
  };
  const auto step_rows = [&](const SpecificForce& f, const ForceRows& by_error, double step) {
    FullRows rows = FullRows::Zero();
    rows.leftCols<kCore>() = core_rows(x, omega, f.value, u.airspeed, step);
    if (has_imu_errors) rows.middleCols<kImuErrors>(kCore) = imu_rows(x, omega, f.value, step, false);
    rows.middleRows<3>(kVelocity) += velocity_by_force(x, omega, step) * by_error;
    return rows;
  };

  ForceRows v_rows = ForceRows::Zero();
  v_rows.leftCols<kCore>() = air_velocity_jacobian(x);
  const SpecificForce first = specific_force_derivatives(air_velocity<double>(x), omega, x.coefficient_error, u);
  const FullRows to_middle = step_rows(first, force_rows(first, v_rows), 0.5 * dt);
  const State<double> middle = advance<double>(x, omega, first.value, u.airspeed, 0.5 * dt);

  const Eigen::Matrix<double, 3, kCore> J = air_velocity_jacobian(middle);
  v_rows = J.leftCols<kDynamic>() * to_middle;
  v_rows.middleCols<3>(kWind) += J.rightCols<3>();
  const SpecificForce second = specific_force_derivatives(air_velocity<double>(middle), omega, x.coefficient_error, u);
  after = advance<double>(x, omega, second.value, u.airspeed, dt);
  return step_rows(second, force_rows(second, v_rows), dt);
}

Prediction predict_specific_force(const ModelBasedMotion& model, const AirDataState<double>& x, const AirDataInput& u,
                                  int axis, double gyro_sigma, double& noise_variance) {
  const Eigen::Vector3d omega = AirDataMotion::rates<double>(x, u.gyro);
  const ModelBasedMotion::SpecificForce f =
      model.specific_force_derivatives(model.air_velocity<double>(x), omega, x.coefficient_error, u);
  const double gain = 1.0 + x.imu_scale(3 + axis);
  Prediction p;
  p.value = gain * f.value(axis) + x.imu_bias(3 + axis);
  p.core = model.air_velocity_jacobian(x).transpose() * (gain * f.by_velocity.row(axis).transpose());
  p.by_sensor_errors = true;
  p.further.tail<3>() = gain * f.by_coefficient_error.row(axis).transpose();
  const Eigen::Vector3d by_rate = gain * f.by_rates.row(axis).transpose();
  for (int i = 0; i < 3; ++i) {
    const double gyro_gain = 1.0 / (1.0 + x.imu_scale(i));
    p.further(i) = -by_rate(i) * gyro_gain;
    p.further(6 + i) = -by_rate(i) * omega(i) * gyro_gain;
  }
  p.further(3 + axis) = 1.0;
  p.further(9 + axis) = f.value(axis);
  noise_variance = by_rate.squaredNorm() * gyro_sigma * gyro_sigma;
  return p;
}

}  // namespace veridyn::aircraft
