#include "veridyn/live/rig/car_links.hpp"

#include <poll.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>

#include "veridyn/core/error.hpp"
#include "veridyn/live/driver/driver_table.hpp"

namespace veridyn::live {
namespace {

std::unique_ptr<DriverSource> source_of(const DriverStudy& driver) {
  if (driver.kind == DriverStudy::Kind::kWheel) return wheel_source(driver.file);
  return recorded_source(
      driver.kind == DriverStudy::Kind::kEvents ? read_wheel_events(driver.file) : read_driver_table(driver.file),
      driver.calibration.at_rest());
}

std::string_view text_of(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

CarLinks::CarLinks(const LiveStudy& study)
    : line_options_{.device = study.car->line, .baud = study.car->baud},
      line_(line_options_),
      driver_(source_of(*study.driver)),
      platform_(UdpSocket::connected(study.platform, "live.platform")) {
  if (study.telemetry.port != 0) stop_.emplace(study.telemetry, "live.stop");
  if (study.camera) camera_.emplace(study.camera->address);
}

bool CarLinks::send_command(std::string_view command) {
  if (!line_) return false;
  const Bytes bytes(reinterpret_cast<const std::uint8_t*>(command.data()), command.size());
  return line_->write(bytes) == bytes.size();
}

void CarLinks::open_again(Nanoseconds now) {
  constexpr Nanoseconds kApart = kSecond / 2;
  if (line_ || now - tried_at_ < kApart) return;
  tried_at_ = now;
  if (::access(line_options_.device.c_str(), R_OK | W_OK) != 0) return;
  try {
    line_.emplace(line_options_);
  } catch (const InputError&) {
    // Not there yet after all.
  }
}

std::optional<Incoming> CarLinks::from_line(Nanoseconds now) {
  if (begin_ == end_ && line_) {
    begin_ = 0;
    end_ = line_->read(chunk_);
    read_at_ = now;
    if (line_->hung_up()) line_.reset();
  }
  if (begin_ == end_) return std::nullopt;
  // Up to the zero that ends a frame.
  const Bytes there = Bytes(chunk_).subspan(begin_, end_ - begin_);
  const auto zero = std::find(there.begin(), there.end(), std::uint8_t{0});
  const auto size = static_cast<std::size_t>(zero - there.begin()) + (zero != there.end() ? 1U : 0U);
  begin_ += size;
  return Incoming{LinkOf::kCar, {text_of(there.first(size)), {}, read_at_}};
}

std::optional<Incoming> CarLinks::from_driver(Nanoseconds now) {
  if (driver_gone_) return std::nullopt;
  const std::size_t size = driver_->read(now, records_);
  driver_gone_ = size == 0 && driver_->ended();
  if (size == 0 && !driver_gone_) return std::nullopt;
  return Incoming{LinkOf::kDriver, {text_of(Bytes(records_).first(size)), {}, now}};
}

void CarLinks::wait(Nanoseconds now, Nanoseconds until) {
  std::array<pollfd, 5> all = {{{platform_.handle(), POLLIN, 0},
                                {line_ ? line_->descriptor() : -1, POLLIN, 0},
                                {driver_gone_ ? -1 : driver_->descriptor(), POLLIN, 0},
                                {stop_ ? stop_->handle() : -1, POLLIN, 0},
                                {camera_ ? camera_->handle() : -1, POLLIN, 0}}};
  const std::optional<Nanoseconds> due = driver_gone_ ? std::nullopt : driver_->due();
  const Nanoseconds left = std::max<Nanoseconds>((due ? std::min(*due, until) : until) - now, 0);
  const timespec timeout{left / kSecond, left % kSecond};
  ::ppoll(all.data(), all.size(), &timeout, nullptr);
}

std::optional<Incoming> CarLinks::next(Clock& clock, Nanoseconds until) {
  while (true) {
    const Nanoseconds now = clock.now();
    if (now >= until) return std::nullopt;
    if (const auto from = from_line(now)) return from;
    if (const auto from = from_driver(now)) return from;
    if (const auto d = platform_.receive()) return Incoming{LinkOf::kPlatform, *d};
    if (stop_) {
      if (const auto d = stop_->receive()) return Incoming{LinkOf::kTelemetry, *d};
    }
    if (camera_) {
      if (const auto d = camera_->next(now)) return Incoming{LinkOf::kCamera, *d};
    }
    open_again(now);
    wait(now, until);
  }
}

}  // namespace veridyn::live
