#include "veridyn/live/driver/driver_table.hpp"

#include <fmt/format.h>

#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/io/tables/table.hpp"

namespace veridyn::live {
namespace {

constexpr double kWheelStep = 1e-5;  // [rad]
constexpr std::int32_t kMostWheel = 2'000'000, kPedalDown = 100'000, kReverse = 1;
constexpr double kMostAngle = kMostWheel * kWheelStep;
constexpr Nanoseconds kRowStep = kSecond / 100;

/// A column with the range of its values.
struct DriverColumn {
  const io::TableColumn* column = nullptr;
  double lowest = 0.0, highest = 1.0;
};

void check(const io::Table& table, const DriverColumn& c) {
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const double value = c.column->value[row];
    if (!(value >= c.lowest && value <= c.highest))
      throw InputError(fmt::format("{}:{}", table.source, table.lines[row]),
                       fmt::format("{} is {:g}; takes {:g} to {:g}", c.column->name, value, c.lowest, c.highest));
  }
}

}  // namespace

std::vector<WheelEvent> read_driver_table(const std::filesystem::path& path) {
  const io::Table table = io::read_table(path);
  const std::vector<double>& time = table.at("time").value;
  const std::vector<double>& steering = table.at("steering").value;
  const std::vector<double>& throttle = table.at("throttle").value;
  const std::vector<double>& brake = table.at("brake").value;
  const std::vector<double>* reverse = nullptr;
  for (const io::TableColumn& column : table.columns) {
    if (column.name == "reverse") reverse = &column.value;
  }
  constexpr double kLongest = 86400.0;  // [s]
  check(table, {&table.at("time"), 0.0, kLongest});
  check(table, {&table.at("steering"), -kMostAngle, kMostAngle});
  check(table, {&table.at("throttle"), 0.0, 1.0});
  check(table, {&table.at("brake"), 0.0, 1.0});
  if (reverse != nullptr) check(table, {&table.at("reverse"), 0.0, 1.0});
  for (std::size_t row = 1; row < time.size(); ++row) {
    if (!(time[row] > time[row - 1]))
      throw InputError(fmt::format("{}:{}", table.source, table.lines[row]),
                       fmt::format("time is {:g} s after {:g} s; must grow", time[row], time[row - 1]));
  }
  const WheelCalibration wheel = table_calibration();
  std::vector<WheelEvent> events;
  std::size_t row = 0;
  for (Nanoseconds at = nanoseconds(time.front()); at <= nanoseconds(time.back()); at += kRowStep) {
    while (row + 2 < time.size() && time[row + 1] <= seconds(at)) ++row;
    const std::size_t next = std::min(row + 1, time.size() - 1);
    const double part = next > row ? std::min((seconds(at) - time[row]) / (time[next] - time[row]), 1.0) : 0.0;
    const auto value = [&](const std::vector<double>& all, double step) {
      return static_cast<std::int32_t>(std::lround((all[row] + part * (all[next] - all[row])) / step));
    };
    const auto add = [&](std::uint16_t type, std::uint16_t code, std::int32_t number) {
      events.push_back({.time = at, .type = type, .code = code, .value = number});
    };
    add(kAxisEvent, wheel.steering.axis, value(steering, kWheelStep));
    add(kAxisEvent, wheel.throttle.axis, value(throttle, 1.0 / kPedalDown));
    add(kAxisEvent, wheel.brake.axis, value(brake, 1.0 / kPedalDown));
    // Not between the gears.
    if (reverse != nullptr) add(kAxisEvent, wheel.gear->axis, (*reverse)[row] > 0.5 ? kReverse : 0);
    add(kSyncEvent, kSyncReport, 0);
  }
  return events;
}

WheelCalibration table_calibration() {
  WheelCalibration c = source_calibration();
  c.steering = {
      .axis = kAxisX, .left = kMostWheel, .centre = 0, .right = -kMostWheel, .lock = kMostAngle, .deadband = 0.0};
  c.throttle.released = c.brake.released = 0;
  c.throttle.pressed = c.brake.pressed = kPedalDown;
  c.throttle.deadband = c.brake.deadband = 0.0;
  c.gear->forward = 0;
  c.gear->reverse = kReverse;
  return c;
}

}  // namespace veridyn::live
