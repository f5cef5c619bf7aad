#pragma once

#include <vector>

#include "veridyn/aircraft/reconstruction/reconstruct.hpp"

namespace veridyn::aircraft {

/// Runs the model-free and the model-based filter over the same recording and compares both with the truth of the
/// simulated flight: root mean square errors of filter and smoother for airspeed, alpha, beta and the whole wind,
/// with the standard deviation of the signal and, for alpha, beta and airspeed, the information bounds of both at the
/// mean airspeed. The first 10 s, in which the filters settle, are left out.
/// @throws InputError as `reconstruct`.
[[nodiscard]] std::vector<FilterError> compare_filters(const Recording& mapped, const Recording& truth,
                                                       const ReconstructOptions& options, const Subject& subject,
                                                       Progress& progress);

}  // namespace veridyn::aircraft
