#include "veridyn/aircraft/reconstruction/contradiction.hpp"

#include <fmt/format.h>

#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft::internal {
namespace {

/// What the sensor's quantity is dead reckoned from.
const char* reckoned_from(Sensor sensor) {
  if (sensor <= kYaw) return "gyro";
  return sensor == kPitot ? "ground velocity and wind" : "accelerometer and attitude";
}

/// The steady error that would let the difference grow by `rate`.
std::string meaning_of(Sensor sensor, double rate) {
  /// Beyond this share of gravity no tilt is likely.
  constexpr double kTilted = 0.3;
  if (sensor == kPitot) return "as if the wind had changed, or the unit of the pitot tube were wrong";
  if (sensor <= kYaw) return fmt::format("as if the gyro were off by {:.2g} deg/s", rate / kDegree);
  std::string text = fmt::format("as if the accelerometer were off by {:.2g} m/s^2", rate);
  if (sensor != kVelDown && rate < kTilted * kGravity)
    text += fmt::format(" or the attitude leaned by {:.2g} deg", std::asin(rate / kGravity) / kDegree);
  return text;
}

}  // namespace

std::optional<Contradiction> contradiction_of(const FlightStreams& streams, const Monitors& monitors) {
  const std::optional<Sensor> lost = lost_sensor(monitors);
  if (!lost) return std::nullopt;
  const estimation::InnovationMonitor& monitor = monitors[*lost];
  const Stream& stream = streams.sensors[*lost];
  Contradiction c;
  c.channel = stream.channel;
  c.unit = stream.unit;
  c.against = reckoned_from(*lost);
  c.by_gyro = *lost <= kYaw;
  c.span = {monitor.unsupported_since(), monitor.last_time()};
  c.departure = -monitor.largest_innovation();
  c.expected = monitor.largest_sigma();
  c.meaning = meaning_of(*lost, monitor.largest_rate());
  c.statement = fmt::format(
      "{} contradicts {} from {:.1f} s on: refused for {:.0f} s, while the reconstruction departed from it by up "
      "to {:.3g}{} where +-{:.2g} was expected, {}; reconstruction ended at {:.1f} s",
      c.channel, c.against, c.span.begin, c.span.duration(), std::abs(display_value(c.departure, c.unit)),
      display_unit(c.unit), display_value(c.expected, c.unit), c.meaning, c.span.end);
  return c;
}

}  // namespace veridyn::aircraft::internal
