#include "veridyn/vehicle/simulation/body_motion.hpp"

#include <cmath>

namespace veridyn::vehicle {

recording::MotionSample motion_sample(const BodyMotion& m, double gravity, double grade) {
  using Eigen::Vector3d;
  using recording::Origin;
  const Eigen::Quaterniond leans(Eigen::AngleAxisd(m.pitch, Vector3d::UnitY()) *
                                 Eigen::AngleAxisd(m.roll, Vector3d::UnitX()));
  recording::MotionSample out;
  out.time = m.time;
  out.frame = Frame::kFlu;
  out.attitude = Eigen::AngleAxisd(m.yaw, Vector3d::UnitZ()) * Eigen::AngleAxisd(-grade, Vector3d::UnitY()) * leans;
  // In the axes of the road under the vehicle, where the equations of motion are written.
  const Vector3d force(m.forward + gravity * std::sin(grade), m.leftward, m.upward + gravity * std::cos(grade));
  const Vector3d across(0.0, 1.0, 0.0);  // the axis of pitch, which no other turn has moved
  const Vector3d forward(std::cos(m.pitch), 0.0, -std::sin(m.pitch));  // that of roll, turned by pitch
  const Vector3d up = Vector3d::UnitZ();
  const Vector3d yaw_rate = m.yaw_rate * up;
  const Vector3d rate = yaw_rate + m.pitch_rate * across + m.roll_rate * forward;
  // These axes turn themselves: pitch's with yaw, roll's with yaw and pitch.
  const Vector3d turning = m.yaw_acceleration * up + m.pitch_acceleration * across +
                           m.pitch_rate * yaw_rate.cross(across) + m.roll_acceleration * forward +
                           m.roll_rate * (yaw_rate + m.pitch_rate * across).cross(forward);
  const Eigen::Quaterniond to_body = leans.conjugate();
  out.force = to_body * force;
  out.rate = to_body * rate;
  out.angular_acceleration = to_body * turning;
  out.position = {m.x, m.y};
  out.speed = m.speed;
  out.force_from = out.rate_from = out.angular_acceleration_from = out.attitude_from = out.position_from =
      out.speed_from = Origin::kMeasured;
  return out;
}

}  // namespace veridyn::vehicle
