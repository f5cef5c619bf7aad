#include "veridyn/vehicle/identification/drive_signals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::vehicle {
namespace {

bool holds_numbers(const Channel& channel) {
  return std::any_of(channel.value.begin(), channel.value.end(), [](double v) { return std::isfinite(v); });
}

/// Interpolated where samples follow each other as usual: a drive is recorded by one clock.
std::vector<double> on_grid(const Channel& channel, const numerics::UniformGrid& grid) {
  return recording::on_grid(channel, grid, recording::Holes::kOfTheSensor);
}

class Preparation {
 public:
  Preparation(const recording::MappedRecording& mapped, const DriveSignalOptions& options, bool needs_steer)
      : recording_(mapped.recording), mapped_(mapped), options_(options), needs_steer_(needs_steer) {}

  DriveSignals run() {
    out_.source = recording_.source;
    out_.accel_position = options_.accel_position;
    make_grid();
    steering();
    speed();
    acceleration();
    sideways();
    position();
    check_signs();
    return std::move(out_);
  }

 private:
  const Channel* find(const char* name) {
    const Channel* channel = recording_.find(name);
    if (channel != nullptr && !holds_numbers(*channel)) {
      throw InputError(recording_.source, fmt::format("channel {} holds no numbers", name));
    }
    return channel;
  }

  GridSignal& put(DriveSignal which, const Channel& channel, std::string origin, double scale = 1.0) {
    GridSignal& signal = out_[which];
    signal.value = on_grid(channel, out_.grid);
    for (double& v : signal.value) v *= scale;
    signal.rate_Hz = channel.rate_Hz();
    signal.origin = std::move(origin);
    signal.sigma = noise_of(which, channel, std::abs(scale));
    return signal;
  }

  double noise_of(DriveSignal which, const Channel& channel, double scale) const {
    const std::string_view name = kDriveSignalNames[static_cast<std::size_t>(which)];
    if (const std::optional<double> given = recording::given_noise(options_.noise, name)) return *given;
    return scale * recording::noise_floor(channel);
  }

  void make_grid() {
    const Channel* yaw_rate = find("yaw_rate");
    const char* name = "yaw_rate";
    if (yaw_rate == nullptr) {
      yaw_rate = find("gyro_z");
      name = "gyro_z";
    }
    if (yaw_rate == nullptr) {
      const std::vector<std::string> needed{"yaw_rate"};
      recording::require_channels(mapped_, needed, "the lateral motion");
    }
    const double own = yaw_rate->rate_Hz();
    if (!(own >= 5.0)) {
      throw InputError(
          recording_.source,
          fmt::format("its {} is sampled at {:.1f} Hz; the lateral motion of a vehicle needs at least 5 Hz", name,
                      own));
    }
    out_.grid = recording::grid_over(*yaw_rate, recording::grid_rate(*yaw_rate, options_.rate_Hz), recording_.source);
    if (out_.grid.count < 2) throw InputError(recording_.source, fmt::format("its {} has no duration", name));
    put(DriveSignal::kYawRate, *yaw_rate, name);
  }

  void steering() {
    if (const Channel* steer = find("steer")) {
      put(DriveSignal::kSteer, *steer, "steer");
      return;
    }
    if (const Channel* wheel = find("steering_wheel")) {
      if (!(options_.steering_ratio > 0.0)) {
        throw InputError("signals.steering_ratio",
                         "is missing: the recording has the angle of the hand wheel, which is that of the road wheels "
                         "times this ratio (13 to 20 on most cars)");
      }
      put(DriveSignal::kSteer, *wheel, fmt::format("steering_wheel / {:g}", options_.steering_ratio),
          1.0 / options_.steering_ratio);
      return;
    }
    if (!needs_steer_) return;
    const std::vector<std::string> needed{"steer"};
    recording::require_channels(mapped_, needed, "the slip angles of the front wheels");
  }

  void speed() {
    if (const Channel* speed = find("speed")) {
      put(DriveSignal::kSpeed, *speed, "speed");
      return;
    }
    for (const bool rear : {true, false}) {
      const Channel* left = find(rear ? "wheel_speed_rl" : "wheel_speed_fl");
      const Channel* right = find(rear ? "wheel_speed_rr" : "wheel_speed_fr");
      if (left == nullptr || right == nullptr) continue;
      if (!(options_.rolling_radius > 0.0)) {
        throw InputError("signals.rolling_radius",
                         "is missing: the recording has wheel speeds, which need it to give the vehicle's speed");
      }
      GridSignal& signal = put(DriveSignal::kSpeed, *left,
                               fmt::format("{} wheels x {:g} m", rear ? "rear" : "front", options_.rolling_radius),
                               options_.rolling_radius);
      const std::vector<double> other = on_grid(*right, out_.grid);
      for (std::size_t k = 0; k < other.size(); ++k)
        signal.value[k] = 0.5 * (signal.value[k] + options_.rolling_radius * other[k]);
      signal.sigma /= std::sqrt(2.0);
      return;
    }
    const std::vector<std::string> needed{"speed"};
    recording::require_channels(mapped_, needed, "the slip angles (wheel_speed_rl and wheel_speed_rr would do)");
  }

  void acceleration() {
    if (const Channel* accel = find("accel_x")) put(DriveSignal::kAccelX, *accel, "accel_x");
    const Channel* accel = find("accel_y");
    if (accel == nullptr) {
      out_.notes.emplace_back(
          "without accel_y, the stiffnesses are distinguishable by the yaw rate only in transients");
      return;
    }
    GridSignal& signal = put(DriveSignal::kAccelY, *accel, "accel_y");
    if (const Channel* roll = find("roll")) {
      const std::vector<double> angle = on_grid(*roll, out_.grid);
      for (std::size_t k = 0; k < signal.value.size(); ++k) signal.value[k] -= options_.gravity * std::sin(angle[k]);
      signal.origin = "accel_y - g sin(roll)";
      out_.gravity_removed = true;
    } else if (options_.roll_gradient > 0.0) {
      const double gain = 1.0 / (1.0 + options_.gravity * options_.roll_gradient);
      for (double& v : signal.value) v *= gain;
      signal.sigma *= gain;
      signal.origin = fmt::format("accel_y x {:.4f} (roll gradient)", gain);
      out_.gravity_removed = true;
    }
  }

  void sideways() {
    const std::vector<double>& u = out_[DriveSignal::kSpeed].value;
    if (const Channel* v = find("lateral_velocity")) {
      put(DriveSignal::kLateralVelocity, *v, "lateral_velocity");
    } else if (const Channel* beta = find("sideslip")) {
      GridSignal& signal = put(DriveSignal::kLateralVelocity, *beta, "speed tan(sideslip)");
      for (std::size_t k = 0; k < signal.value.size(); ++k) signal.value[k] = u[k] * std::tan(signal.value[k]);
      signal.sigma *= numerics::median(u);
    } else {
      return;
    }
    GridSignal& signal = out_[DriveSignal::kLateralVelocity];
    if (options_.velocity_position == 0.0) return;
    const std::vector<double>& r = out_[DriveSignal::kYawRate].value;
    for (std::size_t k = 0; k < signal.value.size(); ++k) signal.value[k] -= options_.velocity_position * r[k];
    signal.origin += fmt::format(", moved by {:g} m", -options_.velocity_position);
  }

  void position() {
    const Channel* x = find("pos_x");
    const Channel* y = find("pos_y");
    if (x != nullptr && y != nullptr) {
      put(DriveSignal::kX, *x, "pos_x");
      put(DriveSignal::kY, *y, "pos_y");
    }
    if (const Channel* yaw = find("yaw")) {
      Channel unwrapped = *yaw;
      numerics::unwrap_angles(unwrapped.value);
      put(DriveSignal::kYaw, unwrapped, "yaw");
    }
  }

  /// Slope of y on x through the origin and their correlation, over samples where |x| stands out.
  struct Relation {
    double slope = 0.0;
    double correlation = 0.0;
    std::size_t count = 0;
  };
  static Relation relate(const std::vector<double>& x, const std::vector<double>& y, double least) {
    double xx = 0.0, xy = 0.0, yy = 0.0;
    Relation relation;
    for (std::size_t k = 0; k < x.size(); ++k) {
      if (!(std::abs(x[k]) >= least) || !std::isfinite(y[k])) continue;
      xx += x[k] * x[k];
      xy += x[k] * y[k];
      yy += y[k] * y[k];
      ++relation.count;
    }
    if (relation.count > 0 && xx > 0.0 && yy > 0.0) {
      relation.slope = xy / xx;
      relation.correlation = xy / std::sqrt(xx * yy);
    }
    return relation;
  }

  /// Means over two seconds about each sample; NaN where one is missing.
  [[nodiscard]] std::vector<double> slow(const std::vector<double>& values) const {
    const auto half = static_cast<std::size_t>(1.0 / out_.grid.step);
    std::vector<double> out(values.size(), kNaN);
    double sum = 0.0;
    std::size_t filled = 0;  // finite samples up to the window's end
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (!std::isfinite(values[k])) {
        sum = 0.0;
        filled = 0;
        continue;
      }
      sum += values[k];
      ++filled;
      const std::size_t window = 2 * half + 1;
      if (filled > window) sum -= values[k - window];
      if (filled >= window) out[k - half] = sum / static_cast<double>(window);
    }
    return out;
  }

  void check_signs() {
    const std::vector<double>& u = out_[DriveSignal::kSpeed].value;
    const std::vector<double>& r = out_[DriveSignal::kYawRate].value;
    std::vector<double> centripetal(r.size());
    for (std::size_t k = 0; k < r.size(); ++k) centripetal[k] = u[k] * r[k];
    constexpr double kLeast_mps2 = 0.5;
    constexpr std::size_t kEnough = 50;
    const GridSignal& accel = out_[DriveSignal::kAccelY];
    if (accel.available()) {
      // In quick transients a_y is not u r: the lateral velocity changes too.
      const Relation relation = relate(slow(centripetal), slow(accel.value), kLeast_mps2);
      if (relation.count >= kEnough && relation.correlation < -0.5) {
        throw InputError(
            recording_.source,
            "accel_y goes against yaw_rate x speed: one of them points the other way (check data.frame, or "
            "give the channel scale = -1 in [data.map])");
      }
      if (relation.count >= kEnough && relation.correlation > 0.5 && !(relation.slope > 0.6 && relation.slope < 1.67)) {
        out_.notes.push_back(
            fmt::format("accel_y is {:.2f} times yaw_rate x speed: a unit, a scale or the place of a sensor is wrong",
                        relation.slope));
      }
    }
    const GridSignal& steer = out_[DriveSignal::kSteer];
    if (steer.available()) {
      const Relation relation = relate(centripetal, steer.value, kLeast_mps2);
      if (relation.count >= kEnough && relation.correlation < -0.7) {
        throw InputError(recording_.source,
                         "steer goes against the yaw rate: one of them points the other way (left must be positive; "
                         "check data.frame, or give the channel scale = -1 in [data.map])");
      }
    }
  }

  const Recording& recording_;
  const recording::MappedRecording& mapped_;
  const DriveSignalOptions& options_;
  bool needs_steer_;
  DriveSignals out_;
};

}  // namespace

DriveSignalOptions DriveSignalOptions::read(const StudyTable& table) {
  DriveSignalOptions o;
  o.rate_Hz = table.has("rate") ? table.positive("rate", "Hz") : 0.0;
  o.pass_Hz = table.has("pass_band") ? table.positive("pass_band", "Hz") : 0.0;
  o.steering_ratio = table.has("steering_ratio") ? table.positive("steering_ratio", "1") : 0.0;
  o.rolling_radius = table.has("rolling_radius") ? table.positive("rolling_radius", "m") : 0.0;
  if (table.has("accel_position")) {
    const std::vector<double> p = table.numbers("accel_position", "m");
    if (p.size() != 3) table.fail("accel_position", fmt::format("has {} numbers; must have 3: x, y, z", p.size()));
    std::copy(p.begin(), p.end(), o.accel_position.begin());
  }
  o.velocity_position = table.number_or("velocity_position", "m", 0.0);
  o.roll_gradient = table.number_or("roll_gradient", "rad/(m/s^2)", 0.0);
  if (!(o.roll_gradient >= 0.0 && o.roll_gradient < 0.1)) {
    table.fail("roll_gradient",
               fmt::format("= {:g} must be from 0 to 0.1 rad/(m/s^2) (5 deg per g is 0.0089)", o.roll_gradient));
  }
  o.gravity = table.positive_or("gravity", "m/s^2", o.gravity);
  std::vector<recording::StandardChannel> channels;
  for (std::size_t i = 0; i < kDriveSignals; ++i)
    channels.push_back({std::string(kDriveSignalNames[i]), std::string(kDriveSignalUnits[i])});
  o.noise = recording::read_noise(table.table_or_empty("noise"), channels);
  return o;
}

DriveSignals prepare_drive_signals(const recording::MappedRecording& mapped, const DriveSignalOptions& options,
                                   bool needs_steer) {
  return Preparation(mapped, options, needs_steer).run();
}

}  // namespace veridyn::vehicle
