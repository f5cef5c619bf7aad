#pragma once

#include "veridyn/recording/motion_sample.hpp"

namespace veridyn::cueing::testing_support {

/// A vehicle on level ground under a specific force forward [m/s^2].
inline recording::MotionSample pushed(double forward) {
  recording::MotionSample s;
  s.frame = Frame::kFrd;
  s.force = recording::force_at_rest(Frame::kFrd) + Eigen::Vector3d(forward, 0.0, 0.0);
  return s;
}

}  // namespace veridyn::cueing::testing_support
