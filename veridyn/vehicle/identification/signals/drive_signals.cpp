#include "veridyn/vehicle/identification/signals/drive_signals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/vehicle/identification/signals/course_lateral_velocity.hpp"

namespace veridyn::vehicle {
namespace {

bool holds_numbers(const Channel& channel) {
  return std::any_of(channel.value.begin(), channel.value.end(), [](double v) { return std::isfinite(v); });
}

/// Interpolated where samples follow each other as usual: a drive is recorded by one clock.
std::vector<double> on_grid(const Channel& channel, const numerics::UniformGrid& grid) {
  return recording::on_grid(channel, grid, recording::Holes::kOfTheSensor);
}

/// The channel of a standard name; null: not recorded.
const Channel* find_channel(const recording::MappedRecording& mapped, const char* name) {
  const Channel* channel = mapped.recording.find(name);
  if (channel != nullptr && !holds_numbers(*channel))
    throw InputError(mapped.recording.source, fmt::format("channel {} holds no numeric values", name));
  return channel;
}

/// Refuses a recording without a channel that nothing else can replace.
void require_channel(const recording::MappedRecording& mapped, const char* name, const char* purpose) {
  const std::vector<std::string> needed{name};
  recording::require_channels(mapped, needed, purpose);
}

double noise_of(DriveSignal which, const Channel& channel, double scale, const DriveSignalOptions& options) {
  const std::string_view name = kDriveSignalNames[which];
  if (const std::optional<double> given = recording::given_noise(options.noise, name)) return *given;
  return scale * recording::noise_floor(channel);
}

/// `scale` times a channel as the signal `which`.
GridSignal signal_of(DriveSignal which, const Channel& channel, const numerics::UniformGrid& grid,
                     const DriveSignalOptions& options, std::string origin, double scale = 1.0) {
  GridSignal signal;
  signal.value = on_grid(channel, grid);
  for (double& v : signal.value) v *= scale;
  signal.rate_Hz = channel.rate_Hz();
  signal.origin = std::move(origin);
  signal.sigma = noise_of(which, channel, std::abs(scale), options);
  return signal;
}

/// The channel that carries the yaw rate, by whose samples the grid is laid.
const Channel& yaw_rate_channel(const recording::MappedRecording& mapped) {
  const Channel* channel = find_channel(mapped, "yaw_rate");
  if (channel == nullptr) channel = find_channel(mapped, "gyro_z");
  if (channel == nullptr) require_channel(mapped, "yaw_rate", "the lateral motion");
  if (!(channel->rate_Hz() >= 5.0)) {
    throw InputError(mapped.recording.source, fmt::format("its {} is sampled at {:.1f} Hz; the lateral motion of a "
                                                          "vehicle needs at least 5 Hz; is its time in seconds?",
                                                          channel->name, channel->rate_Hz()));
  }
  return *channel;
}

numerics::UniformGrid grid_of(const Channel& yaw_rate, const DriveSignalOptions& options, const std::string& source) {
  const numerics::UniformGrid grid =
      recording::grid_over(yaw_rate, recording::grid_rate(yaw_rate, options.rate_Hz), source);
  if (grid.count < 2) throw InputError(source, fmt::format("its {} has no duration", yaw_rate.name));
  return grid;
}

/// Empty where it is neither recorded nor needed.
GridSignal steering(const recording::MappedRecording& mapped, const numerics::UniformGrid& grid,
                    const DriveSignalOptions& options, bool needed) {
  if (const Channel* steer = find_channel(mapped, "steer"))
    return signal_of(DriveSignal::kSteer, *steer, grid, options, "steer");
  if (const Channel* wheel = find_channel(mapped, "steering_wheel")) {
    if (!(options.steering_ratio > 0.0)) {
      throw InputError("signals.steering_ratio",
                       "is missing: the recording has the angle of the hand wheel, which is that of the road wheels "
                       "times this ratio (13 to 20 on most cars)");
    }
    return signal_of(DriveSignal::kSteer, *wheel, grid, options,
                     fmt::format("steering_wheel / {:g}", options.steering_ratio), 1.0 / options.steering_ratio);
  }
  if (needed) require_channel(mapped, "steer", "the slip angles of the front wheels");
  return {};
}

GridSignal forward_speed(const recording::MappedRecording& mapped, const numerics::UniformGrid& grid,
                         const DriveSignalOptions& options) {
  if (const Channel* speed = find_channel(mapped, "speed"))
    return signal_of(DriveSignal::kSpeed, *speed, grid, options, "speed");
  for (const bool rear : {true, false}) {
    const Channel* left = find_channel(mapped, rear ? "wheel_velocity_rl" : "wheel_velocity_fl");
    const Channel* right = find_channel(mapped, rear ? "wheel_velocity_rr" : "wheel_velocity_fr");
    if (left == nullptr || right == nullptr) continue;
    GridSignal signal = signal_of(DriveSignal::kSpeed, *left, grid, options,
                                  rear ? "mean of the rear wheels" : "mean of the front wheels");
    const std::vector<double> other = on_grid(*right, grid);
    for (std::size_t k = 0; k < other.size(); ++k) signal.value[k] = 0.5 * (signal.value[k] + other[k]);
    signal.sigma /= std::sqrt(2.0);
    return signal;
  }
  for (const bool rear : {true, false}) {
    const Channel* left = find_channel(mapped, rear ? "wheel_speed_rl" : "wheel_speed_fl");
    const Channel* right = find_channel(mapped, rear ? "wheel_speed_rr" : "wheel_speed_fr");
    if (left == nullptr || right == nullptr) continue;
    if (!(options.rolling_radius > 0.0)) {
      throw InputError("signals.rolling_radius",
                       "is missing: the recording has wheel speeds, which need it to give the vehicle's speed");
    }
    GridSignal signal = signal_of(DriveSignal::kSpeed, *left, grid, options,
                                  fmt::format("{} wheels x {:g} m", rear ? "rear" : "front", options.rolling_radius),
                                  options.rolling_radius);
    const std::vector<double> other = on_grid(*right, grid);
    for (std::size_t k = 0; k < other.size(); ++k)
      signal.value[k] = 0.5 * (signal.value[k] + options.rolling_radius * other[k]);
    signal.sigma /= std::sqrt(2.0);
    return signal;
  }
  require_channel(mapped, "speed", "the slip angles (wheel_speed_rl and wheel_speed_rr would do)");
  return {};
}

/// A lateral acceleration, as far as gravity's share could be removed.
struct LateralAcceleration {
  GridSignal signal;
  bool gravity_removed = false;
};

LateralAcceleration lateral_acceleration(const Channel& accel, const recording::MappedRecording& mapped,
                                         const numerics::UniformGrid& grid, const DriveSignalOptions& options) {
  GridSignal signal = signal_of(DriveSignal::kAccelY, accel, grid, options, "accel_y");
  if (const Channel* roll = find_channel(mapped, "roll")) {
    const std::vector<double> angle = on_grid(*roll, grid);
    for (std::size_t k = 0; k < signal.value.size(); ++k) signal.value[k] -= options.gravity * std::sin(angle[k]);
    signal.origin = "accel_y - g sin(roll)";
    return {std::move(signal), true};
  }
  if (!(options.roll_gradient > 0.0)) return {std::move(signal), false};
  const double gain = 1.0 / (1.0 + options.gravity * options.roll_gradient);
  for (double& v : signal.value) v *= gain;
  signal.sigma *= gain;
  signal.origin = fmt::format("accel_y x {:.4f} (roll gradient)", gain);
  return {std::move(signal), true};
}

/// v of the centre of gravity from speed u and yaw rate r on the grid; empty where nothing of it is recorded.
GridSignal lateral_velocity(const recording::MappedRecording& mapped, const numerics::UniformGrid& grid,
                            const DriveSignalOptions& options, const std::vector<double>& u,
                            const std::vector<double>& r) {
  GridSignal signal;
  if (const Channel* v = find_channel(mapped, "lateral_velocity")) {
    signal = signal_of(DriveSignal::kLateralVelocity, *v, grid, options, "lateral_velocity");
  } else if (const Channel* beta = find_channel(mapped, "sideslip")) {
    signal = signal_of(DriveSignal::kLateralVelocity, *beta, grid, options, "speed tan(sideslip)");
    for (std::size_t k = 0; k < signal.value.size(); ++k) signal.value[k] = u[k] * std::tan(signal.value[k]);
    signal.sigma *= numerics::median(u);
  } else {
    return signal;
  }
  if (options.velocity_position == 0.0) return signal;
  for (std::size_t k = 0; k < signal.value.size(); ++k) signal.value[k] -= options.velocity_position * r[k];
  signal.origin += fmt::format(", moved by {:g} m", -options.velocity_position);
  return signal;
}

GridSignal heading(const Channel& yaw, const numerics::UniformGrid& grid, const DriveSignalOptions& options) {
  Channel unwrapped = yaw;
  numerics::unwrap_angles(unwrapped.value);
  return signal_of(DriveSignal::kYaw, unwrapped, grid, options, "yaw");
}

}  // namespace

const KeyTable<DriveSignalOptions>& DriveSignalOptions::keys() {
  using O = DriveSignalOptions;
  static const auto table =
      KeyTable<O>("signals", "How recorded channels become signals on one grid.")
          .number("rate", &O::rate_Hz, "Hz", kPositive, "of the common grid")
          .otherwise("that of the yaw rate, at most 100")
          .number("pass_band", &O::pass_Hz, "Hz", kPositive,
                  "of the equation-error regressions, which differentiate; output error takes the unfiltered signals")
          .otherwise("2, or a tenth of the rate where that is less")
          .number("steering_ratio", &O::steering_ratio, "1", kPositive,
                  "ratio of hand-wheel to road-wheel angle; needed where the log has `steering_wheel`")
          .otherwise("none")
          .number("rolling_radius", &O::rolling_radius, "m", kPositive,
                  "gives the speed by the rear wheels where the log has no `speed`")
          .otherwise("none")
          .numbers("accel_position", &O::accel_position, "m", kAnyNumber,
                   "of the accelerometer from the centre of gravity: forward, left, up")
          .number("velocity_position", &O::velocity_position, "m", kAnyNumber,
                  "how far ahead of the centre of gravity `lateral_velocity`, `sideslip` and `course` are measured")
          .number("roll_gradient", &O::roll_gradient, "rad/(m/s^2)", {.low = 0.0, .high = 0.1, .with_high = false},
                  "how far the body leans outward per lateral acceleration, 0.0089 for 5 deg per g: a sensor fixed to "
                  "the body then shows (1 + g roll_gradient) times the lateral acceleration, and that is taken off. "
                  "Ignored where `roll` is recorded, of which g sin(roll) is taken off")
          .number("gravity", &O::gravity, "m/s^2", kPositive, "acceleration of free fall, where the vehicle drives")
          .other(recording::noise_key("measured above 0.2 of the channel's rate"),
                 [](const StudyTable& t, const std::string& key, O& o) {
                   std::vector<recording::StandardChannel> channels;
                   for (std::size_t i = 0; i < kDriveSignals; ++i)
                     channels.push_back({std::string(kDriveSignalNames[i]), std::string(kDriveSignalUnits[i])});
                   o.noise = recording::read_noise(t.table(key), channels);
                 });
  return table;
}

DriveSignals prepare_drive_signals(const recording::MappedRecording& mapped, const DriveSignalOptions& options,
                                   bool needs_steer) {
  DriveSignals out;
  out.source = mapped.recording.source;
  out.accel_position = options.accel_position;
  const Channel& yaw_rate = yaw_rate_channel(mapped);
  out.grid = grid_of(yaw_rate, options, out.source);
  const auto as = [&](DriveSignal which, const Channel& channel) {
    return signal_of(which, channel, out.grid, options, channel.name);
  };
  out[DriveSignal::kYawRate] = as(DriveSignal::kYawRate, yaw_rate);
  out[DriveSignal::kSteer] = steering(mapped, out.grid, options, needs_steer);
  out[DriveSignal::kSpeed] = forward_speed(mapped, out.grid, options);
  if (const Channel* accel = find_channel(mapped, "accel_x"))
    out[DriveSignal::kAccelX] = as(DriveSignal::kAccelX, *accel);
  if (const Channel* accel = find_channel(mapped, "accel_y")) {
    LateralAcceleration lateral = lateral_acceleration(*accel, mapped, out.grid, options);
    out[DriveSignal::kAccelY] = std::move(lateral.signal);
    out.gravity_removed = lateral.gravity_removed;
    if (find_channel(mapped, "roll") == nullptr) out.roll_gradient = options.roll_gradient;
  } else {
    out.notes.emplace_back("without accel_y, the stiffnesses are distinguishable by the yaw rate only in transients");
  }
  out[DriveSignal::kLateralVelocity] =
      lateral_velocity(mapped, out.grid, options, out[DriveSignal::kSpeed].value, out[DriveSignal::kYawRate].value);
  const Channel *course = find_channel(mapped, "course"), *direction = find_channel(mapped, "yaw");
  if (course != nullptr && direction != nullptr && !out[DriveSignal::kLateralVelocity].available()) {
    CourseLateralVelocity made = course_lateral_velocity({.course = *course,
                                                          .yaw = *direction,
                                                          .speed = out[DriveSignal::kSpeed].value,
                                                          .yaw_rate = out[DriveSignal::kYawRate].value,
                                                          .speed_sigma = out[DriveSignal::kSpeed].sigma,
                                                          .yaw_rate_sigma = out[DriveSignal::kYawRate].sigma,
                                                          .grid = out.grid,
                                                          .position = options.velocity_position});
    out.lateral_by_course = made.signal.available();
    if (const auto given = recording::given_noise(options.noise, "lateral_velocity")) made.signal.sigma = *given;
    out[DriveSignal::kLateralVelocity] = std::move(made.signal);
    out.notes.push_back(std::move(made.note));
  }
  const Channel* x = find_channel(mapped, "pos_x");
  const Channel* y = find_channel(mapped, "pos_y");
  if (x != nullptr && y != nullptr) {
    out[DriveSignal::kX] = as(DriveSignal::kX, *x);
    out[DriveSignal::kY] = as(DriveSignal::kY, *y);
  }
  if (const Channel* roll = find_channel(mapped, "roll")) out[DriveSignal::kRoll] = as(DriveSignal::kRoll, *roll);
  for (const char* name : {"roll_rate", "gyro_x"}) {
    const Channel* rate = find_channel(mapped, name);
    if (rate != nullptr && !out[DriveSignal::kRollRate].available())
      out[DriveSignal::kRollRate] = as(DriveSignal::kRollRate, *rate);
  }
  if (const Channel* yaw = find_channel(mapped, "yaw")) out[DriveSignal::kYaw] = heading(*yaw, out.grid, options);
  return out;
}

}  // namespace veridyn::vehicle
