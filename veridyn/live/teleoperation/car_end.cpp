#include "veridyn/live/teleoperation/car_end.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"

namespace veridyn::live {

void CarEndOptions::validate() const {
  range.validate();
  const auto positive = [](std::string_view name, double value) {
    if (!(value > 0.0)) throw InputError(name, fmt::format("is {}; must be > 0", value));
  };
  const auto share = [](std::string_view name, double value) {
    if (!(value >= 0.0 && value <= 1.0)) throw InputError(name, fmt::format("is {}; must be from 0 to 1", value));
  };
  positive("lost_after", seconds(lost_after));
  positive("stale_after", seconds(stale_after));
  positive("blind_after", seconds(blind_after));
  positive("brake_rate", brake_rate);
  positive("standing_speed", standing_speed);
  if (neutral_for < 0) throw InputError("neutral_for", fmt::format("is {}; must not be below 0", seconds(neutral_for)));
  if (standing_for < 0)
    throw InputError("standing_for", fmt::format("is {}; must not be below 0", seconds(standing_for)));
  share("neutral_force", neutral_force);
  share("neutral_brake", neutral_brake);
  share("brake_moving", brake_moving);
  share("brake_holding", brake_holding);
}

CarEnd::CarEnd(const CarEndOptions& options, std::uint16_t run)
    : options_(options), run_(run), own_brake_(options.brake_holding) {
  options_.validate();
}

void CarEnd::receive(Bytes bytes, Nanoseconds now) {
  while (const std::optional<SerialFrame> frame = decoder_.next(bytes)) ++verdicts_[judge(*frame, now)];
}

CommandVerdict CarEnd::judge(const SerialFrame& frame, Nanoseconds now) {
  const std::optional<CommandPayload> payload =
      frame.header.kind == kCommandKind ? decode_command(frame.payload) : std::nullopt;
  if (!payload) return CommandVerdict::kNoCommand;
  const bool in_range = what_is_wrong(payload->command, options_.range).empty();
  const std::optional<Nanoseconds> age = age_bound(payload->echo, now);
  const bool fresh = age && *age <= options_.stale_after;

  if (operator_run_ != frame.header.run) {
    // A delayed frame of an earlier run must not take the car over: only a fresh one, and only where nobody drives.
    if (operator_run_ && link_alive(now)) return CommandVerdict::kOtherRun;
    if (!fresh) return age ? CommandVerdict::kStale : CommandVerdict::kUnproven;
    if (!in_range) return CommandVerdict::kOutOfRange;
    operator_run_ = frame.header.run;
    commands_.reset();
    last_executed_.reset();
    neutral_since_.reset();
  }

  switch (commands_.take(frame.header.sequence)) {
    case SequenceVerdict::kDuplicate:
    case SequenceVerdict::kTooOld:
      return CommandVerdict::kDuplicate;
    case SequenceVerdict::kLate:
      return CommandVerdict::kLate;
    case SequenceVerdict::kNewer:
      break;
  }
  newest_at_ = now;
  if (!in_range) return CommandVerdict::kOutOfRange;
  if (!age) return CommandVerdict::kUnproven;
  if (!fresh) return CommandVerdict::kStale;
  last_executed_ = frame.header.sequence;
  execute(payload->command, now);
  return CommandVerdict::kExecuted;
}

std::optional<Nanoseconds> CarEnd::age_bound(const std::optional<Echo>& echo, Nanoseconds now) const {
  if (!echo || echo->run != run_ || echo->age > options_.blind_after) return std::nullopt;
  const std::optional<Nanoseconds> sent = reports_.of(echo->sequence);
  if (!sent) return std::nullopt;
  // From report to command and back, less what the operator held it; the command took no more than that.
  return std::max<Nanoseconds>(now - *sent - echo->age, 0);
}

bool CarEnd::link_alive(Nanoseconds now) const { return executed_at_ && now - *executed_at_ < options_.lost_after; }

void CarEnd::lose_link() {
  state_ = CarState::kBraking;
  own_brake_ = wanted_.brake;
  wanted_.brake = 0.0;
  ++links_lost_;
}

void CarEnd::execute(const CarCommand& command, Nanoseconds now) {
  // An outage that ends between two steps is one too.
  if (state_ == CarState::kDriving && !link_alive(now)) lose_link();
  const bool neutral = std::abs(command.drive_force) <= options_.neutral_force * options_.range.drive_force &&
                       command.brake <= options_.neutral_brake;
  // Neutral before an outage is not neutral after it.
  if (!neutral || !link_alive(now)) neutral_since_.reset();
  if (neutral && !neutral_since_) neutral_since_ = now;
  executed_at_ = now;
  wanted_ = command;
}

CarActuation CarEnd::step(const CarSensors& sensors, Nanoseconds now) {
  const double elapsed = last_step_ ? seconds(std::max<Nanoseconds>(now - *last_step_, 0)) : 0.0;
  last_step_ = now;
  watch_standstill(sensors, now);
  const bool alive = link_alive(now);

  if (state_ == CarState::kDriving && !alive) lose_link();
  // Pedals that were released when the link was lost have to be seen released when it is back.
  if (!alive) neutral_since_.reset();
  if (state_ != CarState::kDriving && neutral_since_ && *executed_at_ - *neutral_since_ >= options_.neutral_for)
    state_ = CarState::kDriving;
  if (state_ == CarState::kDriving) return {.command = wanted_, .state = state_};

  if (state_ == CarState::kBraking && standing_since_ && now - *standing_since_ >= options_.standing_for)
    state_ = CarState::kHolding;
  const double aim = state_ == CarState::kHolding ? options_.brake_holding : options_.brake_moving;
  // A driver's brake beyond the aim stays as it was.
  own_brake_ = std::max(own_brake_, std::min(aim, own_brake_ + options_.brake_rate * elapsed));
  CarActuation actuation{.command = {.steering = wanted_.steering, .drive_force = 0.0, .brake = own_brake_},
                         .state = state_};
  if (alive) actuation.command.brake = std::max(own_brake_, wanted_.brake);
  return actuation;
}

void CarEnd::watch_standstill(const CarSensors& sensors, Nanoseconds now) {
  const bool stands = std::all_of(sensors.wheel_speeds.begin(), sensors.wheel_speeds.end(),
                                  [&](double speed) { return std::abs(speed) < options_.standing_speed; });
  if (!stands) standing_since_.reset();
  if (stands && !standing_since_) standing_since_ = now;
}

std::size_t CarEnd::report(const CarSensors& sensors, Nanoseconds now, std::span<std::uint8_t> out) {
  ReportPayload payload{.sensors = sensors,
                        .time_us = static_cast<std::uint32_t>(now / 1000),
                        .received = static_cast<std::uint16_t>(commands_.received()),
                        .state = state_,
                        .echo = std::nullopt};
  if (operator_run_ && !commands_.empty())
    payload.echo = Echo{.run = *operator_run_,
                        .sequence = static_cast<std::uint16_t>(commands_.newest()),
                        .age = std::max<Nanoseconds>(now - newest_at_, 0)};
  std::array<std::uint8_t, kReportPayload> bytes;
  encode_report(payload, bytes);
  const std::size_t size = encode_frame({.kind = kReportKind, .run = run_, .sequence = next_report_}, bytes, out);
  if (size > 0) reports_.add(next_report_++, now);
  return size;
}

}  // namespace veridyn::live
