#include "veridyn/cueing/score/knob_effect.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"

namespace veridyn::cueing {
namespace {

constexpr double kDriveSample = 0.02, kDriveEnds = 30.0;  // [s]

/// 0 before and after, 1 between, with smooth ramps of half a second.
double lasting(double t, double begin, double end) {
  constexpr double kRamp = 0.5;
  const double up = std::clamp((t - begin) / kRamp, 0.0, 1.0), down = std::clamp((end - t) / kRamp, 0.0, 1.0);
  return up * up * (3.0 - 2.0 * up) * down * down * (3.0 - 2.0 * down);
}

/// What the simulated car does: it dips as it brakes, leans out of the bend, and a bump throws it up.
struct KnobDriveMoment {
  double surge, sway, heave;  ///< accelerations along the level road [m/s^2]
  Eigen::Quaterniond attitude;
};

KnobDriveMoment knob_drive_at(double t, double yaw) {
  const double braking = lasting(t, 2.0, 6.0), bend = lasting(t, 11.0, 16.0);
  const bool bump = t > 22.0 && t < 22.5;
  return {.surge = -3.0 * braking,
          .sway = 3.0 * bend,
          .heave = bump ? 7.0 * std::sin(2.0 * kPi * (t - 22.0) / 0.5) : 0.0,
          .attitude = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                      Eigen::AngleAxisd(2.0 * kDegree * braking, Eigen::Vector3d::UnitY()) *
                      Eigen::AngleAxisd(2.5 * kDegree * bend, Eigen::Vector3d::UnitX())};
}

FeltMotion felt_with(const WashoutDesign& design, const Platform& platform, const VestibularModel& model,
                     const MotionThresholds& thresholds) {
  Progress silent;
  return felt_motion(drive_platform(knob_drive(), *design.make(platform), platform, silent), model, thresholds);
}

}  // namespace

std::vector<recording::MotionSample> knob_drive() {
  constexpr double kSpeed = 15.0;  // [m/s]
  std::vector<recording::MotionSample> drive;
  double yaw = 0.0;
  for (double t = 0.0; t < kDriveEnds; t += kDriveSample) {
    const KnobDriveMoment now = knob_drive_at(t, yaw);
    const Eigen::AngleAxisd heading(yaw, Eigen::Vector3d::UnitZ());
    yaw += kDriveSample * now.sway / kSpeed;
    recording::MotionSample s;
    s.time = t;
    s.frame = Frame::kFlu;
    s.attitude = now.attitude;
    s.force = s.attitude.conjugate() *
              (heading * Eigen::Vector3d(now.surge, now.sway, now.heave) + recording::force_at_rest(Frame::kFlu));
    const Eigen::AngleAxisd turn(now.attitude.conjugate() * knob_drive_at(t + kDriveSample, yaw).attitude);
    s.rate = turn.angle() * turn.axis() / kDriveSample;
    s.force_from = s.rate_from = s.attitude_from = recording::Origin::kMeasured;
    drive.push_back(s);
  }
  return drive;
}

std::vector<KnobEffect> knob_effects(const WashoutDesign& design, const Platform& platform,
                                     const VestibularModel& model, const MotionThresholds& thresholds) {
  std::vector<KnobEffect> all;
  const FeltMotion as_set = felt_with(design, platform, model, thresholds);
  const std::size_t knobs = design.clone()->knobs().size();
  for (std::size_t i = 0; i < knobs; ++i) {
    KnobEffect effect;
    std::array<FeltMotion, 3> felt;
    for (std::size_t f = 0; f < felt.size(); ++f) {
      const std::unique_ptr<WashoutDesign> turned = design.clone();
      const Knob knob = turned->knobs()[i];
      effect.knob = knob;
      felt[f] = as_set;
      if (effect.factors[f] == 1.0) continue;
      for (double& v : knob.values) v *= effect.factors[f];
      try {
        felt[f] = felt_with(*turned, platform, model, thresholds);
      } catch (const InputError&) {
        effect.factors[f] = 1.0;
      }
    }
    effect.knob.values = {};
    for (std::size_t c = 0; c < kCues; ++c) {
      const auto cue = static_cast<Cue>(c);
      const std::vector<double>&low = felt[0].felt[cue].platform, &high = felt[2].felt[cue].platform;
      double squares = 0.0;
      for (std::size_t k = 0; k < low.size(); ++k) squares += (high[k] - low[k]) * (high[k] - low[k]);
      const double off = std::sqrt(squares / static_cast<double>(low.size())) / as_set.threshold[cue];
      if (off <= effect.difference) continue;
      effect.difference = off;
      effect.cue = cue;
    }
    effect.time = as_set.time;
    effect.vehicle = as_set.felt[effect.cue].vehicle;
    for (std::size_t f = 0; f < felt.size(); ++f) effect.platform[f] = felt[f].felt[effect.cue].platform;
    all.push_back(std::move(effect));
  }
  return all;
}

}  // namespace veridyn::cueing
