#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/io/tables/table.hpp"
#include "veridyn/vehicle/manoeuvre/manoeuvre.hpp"

namespace veridyn::vehicle {
namespace {

PreviewDriverOptions read_driver(const StudyTable& drive) {
  PreviewDriverOptions options;
  options.preview_time = drive.positive_or("preview_time", "s", options.preview_time);
  options.delay = drive.number_or("delay", "s", options.delay);
  options.lag = drive.number_or("lag", "s", options.lag);
  options.max_steer = drive.positive_or("max_steer", "rad", options.max_steer);
  options.max_steer_rate = drive.positive_or("max_steer_rate", "rad/s", options.max_steer_rate);
  return options;
}

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
PiecewiseLinear read_torque(const StudyTable& drive, const char* key) {
  if (!drive.has(key)) return {};
  if (!drive.is_array(key)) return PiecewiseLinear(drive.number(key, "N m"));
  const std::vector<double> time = drive.numbers("torque_time", "s");
  try {
    return {time, drive.numbers(key, "N m")};
  } catch (const InputError& wrong) {
    if (wrong.place() != "signal") throw;
    drive.fail(key, std::string_view(wrong.what()).substr(wrong.place().size() + 2));
  }
}

/// The manoeuvre with what drives and brakes.
Manoeuvre with_longitudinal(Manoeuvre manoeuvre, const StudyTable& drive, const ManoeuvreContext& context) {
  const bool hold = drive.flag_or("hold_speed", false);
  const bool torques = drive.has("drive_torque") || drive.has("brake_torque");
  for (const char* key : {"hold_speed", "target_speed", "drive_torque", "brake_torque"}) {
    if (drive.has(key) && !drive.flag_or("longitudinal", false)) drive.fail(key, "needs longitudinal = true");
  }
  if (torques) {
    manoeuvre =
        with_torques(std::move(manoeuvre), read_torque(drive, "drive_torque"), read_torque(drive, "brake_torque"));
  }
  if (hold || drive.has("target_speed")) {
    if (!manoeuvre.speed.empty())
      drive.fail(hold ? "hold_speed" : "target_speed", "this manoeuvre sets the speed itself");
    return with_speed_control(std::move(manoeuvre),
                              PiecewiseLinear(drive.positive_or("target_speed", "m/s", context.speed)), context);
  }
  return manoeuvre;
}

Manoeuvre read_signal(const StudyTable& drive) {
  if (!drive.has("file")) {
    const std::vector<double> time = drive.numbers("time", "s");
    return steering_signal(PiecewiseLinear(time, drive.numbers("steer", "rad")));
  }
  const io::Table table = io::read_table(drive.file("file"));
  (void)table.at("time");
  (void)table.at("steer");
  return steering_signal(column(table, "steer", "rad"), column(table, "drive_torque", "N m"),
                         column(table, "brake_torque", "N m"));
}

Manoeuvre read_circle(const StudyTable& drive, const ManoeuvreContext& context, double amplitude, double start) {
  static const std::array<std::string, 2> methods{"constant speed", "constant radius"};
  if (drive.choice_or("method", methods, methods[0]) == methods[0]) {
    return slowly_increasing_steer(amplitude, drive.positive_or("rate", "rad/s", 0.2 * kDegree), start);
  }
  const double radius = drive.number("radius", "m");
  return constant_radius_circle(context, radius, drive.positive("end_speed", "m/s"),
                                drive.positive_or("length", "s", 120.0), read_driver(drive));
}

Manoeuvre read_path_manoeuvre(const StudyTable& drive, const ManoeuvreContext& context) {
  if (drive.has("file")) {
    return follow_path(context, std::make_shared<const Path>(read_path(drive.file("file"))), read_driver(drive));
  }
  if (!drive.has("radius")) drive.fail("manoeuvre", "follow path needs a file or the radius of a circle");
  static const std::array<std::string, 2> sides{"left", "right"};
  const int side = drive.choice_or("direction", sides, "left") == "left" ? 1 : -1;
  const double radius = drive.positive("radius", "m");
  return follow_path(context, std::make_shared<const Path>(Path::circle(radius, side)), read_driver(drive));
}

/// A manoeuvre between cones, with the body's overhangs.
Manoeuvre read_cones(const std::string& name, const StudyTable& drive, const ManoeuvreContext& context) {
  const double width = drive.has("vehicle_width") ? drive.positive("vehicle_width", "m") : 0.0;
  const auto course = [&] {
    if (name == "slalom") {
      const VehicleParameters<double>& p = context.parameters;
      return slalom(context,
                    slalom_course(static_cast<int>(drive.integer_or("cones", 8)),
                                  drive.positive_or("spacing", "m", 18.0), drive.number_or("clearance", "m", 0.5),
                                  width == 0.0 ? 7.0 / 6.0 * std::max(p.track_f, p.track_r) : width),
                    read_driver(drive));
    }
    const double scale = drive.positive_or("course_scale", "1", 1.0);
    return name == "double lane change" ? double_lane_change(context, width, scale, read_driver(drive))
                                        : obstacle_avoidance(context, width, scale, read_driver(drive));
  };
  Manoeuvre m = course();
  const auto overhang = [&](const char* key) {
    const double length = drive.number_or(key, "m", 0.0);
    if (!(length >= 0.0)) drive.fail(key, fmt::format("= {:g} must be >= 0", length));
    return length;
  };
  m.body.ahead += overhang("front_overhang");
  m.body.behind += overhang("rear_overhang");
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
    return braking_in_a_turn(context, drive.number_or("radius", "m", 100.0),
                             drive.positive_or("deceleration", "m/s^2", 4.0),
                             drive.positive_or("brake_time", "s", 15.0), read_driver(drive));
  }
  if (name == "follow path") return read_path_manoeuvre(drive, context);
  const double amplitude = drive.number_or("amplitude", "rad", (name == "ramp steer" ? 5.0 : 2.0) * kDegree);
  const double start = drive.number_or("start", "s", 1.0);
  if (name == "step steer") return step_steer(amplitude, start, drive.positive_or("rise_time", "s", 0.1));
  if (name == "sine") return sine_steer(amplitude, drive.positive_or("frequency", "Hz", 0.5), start, 1);
  if (name == "continuous sine") {
    return sine_steer(amplitude, drive.positive_or("frequency", "Hz", 0.5), start,
                      static_cast<int>(drive.integer_or("periods", 3)));
  }
  if (name == "sine with dwell") {
    return sine_with_dwell(amplitude, start, drive.positive_or("frequency", "Hz", 0.7),
                           drive.number_or("dwell", "s", 0.5));
  }
  if (name == "ramp steer") {
    return ramp_steer(amplitude, drive.positive_or("rate", "rad/s", kDegree), start, drive.number_or("hold", "s", 2.0));
  }
  if (name == "fishhook") {
    return fishhook(amplitude, drive.positive_or("rate", "rad/s", 0.75), start, drive.positive_or("dwell", "s", 0.25));
  }
  if (name == "steady-state circle") return read_circle(drive, context, amplitude, start);
  const double low = drive.positive_or("low", "Hz", 0.1), high = drive.positive_or("high", "Hz", 4.0);
  const double length = drive.positive_or("length", "s", 60.0);
  if (name == "sweep") return sweep_steer(amplitude, low, high, length, start);
  const auto seed = static_cast<std::uint64_t>(drive.integer_or("seed", static_cast<long long>(context.seed)));
  return random_steer(amplitude, low, high, length, seed, start, progress);
}

}  // namespace

Manoeuvre read_manoeuvre(const StudyTable& drive, const ManoeuvreContext& context, const Progress& progress) {
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
