#pragma once

#include <string>
#include <vector>

#include "veridyn/recording/motion_sample.hpp"

namespace veridyn::live {

/// Whether the axes, signs and units of telemetry are right, by what its channels say of each other while the vehicle
/// drives (`recording::check_drive_axes`).
struct SignVerdict {
  enum class Kind { kUnknown, kRight, kWrong };
  Kind kind = Kind::kUnknown;
  /// What is wrong with its remedy, or what is still to be driven: "accelerate and brake".
  std::string text;
};

/// Collects the motion of a drive until it can be judged. Not for the loop's thread: it allocates.
class SignChecker {
 public:
  /// @param samples of accepted packets, frame flu
  void add(const std::vector<recording::MotionSample>& samples);
  /// A drive that began again: what was before is not compared with what follows.
  void reset() { samples_.clear(); }
  /// Right: forward and sideways acceleration and yaw rate were compared and fit, and nothing else is wrong. What is
  /// wrong is said as soon as it shows. The last two minutes are looked at.
  [[nodiscard]] SignVerdict check() const;

 private:
  std::vector<recording::MotionSample> samples_;
};

}  // namespace veridyn::live
