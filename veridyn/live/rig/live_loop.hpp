#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "veridyn/live/link/live_links.hpp"
#include "veridyn/live/recording/live_recorder.hpp"
#include "veridyn/live/rig/live_rig.hpp"
#include "veridyn/live/threads/triple_buffer.hpp"
#include "veridyn/live/time/latency_histogram.hpp"

namespace veridyn::live {

/// How well the loop kept its time.
struct LoopTimes {
  /// What came in before the loop began waited for it, not for an order: it is not in the first two.
  LatencyHistogram receive_to_send;   ///< kernel's stamp of an accepted packet to the first order that could know of it
  LatencyHistogram wait;              ///< of that: until the step began
  LatencyHistogram work;              ///< of that: from the step's beginning to the order handed to the kernel
  LatencyHistogram wake;              ///< how late steps began
  LatencyHistogram jitter;            ///< interval between orders against the period, either way
  LatencyHistogram pedal_to_command;  ///< an event of wheel or pedals to the first command that could know of it
  std::uint64_t steps = 0, left_out = 0, not_sent = 0;
  std::uint64_t commands = 0, commands_not_sent = 0;  ///< to the car
};

/// What somebody beside the loop may look at.
struct RigStatus {
  RigStep step;
  Readiness readiness = Readiness::kNoTelemetry;
  LiveRig::Answers answers;
  PerPacketStatus<std::uint64_t> packets = {};
  std::uint64_t drives = 0, gaps = 0;
  LiveRig::Extrapolated extrapolated;
  double drift = 0.0;            ///< of the sender's clock, NaN where not known
  std::optional<CarStatus> car;  ///< ten times a second
  LoopTimes times;
  /// All that the rig itself knows; the rest stays.
  void take(const LiveRig& rig);
};

/// Numbers of an algorithm, all of them, and the algorithm that is made of them.
struct KnobSetting {
  std::vector<double> values;  ///< of all knobs of the design, one after the other
  std::unique_ptr<cueing::Washout> washout;
};
/// The values of a design's knobs as above, and a design with them.
[[nodiscard]] std::vector<double> knob_values(cueing::WashoutDesign& design);
void set_knob_values(cueing::WashoutDesign& design, const std::vector<double>& values);

/// The way from the operator's thread to the loop's and back. Nobody ever waits.
class LiveControl {
 public:
  LiveControl();
  ~LiveControl();
  LiveControl(const LiveControl&) = delete;
  LiveControl& operator=(const LiveControl&) = delete;

  // By the operator's thread.
  void request(OperatorRequest request);
  /// Takes effect at one step, whole; a setting that the loop has not taken yet is replaced.
  void turn(std::unique_ptr<KnobSetting> setting);
  /// Frees what the loop has done with.
  void tidy();
  /// The newest status.
  [[nodiscard]] const RigStatus& status();
  /// Motions of accepted packets since the last call, at most 8000 of them.
  void take_motions(std::vector<Telemetry>& motions);

  // From any thread, also from a signal's handler.
  void emergency() { emergency_ = true; }
  void end() { ended_ = true; }
  [[nodiscard]] bool ended() const { return ended_; }

 private:
  friend class LiveLoop;
  struct Queues;
  std::unique_ptr<Queues> queues_;
  std::atomic<bool> emergency_{false}, ended_{false};
  TripleBuffer<RigStatus> status_;
};

/// The loop: at an even rate on absolute deadlines, datagrams in between. On its path nothing is allocated, locked,
/// logged or thrown, and no file is touched.
class LiveLoop {
 public:
  /// @throws InputError as `LiveRig`
  LiveLoop(const LiveStudy& study, std::uint32_t session);

  /// Runs until the control ends it or the time is over.
  /// @param recorder null: nothing is recorded @param end by the clock; nothing: never
  void run(LiveLinks& links, Clock& clock, LiveControl& control, LiveRecorder* recorder,
           std::optional<Nanoseconds> end);

  [[nodiscard]] const LiveRig& rig() const { return rig_; }
  [[nodiscard]] const LoopTimes& times() const { return times_; }

 private:
  void take(const Incoming& incoming, Nanoseconds now, LiveControl& control, LiveRecorder* recorder);
  void command(LiveLinks& links, Clock& clock, const RigStep& step, LiveRecorder* recorder);
  void take_requests(LiveControl& control, Nanoseconds now, LiveRecorder* recorder);

  LiveRig rig_;
  OrderFormat format_;
  Nanoseconds period_;
  LoopTimes times_;
  static constexpr std::size_t kArrivals = 64;
  std::array<Nanoseconds, kArrivals> arrivals_{};  ///< of packets accepted since the last order
  std::size_t arrived_ = 0;
  Nanoseconds last_sent_ = 0, begun_ = 0;
  std::optional<CarStatus> car_;
  Nanoseconds car_at_ = 0;
};

}  // namespace veridyn::live
