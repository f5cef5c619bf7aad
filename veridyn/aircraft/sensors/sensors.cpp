#include "veridyn/aircraft/sensors/sensors.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {

namespace {

/// One number for all channels or one for each.
void read_each(const StudyTable& t, std::string_view key, const SensorKind& kind, std::array<double, 4>& out,
               double factor) {
  if (!t.has(key)) return;
  const std::vector<double> v = t.numbers(key, kind.unit);
  if (v.size() != 1 && v.size() != kind.channels) {
    t.fail(key, fmt::format("has {} numbers, expected 1 or {}", v.size(), kind.channels));
  }
  for (std::size_t i = 0; i < kind.channels; ++i) out[i] = factor * v[v.size() == 1 ? 0 : i];
}

KeyTable<SensorSettings> keys_of(const SensorKind& kind) {
  using S = SensorSettings;
  const std::string unit(kind.unit);
  const auto each = [&kind](auto member, double factor) {
    return [kind, member, factor](const StudyTable& t, const std::string& key, S& s) {
      read_each(t, key, kind, s.*member, factor);
    };
  };
  const std::string one_or_each = "one value, or one for each channel";
  return KeyTable<S>(std::string(kind.name))
      .flag("enabled", &S::enabled, "whether it is there; naming a sensor switches it on")
      .number("rate", &S::rate, "Hz", share_up_to(1e5), "of its samples")
      .other({"two_sigma", unit, one_or_each, "as of the set", "twice the standard deviation of its white noise", true},
             each(&S::sigma, 0.5))
      .other({"sigma", unit, one_or_each, "as of the set", "or the standard deviation itself", true},
             each(&S::sigma, 1.0))
      .other({"bias", unit, one_or_each, "0", "fixed", true}, each(&S::bias, 1.0))
      .number("bias_sigma", &S::bias_sigma, unit, kNotNegative,
              "standard deviation of a further fixed bias, drawn once a flight")
      .number("walk", &S::walk, unit, kNotNegative, "standard deviation of the wandering bias after one second")
      .number("scale", &S::scale, "1", kAnyNumber, "error of scale")
      .number("time_constant", &S::time_constant, "s", kNotNegative, "of a first-order lag, as of a hose; 0: none")
      .number("frequency", &S::frequency, "rad/s", kNotNegative,
              "natural one of second-order dynamics, as of a vane; 0: none")
      .number("damping", &S::damping, "1", kPositive, "and their damping ratio")
      .number("delay", &S::delay, "s", kNotNegative, "from event to time stamp")
      .number("jitter", &S::jitter, "s", kNotNegative,
              "standard deviation of the stamp about that, to 0.45 of a sample's time")
      .number("resolution", &S::resolution, unit, kNotNegative, "step of the last digit; 0: none")
      .number("dropout", &S::dropout, "1", {.low = 0.0, .high = 1.0, .with_high = false}, "share of lost samples")
      .number("dropout_duration", &S::dropout_duration, "s", kNotNegative, "mean length of a loss; 0: single samples")
      .check([](const StudyTable& t, S& s) {
        if (t.has("sigma") && t.has("two_sigma")) t.fail("sigma", "is given together with two_sigma");
        for (const double v : s.sigma)
          if (!(v >= 0.0)) t.fail(t.has("sigma") ? "sigma" : "two_sigma", fmt::format("= {:g} must be >= 0", v));
      });
}

/// The same noise on all channels.
constexpr SensorSettings sampled(double rate, double sigma) {
  return {.rate = rate, .sigma = {sigma, sigma, sigma, sigma}};
}

}  // namespace

std::span<const SensorKind> sensor_kinds() {
  using T = Truth;
  // clang-format off
  static constexpr std::array kKinds = std::to_array<SensorKind>({
      {"accelerometer", "m/s^2", 3, {T::kImuAccelX, T::kImuAccelY, T::kImuAccelZ}, {"accel_x", "accel_y", "accel_z"},
       sampled(100, 0.05)},
      {"gyro", "rad/s", 3, {T::kGyroX, T::kGyroY, T::kGyroZ}, {"gyro_x", "gyro_y", "gyro_z"},
       sampled(100, 0.35 * kDegree)},
      {"ahrs", "rad", 3, {T::kRoll, T::kPitch, T::kYaw}, {"roll", "pitch", "yaw"}, sampled(100, 0.75 * kDegree)},
      {"magnetometer", "T", 3, {T::kMagX, T::kMagY, T::kMagZ}, {"mag_x", "mag_y", "mag_z"}, sampled(50, 0.2e-6)},
      {"gps_velocity", "m/s", 3, {T::kVelNorth, T::kVelEast, T::kVelDown}, {"vel_north", "vel_east", "vel_down"},
       {.rate = 20, .sigma = {0.05, 0.05, 0.1}}},
      {"gps_position", "m", 3, {T::kPosNorth, T::kPosEast, T::kPosDown}, {"pos_north", "pos_east", "pos_down"},
       {.rate = 20, .sigma = {1.0, 1.0, 2.0}}},
      {"barometer", "Pa", 1, {T::kStaticPressure}, {"static_pressure"}, sampled(20, 5.0)},
      {"thermometer", "K", 1, {T::kAirTemperature}, {"air_temperature"}, sampled(20, 0.25)},
      {"pitot", "Pa", 1, {T::kDynamicPressure}, {"dynamic_pressure"}, sampled(100, 10.0)},
      {"alpha_vane", "rad", 1, {T::kAlpha}, {"alpha"}, sampled(100, 0.6 * kDegree)},
      {"beta_vane", "rad", 1, {T::kBeta}, {"beta"}, sampled(100, 0.6 * kDegree)},
      {"servos", "1", 4, {T::kElevator, T::kAileron, T::kRudder, T::kThrottle},
       {"elevator", "aileron", "rudder", "throttle"}, sampled(100, 0.0)},
      {"tachometer", "rad/s", 1, {T::kEngineSpeed}, {"engine_speed"}, sampled(100, 0.0)},
      {"thrust", "N", 1, {T::kThrust}, {"thrust"}, {.enabled = false, .rate = 100}},
  });
  // clang-format on
  return kKinds;
}

SensorKind of_commands(SensorKind kind) {
  for (Truth& source : kind.source) {
    if (source < Truth::kElevator || source > Truth::kThrottle) return kind;
    source = static_cast<Truth>(static_cast<std::size_t>(source) + static_cast<std::size_t>(Truth::kElevatorCommand) -
                                static_cast<std::size_t>(Truth::kElevator));
  }
  return kind;
}

SensorSet reference_sensors() {
  SensorSet set;
  for (const SensorKind& kind : sensor_kinds()) set.push_back(kind.reference);
  return set;
}

namespace {

void read_each_sensor(const StudyTable& table, SensorSet& set) {
  std::vector<std::string> names = {"set"};
  for (const SensorKind& kind : sensor_kinds()) names.emplace_back(kind.name);
  names.insert(names.end(), kRecordedSensorNames.begin(), kRecordedSensorNames.end());
  for (const std::string& key : table.keys())
    if (std::find(names.begin(), names.end(), key) == names.end())
      table.fail(key, fmt::format("unknown sensor{}", suggestion(key, names)));
  for (std::size_t i = 0; i < set.size(); ++i) {
    const SensorKind& kind = sensor_kinds()[i];
    const StudyTable own = table.table_or_empty(kind.name);
    set[i].enabled = set[i].enabled || !own.keys().empty();
    keys_of(kind).read(own, set[i]);
  }
}

}  // namespace

const KeyTable<SensorSet>& sensor_keys() {
  static const auto table = [] {
    std::vector<std::string_view> names;
    for (const SensorKind& kind : sensor_kinds()) names.push_back(kind.name);
    // All have the keys of the gyro, which stands for them.
    return KeyTable<SensorSet>("sensors",
                               fmt::format("What the simulated sensors are, and a table for each that differs from its "
                                           "set: {}.",
                                           fmt::join(names, ", ")))
        .other(
            {"set", "", "`\"reference\"`, `\"perfect\"`", "\"reference\"", "`perfect`: the same sensors without noise"},
            [](const StudyTable& t, const std::string& key, SensorSet& set) {
              const std::vector<std::string> sets{"reference", "perfect"};
              if (t.choice_or(key, sets, "") != "perfect") return;
              for (SensorSettings& s : set) s.sigma = {};
            })
        .within("gyro", keys_of(sensor_kinds()[1]), read_each_sensor);
  }();
  return table;
}

SensorSet read_sensors(const StudyTable& table) {
  SensorSet set = reference_sensors();
  sensor_keys().read(table, set);
  return set;
}

Sensor::Sensor(const SensorKind& kind, const SensorSettings& settings, std::uint64_t seed)
    : kind_(kind),
      settings_(settings),
      noise_(seed, std::string("sensor.") + std::string(kind.name)),
      losses_(seed, std::string("dropout.") + std::string(kind.name)),
      jitter_(seed, std::string("jitter.") + std::string(kind.name)) {
  if (settings.time_constant > 0.0 || settings.frequency > 0.0) {
    numerics::TransferFunction lag;
    if (settings.time_constant > 0.0) lag = numerics::low_pass(1.0 / settings.time_constant);
    if (settings.frequency > 0.0) lag = lag * numerics::low_pass(settings.frequency, settings.damping);
    dynamics_.assign(kind.channels, numerics::CausalFilter(lag));
  }
  for (std::size_t i = 0; i < kind.channels; ++i) settings_.bias[i] += settings_.bias_sigma * noise_.normal();
  count_ = static_cast<long long>(std::ceil(settings_.delay * settings_.rate - 1e-9));
}

Sensor::Values Sensor::seen(double t, const TruthSample& truth) {
  Values out{};
  for (std::size_t i = 0; i < kind_.channels; ++i) {
    const Truth source = kind_.source[i];
    out[i] = truth[source];
    if (dynamics_.empty()) continue;
    if (kTruthChannels[source].angle && started_)
      out[i] = unwrapped_[i] + std::remainder(out[i] - unwrapped_[i], kFullTurn);
    unwrapped_[i] = out[i];
    out[i] = started_ ? dynamics_[i].step(out[i], t - last_time_) : dynamics_[i].reset(out[i]);
  }
  return out;
}

void Sensor::observe(double t, const TruthSample& truth) {
  if (!settings_.enabled) return;
  const Values now = seen(t, truth);
  constexpr double kSlack = 1e-9;  // a stamp that coincides with a step up to rounding belongs to it
  while (true) {
    const double stamp = static_cast<double>(count_) / settings_.rate;
    const double event = stamp - settings_.delay;
    if (event > t + kSlack) break;
    const double span = t - last_time_;
    const double share = !started_ || span <= 0.0 ? 1.0 : std::min(1.0, std::max(0.0, (event - last_time_) / span));
    sample(stamp, share, now);
    ++count_;
  }
  last_ = now;
  last_time_ = t;
  started_ = true;
}

void Sensor::sample(double stamp, double share, const Values& now) {
  std::array<double, 4> y{};
  const double walk_step = settings_.walk / std::sqrt(settings_.rate);
  for (std::size_t i = 0; i < kind_.channels; ++i) {
    const Truth source = kind_.source[i];
    double value = now[i];
    const bool angle = kTruthChannels[source].angle;
    if (share < 1.0) {
      double change = now[i] - last_[i];
      if (angle) change = std::remainder(change, kFullTurn);
      value = last_[i] + share * change;
    }
    wander_[i] += walk_step * noise_.normal();
    y[i] = settings_.bias[i] + wander_[i] + (1.0 + settings_.scale) * value + settings_.sigma[i] * noise_.normal();
    if (angle) y[i] = std::remainder(y[i], kFullTurn);
    if (settings_.resolution > 0.0) y[i] = settings_.resolution * std::round(y[i] / settings_.resolution);
  }
  if (settings_.dropout > 0.0) {
    // Losses begin at random and last for an exponential time, such that the share of lost samples is `dropout`.
    if (stamp < lost_until_) return;
    const double length = std::max(settings_.dropout_duration, 1.0 / settings_.rate) * settings_.rate;
    const double begin = settings_.dropout / (settings_.dropout + length * (1.0 - settings_.dropout));
    if (losses_.uniform() < begin) {
      const double extra = std::max(0.0, settings_.dropout_duration - 1.0 / settings_.rate);
      lost_until_ = stamp + (1.0 - 1e-9) / settings_.rate - extra * std::log1p(-losses_.uniform());
      return;
    }
  }
  if (settings_.jitter > 0.0) {
    // Less than half a period, so that stamps stay in order.
    const double most = 0.45 / settings_.rate;
    stamp += std::clamp(settings_.jitter * jitter_.normal(), -most, most);
  }
  time_.push_back(stamp);
  for (std::size_t i = 0; i < kind_.channels; ++i) value_[i].push_back(y[i]);
}

void Sensor::move_into(Recording& recording) {
  if (!settings_.enabled) return;
  const TimeBase base = make_time_base(std::move(time_));
  for (std::size_t i = 0; i < kind_.channels; ++i) {
    const std::string_view unit = kTruthChannels[kind_.source[i]].unit;
    recording.add(make_channel(std::string(kind_.channel[i]), unit, base, std::move(value_[i])));
  }
}

}  // namespace veridyn::aircraft
