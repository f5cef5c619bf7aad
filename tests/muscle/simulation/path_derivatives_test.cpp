#include "veridyn/muscle/simulation/path_derivatives.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"

namespace veridyn::muscle {
namespace {

/// Lengths and gradients against the evaluator, which uses no jets; the change of gradients against differences of its
/// gradients of steps h and h/2, extrapolated.
void expect_path_derivatives(const MusculoskeletalSystem& system, double tolerance) {
  SystemEvaluator<double> evaluator(system);
  const Eigen::VectorXd pose = system.model().default_pose();
  evaluator.hold(pose.data());
  const std::size_t free = system.reduction().free().size();
  std::vector<double> z(free), rest(free, 0.0);
  const auto gradient_at = [&](const std::vector<double>& at_z) {
    evaluator.set_motion(at_z.data(), rest.data());
    return std::vector<double>(evaluator.path_gradient().begin(), evaluator.path_gradient().end());
  };
  for (std::size_t k = 0; k < free; ++k) z[k] = 0.4 + 0.3 * static_cast<double>(k);
  const std::vector<double> gradient = gradient_at(z);
  const std::vector<double> length(evaluator.path_length().begin(), evaluator.path_length().end());
  // No couplers here: a free coordinate follows itself.
  std::vector<double> q(evaluator.q(), evaluator.q() + system.coordinates()), slope(q.size(), 1.0);
  const auto paths = make_path_derivatives(system);
  paths->evaluate(q.data(), slope.data());
  for (std::size_t m = 0; m < length.size(); ++m) EXPECT_NEAR(paths->length()[m], length[m], 1e-12) << m;
  ASSERT_EQ(paths->gradient().size(), system.pairs().size());
  ASSERT_EQ(paths->curvature().size(), free * system.pairs().size());
  double largest = 0.0;
  for (std::size_t k = 0; k < free; ++k) {
    const auto difference = [&](double h) {
      std::vector<double> up = z, down = z;
      up[k] += h;
      down[k] -= h;
      std::vector<double> by = gradient_at(up);
      const std::vector<double> less = gradient_at(down);
      for (std::size_t p = 0; p < by.size(); ++p) by[p] = (by[p] - less[p]) / (2.0 * h);
      return by;
    };
    const std::vector<double> coarse = difference(2e-5), fine = difference(1e-5);
    for (std::size_t p = 0; p < gradient.size(); ++p) {
      EXPECT_NEAR(paths->gradient()[p], gradient[p], 1e-7) << p;
      const double expected = (4.0 * fine[p] - coarse[p]) / 3.0;
      largest = std::max(largest, std::abs(expected));
      EXPECT_NEAR(paths->curvature()[p * free + k], expected, tolerance) << "pair " << p << " by " << k;
    }
  }
  EXPECT_GT(largest, 1e-3) << "moment arms change";
}

TEST(PathDerivatives, OfFittedPathsAreThoseOfDifferences) {
  expect_path_derivatives(MusculoskeletalSystem(load_model("arm").model(), {.paths = PathSource::kFitted}), 1e-8);
}

// Geodesics are found to some 1e-8, which the step of the differences divides.
TEST(PathDerivatives, OfExactPathsAreThoseOfDifferences) {
  expect_path_derivatives(MusculoskeletalSystem(load_model("arm").model(), {.paths = PathSource::kExact}), 2e-5);
}

TEST(PathDerivatives, AreThoseByFreeCoordinatesAlone) {
  const Model arm = load_model("arm").model();
  const MusculoskeletalSystem locked(arm, {.paths = PathSource::kFitted, .locked = {"shoulder_flexion"}});
  ASSERT_EQ(locked.reduction().free().size(), 1U);
  expect_path_derivatives(locked, 1e-8);
}

// What the slope says of a coordinate that follows another: twice the slope, twice the change.
TEST(PathDerivatives, GoByTheSlopeOfWhatFollows) {
  const MusculoskeletalSystem system(load_model("arm").model(), {.paths = PathSource::kFitted});
  const auto paths = make_path_derivatives(system);
  const std::vector<double> q{0.3, 0.9};
  const std::vector<double> once{1.0, 1.0}, twice{2.0, 1.0};
  paths->evaluate(q.data(), once.data());
  const std::vector<double> plain(paths->curvature().begin(), paths->curvature().end());
  paths->evaluate(q.data(), twice.data());
  for (std::size_t p = 0; p < system.pairs().size(); ++p) {
    EXPECT_NEAR(paths->curvature()[2 * p], 2.0 * plain[2 * p], 1e-14);
    EXPECT_EQ(paths->curvature()[2 * p + 1], plain[2 * p + 1]);
  }
}

}  // namespace
}  // namespace veridyn::muscle
