#pragma once

#include <optional>
#include <vector>

#include "veridyn/aircraft/model/aero_model.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/open_loop/open_loop.hpp"

namespace veridyn::aircraft {

/// What is flown open loop in validation. Keys of the study table `[validate]`.
struct OpenLoopOptions : estimation::OpenLoopTimes {
  /// Have a constant of their own in each window, estimated with the initial state: trim, which differs between flights
  /// and which the integration would turn into a drift without bounds.
  std::vector<Coefficient> offsets = {Coefficient::kCl, Coefficient::kCm, Coefficient::kCn};
  std::optional<bool> gusts = {};  ///< nothing: where a ground velocity is recorded

  [[nodiscard]] bool asked() const { return duration_s > 0.0; }
  [[nodiscard]] static const KeyTable<OpenLoopOptions>& keys();
};

}  // namespace veridyn::aircraft
