#pragma once

#include <optional>
#include <string_view>

#include "veridyn/core/study.hpp"
#include "veridyn/cueing/washout/washout_design.hpp"

namespace veridyn::cueing {

/// The settings that drivers know from a motion platform's own program, for all algorithms at once. Each turns the
/// knobs that mean the same, where an algorithm has them.
struct DriverSettings {
  std::optional<double> overall, sustained, instant, chassis, aggression;

  /// "low", "medium", "high": overall 30, 68, 100; sustained 0.45, instant 0.15, chassis 6, aggression 4.4.
  [[nodiscard]] static DriverSettings preset(std::string_view name);
  /// A `preset`, and settings in place of its own.
  [[nodiscard]] static const KeyTable<DriverSettings>& keys();
  /// Turns the knobs of a design.
  void apply(WashoutDesign& design) const;
};

}  // namespace veridyn::cueing
