#pragma once

#include <memory>

#include "veridyn/cueing/platform/platform_command.hpp"
#include "veridyn/recording/motion_sample.hpp"

namespace veridyn::cueing {

/// A washout algorithm: motion of the vehicle at the driver's head in, motion of the platform out, one sample at a
/// time. It knows nothing of clocks and files; after construction nothing is allocated or thrown. Values that are not
/// finite stand for those of the sample before.
class Washout {
 public:
  virtual ~Washout() = default;

  /// Begins at the platform's neutral position with a vehicle that has moved like this for long: nothing jumps.
  virtual PlatformCommand reset(const recording::MotionSample& sample) = 0;
  /// @param step since the last sample [s]; below zero or not finite: none
  virtual PlatformCommand step(const recording::MotionSample& sample, double step) = 0;
  /// A copy with its state.
  [[nodiscard]] virtual std::unique_ptr<Washout> clone() const = 0;

 protected:
  Washout() = default;
  Washout(const Washout&) = default;
  Washout& operator=(const Washout&) = default;
};

}  // namespace veridyn::cueing
