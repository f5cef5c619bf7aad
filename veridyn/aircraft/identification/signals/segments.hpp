#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/recording/segments.hpp"

namespace veridyn::aircraft {

/// Which part of the motion a stretch of flight excites.
enum class Axis { kLongitudinal, kLateral };
[[nodiscard]] const char* to_string(Axis axis);

/// How stretches of flight with excitation are found. Study table `[segments]`.
struct SegmentOptions : recording::SegmentOptions {
  double min_airspeed_mps = 0.0;  ///< 0: set by the caller from the subject
  /// Nothing: 0.01 rad, or where a flight is gentler half of what its most active twentieth exceeds, down to 0.05 deg.
  std::optional<double> min_input_rad = {};
  double ambient_factor = 2.0;
  std::optional<double> min_rate_radps = {};  ///< nothing: 2 deg/s, or less likewise, down to 0.1 deg/s
  std::vector<TimeSpan> longitudinal;         ///< as given
  std::vector<TimeSpan> lateral;

  [[nodiscard]] static const KeyTable<SegmentOptions>& keys();
};

/// What the search looks at: one uniform grid, NaN where a signal is missing.
struct SegmentSignals {
  double begin = 0.0;
  double step = 0.01;
  std::span<const double> airspeed;
  std::span<const double> p, q, r;
  std::span<const double> elevator, aileron, rudder;  ///< may be empty when there is none
  std::span<const double> vel_down = {};              ///< [m/s]; may be empty
};

/// Excited stretches of one axis and how they are used.
struct AxisSegments : recording::Segments {
  Axis axis = Axis::kLongitudinal;
  double input_threshold_rad = 0.0;  ///< what was applied after the ambient activity was known
  double rate_threshold_radps = 0.0;
  double ambient_input_rad = 0.0;
  [[nodiscard]] double excited_s() const { return recording::total_s(excited); }
};

/// Where the aircraft flies, and the excited stretches of both axes.
struct Segments {
  std::vector<TimeSpan> airborne;
  AxisSegments longitudinal;
  AxisSegments lateral;
  [[nodiscard]] const AxisSegments& of(Axis axis) const { return axis == Axis::kLongitudinal ? longitudinal : lateral; }
};

/// Finds where the aircraft flies (of a flight that the recording has from take-off, or to landing, what is more than 5
/// m above the place where it began or ended, as the integral of `vel_down` has it), where a surface is moved more than
/// in the flight's calm parts (activity: RMS about the mean in a sliding window) and the body answers, longitudinal
/// (elevator, q) and lateral (aileron or rudder, p or r) separately, and assigns the blocks of each axis to
/// identification and hold-out so that both hold every kind of manoeuvre.
[[nodiscard]] Segments find_segments(const SegmentSignals& signals, const SegmentOptions& options);

}  // namespace veridyn::aircraft
