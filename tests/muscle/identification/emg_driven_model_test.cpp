#include "veridyn/muscle/identification/emg_driven_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tests/muscle/identification/moved_arm.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/identification/muscle_parametric_model.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"

namespace veridyn::muscle {
namespace {

using ::testing::HasSubstr;

using test::MovedArm;

const std::vector<std::string> kNames = {"biceps_long.max_isometric_force", "biceps_long.optimal_fiber_length",
                                         "biceps_long.tendon_slack_length", "brachialis.excitation_gain",
                                         "brachialis.excitation_delay",     "triceps_long.excitation_gain",
                                         "brachialis.tendon_strain_factor", "brachialis.max_contraction_velocity"};

class EmgDrivenArm : public ::testing::TestWithParam<std::tuple<PathSource, bool>> {
 protected:
  static Model model() {
    Model arm = load_model("arm").model();
    if (std::get<1>(GetParam())) {
      for (Muscle& muscle : arm.muscles) muscle.parameters.rigid_tendon = true;
    }
    return arm;
  }
};

// The independent check: skeleton, muscles and their tendons integrated together by another program path. Its angles
// and excitations, given to muscles along the recorded angles, make its moments, forces and fibre lengths again.
TEST_P(EmgDrivenArm, MakesTheMomentsOfAForwardSimulation) {
  const MovedArm arm(model(), std::get<0>(GetParam()), kNames);
  ASSERT_TRUE(arm.moved);
  const EmgDrivenModel driven = arm.along(1, 1e-8);
  estimation::ModelResponse response;
  ASSERT_TRUE(driven.respond(0, arm.theta.head(8), {}, response));
  for (Eigen::Index o = 0; o < 4; ++o) {
    double largest = 0.0, difference = 0.0;
    // At the first sample the slope of the spline through the angles is its own, and a rigid tendon's fibre has it.
    for (Eigen::Index k = 1; k < response.output.rows(); ++k) {
      largest = std::max(largest, std::abs(arm.recorded(10 * k, 2 + o)));
      difference = std::max(difference, std::abs(response.output(k, o) - arm.recorded(10 * k, 2 + o)));
    }
    // Measured: 3.3e-5 with elastic tendons, 1.7e-4 with rigid ones, whose force has the slope of the spline in it.
    EXPECT_LT(difference, 3e-4 * largest) << "output " << o;
    EXPECT_GT(largest, o == 2 ? 0.01 : 0.5);
  }
}

TEST_P(EmgDrivenArm, DerivativesAreThoseOfCentralDifferences) {
  const MovedArm arm(model(), std::get<0>(GetParam()), kNames);
  const EmgDrivenModel driven = arm.along(10, 1e-8), finer = arm.along(10, 1e-10);
  const Eigen::VectorXd theta = arm.theta.head(8);
  std::vector<Eigen::Index> active(8);
  std::iota(active.begin(), active.end(), 0);
  estimation::ModelResponse exact, middle, plus, minus;
  ASSERT_TRUE(driven.respond(0, theta, active, exact));
  ASSERT_TRUE(finer.respond(0, theta, {}, middle));
  for (Eigen::Index j = 0; j < 8; ++j) {
    // Wide enough that what is left of the integration's error, over it, is none of the derivative. A rigid tendon's
    // fibre is not integrated, and a wide step would cross the corners of its curves.
    const double narrow = std::get<1>(GetParam()) ? 0.01 : 1.0;
    const bool delay = arm.unknowns[j].unit == "s";
    const double h = narrow * (delay ? 1e-4 : 1e-3 * std::abs(theta(j)));
    Eigen::VectorXd up = theta, down = theta;
    up(j) += h;
    down(j) -= h;
    ASSERT_TRUE(finer.respond(0, up, {}, plus) && finer.respond(0, down, {}, minus));
    for (Eigen::Index o = 0; o < 4; ++o) {
      double largest = 0.0, difference = 0.0;
      Eigen::Index where = 0, corners = 0;
      for (Eigen::Index k = 0; k < exact.output.rows(); ++k)
        largest = std::max(largest, std::abs(plus.output(k, o) - minus.output(k, o)) / (2.0 * h));
      for (Eigen::Index k = 0; k < exact.output.rows(); ++k) {
        const double numeric = (plus.output(k, o) - minus.output(k, o)) / (2.0 * h);
        // Thelen's velocity curve has a corner at rest. Where the two halves of a difference differ by as much as is
        // allowed, it tells no slope.
        if (std::abs(plus.output(k, o) - 2.0 * middle.output(k, o) + minus.output(k, o)) / h > 2e-2 * largest) {
          ++corners;
          continue;
        }
        if (std::abs(numeric - exact.sensitivity(4 * k + o, j)) > difference) where = k;
        difference = std::max(difference, std::abs(numeric - exact.sensitivity(4 * k + o, j)));
      }
      EXPECT_LE(corners, exact.output.rows() / 5);
      // Next to the corner single samples are that far off.
      EXPECT_LE(difference, 2e-2 * largest) << kNames[j] << ", output " << o << ", sample " << where;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(PathsAndTendons, EmgDrivenArm,
                         ::testing::Combine(::testing::Values(PathSource::kExact, PathSource::kFitted),
                                            ::testing::Bool()));

TEST(EmgDrivenModel, ErrorsOfTheEmgHaveTheDerivativesOfCentralDifferences) {
  const MovedArm arm(load_model("arm").model(), PathSource::kFitted,
                     {"brachialis.excitation_gain", "brachialis.excitation_delay"},
                     {{MuscleOutputKind::kMoment, 1, 0.0}});
  const EmgError error{.relative = 0.1, .absolute = 0.02};
  const EmgDrivenModel driven = arm.along(10, 1e-8, error);
  // About errors that are none of them zero.
  Eigen::VectorXd theta(2 + driven.errors(0));
  theta << arm.theta.head(2), Eigen::VectorXd::Constant(driven.errors(0), 0.4);
  estimation::RowMatrix exact;
  ASSERT_TRUE(driven.error_response(0, theta, exact));
  ASSERT_EQ(exact.cols(), driven.errors(0));
  estimation::ModelResponse plus, minus;
  for (Eigen::Index j = 0; j < exact.cols(); j += 7) {
    const double h = 0.05;
    Eigen::VectorXd up = theta, down = theta;
    up(2 + j) += h;
    down(2 + j) -= h;
    ASSERT_TRUE(driven.respond(0, up, {}, plus) && driven.respond(0, down, {}, minus));
    const Eigen::VectorXd numeric = (plus.output - minus.output).reshaped() / (2.0 * h);
    // The EMG is on lines between its samples, the shapes of its errors are not.
    EXPECT_LE((numeric - exact.col(j)).cwiseAbs().maxCoeff(), 0.03 * exact.cwiseAbs().maxCoeff()) << "error " << j;
  }
}

TEST(EmgDrivenModel, SaysWhichMuscleCannotBeSimulatedAndWhere) {
  const MovedArm arm(load_model("arm").model(), PathSource::kFitted, {"brachialis.optimal_fiber_length"});
  const EmgDrivenModel model = arm.along(10, 1e-6);
  EXPECT_EQ(model.trouble(0, arm.theta), "");
  EXPECT_THAT(model.trouble(0, Eigen::VectorXd::Constant(1, -0.1)), HasSubstr("cannot have these parameters"));
  // A path without a number: the fibre has no equilibrium with it.
  EmgSegment broken;
  broken.begin = 0.0;
  broken.time = {0.0, 0.1};
  for (std::size_t m = 0; m < 6; ++m) {
    const double length = m == 2 ? std::nan("") : 0.4;
    broken.length.push_back(numerics::PiecewisePolynomial::quintic_spline(std::vector<double>{0.0, 0.1, 0.2},
                                                                          std::vector<double>(3, length)));
    broken.emg.push_back({ControlSignals({0.1}), {}});
  }
  const std::vector<MuscleOutput> outputs{
      parse_output(arm.system.model(), arm.system.model().muscles[2].name() + ".tendon_force", "test")};
  broken.arm.setZero(2, 6);
  const EmgDrivenModel none(arm.system, arm.unknowns, {broken}, outputs, {0, 1, 2, 3, 4, 5}, 1e-6);
  EXPECT_THAT(none.trouble(0, arm.theta),
              ::testing::StartsWith(arm.system.model().muscles[2].name() + ": the simulation diverges at 0 s"));
}

}  // namespace
}  // namespace veridyn::muscle
