#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "veridyn/camera/calibration/fit_camera.hpp"
#include "veridyn/core/check_outcome.hpp"

namespace veridyn::camera {

/// Whether residuals depend on the place: what a map that is too poor leaves behind.
struct NeighbourCorrelation {
  double correlation = 0.0;  ///< mean product of the residuals of neighbours over the mean square, -1 ... 1
  double p = 1.0;            ///< of at least this correlation when residuals are shuffled among the points
  std::size_t pairs = 0;
  bool tested = false;  ///< with at least 12 points
  [[nodiscard]] bool significant() const { return tested && p < 0.01 && correlation > 0.0; }
};

/// Moran's I (1950, Biometrika 37:17) of residuals in the image, each point against its four nearest neighbours on the
/// track, with a permutation test of 999 shuffles from a fixed seed.
[[nodiscard]] NeighbourCorrelation neighbour_correlation(const CalibrationPoints& points,
                                                         std::span<const CalibrationResidual> residuals);

/// Points whose residual is more than six robust standard deviations of all: wrongly measured, or swapped with another.
/// None with fewer than 8 points, among which no majority is certain.
[[nodiscard]] std::vector<std::size_t> outlying_points(std::span<const CalibrationResidual> residuals);

/// What could make a fitted map wrong, each as a check with what was found:
/// - the residuals do not depend on the place (the model is rich enough),
/// - no point is far off the others (none swapped or wrongly measured),
/// - the track is seen from above (x and y are not swapped, on neither side),
/// - the scale is that of metres and pixels,
/// - there are more equations than parameters, and the fit came to rest.
[[nodiscard]] std::vector<CheckOutcome> calibration_checks(const CalibrationPoints& points,
                                                           const Calibration& calibration);

}  // namespace veridyn::camera
