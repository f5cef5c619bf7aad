#pragma once

#include <vector>

#include "veridyn/muscle/identification/muscle_parametric_model.hpp"

namespace veridyn::muscle::test {

/// Every 10 ms.
inline std::vector<double> samples(double end) {
  std::vector<double> time;
  for (double t = 0.0; t < end + 1e-9; t += 0.01) time.push_back(t);
  return time;
}

/// The arm hangs with this angle of its elbow, and then these excitations are held.
inline MotionSegment segment_of(const MusculoskeletalSystem& system, double elbow,
                                const std::vector<double>& excitation, double end) {
  MotionSegment segment;
  segment.start = default_start(system.model());
  segment.start.q(1) = elbow;
  segment.controls = {ControlSignals(excitation), {}};
  segment.time = samples(end);
  return segment;
}

}  // namespace veridyn::muscle::test
