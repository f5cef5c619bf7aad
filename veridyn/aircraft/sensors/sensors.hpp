#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/aircraft/sensors/flight_truth.hpp"
#include "veridyn/core/recording.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/numerics/linear_systems/causal_filter.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::aircraft {

/// Error model of one sensor: y = bias + walk(t) + (1 + scale) y_seen + white noise, taken at its rate, with delay,
/// quantisation and dropouts. What it sees follows the truth by its own dynamics, of first order, second order or both.
/// Units are those of the channel in SI.
struct SensorSettings {
  bool enabled = true;
  double rate = 100.0;            ///< [Hz]
  std::array<double, 4> sigma{};  ///< standard deviation of the white noise, each channel
  std::array<double, 4> bias{};   ///< fixed, each channel
  double bias_sigma = 0.0;        ///< standard deviation of a further fixed bias, drawn once a flight
  double walk = 0.0;              ///< of the wandering bias: standard deviation after one second [unit/sqrt(s)]
  double scale = 0.0;             ///< error of scale [-]
  double time_constant = 0.0;     ///< of a first-order lag [s]; 0: none
  double frequency = 0.0;         ///< natural one of second-order dynamics [rad/s]; 0: none
  double damping = 0.7;           ///< and their damping ratio
  double delay = 0.0;             ///< from event to time stamp [s]
  double jitter = 0.0;            ///< standard deviation of the stamp about that [s], to 0.45 of a sample's time
  double resolution = 0.0;        ///< step of the last digit; 0: none
  double dropout = 0.0;           ///< share of samples that are lost [0, 1)
  double dropout_duration = 0.0;  ///< mean length of a loss [s]; 0: single samples
  friend bool operator==(const SensorSettings&, const SensorSettings&) = default;
};

/// A kind of sensor, what it measures, and how well in the reference set.
struct SensorKind {
  std::string_view name;
  std::string_view unit;  ///< of noise and biases
  std::size_t channels;
  std::array<Truth, 4> source;
  std::array<std::string_view, 4> channel;
  SensorSettings reference;
};

/// All sensors that can be simulated.
[[nodiscard]] std::span<const SensorKind> sensor_kinds();

/// The kind that records what the servos are told in place of deflections; of other sensors the same.
[[nodiscard]] SensorKind of_commands(SensorKind kind);

/// Settings of every sensor, in the order of `sensor_kinds()`.
using SensorSet = std::vector<SensorSettings>;

/// The reference set (two standard deviations): accelerometer 0.1 m/s^2, gyro 0.7 deg/s, AHRS angles 1.5 deg, pitot 20
/// Pa, vanes 1.2 deg at 100 Hz; GPS velocity 0.1 m/s (down 0.2) at 20 Hz. Ours for the rest: GPS position 2 m (down 4
/// m) at 20 Hz, barometer 10 Pa and thermometer 0.5 K at 20 Hz, magnetometer 0.4 uT at 50 Hz; servo outputs and
/// tachometer without error at 100 Hz; the thrust sensor is off.
[[nodiscard]] SensorSet reference_sensors();

/// Tables of `[sensors]` that say what is known of the sensor of a recorded channel; simulations do not read them.
inline constexpr std::array<std::string_view, 9> kRecordedSensorNames{
    "airspeed", "alpha", "beta", "elevator", "aileron", "rudder", "specific_force", "air_density", "air"};

/// Study table `[sensors]`, over the reference set, with a table for each sensor that differs.
[[nodiscard]] const KeyTable<SensorSet>& sensor_keys();
/// The reference set with what the table changes. @throws InputError with file, line and key
[[nodiscard]] SensorSet read_sensors(const StudyTable& table);

/// One sensor at work. Draws from a separate random stream, so that switching one off leaves the others unchanged.
class Sensor {
 public:
  Sensor(const SensorKind& kind, const SensorSettings& settings, std::uint64_t seed);
  /// The truth at `t`, `step` seconds after the last call; stamps between are taken on the straight line. The first
  /// call is at t = 0.
  void observe(double t, const TruthSample& now);
  /// Moves the channels measured so far into a recording.
  void move_into(Recording& recording);

 private:
  /// A value for each channel.
  using Values = std::array<double, 4>;

  [[nodiscard]] Values seen(double t, const TruthSample& truth);
  void sample(double stamp, double share, const Values& now);

  SensorKind kind_;
  SensorSettings settings_;
  numerics::RandomStream noise_;
  numerics::RandomStream losses_;
  numerics::RandomStream jitter_;
  std::vector<numerics::CausalFilter> dynamics_;  ///< of each channel, where it has any
  Values unwrapped_{};                            ///< what went into them last
  std::array<double, 4> wander_{};
  Values last_{};  ///< seen
  double last_time_ = 0.0;
  bool started_ = false;
  long long count_ = 0;
  double lost_until_ = -1.0;
  std::vector<double> time_;
  std::array<std::vector<double>, 4> value_;
};

}  // namespace veridyn::aircraft
