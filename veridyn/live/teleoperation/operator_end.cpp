#include "veridyn/live/teleoperation/operator_end.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/core/error.hpp"

namespace veridyn::live {
namespace {

// What times of the car are rounded down by, at most.
constexpr Nanoseconds kTimeStep = 1'000;

double share_lost(std::uint64_t lost, std::uint64_t arrived) {
  const std::uint64_t all = lost + arrived;
  return all > 0 ? static_cast<double>(lost) / static_cast<double>(all) : 0.0;
}

/// A delay is not below zero, whatever the coarseness of stamps allows.
DelayBounds delay(Nanoseconds lowest, Nanoseconds highest) {
  return {.lowest = std::max<Nanoseconds>(lowest, 0), .highest = std::max<Nanoseconds>(highest, 0)};
}

}  // namespace

double LinkQuality::command_loss() const { return share_lost(commands_lost, commands_arrived); }
double LinkQuality::report_loss() const { return share_lost(reports_lost, reports_received); }

OperatorEnd::OperatorEnd(const OperatorEndOptions& options, std::uint16_t run) : options_(options), run_(run) {
  options_.range.validate();
  if (!(options_.lost_after > 0))
    throw InputError("lost_after", fmt::format("is {} s; must be > 0", seconds(options_.lost_after)));
}

std::size_t OperatorEnd::command(const CarCommand& command, Nanoseconds now, std::span<std::uint8_t> out) {
  if (!what_is_wrong(command, options_.range).empty()) {
    ++refused_;
    return 0;
  }
  CommandPayload payload{.command = command, .echo = std::nullopt};
  if (report_)
    payload.echo = Echo{.run = *car_run_,
                        .sequence = static_cast<std::uint16_t>(report_->sequence),
                        .age = std::max<Nanoseconds>(now - report_->arrived, 0)};
  std::array<std::uint8_t, kCommandPayload> bytes;
  encode_command(payload, bytes);
  const std::size_t size = encode_frame({.kind = kCommandKind, .run = run_, .sequence = next_command_}, bytes, out);
  if (size == 0) return 0;
  commands_.add(next_command_++, now);
  ++commands_sent_;
  return size;
}

void OperatorEnd::receive(Bytes bytes, Nanoseconds now) {
  while (const std::optional<SerialFrame> frame = decoder_.next(bytes)) take(*frame, now);
}

void OperatorEnd::take(const SerialFrame& frame, Nanoseconds now) {
  const std::optional<ReportPayload> payload =
      frame.header.kind == kReportKind ? decode_report(frame.payload) : std::nullopt;
  // A delayed report of the car's run before this one is as good as none.
  if (!payload || frame.header.run == previous_car_run_) {
    ++no_reports_;
    return;
  }
  if (car_run_ != frame.header.run) adopt(frame.header.run);
  if (reports_.take(frame.header.sequence) != SequenceVerdict::kNewer) return;
  const Nanoseconds made = car_time(payload->time_us);
  report_ = ReceivedReport{.payload = *payload,
                           .sequence = frame.header.sequence,
                           .arrived = now,
                           .made = made,
                           .fault = what_is_wrong(payload->sensors)};
  offset_.backward(made, now, now);
  report_stamps_ = now - made;
  if (payload->echo && payload->echo->run == run_) {
    take_echo(*payload->echo, made, now);
    count_commands(*payload);
  }
}

void OperatorEnd::adopt(std::uint16_t car_run) {
  if (car_run_) ++car_restarts_;
  previous_car_run_ = car_run_;
  car_run_ = car_run;
  reports_.reset();
  offset_.reset();
  car_time_.reset();
  car_count_.reset();
  command_stamps_.reset();
  commands_sent_ = commands_arrived_ = commands_spanned_ = 0;
  round_trip_count_ = 0;
}

Nanoseconds OperatorEnd::car_time(std::uint32_t time_us) {
  if (!car_time_) {
    car_time_ = Nanoseconds{time_us} * 1000;
  } else {
    // The stamp wraps every 71 minutes: of all times that it may mean the one next to the last is meant.
    const auto last = static_cast<std::uint32_t>(*car_time_ / 1000);
    *car_time_ += Nanoseconds{static_cast<std::int32_t>(time_us - last)} * 1000;
  }
  return *car_time_;
}

void OperatorEnd::take_echo(const Echo& echo, Nanoseconds made, Nanoseconds now) {
  const std::optional<Nanoseconds> sent = commands_.of(echo.sequence);
  if (!sent) return;
  round_trips_[round_trip_count_++ % round_trips_.size()] = std::max<Nanoseconds>(now - *sent - echo.age, 0);
  // Both the time and the age are rounded down: the command can have arrived no later than this.
  const Nanoseconds arrived = made + kTimeStep - echo.age;
  offset_.outward(*sent, arrived, now);
  command_stamps_ = arrived - *sent;
}

void OperatorEnd::count_commands(const ReportPayload& payload) {
  const CarCount count{.received = payload.received, .newest = payload.echo->sequence};
  if (!car_count_) {
    // Counting begins with the first report: what was lost before it is not known.
    commands_arrived_ = commands_spanned_ = count.received;
  } else {
    commands_arrived_ += static_cast<std::uint16_t>(count.received - car_count_->received);
    commands_spanned_ += static_cast<std::uint16_t>(count.newest - car_count_->newest);
  }
  car_count_ = count;
}

LinkQuality OperatorEnd::quality(Nanoseconds now) const {
  LinkQuality quality;
  quality.commands_sent = commands_sent_;
  quality.commands_arrived = commands_arrived_;
  quality.commands_lost = commands_spanned_ - std::min(commands_spanned_, commands_arrived_);
  quality.reports_received = reports_.received();
  quality.reports_lost = reports_.lost();
  quality.reports_late = reports_.late();
  quality.reports_duplicate = reports_.duplicates() + reports_.too_old();
  quality.frames_damaged = decoder_.counts().damaged();
  if (report_) {
    quality.since_report = now - report_->arrived;
    quality.connected = *quality.since_report < options_.lost_after;
  }
  if (round_trip_count_ > 0) {
    std::array<Nanoseconds, std::tuple_size_v<decltype(round_trips_)>> sorted = round_trips_;
    const auto count = std::min<std::size_t>(round_trip_count_, sorted.size());
    std::sort(sorted.begin(), sorted.begin() + count);
    quality.round_trip_last = round_trips_[(round_trip_count_ - 1) % round_trips_.size()];
    quality.round_trip_least = sorted.front();
    quality.round_trip_median = sorted[(count - 1) / 2];
    quality.round_trip_p99 = sorted[(99 * (count - 1) + 99) / 100];
  }
  quality.clock_offset = offset_.offset(now);
  if (quality.clock_offset) {
    // arrival on the other clock less sending on this one = delay + offset; the other way round: delay - offset.
    const auto [lowest, highest] = *quality.clock_offset;
    if (command_stamps_)
      quality.command_delay = delay(*command_stamps_ - kTimeStep - kEchoAgeStep - highest, *command_stamps_ - lowest);
    if (report_stamps_) quality.report_delay = delay(*report_stamps_ - kTimeStep + lowest, *report_stamps_ + highest);
  }
  return quality;
}

}  // namespace veridyn::live
