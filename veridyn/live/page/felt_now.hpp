#pragma once

#include <optional>

#include "veridyn/cueing/perception/perception.hpp"
#include "veridyn/cueing/score/felt_motion.hpp"
#include "veridyn/live/rig/live_loop.hpp"

namespace veridyn::live {

/// What the driver would feel in the vehicle and what the rider feels on the platform, as a run goes on: as
/// `cueing::felt_motion`, status by status.
class FeltNow {
 public:
  /// Nothing is felt of a model whose answers are no forces and rates.
  explicit FeltNow(const cueing::CueingStudy& study);

  /// A newer status. Between two of them motion is taken to go on a line: often enough, 50 times a second, say.
  void update(const RigStatus& status);

  struct Cues {
    cueing::PerCue<double> vehicle = {}, rider = {};  ///< [m/s^2, rad/s]
  };
  /// Nothing before the first motion.
  [[nodiscard]] const std::optional<Cues>& now() const { return now_; }
  [[nodiscard]] const cueing::PerCue<double>& threshold() const { return threshold_; }

 private:
  /// One of the two.
  struct Head {
    explicit Head(const cueing::VestibularModel& model) : perception(model) {}
    cueing::PerCue<double> feel(const recording::MotionSample& sample, std::optional<double> step);
    cueing::Perception perception;
  };

  Eigen::Vector3d rider_place_;
  cueing::PerCue<double> threshold_;
  bool has_units_;
  Head vehicle_, rider_;
  std::optional<Nanoseconds> last_;
  std::optional<Cues> now_;
};

}  // namespace veridyn::live
