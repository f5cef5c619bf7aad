#pragma once

#include <optional>
#include <string>
#include <vector>

#include "veridyn/cueing/score/felt_motion.hpp"

namespace veridyn::cueing {

/// Gain and phase that a cue keeps from the vehicle to the rider at a frequency.
struct ResponsePoint {
  double frequency = 0.0;  ///< [rad/s]
  double gain = 0.0;
  double phase = 0.0;  ///< [rad]
};

/// The frequencies of the objective motion cueing test (ICAO 9625, Hosman & Advani 2013) [rad/s].
[[nodiscard]] std::vector<double> omct_frequencies();

/// How large the sines of the test are.
struct ResponseOptions {
  double force = 0.5;           ///< [m/s^2]
  double rate = 2.0 * kDegree;  ///< [rad/s]
  double step = 0.01;           ///< [s]
  double settling = 40.0;       ///< before anything is measured [s]
  std::vector<double> frequencies = omct_frequencies();
};

/// The response of the complete chain (algorithm, guard, legs, actuators) in one cue: the vehicle moves on a sine along
/// or about that axis, and sine and cosine are fitted to what the rider feels there, over a whole period at least
/// [objective motion cueing test].
[[nodiscard]] std::vector<ResponsePoint> frequency_response(const Washout& washout, const Platform& platform, Cue cue,
                                                            const ResponseOptions& options, const Progress& progress);

/// Where a response has to be at a frequency.
struct MaskPoint {
  double frequency = 0.0;  ///< [rad/s]
  double least_gain = 0.0, most_gain = kInfinity;
  double least_phase = -kInfinity, most_phase = kInfinity;  ///< [rad]
};
/// The response's points that are outside the mask, between whose points limits go on lines over the frequency; outside
/// its frequencies there is no limit.
[[nodiscard]] std::vector<ResponsePoint> outside(const std::vector<ResponsePoint>& response,
                                                 const std::vector<MaskPoint>& mask);

}  // namespace veridyn::cueing
