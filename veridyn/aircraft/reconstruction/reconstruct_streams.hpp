#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "veridyn/aircraft/model/flight_dynamics.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_options.hpp"
#include "veridyn/aircraft/sensors/delays.hpp"
#include "veridyn/core/enum_array.hpp"
#include "veridyn/core/recording.hpp"

/// Inside of reconstruct.cpp: a recording's channels made ready for event-driven filtering.
namespace veridyn::aircraft::internal {

/// Scalar sensors in the order in which those of one time stamp are processed: the attitude first, because the rest
/// depends on it most.
/// The accelerometer's axes are measurements for the model-based filter only; for the other their streams are empty.
enum Sensor { kRoll, kPitch, kYaw, kVelNorth, kVelEast, kVelDown, kPitot, kAlpha, kBeta, kAccelX, kAccelY, kAccelZ };
inline constexpr std::size_t kSensors = 12;

/// Finite samples of a scalar sensor; delays taken off the stamps.
struct Stream {
  std::string channel;
  std::string unit;
  std::vector<double> t;
  std::vector<double> v;
  double sigma = 0.0;
  double rate_Hz = 0.0;
};

/// Finite samples of a vector sensor at increasing stamps.
struct VectorStream {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> v;
  double interval = 0.01;  ///< median [s]

  /// Linear between samples, constant beyond. `cursor` is moved to the last sample at or before `time`, which must not
  /// run backwards by more than a few samples.
  [[nodiscard]] Eigen::Vector3d at(double time, std::size_t& cursor) const;
};

/// What moves the aircraft, for the model-based filter: linear between samples. Channels that the model does not need
/// are empty and read as 0.
struct ControlStreams {
  Stream elevator, aileron, rudder, throttle, rotor_speed;

  /// Positions of the reading cursors, moved by `at`.
  struct Cursor {
    std::array<std::size_t, 5> position{};
  };
  [[nodiscard]] Controls<double> at(double time, Cursor& cursor) const;
};

/// All streams of a flight.
struct FlightStreams {
  ControlStreams controls;
  EnumArray<Sensor, Stream, kSensors> sensors;
  VectorStream gyro, accel;
  std::vector<double> density_t, density;  ///< linear between, constant beyond; one entry when constant
  std::string density_origin;
  bool pitot_is_pressure = true;
  SensorSigma sigma;
  std::vector<std::string> warnings;  ///< what had to be assumed

  [[nodiscard]] bool has(Sensor sensor) const { return !sensors[sensor].t.empty(); }
  /// Roll and pitch.
  [[nodiscard]] bool has_tilt() const { return has(kRoll) && has(kPitch); }
  /// North and east. Without it velocity is relative to the slow wind, which then cannot be told from it.
  [[nodiscard]] bool has_ground_velocity() const { return has(kVelNorth) && has(kVelEast); }

  [[nodiscard]] double density_at(double time, std::size_t& cursor) const;
  [[nodiscard]] double density_at(double time) const;
};

/// Channels that the recording lacks have empty streams.
/// @throws InputError where the gyro is missing
[[nodiscard]] FlightStreams load_streams(const Recording& recording, const ReconstructOptions& options);

/// The alignment with what the motion past the vanes of this recording is computed with: the median air density, where
/// the vanes are and what kind of airspeed it holds.
[[nodiscard]] DelayAlignment alignment_of(const Recording& recording, DelayAlignment alignment,
                                          const ReconstructOptions& options);

/// Streams with a force model to filter with.
struct ModelStreams {
  FlightStreams streams;
  Subject force_model;
};

/// Adds what the model-based filter needs beyond `load_streams`: the accelerometer's axes as measurements at the centre
/// of gravity, deflections, thrust. The force model is the subject without moments, and with a propulsion that turns
/// recorded thrust into thrust where there is a channel `thrust`.
/// @param needing the key that asks for it, in messages
/// @throws InputError naming a channel or a parameter that the model of CL, CD and CY needs and that is missing.
[[nodiscard]] ModelStreams load_model_streams(const Recording& recording, Subject subject, FlightStreams streams,
                                              const std::string& needing = "reconstruct.filter = \"model-based\"");

/// A stretch over which gyro and accelerometer have no gap longer than `max_gap`, from where attitude and ground
/// velocity are known.
struct Segment {
  double begin = 0.0;
  double end = 0.0;
};
/// The segments of at least a second and ten samples of the gyro; `max_gap` in s.
[[nodiscard]] std::vector<Segment> find_segments(const FlightStreams& streams, double max_gap);

}  // namespace veridyn::aircraft::internal
