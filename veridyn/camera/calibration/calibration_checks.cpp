#include "veridyn/camera/calibration/calibration_checks.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "veridyn/numerics/random.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::camera {
namespace {

using Pair = std::pair<std::size_t, std::size_t>;

/// Each point with its four nearest neighbours on the track.
std::vector<Pair> neighbours(const CalibrationPoints& points) {
  constexpr std::size_t kNeighbours = 4;
  const auto& all = points.points;
  std::vector<Pair> pairs;
  std::vector<std::pair<double, std::size_t>> distance;
  for (std::size_t i = 0; i < all.size(); ++i) {
    distance.clear();
    for (std::size_t j = 0; j < all.size(); ++j)
      if (j != i) distance.push_back({(all[j].track - all[i].track).squaredNorm(), j});
    std::partial_sort(distance.begin(), distance.begin() + kNeighbours, distance.end());
    for (std::size_t k = 0; k < kNeighbours; ++k) pairs.push_back({i, distance[k].second});
  }
  return pairs;
}

CheckOutcome check_place(const CalibrationPoints& points, const Calibration& c) {
  const NeighbourCorrelation n = neighbour_correlation(points, c.residuals);
  if (!n.tested) return {true, "dependence of the residuals on the place: too few points to test"};
  if (!n.significant())
    return {true, fmt::format("residuals do not depend on the place (correlation of neighbours {:.2f}, p = {:.3f})",
                              n.correlation, n.p)};
  return {false,
          fmt::format("residuals depend on the place (correlation of neighbours {:.2f}): of {:.2f} px per coordinate "
                      "{:.2f} px are an error of the map, which poses carry and no averaging removes; standard errors "
                      "of the parameters are too small. The lens may need more terms, or the track is not flat",
                      n.correlation, c.sigma_image, c.systematic_image)};
}

CheckOutcome check_outliers(const CalibrationPoints& points, const Calibration& c) {
  const std::vector<std::size_t> off = outlying_points(c.residuals);
  if (off.empty()) return {true, "no point is far off the others"};
  std::string text;
  constexpr std::size_t kShown = 5;
  for (std::size_t k = 0; k < std::min(off.size(), kShown); ++k)
    text += fmt::format("{}{} ({:.1f} mm)", k > 0 ? ", " : "", points.place(off[k]),
                        1e3 * c.residuals[off[k]].track.norm());
  if (off.size() > kShown) text += fmt::format(" and {} more", off.size() - kShown);
  return {false, fmt::format("far off the others: {}; measured wrongly, or swapped?", text)};
}

}  // namespace

NeighbourCorrelation neighbour_correlation(const CalibrationPoints& points,
                                           std::span<const CalibrationResidual> residuals) {
  NeighbourCorrelation result;
  const std::size_t n = residuals.size();
  if (n < 12) return result;
  const std::vector<Pair> pairs = neighbours(points);
  std::vector<Eigen::Vector2d> r;
  double mean_square = 0.0;
  for (const CalibrationResidual& residual : residuals) {
    r.push_back(residual.image);
    mean_square += residual.image.squaredNorm() / static_cast<double>(n);
  }
  // Rounding errors of an exact fit are no residuals.
  if (!(mean_square > 1e-16)) return result;
  const auto correlation = [&] {
    double sum = 0.0;
    for (const auto& [i, j] : pairs) sum += r[i].dot(r[j]);
    return sum / (mean_square * static_cast<double>(pairs.size()));
  };
  result.tested = true;
  result.pairs = pairs.size();
  result.correlation = correlation();
  constexpr int kShuffles = 999;
  numerics::RandomStream random(1, "calibration/neighbours");
  int as_large = 0;
  for (int k = 0; k < kShuffles; ++k) {
    for (std::size_t i = n - 1; i > 0; --i) std::swap(r[i], r[random.index(i + 1)]);
    as_large += correlation() >= result.correlation ? 1 : 0;
  }
  result.p = static_cast<double>(1 + as_large) / static_cast<double>(1 + kShuffles);
  return result;
}

std::vector<std::size_t> outlying_points(std::span<const CalibrationResidual> residuals) {
  constexpr double kOutlierDeviations = 6.0;
  std::vector<std::size_t> off;
  if (residuals.size() < 8) return off;
  std::vector<double> coordinates;
  for (const CalibrationResidual& r : residuals) {
    coordinates.push_back(r.image(0));
    coordinates.push_back(r.image(1));
  }
  // Below a thousandth of a pixel nothing was measured: that is rounding.
  const double limit = kOutlierDeviations * std::max(numerics::robust_sd(coordinates), 1e-3);
  for (std::size_t i = 0; i < residuals.size(); ++i)
    if (!(residuals[i].image.cwiseAbs().maxCoeff() <= limit)) off.push_back(i);
  std::sort(off.begin(), off.end(),
            [&](std::size_t a, std::size_t b) { return residuals[a].image.norm() > residuals[b].image.norm(); });
  return off;
}

std::vector<CheckOutcome> calibration_checks(const CalibrationPoints& points, const Calibration& c) {
  std::vector<CheckOutcome> checks{check_place(points, c), check_outliers(points, c)};
  const Eigen::Matrix2d J = c.camera.J_image_track(c.camera.track_centre());
  checks.push_back(
      J.determinant() < 0.0
          ? CheckOutcome{true, "the track is seen from above"}
          : CheckOutcome{false,
                         "the track is seen as in a mirror: are x and y swapped, or does x or y of the track or "
                         "of the image grow the other way?"});
  const double scale = std::sqrt(std::abs(J.determinant()));
  constexpr double kSmallestScale_px = 2.0, kLargestScale_px = 20000.0;
  checks.push_back(
      scale > kSmallestScale_px && scale < kLargestScale_px
          ? CheckOutcome{true, fmt::format("scale {:.1f} px/m", scale)}
          : CheckOutcome{false, fmt::format("scale {:.3g} px/m is outside {:g} to {:g}: is the track in metres (write "
                                            "world_x[mm] for millimetres) and the image in pixels?",
                                            scale, kSmallestScale_px, kLargestScale_px)});
  checks.push_back(
      std::isfinite(c.sigma_image)
          ? CheckOutcome{true, fmt::format("{} points for {} parameters", c.points, c.distorted ? 12 : 8)}
          : CheckOutcome{false, fmt::format("{} points are fitted exactly, so the error of the map is unknown: "
                                            "give more points",
                                            c.points)});
  if (!c.converged) checks.push_back({false, "the fit did not come to rest"});
  return checks;
}

}  // namespace veridyn::camera
