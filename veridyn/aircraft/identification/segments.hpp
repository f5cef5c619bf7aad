#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::aircraft {

/// Which part of the motion a stretch of flight excites.
enum class Axis { kLongitudinal, kLateral };
[[nodiscard]] const char* to_string(Axis axis);

/// How stretches of flight with excitation are found. Study table `[segments]`; every key is optional.
struct SegmentOptions {
  double min_airspeed_mps =
      0.0;                ///< `min_airspeed`: below it the aircraft is not flying; set by the caller from the subject
  double window_s = 4.0;  ///< `window`: activity is an RMS about the mean over this long
  double min_input_rad = 0.01;  ///< `min_input`: surface activity that counts as excitation, at least (0.6 deg)
  double ambient_factor = 2.0;  ///< `ambient_factor`: ... and at least this many times the calmest fifth of the flight
  double min_rate_radps = 0.035;  ///< `min_rate`: body rate activity that must answer (2 deg/s)
  double merge_s = 3.0;           ///< `merge`: excited stretches closer than this are one segment
  double min_duration_s = 3.0;    ///< `min_duration`
  double holdout = 1.0 / 3.0;     ///< `holdout`: share of each axis kept from identification, in [0, 0.8]
  double block_s = 10.0;  ///< `block`: segments are dealt to identification and hold-out in blocks of this length
  double guard_s = 0.5;   ///< `guard`: cut from both sides where blocks of different use meet
  std::vector<TimeSpan> longitudinal;  ///< `longitudinal = [10, 60, 80, 95]`: begin and end of each, given by the user
  std::vector<TimeSpan> lateral;       ///< `lateral`

  /// @throws InputError for values that make no sense.
  [[nodiscard]] static SegmentOptions read(const StudyTable& table);
};

/// What the search looks at: one uniform grid, NaN where a signal is missing.
struct SegmentSignals {
  double begin = 0.0;
  double step = 0.01;
  std::span<const double> airspeed;
  std::span<const double> p, q, r;
  std::span<const double> elevator, aileron, rudder;  ///< may be empty when there is none
};

/// Excited stretches of one axis and how they were dealt.
struct AxisSegments {
  Axis axis = Axis::kLongitudinal;
  std::vector<TimeSpan> excited;
  std::vector<TimeSpan> identification;  ///< blocks used to identify
  std::vector<TimeSpan> holdout;         ///< blocks that identification never sees
  double input_threshold_rad = 0.0;      ///< what was applied after the ambient activity was known
  double ambient_input_rad = 0.0;
  bool given = false;  ///< by the user
  std::string text;    ///< one sentence for the report
  [[nodiscard]] double excited_s() const;
};

struct Segments {
  std::vector<TimeSpan> airborne;
  AxisSegments longitudinal;
  AxisSegments lateral;
  [[nodiscard]] const AxisSegments& of(Axis axis) const { return axis == Axis::kLongitudinal ? longitudinal : lateral; }
};

/// Finds where the aircraft flies, where a surface is moved more than the flight's own calm (activity: RMS about the
/// mean in a sliding window) and the body answers, longitudinal (elevator, q) and lateral (aileron or rudder, p or r)
/// apart, and deals the blocks of each axis to identification and hold-out so that both hold every kind of manoeuvre.
[[nodiscard]] Segments find_segments(const SegmentSignals& signals, const SegmentOptions& options);

}  // namespace veridyn::aircraft
