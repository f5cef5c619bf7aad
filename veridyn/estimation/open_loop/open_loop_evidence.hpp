#pragma once

#include <optional>
#include <string>
#include <vector>

#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/estimation/open_loop/open_loop.hpp"

namespace veridyn::estimation {

/// Errors that are large, over the motion's standard deviation.
inline constexpr double kLargeError = 0.25;

/// What the horizon of a group of states is measured by.
struct OpenLoopHorizon {
  std::string group = {};
  double period_s = 0.0;  ///< of the model's natural motion where it was integrated
  std::string motion;     ///< "short-period motion"
  double large_error = kLargeError;
  bool air_known = true;  ///< whether gusts were an input, or there were none
};

/// *open loop horizon*: how long the states of a group stay within their bands, by the worst of them, in periods of the
/// natural motion. Below ten with care; below three failed where the error is also larger than `large_error` of the
/// motion's standard deviation. Not verified where the windows are shorter than ten and most are held to their end.
/// Nothing where no state of the group was integrated.
[[nodiscard]] std::optional<Evidence> open_loop_horizon(const OpenLoop& open_loop, const OpenLoopHorizon& horizon);

/// *open loop against the mean*, of each state: with care where the error is larger than the motion's standard
/// deviation; and *open loop divergence*: failed where a simulation left the model's range.
/// @param range  what that is: "80 deg, 2 m/s"
[[nodiscard]] std::vector<Evidence> open_loop_errors(const OpenLoop& open_loop, const std::string& range);

}  // namespace veridyn::estimation
