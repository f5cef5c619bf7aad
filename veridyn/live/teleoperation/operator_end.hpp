#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "veridyn/live/serial/frame.hpp"
#include "veridyn/live/teleoperation/car_report.hpp"
#include "veridyn/live/teleoperation/clock_offset.hpp"
#include "veridyn/live/teleoperation/sent_times.hpp"
#include "veridyn/live/teleoperation/sequence_counter.hpp"

namespace veridyn::live {

struct OperatorEndOptions {
  CommandRange range = {};
  /// Without a report for so long the link counts as lost, as the car counts it.
  Nanoseconds lost_after = 200 * kMillisecond;
};

/// How good the line is, over all since the car's last start unless said otherwise. Times in ns.
struct LinkQuality {
  bool connected = false;  ///< a report came within `lost_after`
  std::optional<Nanoseconds> since_report;

  std::uint64_t commands_sent = 0;
  std::uint64_t commands_arrived = 0;  ///< as the car counts them
  /// Of those between the first report's newest and the last report's newest. Commands on their way are neither.
  std::uint64_t commands_lost = 0;
  std::uint64_t reports_received = 0;
  std::uint64_t reports_lost = 0;
  std::uint64_t reports_late = 0;
  std::uint64_t reports_duplicate = 0;
  std::uint64_t frames_damaged = 0;  ///< seen as such; since this end's start

  /// From sending a command to receiving a report that echoes it, less what the car held it: both ways together, of
  /// the last 1024 reports; nothing before the first.
  std::optional<Nanoseconds> round_trip_last, round_trip_least, round_trip_median, round_trip_p99;
  /// One way, of the newest command and report that arrived. Only bounds can be known, see `ClockOffset`: their width
  /// is the least round trip.
  std::optional<DelayBounds> command_delay, report_delay;
  /// The car's clock less this one.
  std::optional<DelayBounds> clock_offset;

  /// Share of commands and of reports that were lost; 0 where none was sent.
  [[nodiscard]] double command_loss() const;
  [[nodiscard]] double report_loss() const;
};

/// A report with its times on this end's clock.
struct ReceivedReport {
  ReportPayload payload;
  std::uint32_t sequence = 0;
  Nanoseconds arrived = 0;
  Nanoseconds made = 0;    ///< by the car's clock, without the wrap of its stamps
  std::string_view fault;  ///< the first quantity that no sensor delivered; empty: all did
};

/// The operator's end of the line, without a device: commands and bytes in, bytes and reports out, each with its time.
/// Deterministic; nothing allocates or throws after construction.
class OperatorEnd {
 public:
  /// @param run another number after each start of the operator
  /// @throws InputError as `CommandRange::validate`, and where `lost_after` is not above zero
  OperatorEnd(const OperatorEndOptions& options, std::uint16_t run);

  /// Takes bytes of the line. @param now of this end's clock, not before that of any earlier call
  void receive(Bytes bytes, Nanoseconds now);
  /// The next frame to send at once.
  /// @return bytes written; 0 where a value is not finite or out of range, which is counted, or `out` is shorter than
  /// `frame_size(kCommandPayload)`. A command that is not sent lets the car brake: that is what is to happen where the
  /// program does not know what it wants.
  std::size_t command(const CarCommand& command, Nanoseconds now, std::span<std::uint8_t> out);

  /// The newest report, however old.
  [[nodiscard]] const std::optional<ReceivedReport>& report() const { return report_; }
  [[nodiscard]] LinkQuality quality(Nanoseconds now) const;
  [[nodiscard]] const FrameCounts& frames() const { return decoder_.counts(); }
  /// Commands that were not sent because of their values.
  [[nodiscard]] std::uint64_t refused() const { return refused_; }
  /// Good frames that were no report.
  [[nodiscard]] std::uint64_t no_reports() const { return no_reports_; }
  /// How often the car was started again while this end ran.
  [[nodiscard]] std::uint64_t car_restarts() const { return car_restarts_; }

 private:
  void take(const SerialFrame& frame, Nanoseconds now);
  void adopt(std::uint16_t car_run);
  [[nodiscard]] Nanoseconds car_time(std::uint32_t time_us);
  void take_echo(const Echo& echo, Nanoseconds made, Nanoseconds now);
  void count_commands(const ReportPayload& payload);

  OperatorEndOptions options_;
  std::uint16_t run_;
  FrameDecoder decoder_;
  std::uint64_t refused_ = 0, no_reports_ = 0, car_restarts_ = 0;

  SentTimes commands_;
  std::uint32_t next_command_ = 0;
  std::uint64_t commands_sent_ = 0;

  std::optional<std::uint16_t> car_run_, previous_car_run_;
  SequenceCounter reports_;
  std::optional<ReceivedReport> report_;
  std::optional<Nanoseconds> car_time_;  ///< of the newest report, without the wrap

  struct CarCount {
    std::uint16_t received = 0, newest = 0;
  };
  std::optional<CarCount> car_count_;  ///< of the newest report
  std::uint64_t commands_arrived_ = 0, commands_spanned_ = 0;

  ClockOffset offset_;
  std::optional<Nanoseconds> command_stamps_, report_stamps_;  ///< latest arrival less earliest sending, on two clocks
  std::array<Nanoseconds, 1024> round_trips_ = {};
  std::uint64_t round_trip_count_ = 0;
};

}  // namespace veridyn::live
