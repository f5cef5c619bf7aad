#include "veridyn/live/rig/car_study.hpp"

#include <fmt/format.h>

#include <array>

#include "veridyn/core/error.hpp"
#include "veridyn/live/driver/driver_table.hpp"
#include "veridyn/live/rig/live_study.hpp"

namespace veridyn::live {
namespace {

/// A number within a range, with its unit in the message.
double car_number(const StudyTable& table, std::string_view key, std::string_view unit, double otherwise, double lowest,
                  double highest) {
  const double value = table.number_or(key, unit, otherwise);
  if (!(value >= lowest && value <= highest))
    table.fail(key, fmt::format("is {:g} {}; takes {:g} to {:g} {}", value, unit, lowest, highest, unit));
  return value;
}

}  // namespace

CarStudy read_car(const StudyTable& live) {
  const StudyTable table = live.table_or_empty("car");
  CarStudy c;
  if (table.has("line")) c.line = table.file("line");
  c.baud = static_cast<int>(table.integer_or("baud", c.baud));
  if (!(c.baud >= 1200 && c.baud <= 12'000'000))
    table.fail("baud", fmt::format("is {}; takes 1200 to 12000000", c.baud));
  c.range.steering = car_number(table, "steering", "rad", c.range.steering, 0.01, 1.5);
  c.range.drive_force = car_number(table, "force", "N", c.range.drive_force, 0.1, 1600.0);
  c.brake = car_number(table, "brake", "N m", c.brake, 1e-3, 1e4);
  c.radius = car_number(table, "radius", "m", c.radius, 0.005, 1.0);
  if (table.has("sensor")) {
    const std::vector<double> place = table.numbers("sensor", "m");
    if (place.size() != 3) table.fail("sensor", "takes three numbers: forward, left, up");
    c.sensor = {place[0], place[1], place[2]};
  }
  c.report_rate = car_number(table, "report_rate", "Hz", c.report_rate, 20.0, 400.0);
  constexpr double kMostFlips = 0.5;
  c.flips = car_number(table, "flips", "1", c.flips, 0.0, kMostFlips);
  if (table.has("truth")) c.truth = parse_address(table.text("truth"), table.place("truth"));
  return c;
}

DriverStudy read_driver(const StudyTable& live, const CommandRange& range) {
  if (!live.has("driver")) live.fail("driver", "is missing: [live.driver] says who drives the car");
  const StudyTable table = live.table("driver");
  DriverStudy d;
  constexpr std::array<std::pair<const char*, DriverStudy::Kind>, 3> kKinds = {{{"wheel", DriverStudy::Kind::kWheel},
                                                                                {"events", DriverStudy::Kind::kEvents},
                                                                                {"table", DriverStudy::Kind::kTable}}};
  int named = 0;
  for (const auto& [key, kind] : kKinds) {
    if (!table.has(key)) continue;
    ++named;
    d.kind = kind;
    d.file = table.file(key);
  }
  if (named != 1) live.fail("driver", fmt::format("names {} of wheel, events and table; takes one", named));
  if (d.kind == DriverStudy::Kind::kTable) {
    d.calibration = table_calibration();
    if (table.has("calibration")) table.fail("calibration", "is for a wheel; a table says what its driver does");
  } else if (table.is_table("calibration")) {
    d.calibration = WheelCalibration::read(table.table("calibration"));
  } else {
    if (!table.has("calibration"))
      table.fail("calibration", "is missing: the file that `veridyn rig wheel` writes for this wheel");
    d.calibration = WheelCalibration::load(table.file("calibration"));
    d.calibration_by_file = true;
  }
  d.command.range = range;
  d.command.steering_ratio = car_number(table, "ratio", "1", d.command.steering_ratio, 0.1, 100.0);
  d.command.reverse_share = car_number(table, "reverse_share", "1", d.command.reverse_share, 0.0, 1.0);
  return d;
}

VirtualCarOptions virtual_car_options(const CarStudy& car, std::uint64_t seed) {
  VirtualCarOptions o;
  o.end.range = car.range;
  o.brake_torque = car.brake;
  o.sensor = car.sensor;
  o.seed = seed;
  return o;
}

Study with_calibration(const Study& study, const DriverStudy& driver) {
  if (!driver.calibration_by_file) return Study::parse(study.to_toml(), study.name(), study.folder());
  const WheelCalibration& c = driver.calibration;
  std::string text =
      fmt::format("live.driver.calibration={{steering={{axis='{}',left={},centre={},right={},lock={},deadband={}}}",
                  axis_name(c.steering.axis), c.steering.left, c.steering.centre, c.steering.right, c.steering.lock,
                  c.steering.deadband);
  const auto pedal = [&](std::string_view name, const PedalCalibration& p) {
    text += fmt::format(",{}={{axis='{}',released={},pressed={},deadband={}}}", name, axis_name(p.axis), p.released,
                        p.pressed, p.deadband);
  };
  pedal("throttle", c.throttle);
  pedal("brake", c.brake);
  if (c.clutch) pedal("clutch", *c.clutch);
  if (c.gear)
    text += fmt::format(",gear={{axis='{}',forward={},reverse={}}}", axis_name(c.gear->axis), c.gear->forward,
                        c.gear->reverse);
  const std::array<std::string, 1> overrides = {text + "}"};
  return Study::parse(study.to_toml(), study.name(), study.folder(), overrides);
}

}  // namespace veridyn::live
