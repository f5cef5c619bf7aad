#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "veridyn/muscle/simulation/forward_simulation.hpp"

namespace veridyn::muscle::test {

/// Excitations of the three scenarios for arm26 that OpenSim was timed with (e_timings.csv of the reference): constant;
/// a step at 0.2 s; sines, sampled every `period` seconds and joined by lines.
inline MuscleControls arm26_scenario(int number, double period) {
  constexpr std::size_t kMuscles = 6;
  if (number == 1) return {ControlSignals(std::vector<double>(kMuscles, 0.05)), {}};
  std::vector<double> time{0.0}, value(kMuscles, 0.05);
  if (number == 2) {
    time.push_back(0.2);
    for (const double u : {0.05, 0.5, 0.5, 0.4, 0.4, 0.4}) value.push_back(u);
    return {ControlSignals(time, value, kMuscles, Interpolation::kHold), {}};
  }
  time.clear();
  value.clear();
  constexpr std::array<double, kMuscles> kBase{0.08, 0.10, 0.25, 0.15, 0.20, 0.08};
  constexpr std::array<double, kMuscles> kFrequency{1.0, 1.3, 1.7, 2.1, 2.5, 3.1};
  const long samples = std::lround(1.0 / period);
  for (long i = 0; i <= samples; ++i) {
    const double t = static_cast<double>(i) * period;
    time.push_back(t);
    for (std::size_t k = 0; k < kMuscles; ++k) {
      value.push_back(kBase[k] + 0.04 * std::sin(2.0 * std::numbers::pi * kFrequency[k] * t +
                                                 static_cast<double>(k) * std::numbers::pi / 3.0));
    }
  }
  return {ControlSignals(time, value, kMuscles, Interpolation::kLinear), {}};
}

}  // namespace veridyn::muscle::test
