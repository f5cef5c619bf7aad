#include "veridyn/vehicle/simulation/trajectory_motion.hpp"

#include "veridyn/vehicle/simulation/body_motion.hpp"

namespace veridyn::vehicle {

std::vector<recording::MotionSample> motion_samples(const VehicleTrajectory& t, double gravity, double grade) {
  const auto value = [](const std::vector<double>& of, std::size_t k) { return of.empty() ? 0.0 : of[k]; };
  std::vector<recording::MotionSample> samples;
  samples.reserve(t.size());
  for (std::size_t k = 0; k < t.size(); ++k) {
    samples.push_back(motion_sample({.time = t.time[k],
                                     .x = t.x[k],
                                     .y = t.y[k],
                                     .yaw = t.yaw[k],
                                     .roll = value(t.roll, k),
                                     .pitch = value(t.pitch, k),
                                     .yaw_rate = t.r[k],
                                     .roll_rate = value(t.roll_rate, k),
                                     .pitch_rate = value(t.pitch_rate, k),
                                     .yaw_acceleration = t.yaw_acceleration[k],
                                     .roll_acceleration = value(t.roll_acceleration, k),
                                     .pitch_acceleration = value(t.pitch_acceleration, k),
                                     .forward = t.longitudinal_acceleration[k],
                                     .leftward = t.lateral_acceleration[k],
                                     .upward = value(t.heave_acceleration, k),
                                     .speed = t.u[k]},
                                    gravity, grade));
    recording::MotionSample& s = samples.back();
    s.inputs = {t.steer[k], value(t.drive_torque, k), value(t.brake_torque, k)};
    s.steer_from = recording::Origin::kMeasured;
    if (!t.drive_torque.empty()) s.torque_from = recording::Origin::kMeasured;
  }
  return samples;
}

}  // namespace veridyn::vehicle
