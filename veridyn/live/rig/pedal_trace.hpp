#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "veridyn/live/serial/frame.hpp"
#include "veridyn/live/teleoperation/operator_end.hpp"
#include "veridyn/live/time/latency_histogram.hpp"

namespace veridyn::live {

/// From wheel or pedal to the platform, one movement after the other: which command first knew of it, which report
/// first knew of that command, which order first held the motion of that report, and when the platform answered that
/// order. Each stage begins where the one before ends, so that their sum is the whole. Times are those of one clock,
/// the rig's; what passed at the car is what its own clock says that it held the command.
///
/// A movement whose command no report knows of within a second (the link is lost) is given up. While the line is whole
/// a new one is followed only after the one before has come through.
class PedalTrace {
 public:
  /// The stages, in order.
  enum class Stage {
    kInput,     ///< wheel or pedal moved, to command sent
    kLine,      ///< command and report on the line, both ways
    kCar,       ///< the command held by the car until the report was made; where it was lost, until the next one
    kMotion,    ///< report's arrival to the order that holds its motion
    kPlatform,  ///< order to the platform's answer
  };
  static constexpr std::size_t kStages = 5;

  /// A command was sent. @param frame its bytes @param moved the oldest movement that it first knew of
  void command(Bytes frame, Nanoseconds sent, std::optional<Nanoseconds> moved);
  /// The newest report, after bytes of the line.
  void report(const ReceivedReport& report);
  /// An order was sent. @param stamp of the motion in it, by the car's clock [s]
  void order(std::uint32_t sequence, double stamp, Nanoseconds sent);
  /// The platform answered an order.
  void answer(std::uint32_t sequence, Nanoseconds arrived);

  /// What came through.
  struct Result {
    std::array<LatencyHistogram, kStages> stages = {};
    LatencyHistogram whole;
    std::uint64_t given_up = 0;
    [[nodiscard]] const LatencyHistogram& operator[](Stage stage) const {
      return stages[static_cast<std::size_t>(stage)];
    }
  };
  [[nodiscard]] const Result& result() const { return result_; }

 private:
  struct Sent {
    std::uint16_t sequence = 0;
    Nanoseconds at = 0;
  };
  struct Followed {
    Nanoseconds moved = 0, sent = 0;
    std::uint16_t sequence = 0;
    std::optional<Nanoseconds> reported, ordered;
    Nanoseconds line = 0;
    double made = 0.0;  ///< stamp of the report [s]
    std::uint32_t order = 0;
  };
  std::array<Sent, 256> sent_ = {};  ///< the last ones
  std::size_t count_ = 0;
  std::optional<Followed> followed_;
  Result result_;
};

}  // namespace veridyn::live
