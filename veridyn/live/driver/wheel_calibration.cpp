#include "veridyn/live/driver/wheel_calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "veridyn/core/constants.hpp"

namespace veridyn::live {
namespace {

/// How far `value` is on the way from `start` to `end`, from 0 to 1.
double share_of_way(std::int32_t value, std::int32_t start, std::int32_t end) {
  const double way = static_cast<double>(end) - static_cast<double>(start);
  return std::clamp((static_cast<double>(value) - static_cast<double>(start)) / way, 0.0, 1.0);
}

double pedal(const PedalCalibration& calibration, const WheelAxes& axes) {
  const double share = share_of_way(axes.value(calibration.axis), calibration.released, calibration.pressed);
  return std::clamp((share - calibration.deadband) / (1.0 - 2.0 * calibration.deadband), 0.0, 1.0);
}

double steering_angle(const SteeringCalibration& calibration, const WheelAxes& axes) {
  const std::int32_t value = axes.value(calibration.axis);
  const double side = share_of_way(value, calibration.centre, calibration.left) -
                      share_of_way(value, calibration.centre, calibration.right);
  const double beyond = std::max(0.0, (std::abs(side) - calibration.deadband) / (1.0 - calibration.deadband));
  return std::copysign(beyond * calibration.lock, side);
}

bool nearer(std::int32_t value, std::int32_t to, std::int32_t than) {
  const auto distance = [&](std::int32_t other) { return std::abs(std::int64_t{value} - other); };
  return distance(to) < distance(than);
}

/// Whether two pedals on one axis claim some of the same numbers; that both rest at the same one is no overlap.
bool overlap(const PedalCalibration& a, const PedalCalibration& b) {
  const auto [a_low, a_high] = std::minmax(a.released, a.pressed);
  const auto [b_low, b_high] = std::minmax(b.released, b.pressed);
  return std::min(a_high, b_high) > std::max(a_low, b_low);
}

std::uint16_t read_axis(const StudyTable& table) {
  const std::string name = table.text("axis");
  const std::optional<std::uint16_t> code = axis_code(name);
  if (!code)
    table.fail("axis", fmt::format("'{}' is no axis; say ABS_X, ABS_WHEEL, ABS_GAS, ... or ABS_ and its number", name));
  return *code;
}

std::int32_t read_number(const StudyTable& table, std::string_view key) {
  const long long value = table.integer(key);
  if (value < INT32_MIN || value > INT32_MAX) table.fail(key, fmt::format("is {}, beyond what an axis can say", value));
  return static_cast<std::int32_t>(value);
}

PedalCalibration read_pedal(const StudyTable& table) {
  PedalCalibration result;
  result.axis = read_axis(table);
  result.released = read_number(table, "released");
  result.pressed = read_number(table, "pressed");
  result.deadband = table.number_or("deadband", "1", result.deadband);
  return result;
}

std::string pedal_to_toml(std::string_view name, const PedalCalibration& pedal) {
  return fmt::format("[{}]\naxis = \"{}\"\nreleased = {}\npressed = {}\ndeadband = {}\n", name, axis_name(pedal.axis),
                     pedal.released, pedal.pressed, pedal.deadband);
}

struct NamedPedal {
  const char* name;
  const PedalCalibration* pedal;
};

std::vector<NamedPedal> pedals_of(const WheelCalibration& calibration) {
  std::vector<NamedPedal> pedals = {{"throttle", &calibration.throttle}, {"brake", &calibration.brake}};
  if (calibration.clutch) pedals.push_back({"clutch", &*calibration.clutch});
  return pedals;
}

}  // namespace

std::optional<DriverInput> WheelCalibration::input(const WheelAxes& axes) const {
  if (!axes.heard_of(steering.axis) || !axes.heard_of(throttle.axis) || !axes.heard_of(brake.axis)) return std::nullopt;
  if ((clutch && !axes.heard_of(clutch->axis)) || (gear && !axes.heard_of(gear->axis))) return std::nullopt;
  DriverInput result;
  result.steering = steering_angle(steering, axes);
  result.throttle = pedal(throttle, axes);
  result.brake = pedal(brake, axes);
  if (clutch) result.clutch = pedal(*clutch, axes);
  if (gear) result.reverse = nearer(axes.value(gear->axis), gear->reverse, gear->forward);
  return result;
}

std::vector<WheelAxis> WheelCalibration::at_rest() const {
  std::vector<WheelAxis> axes;
  const auto add = [&](std::uint16_t code, std::int32_t one, std::int32_t other, std::int32_t value) {
    axes.push_back({.code = code, .lowest = std::min(one, other), .highest = std::max(one, other), .value = value});
  };
  add(steering.axis, steering.left, steering.right, steering.centre);
  for (const NamedPedal& each : pedals_of(*this))
    add(each.pedal->axis, each.pedal->released, each.pedal->pressed, each.pedal->released);
  if (gear) add(gear->axis, gear->forward, gear->reverse, gear->forward);
  return axes;
}

std::optional<WheelCalibration::Problem> WheelCalibration::problem() const {
  const auto [low, high] = std::minmax(steering.left, steering.right);
  if (!(low < steering.centre && steering.centre < high))
    return Problem{"steering", "centre",
                   fmt::format("is {}; must lie between the locks {} and {}", steering.centre, low, high)};
  if (!(steering.lock > 0.0 && steering.lock <= 100.0))
    return Problem{"steering", "lock", fmt::format("is {} rad; must be > 0 and <= 100", steering.lock)};
  if (!(steering.deadband >= 0.0 && steering.deadband <= 0.5))
    return Problem{"steering", "deadband", fmt::format("is {}; must be from 0 to 0.5", steering.deadband)};
  const std::vector<NamedPedal> pedals = pedals_of(*this);
  for (std::size_t k = 0; k < pedals.size(); ++k) {
    const auto& [name, one] = pedals[k];
    if (one->released == one->pressed)
      return Problem{name, "pressed",
                     fmt::format("is {}, where the pedal is released: it does not move", one->pressed)};
    if (!(one->deadband >= 0.0 && one->deadband <= 0.4))
      return Problem{name, "deadband", fmt::format("is {}; must be from 0 to 0.4", one->deadband)};
    if (one->axis == steering.axis)
      return Problem{name, "axis", fmt::format("{} is that of the steering", axis_name(one->axis))};
    for (std::size_t other = 0; other < k; ++other) {
      if (one->axis == pedals[other].pedal->axis && overlap(*one, *pedals[other].pedal))
        return Problem{name, "axis",
                       fmt::format("{} is that of the {} too, and their ranges overlap", axis_name(one->axis),
                                   pedals[other].name)};
    }
  }
  if (gear) {
    if (gear->forward == gear->reverse)
      return Problem{"gear", "reverse", fmt::format("is {} like forward", gear->reverse)};
    const bool taken = gear->axis == steering.axis ||
                       std::any_of(pedals.begin(), pedals.end(),
                                   [&](const NamedPedal& each) { return each.pedal->axis == gear->axis; });
    if (taken)
      return Problem{"gear", "axis", fmt::format("{} is that of the steering or a pedal", axis_name(gear->axis))};
  }
  return std::nullopt;
}

WheelCalibration WheelCalibration::read(const StudyTable& table) {
  WheelCalibration result;
  const StudyTable wheel = table.table("steering");
  result.steering.axis = read_axis(wheel);
  result.steering.left = read_number(wheel, "left");
  result.steering.centre = read_number(wheel, "centre");
  result.steering.right = read_number(wheel, "right");
  result.steering.lock = wheel.number("lock", "rad");
  result.steering.deadband = wheel.number_or("deadband", "1", result.steering.deadband);
  result.throttle = read_pedal(table.table("throttle"));
  result.brake = read_pedal(table.table("brake"));
  if (table.has("clutch")) result.clutch = read_pedal(table.table("clutch"));
  if (table.has("gear")) {
    const StudyTable gear = table.table("gear");
    result.gear = GearCalibration{
        .axis = read_axis(gear), .forward = read_number(gear, "forward"), .reverse = read_number(gear, "reverse")};
  }
  if (const std::optional<Problem> problem = result.problem())
    table.table(problem->table).fail(problem->key, problem->text);
  return result;
}

WheelCalibration WheelCalibration::load(const std::filesystem::path& file) {
  const Study study = Study::load(file);
  WheelCalibration result = read(study.root());
  study.root().finish();
  return result;
}

std::string WheelCalibration::to_toml() const {
  std::string text = fmt::format(
      "# Calibration of a steering wheel with pedals: numbers of its axes.\n[steering]\naxis = \"{}\"\nleft = {}\n"
      "centre = {}\nright = {}\nlock = {}  # rad, from the centre to either side\ndeadband = {}\n",
      axis_name(steering.axis), steering.left, steering.centre, steering.right, steering.lock, steering.deadband);
  for (const NamedPedal& each : pedals_of(*this)) text += pedal_to_toml(each.name, *each.pedal);
  if (gear)
    text += fmt::format("[gear]\naxis = \"{}\"\nforward = {}\nreverse = {}\n", axis_name(gear->axis), gear->forward,
                        gear->reverse);
  return text;
}

WheelCalibration source_calibration() {
  WheelCalibration result;
  result.steering = {.axis = kAxisX, .left = 0, .centre = 32768, .right = 65535};
  result.throttle = {.axis = *axis_code("ABS_GAS"), .released = 0, .pressed = 150};
  result.brake = {.axis = *axis_code("ABS_BRAKE"), .released = 0, .pressed = 150};
  result.gear = GearCalibration{.axis = *axis_code("ABS_MISC"), .forward = 0, .reverse = 128};
  return result;
}

}  // namespace veridyn::live
