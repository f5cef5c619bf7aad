#include "veridyn/aircraft/reconstruction/air_data_filter.hpp"

namespace veridyn::aircraft {
namespace {

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

/// exp(phi + d) = exp(phi) exp(J d) to first order.
Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& phi) {
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

}  // namespace

AirDataMotion::Decay AirDataMotion::decay(double airspeed, double dt) const {
  const double path = airspeed * dt;
  const double v = std::exp(-path / spectrum.Lv);
  const double w = spectrum.Lw == spectrum.Lv ? v : std::exp(-path / spectrum.Lw);
  const double u = spectrum.Lu == spectrum.Lv ? v : std::exp(-path / spectrum.Lu);
  return {u, v, w, path / spectrum.Lv, path / spectrum.Lw};
}

AirDataMotion::CoreRows AirDataMotion::core_rows(const State<double>& x, const Eigen::Vector3d& omega,
                                                 const Eigen::Vector3d& force, double airspeed, double dt) const {
  const Eigen::Matrix3d R_half = rotation<double>(omega * (0.5 * dt)).toRotationMatrix();
  const Eigen::Matrix3d R_NB = x.attitude.toRotationMatrix();
  CoreRows F = CoreRows::Zero();
  F.block<3, 3>(kAttitude, kAttitude) = R_half.transpose() * R_half.transpose();
  F.block<3, 3>(kVelocity, kAttitude) = R_NB * cross_matrix(R_half * force) * -dt;
  F.block<3, 3>(kVelocity, kVelocity).setIdentity();
  const Decay d = decay(airspeed, dt);
  F(kGust, kGust) = d.u;
  F(kGust + 1, kGust + 1) = F(kGust + 2, kGust + 2) = d.v;
  F(kGust + 2, kGust + 1) = d.v * d.step_v;
  F(kGust + 3, kGust + 3) = F(kGust + 4, kGust + 4) = d.w;
  F(kGust + 4, kGust + 3) = d.w * d.step_w;
  return F;
}

AirDataMotion::ImuRows AirDataMotion::imu_rows(const State<double>& x, const Eigen::Vector3d& omega,
                                               const Eigen::Vector3d& force, double dt, bool measured_force) const {
  constexpr int kScale = 6;
  const Eigen::Matrix3d R_half = rotation<double>(omega * (0.5 * dt)).toRotationMatrix();
  const Eigen::Matrix3d R_NB = x.attitude.toRotationMatrix();
  const Eigen::Matrix3d by_rate_attitude = right_jacobian(omega * dt) * -dt;
  const Eigen::Matrix3d by_rate_velocity =
      R_NB * R_half * cross_matrix(force) * right_jacobian(omega * (0.5 * dt)) * (0.5 * dt * dt);
  const Eigen::Matrix3d by_force = R_NB * R_half * -dt;
  ImuRows F = ImuRows::Zero();
  // d(true)/d(bias) = -1/(1 + scale), d(true)/d(scale) = -true/(1 + scale); the minus is in the matrices above.
  for (int i = 0; i < 3; ++i) {
    const double gyro_gain = 1.0 / (1.0 + x.imu_scale(i)), accel_gain = 1.0 / (1.0 + x.imu_scale(3 + i));
    F.block<3, 1>(kAttitude, i) = by_rate_attitude.col(i) * gyro_gain;
    F.block<3, 1>(kVelocity, i) = by_rate_velocity.col(i) * gyro_gain;
    F.block<3, 1>(kAttitude, kScale + i) = by_rate_attitude.col(i) * (omega(i) * gyro_gain);
    F.block<3, 1>(kVelocity, kScale + i) = by_rate_velocity.col(i) * (omega(i) * gyro_gain);
    if (!measured_force) continue;
    F.block<3, 1>(kVelocity, 3 + i) = by_force.col(i) * accel_gain;
    F.block<3, 1>(kVelocity, kScale + 3 + i) = by_force.col(i) * (force(i) * accel_gain);
  }
  return F;
}

Eigen::Matrix3d AirDataMotion::velocity_by_force(const State<double>& x, const Eigen::Vector3d& omega,
                                                 double dt) const {
  return x.attitude.toRotationMatrix() * rotation<double>(omega * (0.5 * dt)).toRotationMatrix() * dt;
}

void AirDataMotion::add_noise(const Input& u, double dt, double* P, int states, bool has_imu_errors) const {
  const auto at = [P, states](int i, int j) -> double& { return P[j * states + i]; };
  const double gyro = noise.gyro * noise.gyro * dt * u.imu_noise_factor;
  const double force = noise.accelerometer * noise.accelerometer * dt * u.imu_noise_factor;
  for (int i = 0; i < 3; ++i) {
    at(kAttitude + i, kAttitude + i) += gyro;
    at(kVelocity + i, kVelocity + i) += force;
  }
  // Q = Pi - F Pi F' with the stationary covariance Pi keeps the gusts stationary for any step.
  const Decay d = decay(u.airspeed, dt);
  at(kGust, kGust) += 1.0 - d.u * d.u;
  const auto add_pair = [&at](int i, double e, double step) {
    const double e2 = e * e;
    at(i, i) += 0.5 * (1.0 - e2);
    const double cross = 0.25 - e2 * (0.5 * step + 0.25);
    at(i, i + 1) += cross;
    at(i + 1, i) += cross;
    at(i + 1, i + 1) += 0.25 - e2 * (0.25 + 0.5 * step + 0.5 * step * step);
  };
  add_pair(kGust + 1, d.v, d.step_v);
  add_pair(kGust + 3, d.w, d.step_w);
  const double walk = noise.wind_walk * noise.wind_walk * dt;
  at(kWind, kWind) += walk;
  at(kWind + 1, kWind + 1) += walk;
  at(kWind + 2, kWind + 2) += noise.wind_down_walk * noise.wind_down_walk * dt;
  if (!has_imu_errors) return;
  for (int i = 0; i < 6; ++i) {
    const double bias_walk = i < 3 ? noise.gyro_bias_walk : noise.accel_bias_walk;
    double& variance = at(kCore + i, kCore + i);
    if (variance > 0.0) variance += bias_walk * bias_walk * dt;
  }
}

Eigen::Matrix<double, 3, AirDataMotion::kCore> AirDataMotion::air_velocity_jacobian(const State<double>& x) const {
  Eigen::Matrix<double, 3, kCore> J = Eigen::Matrix<double, 3, kCore>::Zero();
  const Eigen::Matrix3d R_BN = x.attitude.conjugate().toRotationMatrix();
  const Eigen::Vector3d v = R_BN * (x.velocity - x.wind);
  J(0, kAttitude + 1) = -v.z();
  J(0, kAttitude + 2) = v.y();
  J(1, kAttitude) = v.z();
  J(1, kAttitude + 2) = -v.x();
  J(2, kAttitude) = -v.y();
  J(2, kAttitude + 1) = v.x();
  J.middleCols<3>(kVelocity) = R_BN;
  J.middleCols<3>(kWind) = -R_BN;
  J(0, kGust) = -spectrum.sigma_u;
  J(1, kGust + 1) = -spectrum.sigma_v * kSqrt3;
  J(1, kGust + 2) = spectrum.sigma_v * kSqrt3 * kLead;
  J(2, kGust + 3) = -spectrum.sigma_w * kSqrt3;
  J(2, kGust + 4) = spectrum.sigma_w * kSqrt3 * kLead;
  return J;
}

Prediction predict_ground_velocity(const AirDataState<double>& x, int axis) {
  Prediction p;
  p.value = x.velocity(axis);
  p.core(AirDataMotion::kVelocity + axis) = 1.0;
  return p;
}

std::optional<Prediction> predict_euler_angle(const AirDataState<double>& x, int axis) {
  const auto e = numerics::euler_from_quaternion(x.attitude);
  const double cf = std::cos(e.phi), sf = std::sin(e.phi), ct = std::cos(e.theta);
  if (!(std::abs(ct) > 0.17)) return std::nullopt;
  Prediction p;
  const double tt = std::sin(e.theta) / ct;
  switch (axis) {
    case 0:
      p.value = e.phi;
      p.core.head<3>() << 1.0, sf * tt, cf * tt;
      break;
    case 1:
      p.value = e.theta;
      p.core.head<3>() << 0.0, cf, -sf;
      break;
    default:
      p.value = e.psi;
      p.core.head<3>() << 0.0, sf / ct, cf / ct;
      break;
  }
  return p;
}

Prediction predict_dynamic_pressure(const AirDataMotion& model, const AirDataState<double>& x, double air_density) {
  const Eigen::Vector3d v = model.air_velocity(x);
  const double pressure = 0.5 * air_density * v.squaredNorm();
  const double gain = 1.0 + x.air_error(AirDataMotion::kPitotScale);
  Prediction p;
  p.value = gain * pressure + x.air_error(AirDataMotion::kPitotBias);
  p.core = model.air_velocity_jacobian(x).transpose() * (gain * air_density * v);
  return p;
}

Prediction predict_airspeed(const AirDataMotion& model, const AirDataState<double>& x) {
  const Eigen::Vector3d v = model.air_velocity(x);
  const double speed = std::max(v.norm(), 1e-3);
  const double gain = std::sqrt(std::max(1.0 + x.air_error(AirDataMotion::kPitotScale), 0.01));
  Prediction p;
  p.value = gain * speed;
  p.core = model.air_velocity_jacobian(x).transpose() * (v * (gain / speed));
  return p;
}

Prediction predict_alpha(const AirDataMotion& model, const AirDataState<double>& x,
                         const Eigen::Vector3d& arm_velocity) {
  const Eigen::Vector3d v = model.air_velocity(x) + arm_velocity;
  const double square = std::max(v.x() * v.x() + v.z() * v.z(), 1e-6);
  const double alpha = std::atan2(v.z(), v.x());
  const double gain = 1.0 + x.air_error(AirDataMotion::kAlphaScale);
  Prediction p;
  p.value = gain * alpha + x.air_error(AirDataMotion::kAlphaBias);
  p.core = model.air_velocity_jacobian(x).transpose() * Eigen::Vector3d(-v.z(), 0.0, v.x()) * (gain / square);
  return p;
}

Prediction predict_beta(const AirDataMotion& model, const AirDataState<double>& x, const Eigen::Vector3d& arm_velocity,
                        bool flank) {
  const Eigen::Vector3d v = model.air_velocity(x) + arm_velocity;
  Eigen::Vector3d gradient;
  Prediction p;
  if (flank) {
    p.value = std::atan2(v.y(), v.x());
    gradient = Eigen::Vector3d(-v.y(), v.x(), 0.0) / std::max(v.x() * v.x() + v.y() * v.y(), 1e-6);
  } else {
    const double square = std::max(v.squaredNorm(), 1e-6);
    const double plane = std::max(std::hypot(v.x(), v.z()), 1e-3);
    p.value = std::atan2(v.y(), plane);
    gradient = Eigen::Vector3d(-v.x() * v.y() / plane, plane, -v.z() * v.y() / plane) / square;
  }
  p.value += x.air_error(AirDataMotion::kBetaBias);
  p.core = model.air_velocity_jacobian(x).transpose() * gradient;
  return p;
}

}  // namespace veridyn::aircraft
