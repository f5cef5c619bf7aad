#include "veridyn/live/rig/car_study.hpp"

#include <fmt/format.h>

#include <array>

#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/live/driver/driver_table.hpp"
#include "veridyn/live/rig/live_study.hpp"

namespace veridyn::live {

const KeyTable<CarStudy>& CarStudy::keys() {
  using C = CarStudy;
  const auto steering = [](C& c) -> double& { return c.range.steering; };
  const auto force = [](C& c) -> double& { return c.range.drive_force; };
  static const auto table =
      KeyTable<C>("live.car", "A scaled car at the end of a serial line.")
          .file("line", &C::line, "the serial device; of `veridyn rig car` the name of its pseudo-terminal")
          .otherwise("`/tmp/car`")
          .count("baud", &C::baud, 1200, 12'000'000, "of the line [bit/s]")
          .number("steering", steering, "rad", from_to(0.01, 1.5), "largest angle of the road wheels")
          .number("force", force, "N", from_to(0.1, 1600.0), "largest drive force, of all wheels together")
          .number("brake", &C::brake, "N m", from_to(1e-3, 1e4), "torque of the brake fully on, of all wheels together")
          .number("radius", &C::radius, "m", from_to(0.005, 1.0), "of the wheels: from their speed to the car's")
          .numbers("sensor", &C::sensor, "m", kAnyNumber,
                   "of the inertial sensors from the centre of gravity: forward, left, up")
          .number("report_rate", &C::report_rate, "Hz", from_to(20.0, 400.0), "of the car's reports")
          .number("flips", &C::flips, "1", from_to(0.0, 0.5),
                  "of the virtual car: share of the line's bytes that arrive as other ones")
          .other({"truth", "", "an address", "none", "of the virtual car: where its true motion is sent", true},
                 [](const StudyTable& t, const std::string& key, C& c) {
                   c.truth = parse_address(t.text(key), t.place(key));
                 });
  return table;
}

const KeyTable<DriverStudy>& DriverStudy::keys() {
  using D = DriverStudy;
  const auto driven_by = [](D::Kind by) {
    return [by](const StudyTable& t, const std::string& key, D& d) {
      d.kind = by;
      d.file = t.file(key);
    };
  };
  const auto ratio = [](D& d) -> double& { return d.command.steering_ratio; };
  const auto reverse = [](D& d) -> double& { return d.command.reverse_share; };
  static const auto table =
      KeyTable<D>("live.driver", "Who drives the car: one of `wheel`, `events`, `table`.")
          .other({"wheel", "", "a device", "", "`/dev/input/by-id/...-event-joystick`"}, driven_by(D::Kind::kWheel))
          .other({"events", "", "a file", "", "recorded of such a device"}, driven_by(D::Kind::kEvents))
          .other({"table", "", "a file", "", "what a driver does over time"}, driven_by(D::Kind::kTable))
          .elsewhere({"calibration", "", "a file", "required with `wheel` and `events`",
                      "that `veridyn rig wheel` writes for this wheel; or its tables, as below", true})
          .within("calibration", WheelCalibration::keys(), [](const StudyTable&, D&) {})
          .number("ratio", ratio, "1", from_to(0.1, 100.0), "angle of the steering wheel over that of the road wheels")
          .number("reverse_share", reverse, "1", from_to(0.0, 1.0), "of the drive force, backward")
          .check([](const StudyTable& t, D&) {
            const int named = int{t.has("wheel")} + int{t.has("events")} + int{t.has("table")};
            if (named != 1) t.fail("", fmt::format("names {} of wheel, events and table; takes one", named));
          });
  return table;
}

DriverStudy read_driver(const StudyTable& live, const CommandRange& range) {
  if (!live.has("driver")) live.fail("driver", "is missing: [live.driver] says who drives the car");
  const StudyTable table = live.table("driver");
  DriverStudy d = DriverStudy::keys().read(table);
  if (d.kind == DriverStudy::Kind::kTable) {
    d.calibration = table_calibration();
    if (table.has("calibration")) table.fail("calibration", "is for a wheel; a table says what its driver does");
  } else if (table.is_table("calibration")) {
    d.calibration = WheelCalibration::keys().read(table.table("calibration"));
  } else {
    if (!table.has("calibration"))
      table.fail("calibration", "is missing: the file that `veridyn rig wheel` writes for this wheel");
    d.calibration = WheelCalibration::load(table.file("calibration"));
    d.calibration_by_file = true;
  }
  d.command.range = range;
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
