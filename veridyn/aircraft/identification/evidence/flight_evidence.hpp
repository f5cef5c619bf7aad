#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "veridyn/aircraft/identification/signals/measured_coefficients.hpp"
#include "veridyn/aircraft/model/aero_model.hpp"
#include "veridyn/estimation/judgement/evidence.hpp"

namespace veridyn::aircraft {

/// How wrong a signal may be, the same in all samples, as far as a recording tells: one standard deviation.
struct SignalDoubt {
  FlightSignal signal = FlightSignal::kAirspeed;
  double scale = 0.0;  ///< of reading over truth
  double zero = 0.0;   ///< in the signal's unit
  /// Whether it is part of the interval: of what no sensor measures the reconstruction knows how wrong it may be, while
  /// a sensor is taken as right.
  bool in_interval = false;
};

/// A check of the recording, and which coefficients rest on what it checked.
struct FlightEvidence {
  estimation::Evidence row;
  std::vector<Coefficient> affects = {};  ///< empty: all
  std::optional<SignalDoubt> doubt = {};  ///< what the check leaves in doubt, where that has a size

  [[nodiscard]] bool bears_on(Coefficient c) const {
    return affects.empty() || std::ranges::find(affects, c) != affects.end();
  }
};

/// What rests on the alpha vane.
[[nodiscard]] inline std::vector<Coefficient> by_alpha() {
  return {Coefficient::kCL, Coefficient::kCD, Coefficient::kCm};
}
/// What rests on the beta vane.
[[nodiscard]] inline std::vector<Coefficient> by_beta() {
  return {Coefficient::kCY, Coefficient::kCl, Coefficient::kCn};
}

}  // namespace veridyn::aircraft
