#include "tests/muscle/path/believable_arms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "tests/muscle/path/posed_arm.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"
#include "veridyn/muscle/simulation/wrap_bands.hpp"

namespace veridyn::muscle::test {
namespace {

Eigen::VectorXd moved_along(Eigen::VectorXd q, Eigen::Index c, double by) {
  q(c) += by;
  return q;
}

Eigen::VectorXd random_pose(const Model& model, std::mt19937& random) {
  Eigen::VectorXd q = model.default_pose();
  for (Eigen::Index c = 0; c < q.size(); ++c) {
    const Coordinate& k = model.coordinates[c];
    const double part = static_cast<double>(random()) / 4294967295.0;
    if (k.high > k.low && k.high - k.low < 20.0) q(c) = k.low + (k.high - k.low) * part;
  }
  return q;
}

/// Next to where a path comes to a surface its slope bends like a root, and differences of one step may straddle that:
/// of several steps the best one counts.
void best_differences(PosedArm& posed, const Eigen::VectorXd& q, Eigen::Index c, const std::vector<double>& gradient,
                      std::vector<double>& error) {
  bool all = false;
  for (double h = 1e-4; h > 5e-8 && !all; h *= 0.1) {
    std::vector<double> slope(posed.model.muscles.size(), 0.0);
    for (const auto& [step, weight] : {std::pair{1.0, 8.0}, {-1.0, -8.0}, {2.0, -1.0}, {-2.0, 1.0}}) {
      posed.pose(moved_along(q, c, step * h));
      for (std::size_t m = 0; m < slope.size(); ++m) slope[m] += weight * posed.workspace.length[m] / (12.0 * h);
    }
    all = true;
    for (std::size_t k = 0; k < error.size(); ++k) {
      const MusclePaths::Pair& pair = posed.paths.pairs()[k];
      if (pair.coordinate != c) continue;
      error[k] = std::min(error[k], std::abs(slope[pair.muscle] - gradient[k]));
      all = all && error[k] <= 1e-7;
    }
  }
}

bool side_change_named(const MusculoskeletalSystem& system, int muscle, const Eigen::VectorXd& q, Eigen::Index c) {
  estimation::RowMatrix motion(3, q.size());
  for (Eigen::Index i = 0; i < 3; ++i) motion.row(i) = moved_along(q, c, 2e-4 * static_cast<double>(i - 1)).transpose();
  const std::vector<double> time{0.0, 1.0, 2.0};
  const std::vector<WrapBandVisit> visits = wrap_band_visits(system, time, motion);
  return std::any_of(visits.begin(), visits.end(), [&](const WrapBandVisit& visit) {
    return visit.muscle == muscle && visit.kind == WrapBandKind::kSideChange;
  });
}

}  // namespace

ArmCounts count_arms(const Model& model, int poses, unsigned seed) {
  PosedArm posed(model);
  const MusculoskeletalSystem system(model, {});
  std::mt19937 random(seed);
  ArmCounts counts;
  for (int n = 0; n < poses; ++n) {
    const Eigen::VectorXd q = random_pose(model, random);
    posed.pose(q);
    const std::vector<double> gradient = posed.workspace.gradient;
    std::vector<double> near(gradient.size(), 2e-3), error(gradient.size(), 1e300);
    for (Eigen::Index c = 0; c < q.size(); ++c) {
      for (const double step : {-1.0, -0.5, 0.5, 1.0}) {
        posed.pose(moved_along(q, c, step * kDegree));
        for (std::size_t k = 0; k < near.size(); ++k)
          near[k] = std::max(near[k], std::abs(posed.workspace.gradient[k]));
      }
      best_differences(posed, q, c, gradient, error);
    }
    for (std::size_t k = 0; k < gradient.size(); ++k) {
      const MusclePaths::Pair& pair = posed.paths.pairs()[k];
      const bool sticks_out = std::abs(gradient[k]) > 1.5 * near[k], no_slope = error[k] > 1e-7;
      const bool unnamed = no_slope && !side_change_named(system, pair.muscle, q, pair.coordinate);
      ++counts.arms;
      counts.stick_out += sticks_out ? 1 : 0;
      counts.no_slope += no_slope ? 1 : 0;
      counts.unnamed += unnamed ? 1 : 0;
      counts.largest = std::max(counts.largest, std::abs(gradient[k]));
      if (!sticks_out && !unnamed) continue;
      counts.where +=
          fmt::format("{} about {}: arm {:.5f}, near {:.5f}, off {:.1e}, pose", model.muscles[pair.muscle].name(),
                      model.coordinates[pair.coordinate].name, gradient[k], near[k], error[k]);
      for (const double x : q) counts.where += fmt::format(" {:.6f}", x);
      counts.where += '\n';
    }
  }
  return counts;
}

}  // namespace veridyn::muscle::test
