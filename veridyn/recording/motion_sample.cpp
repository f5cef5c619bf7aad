#include "veridyn/recording/motion_sample.hpp"

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/recording/lever_arm.hpp"

namespace veridyn::recording {
namespace {

/// Half a turn about x.
Eigen::Vector3d turned(const Eigen::Vector3d& v) { return {v.x(), -v.y(), -v.z()}; }

}  // namespace

Eigen::Vector3d force_at_rest(Frame frame) {
  VERIDYN_ASSERT(frame != Frame::kUnspecified);
  return {0.0, 0.0, frame == Frame::kFlu ? kGravity : -kGravity};
}

MotionSample in_frame(const MotionSample& sample, Frame frame) {
  VERIDYN_ASSERT(frame != Frame::kUnspecified && sample.frame != Frame::kUnspecified);
  if (sample.frame == frame) return sample;
  MotionSample s = sample;
  s.frame = frame;
  s.place = turned(sample.place);
  s.force = turned(sample.force);
  s.rate = turned(sample.rate);
  s.angular_acceleration = turned(sample.angular_acceleration);
  // Body and world axes turn alike.
  const Eigen::Quaterniond& q = sample.attitude;
  s.attitude = Eigen::Quaterniond(q.w(), q.x(), -q.y(), -q.z());
  s.position.y() = -sample.position.y();
  return s;
}

MotionSample at_place(const MotionSample& sample, const Eigen::Vector3d& place) {
  const Eigen::Vector3d d = place - sample.place;
  MotionSample s = sample;
  s.place = place;
  s.force += lever_arm_acceleration(sample.angular_acceleration, sample.rate, d);
  s.position += (sample.attitude * d).head<2>();
  return s;
}

Eigen::Vector3d acceleration(const MotionSample& sample) {
  return sample.force - sample.attitude.conjugate() * force_at_rest(sample.frame);
}

}  // namespace veridyn::recording
