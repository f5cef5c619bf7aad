#include "veridyn/vehicle/simulation/trajectory_motion.hpp"

#include <algorithm>

#include "veridyn/numerics/rotation.hpp"

namespace veridyn::vehicle {

std::vector<recording::MotionSample> motion_samples(const VehicleTrajectory& t, double gravity) {
  using recording::Origin;
  const auto value = [](const std::vector<double>& of, std::size_t k) { return of.empty() ? 0.0 : of[k]; };
  const auto slope = [&](const std::vector<double>& of, std::size_t k) {
    if (of.size() < 2) return 0.0;
    const std::size_t before = k > 0 ? k - 1 : 0, after = std::min(k + 1, of.size() - 1);
    return (of[after] - of[before]) / (t.time[after] - t.time[before]);
  };
  std::vector<recording::MotionSample> samples;
  samples.reserve(t.size());
  for (std::size_t k = 0; k < t.size(); ++k) {
    recording::MotionSample s;
    s.time = t.time[k];
    s.frame = Frame::kFlu;
    const double roll = value(t.roll, k), pitch = value(t.pitch, k);
    s.attitude = numerics::quaternion_from_euler(roll, pitch, t.yaw[k]);
    const Eigen::Matrix3d body_from_heading = numerics::R_body_from_ned(roll, pitch, 0.0);
    s.force = body_from_heading * Eigen::Vector3d(t.longitudinal_acceleration[k], t.lateral_acceleration[k],
                                                  slope(t.heave_rate, k) + gravity);
    s.rate = numerics::body_rates(roll, pitch, Eigen::Vector3d(value(t.roll_rate, k), value(t.pitch_rate, k), t.r[k]));
    s.position = {t.x[k], t.y[k]};
    s.speed = t.u[k];
    s.inputs = {t.steer[k], value(t.drive_torque, k), value(t.brake_torque, k)};
    s.force_from = s.rate_from = s.attitude_from = s.position_from = s.speed_from = s.steer_from = Origin::kMeasured;
    if (!t.drive_torque.empty()) s.torque_from = Origin::kMeasured;
    s.angular_acceleration_from = Origin::kDerived;
    samples.push_back(s);
  }
  for (std::size_t k = 0; k < samples.size() && samples.size() > 1; ++k) {
    const auto &before = samples[k > 0 ? k - 1 : 0], &after = samples[std::min(k + 1, samples.size() - 1)];
    samples[k].angular_acceleration = (after.rate - before.rate) / (after.time - before.time);
  }
  return samples;
}

}  // namespace veridyn::vehicle
