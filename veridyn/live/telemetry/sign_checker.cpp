#include "veridyn/live/telemetry/sign_checker.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "veridyn/recording/consistency.hpp"
#include "veridyn/recording/motion_recording.hpp"

namespace veridyn::live {
namespace {

constexpr double kLongest = 120.0;  // [s]
/// An operator waits: half the time that a recording's check needs.
constexpr double kBand_Hz = 1.0;

}  // namespace

void SignChecker::add(const std::vector<recording::MotionSample>& samples) {
  for (const recording::MotionSample& s : samples) {
    if (!samples_.empty() && s.time <= samples_.back().time) continue;
    samples_.push_back(s);
    // On a ramp gravity is felt forward: it is no change of speed.
    if (s.attitude_from == recording::Origin::kMeasured)
      samples_.back().force = recording::acceleration(s) + recording::force_at_rest(s.frame);
  }
  if (samples_.empty()) return;
  const double from = samples_.back().time - kLongest;
  const auto first =
      std::find_if(samples_.begin(), samples_.end(), [&](const recording::MotionSample& s) { return s.time >= from; });
  samples_.erase(samples_.begin(), first);
}

SignVerdict SignChecker::check() const {
  struct Needed {
    recording::InertialChannel channel;
    const char* to_do;
    bool fits = false;
  };
  std::vector<Needed> all = {{recording::InertialChannel::kAccelX, "accelerate and brake"},
                             {recording::InertialChannel::kAccelY, "drive bends"},
                             {recording::InertialChannel::kGyroZ, "turn"}};
  if (samples_.size() >= 2) {
    Recording recording = recording::to_recording(samples_);
    std::vector<double> speed;
    for (const recording::MotionSample& sample : samples_) speed.push_back(sample.speed);
    if (samples_.front().speed_from != recording::Origin::kAbsent)
      recording.add(make_channel("speed", "m/s", recording.find("accel_x")->time, std::move(speed)));
    const recording::DriveMotion motion = recording::drive_motion(recording);
    const recording::Consistency found = check_consistency(motion, {.band_Hz = kBand_Hz});
    std::vector<std::string> faults;
    for (const std::vector<recording::ChannelFault>& together : found.explanations) {
      for (const recording::ChannelFault& f : together)
        if (f.cause != estimation::Cause::kMissingTerm) faults.push_back(f.says(motion.names));
    }
    if (!faults.empty())
      return {SignVerdict::Kind::kWrong, fmt::format("{}", fmt::join(faults, found.is_sure() ? "; " : ", or "))};
    for (Needed& n : all) {
      for (const recording::ChannelRelation& r : found.relations)
        n.fits = n.fits || (r.channel == n.channel && r.power[n.channel] == 1 && r.fits());
    }
  }
  std::vector<std::string> missing;
  for (const Needed& n : all) {
    if (!n.fits) missing.emplace_back(n.to_do);
  }
  if (missing.empty()) return {SignVerdict::Kind::kRight, ""};
  return {SignVerdict::Kind::kUnknown, fmt::format("{}", fmt::join(missing, ", "))};
}

}  // namespace veridyn::live
