#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "veridyn/live/recording/live_file.hpp"
#include "veridyn/live/rig/live_loop.hpp"

namespace veridyn::live {

/// The study that a recording was made of. @throws InputError for one that cannot be read
[[nodiscard]] LiveStudy recorded_study(const LiveHead& head);

/// The rig of a recorded run, fed with its records in order: the same steps as then, bit for bit, and the status that
/// its loop would have shown. Of the loop's times, how long a step waited and worked is not recorded.
class RecordedRig {
 public:
  /// @param study of the head @throws InputError as `LiveRig`
  RecordedRig(const LiveStudy& study, const LiveHead& head);

  /// What a record brought.
  struct Taken {
    std::optional<Telemetry> telemetry;  ///< accepted
    const RigStep* step = nullptr;
    bool turned = false;                              ///< all knobs have their new values
    bool command_differs = false;                     ///< from the recorded one; of a command only
    std::optional<Nanoseconds> pedal = std::nullopt;  ///< of a command: the oldest movement that it first knew of
  };
  Taken take(const LiveRecord& record);

  [[nodiscard]] const LiveRig& rig() const { return rig_; }
  [[nodiscard]] const LoopTimes& times() const { return times_; }
  /// The algorithm with its knobs as they are.
  [[nodiscard]] cueing::WashoutDesign& design() const { return *design_; }
  /// Values of all knobs, as the last turn set them.
  [[nodiscard]] const std::vector<double>& turned_to() const { return values_; }
  [[nodiscard]] RigStatus status() const;

 private:
  void turn(const LiveRecord& record, Taken& taken);
  void step(const LiveRecord& record, Taken& taken);
  void command(const LiveRecord& record, Taken& taken);

  cueing::Platform platform_;
  LiveRig rig_;
  std::unique_ptr<cueing::WashoutDesign> design_;
  std::vector<double> values_;
  RigStep step_;
  std::size_t command_left_ = 0;  ///< bytes of the step's command that no record has had yet
  LoopTimes times_;
  std::vector<Nanoseconds> arrivals_;  ///< of packets accepted since the last step
  std::optional<CarStatus> car_;
  Nanoseconds car_at_ = 0;
  Nanoseconds period_, begun_ = 0, last_time_ = 0, last_sent_ = 0;
};

}  // namespace veridyn::live
