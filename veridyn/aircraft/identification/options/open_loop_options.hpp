#pragma once

#include <optional>
#include <vector>

#include "veridyn/aircraft/model/aero_model.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::aircraft {

/// What is flown open loop in validation. Keys of the study table `[validate]`.
struct OpenLoopOptions {
  double duration_s = 0.0;  ///< `open_loop`: of each window, at most; 0: nothing is flown
  /// `open_loop_start`: the state at the window's beginning and the offsets are estimated from its first seconds; what
  /// comes after is forecast.
  double start_s = 2.0;
  /// `open_loop_offsets`: coefficients that have a constant of their own in each window, estimated with the initial
  /// state: trim, which differs between flights and which the integration would turn into a drift without bounds.
  std::vector<Coefficient> offsets = {Coefficient::kCl, Coefficient::kCm, Coefficient::kCn};
  /// `open_loop_gusts`: the reconstructed gust is an input; false takes the air to be calm. Where it is not given: true
  /// where a ground velocity is recorded, against which a gust can be told from motion.
  std::optional<bool> gusts = {};

  [[nodiscard]] bool asked() const { return duration_s > 0.0; }
  /// Takes the keys that are there. @throws InputError for values that make no sense.
  [[nodiscard]] static OpenLoopOptions read(const StudyTable& table);
};

}  // namespace veridyn::aircraft
