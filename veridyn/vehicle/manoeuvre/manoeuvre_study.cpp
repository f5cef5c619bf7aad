#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/io/tables/table.hpp"
#include "veridyn/vehicle/manoeuvre/manoeuvre.hpp"
#include "veridyn/vehicle/manoeuvre/manoeuvre_keys.hpp"

namespace veridyn::vehicle {
namespace {

/// A column of a table as a function of time; empty when the column is not there.
PiecewiseLinear column(const io::Table& table, std::string_view name, std::string_view unit) {
  const auto found = std::ranges::find(table.columns, name, &io::TableColumn::name);
  if (found == table.columns.end()) return {};
  if (!found->unit.same_dimension(parse_unit(unit))) {
    throw InputError(table.source, fmt::format("column {} is in {}, expected {}", name, found->unit.name, unit));
  }
  try {
    return {table.at("time").value, found->value};
  } catch (const InputError& wrong) {
    throw InputError(fmt::format("{}: {}", table.source, name), wrong.what());
  }
}

/// A torque that is one number or one per moment of `torque_time`.
PiecewiseLinear torque(const StudyTable& drive, const char* key, const std::vector<double>& value,
                       const TorqueKeys& keys) {
  if (value.empty()) return {};
  if (!drive.is_array(key)) return PiecewiseLinear(value.front());
  try {
    return {keys.torque_time, value};
  } catch (const InputError& wrong) {
    if (wrong.place() != "signal") throw;
    drive.fail(key, std::string_view(wrong.what()).substr(wrong.place().size() + 2));
  }
}

/// The manoeuvre with what drives and brakes.
Manoeuvre with_longitudinal(Manoeuvre manoeuvre, const StudyTable& drive, const ManoeuvreContext& context) {
  const TorqueKeys keys = TorqueKeys::keys().read(drive);
  for (const char* key : {"drive_torque", "brake_torque"}) {
    if (!drive.is_array(key)) continue;
    require_keys(drive, {"torque_time"});
    if (drive.numbers(key, "N m").empty()) drive.fail(key, "is empty");
  }
  if (!drive.has("drive_torque") && !drive.has("brake_torque"))
    refuse_keys(drive, {"torque_time"}, "is of drive_torque and brake_torque, and there is neither");
  for (const char* key : {"hold_speed", "target_speed", "drive_torque", "brake_torque"}) {
    if (drive.has(key) && !drive.flag_or("longitudinal", false)) drive.fail(key, "needs longitudinal = true");
  }
  if (!keys.drive_torque.empty() || !keys.brake_torque.empty()) {
    manoeuvre = with_torques(std::move(manoeuvre), torque(drive, "drive_torque", keys.drive_torque, keys),
                             torque(drive, "brake_torque", keys.brake_torque, keys));
  }
  if (keys.hold_speed || keys.target_speed) {
    if (!manoeuvre.speed.empty())
      drive.fail(keys.hold_speed ? "hold_speed" : "target_speed", "this manoeuvre sets the speed itself");
    return with_speed_control(std::move(manoeuvre), PiecewiseLinear(keys.target_speed.value_or(context.speed)),
                              context);
  }
  return manoeuvre;
}

Manoeuvre read_signal(const StudyTable& drive) {
  const SignalKeys keys = SignalKeys::keys().read(drive);
  if (!keys.file) {
    require_keys(drive, {"time", "steer"});
    return steering_signal(PiecewiseLinear(keys.time, keys.steer));
  }
  refuse_keys(drive, {"time", "steer"}, "is given as well as `file`: give one of them");
  const io::Table table = io::read_table(*keys.file);
  (void)table.at("time");
  (void)table.at("steer");
  return steering_signal(column(table, "steer", "rad"), column(table, "drive_torque", "N m"),
                         column(table, "brake_torque", "N m"));
}

Manoeuvre read_circle(const StudyTable& drive, const ManoeuvreContext& context) {
  const CircleKeys keys = CircleKeys::keys().read(drive);
  if (!keys.constant_radius) {
    refuse_keys(drive, {"radius", "end_speed", "length", "preview_time", "delay", "lag", "max_steer", "max_steer_rate"},
                "is of method = \"constant radius\"");
    return slowly_increasing_steer(keys.amplitude, keys.rate, keys.start);
  }
  refuse_keys(drive, {"rate", "amplitude", "start"}, "is of method = \"constant speed\"");
  require_keys(drive, {"radius", "end_speed"});
  return constant_radius_circle(context, keys.radius, keys.end_speed, keys.length, keys.driver);
}

Manoeuvre read_path_manoeuvre(const StudyTable& drive, const ManoeuvreContext& context) {
  const FollowPathKeys keys = FollowPathKeys::keys().read(drive);
  if (keys.file)
    refuse_keys(drive, {"radius", "direction"}, "is of a circle, and there is a `file`: give one of them");
  else if (std::isnan(keys.radius))
    drive.fail("manoeuvre", "follow path needs a file or the radius of a circle");
  return follow_path(
      context, std::make_shared<const Path>(keys.file ? read_path(*keys.file) : Path::circle(keys.radius, keys.side)),
      keys.driver);
}

/// A manoeuvre between cones, with the body's overhangs.
Manoeuvre read_cones(const std::string& name, const StudyTable& drive, const ManoeuvreContext& context) {
  const ConesKeys keys = (name == "slalom" ? ConesKeys::slalom_keys() : ConesKeys::course_keys()).read(drive);
  const auto course = [&] {
    if (name == "slalom") {
      const VehicleParameters<double>& p = context.parameters;
      const double width = keys.vehicle_width == 0.0 ? 7.0 / 6.0 * std::max(p.track_f, p.track_r) : keys.vehicle_width;
      return slalom(context, slalom_course(keys.cones, keys.spacing, keys.clearance, width), keys.driver);
    }
    return name == "double lane change"
               ? double_lane_change(context, keys.vehicle_width, keys.course_scale, keys.driver)
               : obstacle_avoidance(context, keys.vehicle_width, keys.course_scale, keys.driver);
  };
  Manoeuvre m = course();
  m.body.ahead += keys.front_overhang;
  m.body.behind += keys.rear_overhang;
  return m;
}

Manoeuvre read_one(const std::string& name, const StudyTable& drive, const ManoeuvreContext& context,
                   const Progress& progress) {
  if (name == "reference") return reference_manoeuvre();
  if (name == "signal") return read_signal(drive);
  if (name == "double lane change" || name == "obstacle avoidance" || name == "slalom")
    return read_cones(name, drive, context);
  if (name == "braking in a turn") {
    if (!drive.flag_or("longitudinal", false)) drive.fail("manoeuvre", "brakes, which needs longitudinal = true");
    const auto k = BrakingInATurnKeys::keys().read(drive);
    return braking_in_a_turn(context, k.radius, k.deceleration, k.brake_time, k.driver);
  }
  if (name == "follow path") return read_path_manoeuvre(drive, context);
  if (name == "steady-state circle") return read_circle(drive, context);
  if (name == "step steer") {
    const auto k = StepSteerKeys::keys().read(drive);
    return step_steer(k.amplitude, k.start, k.rise_time);
  }
  if (name == "sine") {
    const auto k = SineKeys::keys().read(drive);
    return sine_steer(k.amplitude, k.frequency, k.start, 1);
  }
  if (name == "continuous sine") {
    const auto k = ContinuousSineKeys::keys().read(drive);
    return sine_steer(k.amplitude, k.frequency, k.start, k.periods);
  }
  if (name == "sine with dwell") {
    const auto k = SineWithDwellKeys::keys().read(drive);
    return sine_with_dwell(k.amplitude, k.start, k.frequency, k.dwell);
  }
  if (name == "ramp steer") {
    const auto k = RampSteerKeys::keys().read(drive);
    return ramp_steer(k.amplitude, k.rate, k.start, k.hold);
  }
  if (name == "fishhook") {
    const auto k = FishhookKeys::keys().read(drive);
    return fishhook(k.amplitude, k.rate, k.start, k.dwell);
  }
  const bool sweep = name == "sweep";
  const auto k = (sweep ? RandomSteerKeys::sweep_keys() : RandomSteerKeys::keys()).read(drive);
  if (sweep) return sweep_steer(k.amplitude, k.low, k.high, k.length, k.start);
  return random_steer(k.amplitude, k.low, k.high, k.length, k.seed.value_or(context.seed), k.start, progress);
}

}  // namespace

std::span<const std::string> manoeuvre_names() {
  static const std::array<std::string, 16> names{"reference",
                                                 "step steer",
                                                 "sine",
                                                 "continuous sine",
                                                 "sine with dwell",
                                                 "sweep",
                                                 "random steer",
                                                 "fishhook",
                                                 "steady-state circle",
                                                 "double lane change",
                                                 "obstacle avoidance",
                                                 "slalom",
                                                 "ramp steer",
                                                 "braking in a turn",
                                                 "follow path",
                                                 "signal"};
  return names;
}

Manoeuvre read_manoeuvre(const StudyTable& drive, const ManoeuvreContext& context, const Progress& progress) {
  const std::span<const std::string> names = manoeuvre_names();
  const std::string name = drive.text_or("manoeuvre", names[0]);
  if (std::ranges::find(names, name) == names.end()) {
    drive.fail("manoeuvre", fmt::format("no manoeuvre is called '{}'{}", name, suggestion(name, names)));
  }
  if (!(context.speed > 0.0)) drive.fail("speed", fmt::format("= {:g} m/s must be > 0", context.speed));
  try {
    return with_longitudinal(read_one(name, drive, context, progress), drive, context);
  } catch (const InputError& wrong) {
    // A refusal by the library names the key behind it, where that can be known.
    static const std::array<std::string_view, 4> own{"manoeuvre", "driver", "signal", "slalom"};
    if (std::ranges::find(own, wrong.place()) == own.end()) throw;
    const std::string_view what = std::string_view(wrong.what()).substr(wrong.place().size() + 2);
    std::string key(what.substr(0, what.find(' ')));
    if (key == "steer" && drive.has("amplitude")) key = "amplitude";
    throw InputError(drive.place(drive.has(key) ? key : "manoeuvre"), what);
  }
}

}  // namespace veridyn::vehicle
