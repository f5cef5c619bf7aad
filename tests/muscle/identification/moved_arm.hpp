#pragma once

#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "tests/muscle/identification/parameter_name.hpp"
#include "veridyn/muscle/identification/emg_driven_model.hpp"
#include "veridyn/muscle/identification/muscle_parametric_model.hpp"

namespace veridyn::muscle::test {

/// A second of smooth excitations of the arm's six muscles, on lines between samples 10 ms apart.
inline ControlSignals smooth_excitations(std::size_t muscles) {
  std::vector<double> time, values;
  for (int k = 0; k <= 70; ++k) {
    time.push_back(0.01 * k);
    for (std::size_t m = 0; m < muscles; ++m)
      values.push_back(0.12 + 0.1 * std::sin(9.0 * time.back() + 1.3 * static_cast<double>(m)));
  }
  return {time, values, muscles, Interpolation::kLinear};
}

/// One of these signals by itself.
inline MuscleControls column_of(const ControlSignals& all, std::size_t column) {
  std::vector<double> values;
  for (std::size_t k = 0; k < all.times().size(); ++k) values.push_back(all.row(k)[column]);
  return {ControlSignals({all.times().begin(), all.times().end()}, values, 1, all.interpolation()), {}};
}

/// The unknowns of these names.
inline std::vector<MuscleUnknown> unknowns_of(const Model& model, const std::vector<std::string>& names) {
  std::vector<MuscleUnknown> unknowns;
  for (const std::string& name : names) unknowns.push_back(unknown_of(model, parameter_named(model, name)));
  return unknowns;
}

/// What is computed of the arm: moments of both joints, a fibre and a tendon.
inline std::vector<MuscleOutput> moments(const Model& model) {
  return {parse_output(model, "elbow_flexion.moment", "test"), parse_output(model, "shoulder_flexion.moment", "test"),
          parse_output(model, "brachialis.fiber_length", "test"),
          parse_output(model, "biceps_long.tendon_force", "test")};
}

/// The arm moves under these excitations; what the forward simulation recorded of it.
struct MovedArm {
  /// @param chosen what `along` computes; empty: `moments`
  MovedArm(const Model& model, PathSource paths, const std::vector<std::string>& names,
           const std::vector<MuscleOutput>& chosen = {})
      : system(model, {.paths = paths}),
        unknowns(unknowns_of(system.model(), names)),
        outputs(chosen.empty() ? moments(system.model()) : chosen) {
    MotionSegment segment;
    segment.start = default_start(system.model());
    segment.start.q(1) = 0.6;
    segment.controls = {smooth_excitations(6), {}};
    for (int k = 0; k <= 700; ++k) segment.time.push_back(0.001 * k);
    std::vector<MuscleOutput> all{{MuscleOutputKind::kValue, 0, 0.0}, {MuscleOutputKind::kValue, 1, 0.0}};
    all.insert(all.end(), outputs.begin(), outputs.end());
    const MuscleParametricModel forward(system, unknowns, {segment}, {.accuracy = 1e-9, .outputs = all});
    theta = theta_of(forward);
    estimation::ModelResponse response;
    moved = forward.respond(0, theta, {}, response);
    recorded = response.output;
    time = segment.time;
  }

  [[nodiscard]] Eigen::VectorXd theta_of(const MuscleParametricModel& forward) const {
    Eigen::VectorXd all(unknowns.size() + 4);
    for (std::size_t i = 0; i < unknowns.size(); ++i) {
      // Away from the model's own values, so that gains and delays count.
      const bool delay = unknowns[i].unit == "s" && unknowns[i].start == 0.0;
      all(i) = delay ? 0.03 : 1.05 * unknowns[i].start;
    }
    for (std::size_t i = 0; i < 4; ++i) all(unknowns.size() + i) = forward.initial_conditions(0)[i].start;
    return all;
  }

  /// Along the angles of the forward simulation, sampled every `every` ms.
  [[nodiscard]] EmgDrivenModel along(std::size_t every, double accuracy,
                                     const EmgError& error = {.relative = 0.0}) const {
    Motion motion;
    motion.coordinate.resize(2);
    std::vector<double> t, q;
    for (std::size_t c = 0; c < 2; ++c) {
      t.clear(), q.clear();
      for (std::size_t k = 0; k < time.size(); k += every) {
        t.push_back(time[k]);
        q.push_back(recorded(k, c));
      }
      motion.coordinate[c] = numerics::PiecewisePolynomial::quintic_spline(t, q);
    }
    std::vector<double> samples;
    for (std::size_t k = 0; k < time.size(); k += 10) samples.push_back(time[k]);
    EmgSegment segment = along_motion(system, motion, system.model().default_pose(), time.front(), samples, outputs);
    segment.name = "trial";
    for (std::size_t m = 0; m < 6; ++m) segment.emg.push_back(column_of(smooth_excitations(6), m));
    std::vector<int> signal_of(6);
    std::iota(signal_of.begin(), signal_of.end(), 0);
    return {system, unknowns, {segment}, outputs, signal_of, accuracy, error};
  }

  MusculoskeletalSystem system;
  std::vector<MuscleUnknown> unknowns;
  std::vector<MuscleOutput> outputs;
  std::vector<double> time;
  Eigen::VectorXd theta;
  estimation::RowMatrix recorded;
  bool moved = false;
};

}  // namespace veridyn::muscle::test
