#pragma once

#include "tests/support/folders.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/muscle/simulation/forward_simulation.hpp"

/// A leg that turns a crank, a loop with one motion, as tests of loops share it.
namespace veridyn::muscle::test {

/// The example's model: hip, knee and crank, vasti and gluteus maximus.
[[nodiscard]] inline Model pedals() {
  return read_osim(veridyn::test::source_folder() / "examples/studies/muscle/pedals.osim");
}

/// 0.3 s of it under excitations that rise and fall, every 2 ms.
[[nodiscard]] inline MuscleTrajectory pedalling(const MusculoskeletalSystem& system, double accuracy) {
  Progress progress;
  return simulate_forward(
      system, default_start(system.model()),
      {.excitation =
           ControlSignals({0.0, 0.1, 0.2, 0.3}, {0.1, 0.05, 0.4, 0.1, 0.1, 0.3, 0.05, 0.05}, 2, Interpolation::kLinear),
       .reserve = {}},
      {.end = 0.3, .rate_Hz = 500.0, .accuracy = accuracy}, progress);
}

/// Splines through its angles.
[[nodiscard]] inline Motion motion_of(const MuscleTrajectory& t, const Model& model) {
  SignalTable table;
  table.time = t.time;
  for (Eigen::Index c = 0; c < t.q.cols(); ++c) {
    table.names.push_back(model.coordinates[static_cast<std::size_t>(c)].name);
    table.values.emplace_back(t.q.col(c).begin(), t.q.col(c).end());
  }
  return make_motion(table, model);
}

}  // namespace veridyn::muscle::test
