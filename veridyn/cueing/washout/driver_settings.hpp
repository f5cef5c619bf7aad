#pragma once

#include <optional>
#include <string_view>

#include "veridyn/core/study.hpp"
#include "veridyn/cueing/washout/washout_design.hpp"

namespace veridyn::cueing {

/// The settings that drivers know from a motion platform's own program, for all algorithms at once. Each turns the
/// knobs that mean the same, where an algorithm has them:
///
///     overall     0 to 100   percent of the vehicle's motion: force_gain, rate_gain, heave_gain, yaw_gain
///     sustained   0 to 2     share of lasting forces: sustained
///     instant     0 to 1     share of their beginnings: instant
///     chassis     0 to 20    of the vehicle's own roll and pitch, 20 being all: rate_gain of both, times overall
///     aggression  0 to 20    how fast filters follow: tilt [rad/s]
struct DriverSettings {
  std::optional<double> overall, sustained, instant, chassis, aggression;

  /// "low", "medium", "high": overall 30, 68, 100; sustained 0.45, instant 0.15, chassis 6, aggression 4.4.
  [[nodiscard]] static DriverSettings preset(std::string_view name);
  /// Of a table that may name a `preset` and settings, which come before it. @throws InputError with file, line, key.
  [[nodiscard]] static DriverSettings read(const StudyTable& table);
  /// Turns the knobs of a design.
  void apply(WashoutDesign& design) const;
};

}  // namespace veridyn::cueing
