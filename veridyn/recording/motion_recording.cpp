#include "veridyn/recording/motion_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/rotation.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/recording/channel_map.hpp"
#include "veridyn/recording/gravity.hpp"

namespace veridyn::recording {
namespace {

constexpr double kSlowest = 5.0;       // [Hz]
constexpr double kFastestTurn = 20.0;  // [rad/s]

/// A channel at the stamps; before its first and after its last sample those values. Nothing where it is not recorded.
std::optional<std::vector<double>> held(const Recording& recording, std::initializer_list<const char*> names,
                                        std::span<const double> at) {
  for (const char* name : names) {
    const Channel* channel = recording.find(name);
    if (channel == nullptr || channel->empty()) continue;
    std::vector<double> values = interpolated(*channel, at);
    const auto finite = [](double v) { return std::isfinite(v); };
    const auto first = std::find_if(values.begin(), values.end(), finite);
    if (first == values.end()) continue;
    std::fill(values.begin(), first, *first);
    for (std::size_t i = 1; i < values.size(); ++i) {
      if (!std::isfinite(values[i])) values[i] = values[i - 1];
    }
    return values;
  }
  return std::nullopt;
}

/// Attitude angles are continued over full turns, so that no line between two samples leads through the wrong side.
std::optional<std::vector<double>> held_angle(const Recording& recording, const char* name,
                                              std::span<const double> at) {
  const Channel* channel = recording.find(name);
  if (channel == nullptr || channel->empty()) return std::nullopt;
  Recording unwrapped;
  Channel copy = *channel;
  for (std::size_t i = 1; i < copy.value.size(); ++i) {
    if (std::isfinite(copy.value[i]) && std::isfinite(copy.value[i - 1]))
      copy.value[i] = copy.value[i - 1] + numerics::wrap_angle(copy.value[i] - copy.value[i - 1]);
  }
  unwrapped.add(std::move(copy));
  return held(unwrapped, {name}, at);
}

/// What accelerations hold.
struct GravityDecision {
  bool in = true;
  std::string note = {};  ///< what was taken for granted
};

/// Decides what the accelerations hold. @param up upward accelerations in the recording's frame
GravityDecision holds_gravity(const Recording& recording, std::span<const double> up, GravityIn given, bool has_z) {
  if (!has_z) {
    return {.in = true,
            .note =
                "accel_z is not recorded: 1 g is taken for it; accel_x and accel_y are taken for an "
                "accelerometer's, gravity in"};
  }
  if (given == GravityIn::kNo) return {.in = false};
  const bool frd = recording.frame == Frame::kFrd;
  const VerticalAcceleration found = vertical_acceleration(up, parse_unit("m/s^2"));
  const std::string seen = fmt::format("accel_z is {:+.2f} m/s^2 in the median", found.median);
  using Holds = VerticalAcceleration::Holds;
  const auto refuse = [&](const std::string& what) {
    throw InputError(recording.source, fmt::format("{}{}", seen, what));
  };
  if (found.holds == Holds::kTwice) refuse(": gravity seems to be in it twice");
  if (!found.unit.empty() && given != GravityIn::kYes)
    refuse(fmt::format(": it seems to be in {}; give its unit in [data.map]", found.unit));
  if (found.is_reversed(frd ? -1.0 : 1.0))
    refuse(
        fmt::format("; an accelerometer that rests shows {:+.2f} in frame {}: set `frame`, or turn its sign in "
                    "[data.map]",
                    frd ? -kGravity : kGravity, frd ? "frd" : "flu"));
  if (found.holds == Holds::kGravity || given == GravityIn::kYes) return {.in = true};
  if (found.holds == Holds::kNothing)
    return {.in = false,
            .note = fmt::format("{}: accelerations are taken to be without gravity, and it is put in", seen)};
  refuse(", neither 1 g nor none; say `gravity = \"in\"` or \"out\"");
  return {};
}

}  // namespace

RecordedMotion motion_samples(const Recording& recording, const MotionOptions& options) {
  if (recording.frame == Frame::kUnspecified)
    throw InputError(recording.source, "has no frame; say `frame = \"flu\"` or \"frd\" in [data]");
  RecordedMotion motion;
  const Channel& forward = recording.at("accel_x");
  static_cast<void>(recording.at("accel_y"));
  if (forward.rate_Hz() < kSlowest)
    throw InputError(recording.source,
                     fmt::format("accel_x has {:.2g} samples a second; a platform needs {:g} at least",
                                 forward.rate_Hz(), kSlowest));
  std::vector<double> at;
  for (std::size_t i = 0; i < forward.size(); ++i) {
    if (std::isfinite(forward.value[i]) && (at.empty() || forward.times()[i] > at.back()))
      at.push_back(forward.times()[i]);
  }
  if (at.size() < 2) throw InputError(recording.source, "accel_x has fewer than two samples");
  const auto x = held(recording, {"accel_x"}, at), y = held(recording, {"accel_y"}, at),
             z = held(recording, {"accel_z"}, at);
  if (!y) throw InputError(recording.source, "accel_y has no sample in the time of accel_x");
  const std::array<std::optional<std::vector<double>>, 3> rates = {held(recording, {"gyro_x", "roll_rate"}, at),
                                                                   held(recording, {"gyro_y"}, at),
                                                                   held(recording, {"gyro_z", "yaw_rate"}, at)};
  const std::array<std::optional<std::vector<double>>, 3> angles = {
      held_angle(recording, "roll", at), held_angle(recording, "pitch", at), held_angle(recording, "yaw", at)};
  const std::array<std::optional<std::vector<double>>, 2> places = {held(recording, {"pos_x"}, at),
                                                                    held(recording, {"pos_y"}, at)};
  const bool placed = places[0] && places[1];
  const auto steer = held(recording, {"steer"}, at), speed = held(recording, {"speed"}, at);
  for (std::size_t i = 0; i < 3; ++i) {
    constexpr std::array kNames = {"gyro_x", "gyro_y", "gyro_z"};
    if (!rates[i]) continue;
    const double fastest = *std::max_element(rates[i]->begin(), rates[i]->end(),
                                             [](double a, double b) { return std::abs(a) < std::abs(b); });
    if (std::abs(fastest) > kFastestTurn)
      throw InputError(recording.source, fmt::format("{} reaches {:.3g} rad/s: it seems to be in deg/s; give its unit "
                                                     "in [data.map]",
                                                     kNames[i], fastest));
  }
  const Eigen::Vector3d at_rest = force_at_rest(recording.frame);
  std::vector<std::array<double, 3>> a(at.size());
  for (std::size_t k = 0; k < at.size(); ++k) a[k] = {(*x)[k], (*y)[k], z ? (*z)[k] : at_rest.z()};
  const auto [gravity, gravity_note] = holds_gravity(
      recording, z ? std::span<const double>(*z) : std::span<const double>(), options.gravity, z.has_value());
  if (!gravity_note.empty()) motion.notes.push_back(gravity_note);
  const bool attitude = angles[0].has_value() || angles[1].has_value();
  for (std::size_t k = 0; k < at.size(); ++k) {
    MotionSample s;
    s.time = at[k];
    s.frame = recording.frame;
    s.place = options.place;
    const auto angle = [&](std::size_t i) { return angles[i] ? (*angles[i])[k] : 0.0; };
    s.attitude = numerics::quaternion_from_euler(angle(0), angle(1), angle(2));
    s.attitude_from = attitude ? Origin::kMeasured : Origin::kAbsent;
    s.force = {a[k][0], a[k][1], a[k][2]};
    if (!gravity) s.force += s.attitude.conjugate() * at_rest;
    s.force_from = gravity && z ? Origin::kMeasured : Origin::kDerived;
    for (std::size_t i = 0; i < 3; ++i) s.rate(i) = rates[i] ? (*rates[i])[k] : 0.0;
    s.rate_from = rates[0] || rates[1] || rates[2] ? Origin::kMeasured : Origin::kAbsent;
    if (placed) s.position = {(*places[0])[k], (*places[1])[k]};
    s.position_from = placed ? Origin::kMeasured : Origin::kAbsent;
    if (steer) s.inputs.steer = (recording.frame == Frame::kFrd ? -1.0 : 1.0) * (*steer)[k];
    s.steer_from = steer ? Origin::kMeasured : Origin::kAbsent;
    if (speed) s.speed = (*speed)[k];
    s.speed_from = speed ? Origin::kMeasured : Origin::kAbsent;
    motion.samples.push_back(s);
  }
  std::string absent;
  for (std::size_t i = 0; i < 3; ++i) {
    constexpr std::array kTurns = {"roll rate", "pitch rate", "yaw rate"};
    if (!rates[i]) absent += fmt::format("{}{}", absent.empty() ? "" : ", ", kTurns[i]);
  }
  if (!absent.empty()) motion.notes.push_back(fmt::format("not recorded and taken for zero: {}", absent));
  if (!attitude)
    motion.notes.emplace_back("no attitude is recorded: the vehicle is taken for level where gravity is taken out");
  for (std::size_t k = 0; k < motion.samples.size() && motion.samples[0].rate_from != Origin::kAbsent; ++k) {
    const MotionSample &before = motion.samples[k > 0 ? k - 1 : 0],
                       &after = motion.samples[std::min(k + 1, motion.samples.size() - 1)];
    motion.samples[k].angular_acceleration = (after.rate - before.rate) / (after.time - before.time);
    motion.samples[k].angular_acceleration_from = Origin::kDerived;
  }
  return motion;
}

Recording to_recording(const std::vector<MotionSample>& samples) {
  Recording recording;
  if (samples.empty()) return recording;
  recording.frame = samples.front().frame;
  std::vector<double> stamps;
  for (const MotionSample& s : samples) stamps.push_back(s.time);
  const TimeBase time = make_time_base(std::move(stamps));
  const auto add = [&](const char* name, const char* unit, auto&& value) {
    Channel c{.name = name, .unit = parse_unit(unit), .recorded_unit = unit, .time = time, .value = {}};
    for (const MotionSample& s : samples) c.value.push_back(value(s));
    recording.add(std::move(c));
  };
  constexpr std::array kForces = {"accel_x", "accel_y", "accel_z"}, kRates = {"gyro_x", "gyro_y", "gyro_z"};
  for (std::size_t i = 0; i < 3; ++i) {
    if (samples.front().force_from != Origin::kAbsent)
      add(kForces[i], "m/s^2", [&](const MotionSample& s) { return s.force(i); });
    if (samples.front().rate_from != Origin::kAbsent)
      add(kRates[i], "rad/s", [&](const MotionSample& s) { return s.rate(i); });
  }
  if (samples.front().attitude_from != Origin::kAbsent) {
    const auto euler = [](const MotionSample& s) { return numerics::euler_from_quaternion(s.attitude); };
    add("roll", "rad", [&](const MotionSample& s) { return euler(s).phi; });
    add("pitch", "rad", [&](const MotionSample& s) { return euler(s).theta; });
    add("yaw", "rad", [&](const MotionSample& s) { return euler(s).psi; });
  }
  if (samples.front().position_from != Origin::kAbsent) {
    add("pos_x", "m", [](const MotionSample& s) { return s.position.x(); });
    add("pos_y", "m", [](const MotionSample& s) { return s.position.y(); });
  }
  return recording;
}

}  // namespace veridyn::recording
