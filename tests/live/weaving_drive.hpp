#pragma once

#include <cmath>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/live/rig/live_study.hpp"
#include "veridyn/recording/motion_sample.hpp"

namespace veridyn::live::test {

/// A car that weaves on level ground in closed form: heading 0.3 sin(w t), speed 15 + 5 sin(0.4 t); frame flu, 100 Hz.
inline std::vector<recording::MotionSample> weaving_drive(double duration) {
  constexpr double kStep = 0.01, kW = 0.8, kHeading = 0.3;
  std::vector<recording::MotionSample> drive;
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  const auto velocity = [](double t) {
    const double psi = kHeading * std::sin(kW * t), u = 15.0 + 5.0 * std::sin(0.4 * t);
    return Eigen::Vector2d(u * std::cos(psi), u * std::sin(psi));
  };
  for (int k = 0; k * kStep <= duration; ++k) {
    const double t = k * kStep;
    recording::MotionSample s;
    s.time = t;
    s.frame = Frame::kFlu;
    const double psi = kHeading * std::sin(kW * t), r = kHeading * kW * std::cos(kW * t);
    s.speed = 15.0 + 5.0 * std::sin(0.4 * t);
    s.force = {2.0 * std::cos(0.4 * t), s.speed * r, kGravity};
    s.rate = {0.0, 0.0, r};
    s.angular_acceleration = {0.0, 0.0, -kHeading * kW * kW * std::sin(kW * t)};
    s.attitude = Eigen::AngleAxisd(psi, Eigen::Vector3d::UnitZ());
    s.position = at;
    s.force_from = s.rate_from = s.angular_acceleration_from = s.attitude_from = s.position_from = s.speed_from =
        recording::Origin::kMeasured;
    drive.push_back(s);
    // Simpson's rule over the step.
    at += kStep / 6.0 * (velocity(t) + 4.0 * velocity(t + kStep / 2.0) + velocity(t + kStep));
  }
  return drive;
}

/// A study of a rig on loopback, with lines of `[live]` of its own.
inline LiveStudy rig_study(const std::string& lines = "signs = 'off'\n") {
  return read_live_study(
      Study::parse("[cue]\nalgorithms = ['classical']\n[platform]\nsubject = 'three_axis'\n"
                   "[live]\ntelemetry = '127.0.0.1:47123'\nplatform = '127.0.0.1:47124'\n" +
                       lines,
                   "rig.toml"));
}

}  // namespace veridyn::live::test
