#include "veridyn/live/driver/wheel_calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "veridyn/core/study_keys.hpp"

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

/// `axis`, by its name.
template <typename Part>
void add_axis(KeyTable<Part>& table) {
  table
      .other({"axis", "", "an axis", "", "`ABS_X`, `ABS_WHEEL`, `ABS_GAS`, ..., or `ABS_` and its number"},
             [](const StudyTable& t, const std::string& key, Part& part) {
               const std::string name = t.text(key);
               const std::optional<std::uint16_t> code = axis_code(name);
               if (!code)
                 t.fail(key, fmt::format("'{}' is no axis; say ABS_X, ABS_WHEEL, ABS_GAS, ... or ABS_ and its number",
                                         name));
               part.axis = *code;
             })
      .required();
}

/// A number that the axis says.
template <typename Part>
void add_reading(KeyTable<Part>& table, const char* name, std::int32_t Part::*member, const char* says) {
  table
      .other({name, "", "a whole number", "", says},
             [member](const StudyTable& t, const std::string& key, Part& part) {
               const long long value = t.integer(key);
               if (value < INT32_MIN || value > INT32_MAX)
                 t.fail(key, fmt::format("is {}, beyond what an axis can say", value));
               part.*member = static_cast<std::int32_t>(value);
             })
      .required();
}

const KeyTable<SteeringCalibration>& steering_keys() {
  using S = SteeringCalibration;
  static const auto table = [] {
    KeyTable<S> keys("steering", "The steering wheel.");
    add_axis(keys);
    add_reading(keys, "left", &S::left, "at the left lock; may be the largest");
    add_reading(keys, "centre", &S::centre, "straight ahead");
    add_reading(keys, "right", &S::right, "at the right lock");
    keys.number("lock", &S::lock, "rad", share_up_to(100.0), "of the wheel, from the centre to either side")
        .required()
        .number("deadband", &S::deadband, "1", from_to(0.0, 0.5), "around the centre, share of the way to the lock");
    return keys;
  }();
  return table;
}

const KeyTable<PedalCalibration>& pedal_keys() {
  using P = PedalCalibration;
  static const auto table = [] {
    KeyTable<P> keys("pedal", "A pedal. Two may share an axis where one moves it up from the middle, the other down.");
    add_axis(keys);
    add_reading(keys, "released", &P::released, "at rest");
    add_reading(keys, "pressed", &P::pressed, "down; may be the smaller");
    keys.number("deadband", &P::deadband, "1", from_to(0.0, 0.4), "at each end, share of the way");
    return keys;
  }();
  return table;
}

const KeyTable<GearCalibration>& gear_keys() {
  using G = GearCalibration;
  static const auto table = [] {
    KeyTable<G> keys("gear", "A gear selector that is an axis: the nearer of two numbers. May be left out.");
    add_axis(keys);
    add_reading(keys, "forward", &G::forward, "in a forward gear");
    add_reading(keys, "reverse", &G::reverse, "in reverse");
    return keys;
  }();
  return table;
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
  const std::vector<NamedPedal> pedals = pedals_of(*this);
  for (std::size_t k = 0; k < pedals.size(); ++k) {
    const auto& [name, one] = pedals[k];
    if (one->released == one->pressed)
      return Problem{name, "pressed",
                     fmt::format("is {}, where the pedal is released: it does not move", one->pressed)};
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

const KeyTable<WheelCalibration>& WheelCalibration::keys() {
  using W = WheelCalibration;
  static const auto table =
      KeyTable<W>("calibration")
          .within("steering", steering_keys(),
                  [](const StudyTable& t, W& w) { w.steering = steering_keys().read(t.table("steering")); })
          .within("throttle", pedal_keys(),
                  [](const StudyTable& t, W& w) { w.throttle = pedal_keys().read(t.table("throttle")); })
          .within("brake", pedal_keys(),
                  [](const StudyTable& t, W& w) { w.brake = pedal_keys().read(t.table("brake")); })
          .whole_table("clutch", &W::clutch, pedal_keys())
          .whole_table("gear", &W::gear, gear_keys())
          .check([](const StudyTable& t, W& w) {
            if (const std::optional<Problem> problem = w.problem())
              t.table(problem->table).fail(problem->key, problem->text);
          });
  return table;
}

WheelCalibration WheelCalibration::load(const std::filesystem::path& file) {
  const Study study = Study::load(file);
  WheelCalibration result = keys().read(study.root());
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
