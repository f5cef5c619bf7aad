#include "veridyn/cueing/platform/platform_state.hpp"

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::cueing {

AxisState axis(const PlatformState& s, PlatformAxis which) {
  const auto i = static_cast<Eigen::Index>(which);
  if (turns(which)) return {s.angle(i - 3), s.rate(i - 3), s.angular_acceleration(i - 3)};
  return {s.shift(i), s.velocity(i), s.acceleration(i)};
}

void set_axis(PlatformState& s, PlatformAxis which, const AxisState& to) {
  const auto i = static_cast<Eigen::Index>(which);
  if (turns(which)) {
    s.angle(i - 3) = to.position;
    s.rate(i - 3) = to.rate;
    s.angular_acceleration(i - 3) = to.acceleration;
  } else {
    s.shift(i) = to.position;
    s.velocity(i) = to.rate;
    s.acceleration(i) = to.acceleration;
  }
}

double position(const PlatformCommand& command, PlatformAxis which) {
  const auto i = static_cast<Eigen::Index>(which);
  return turns(which) ? command.angle(i - 3) : command.shift(i);
}

Eigen::Vector3d body_rate(const PlatformState& s) { return numerics::body_rates(s.angle(0), s.angle(1), s.rate); }

recording::MotionSample rider_motion(const PlatformState& s, const Eigen::Vector3d& place) {
  const double sf = std::sin(s.angle(0)), cf = std::cos(s.angle(0)), st = std::sin(s.angle(1)),
               ct = std::cos(s.angle(1));
  const double phi_rate = s.rate(0), theta_rate = s.rate(1), psi_rate = s.rate(2);
  const Eigen::Matrix3d R = numerics::R_body_from_ned(s.angle(0), s.angle(1), s.angle(2));
  recording::MotionSample m;
  m.frame = Frame::kFrd;
  m.rate = body_rate(s);
  // The body rates' derivative: what the angles' second derivatives bring, and what the changing axes do.
  m.angular_acceleration =
      numerics::body_rates(s.angle(0), s.angle(1), s.angular_acceleration) +
      Eigen::Vector3d(-ct * theta_rate * psi_rate,
                      -sf * phi_rate * theta_rate + (cf * ct * phi_rate - sf * st * theta_rate) * psi_rate,
                      -cf * phi_rate * theta_rate - (sf * ct * phi_rate + cf * st * theta_rate) * psi_rate);
  m.attitude = numerics::quaternion_from_euler(s.angle(0), s.angle(1), s.angle(2));
  m.force = R * (shift_from_frd(s.acceleration) - Eigen::Vector3d(0.0, 0.0, kGravity));
  m.force_from = m.rate_from = m.angular_acceleration_from = m.attitude_from = recording::Origin::kDerived;
  return recording::at_place(m, place);
}

}  // namespace veridyn::cueing
