#include "veridyn/live/rig/car_link.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace veridyn::live {

CarLink::CarLink(const CarStudy& car, const DriverStudy& driver, std::uint16_t run)
    : options_(driver.command),
      calibration_(driver.calibration),
      radius_(car.radius),
      place_(car.sensor),
      end_({.range = car.range}, run) {
  options_.validate();
}

std::optional<Telemetry> CarLink::take_line(Bytes& bytes, Nanoseconds arrival) {
  while (!bytes.empty()) {
    // A zero ends a frame: no more than one report at once, so that none is passed over.
    const auto zero = std::find(bytes.begin(), bytes.end(), std::uint8_t{0});
    const auto size = static_cast<std::size_t>(zero - bytes.begin()) + (zero != bytes.end() ? 1U : 0U);
    end_.receive(bytes.first(size), arrival);
    bytes = bytes.subspan(size);
    const std::optional<ReceivedReport>& report = end_.report();
    if (!report || (last_report_ == report->sequence && restarts_ == end_.car_restarts())) continue;
    const bool restarted = !begun_ || restarts_ != end_.car_restarts();
    last_report_ = report->sequence;
    restarts_ = end_.car_restarts();
    if (restarted) {
      clock_.reset();
      begun_ = false;
    }
    if (std::optional<Telemetry> motion = motion_of(*report)) {
      motion->restarted = !std::exchange(begun_, true);
      return motion;
    }
  }
  return std::nullopt;
}

std::optional<Telemetry> CarLink::motion_of(const ReceivedReport& report) {
  const CarSensors& s = report.payload.sensors;
  const double wheels = 0.5 * (s.wheel_speeds[2] + s.wheel_speeds[3]);
  const bool known = s.acceleration.allFinite() && s.rate.allFinite() && std::isfinite(wheels);
  ++counts_[known ? PacketStatus::kAccepted : PacketStatus::kImplausible];
  if (!known) return std::nullopt;
  clock_.add(seconds(report.made), report.arrived);
  Telemetry t;
  t.arrival = report.arrived;
  recording::MotionSample& m = t.sample;
  m.time = seconds(report.made);
  m.frame = Frame::kFlu;
  m.place = place_;
  m.force = s.acceleration;
  m.rate = s.rate;
  m.speed = radius_ * wheels;
  m.force_from = m.rate_from = m.speed_from = recording::Origin::kMeasured;
  if (std::isfinite(s.steering)) {
    m.inputs.steer = s.steering;
    m.steer_from = recording::Origin::kMeasured;
  }
  return t;
}

void CarLink::take_driver(Bytes records) {
  if (records.empty()) {
    input_.reset();
    held_ = true;
    return;
  }
  while (const std::optional<WheelEvent> event = decoder_.next(records)) {
    if (!axes_.take(*event)) continue;
    input_ = calibration_.input(axes_);
    if (!pedal_) pedal_ = axes_.time();
  }
}

std::size_t CarLink::command(Nanoseconds now, bool halt, CommandBytes& out) {
  CarCommand command{.steering = last_.steering, .drive_force = 0.0, .brake = 1.0};
  if (input_) {
    command = car_command(*input_, options_);
    constexpr double kReleased = 0.02;
    held_ = halt || (held_ && input_->throttle > kReleased);
    if (held_) command.drive_force = 0.0;
    if (halt) command.brake = 1.0;
    sent_pedal_ = std::exchange(pedal_, std::nullopt);
  }
  last_ = command;
  return end_.command(command, now, out);
}

std::optional<Nanoseconds> CarLink::take_pedal() { return std::exchange(sent_pedal_, std::nullopt); }

CarStatus CarLink::status(Nanoseconds now) const {
  CarStatus s{.link = quality(now), .command = last_, .state = {}, .battery = 0.0, .restarts = end_.car_restarts()};
  if (const std::optional<ReceivedReport>& report = end_.report()) {
    s.state = report->payload.state;
    s.battery = report->payload.sensors.battery;
  }
  return s;
}

}  // namespace veridyn::live
