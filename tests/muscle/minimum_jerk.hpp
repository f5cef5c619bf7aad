#pragma once

#include <algorithm>

#include "veridyn/muscle/model/signals.hpp"

namespace veridyn::muscle::test {

/// Elbow from `from` to `to` within a second by minimum jerk, shoulder at rest.
inline Motion minimum_jerk(const Model& model, double from, double to) {
  SignalTable table;
  table.source = "minimum jerk";
  table.names = {model.coordinates[0].name, model.coordinates[1].name};
  table.values.resize(2);
  for (int i = -100; i <= 300; ++i) {
    const double t = 0.005 * i, s = std::clamp(t, 0.0, 1.0);
    table.time.push_back(t);
    table.values[0].push_back(0.0);
    table.values[1].push_back(from + (to - from) * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s));
  }
  return make_motion(table, model);
}

}  // namespace veridyn::muscle::test
