#pragma once

#include <string>
#include <vector>

#include "veridyn/cueing/platform/platform.hpp"

namespace veridyn::live {

/// What a platform was ordered and where it came to, at even times.
struct ToldAndReached {
  double step = 0.01;                    ///< [s]
  std::vector<double> ordered, reached;  ///< [m or rad]
};

/// A number with its standard error.
struct WithError {
  double value = 0.0, sigma = 0.0;
};

/// How one axis of a platform follows: reached = gain ordered behind a delay and a second-order lag,
/// gain exp(-s delay) omega^2 / (s^2 + 2 zeta omega s + omega^2).
struct PlatformResponse {
  WithError gain, omega, zeta, delay;  ///< 1, rad/s, 1, s
  double rms = 0.0;                    ///< of what the model leaves, over that of the motion
  /// Of what is left, the first-lag correlation; the standard errors allow for it.
  double correlation = 0.0;
  bool at_once = false;            ///< faster than can be seen: omega and zeta say nothing, the delay is all of it
  std::vector<std::string> notes;  ///< what makes the figures doubtful
};

/// Fits the response to a motion that swept over frequencies (Gauss-Newton on the output error, derivatives by
/// differences). @throws InputError for fewer than 200 samples, a platform without an order, or did not move.
[[nodiscard]] PlatformResponse fit_response(const ToldAndReached& motion);

}  // namespace veridyn::live
