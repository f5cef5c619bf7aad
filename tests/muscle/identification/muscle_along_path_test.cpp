#include "veridyn/muscle/identification/muscle_along_path.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/muscle/arm26_muscles.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::muscle {
namespace {

using Kind = PathMuscleColumn::Kind;

/// One brachialis whose path is lengthened and shortened by 5 mm while its excitation goes up and down.
struct DrivenBrachialis {
  explicit DrivenBrachialis(bool rigid) {
    MuscleParameters p = arm26_muscle("BRA", arm26_thelen());
    p.rigid_tendon = rigid;
    group = MuscleGroup<double>(std::vector<MuscleParameters>{p});
    parameters = p.musculotendon;
    const double middle = parameters.tendon_slack_length + 0.9 * parameters.optimal_fiber_length;
    std::vector<double> t, l, u;
    for (int k = 0; k <= 60; ++k) {
      t.push_back(0.01 * k);
      l.push_back(middle + 0.005 * std::sin(8.0 * t.back()));
      u.push_back(0.3 + 0.15 * std::sin(11.0 * t.back()));
    }
    length = numerics::PiecewisePolynomial::quintic_spline(t, l);
    controls.excitation = ControlSignals(t, u, 1, Interpolation::kLinear);
    for (int k = 0; k <= 20; ++k) time.push_back(0.1 + 0.02 * k);
  }
  [[nodiscard]] MuscleAlongPath along(double accuracy = 1e-9) const {
    return {.muscle = group,
            .length = length,
            .controls = controls,
            .begin = 0.1,
            .time = time,
            .accuracy = accuracy,
            .parameters = parameters,
            .gain = 1.2,
            .delay = 0.034};
  }
  MuscleGroup<double> group;
  MusculotendonParameters<double> parameters{};
  numerics::PiecewisePolynomial length;
  MuscleControls controls;
  std::vector<double> time;
};

class MuscleOnItsPath : public ::testing::TestWithParam<bool> {};

// At rest and long enough the muscle is in equilibrium: what `MuscleGroup` says of it there, and what is excited is
// active.
TEST_P(MuscleOnItsPath, StaysInEquilibriumWhileNothingMoves) {
  DrivenBrachialis m(GetParam());
  const double held = m.parameters.tendon_slack_length + m.parameters.optimal_fiber_length;
  m.length =
      numerics::PiecewisePolynomial::quintic_spline(std::vector<double>{0.0, 0.3, 0.6}, std::vector<double>(3, held));
  m.controls.excitation = ControlSignals({0.25});
  PathMuscleResponse response;
  ASSERT_TRUE(simulate_along_path(m.along(), {}, response)) << response.trouble;
  const double a = 1.2 * 0.25, none = 0.0;
  double fiber = 0.0, force = 0.0;
  m.group.equilibrium({&a, 1}, {&held, 1}, {&fiber, 1});
  m.group.tendon_forces({{&a, 1}, {&a, 1}, {&fiber, 1}, {&held, 1}, {&none, 1}}, {&force, 1});
  ASSERT_GT(force, 10.0);
  for (std::size_t k = 0; k < m.time.size(); ++k) {
    // A nanometre of a tendon of a meganewton per metre is a thousandth of a newton.
    EXPECT_NEAR(response.fiber_length[k], fiber, 1e-8) << m.time[k];
    EXPECT_NEAR(response.force[k], force, 1e-4 * force) << m.time[k];
  }
}

TEST_P(MuscleOnItsPath, HasTheSlopesOfDifferences) {
  const DrivenBrachialis m(GetParam());
  const std::vector<PathMuscleColumn> columns{{.kind = Kind::kField, .field = 0},
                                              {.kind = Kind::kField, .field = 1},
                                              {.kind = Kind::kField, .field = 2},
                                              {.kind = Kind::kField, .field = 4},
                                              {.kind = Kind::kGain},
                                              {.kind = Kind::kDelay}};
  PathMuscleResponse exact, up, down;
  ASSERT_TRUE(simulate_along_path(m.along(), columns, exact)) << exact.trouble;
  for (std::size_t j = 0; j < columns.size(); ++j) {
    MuscleAlongPath more = m.along(1e-11), less = m.along(1e-11);
    const auto number = [&](MuscleAlongPath& of) -> double& {
      return columns[j].kind == Kind::kGain    ? of.gain
             : columns[j].kind == Kind::kDelay ? of.delay
                                               : field_of(of.parameters, columns[j].field);
    };
    const double h = 1e-4 * number(more);
    number(more) += h;
    number(less) -= h;
    ASSERT_TRUE(simulate_along_path(more, {}, up) && simulate_along_path(less, {}, down));
    double largest = 0.0, largest_fiber = 0.0;
    std::vector<double> force_by, fiber_by;
    for (std::size_t k = 0; k < m.time.size(); ++k) {
      force_by.push_back((up.force[k] - down.force[k]) / (2.0 * h));
      fiber_by.push_back((up.fiber_length[k] - down.fiber_length[k]) / (2.0 * h));
      largest = std::max(largest, std::abs(force_by.back()));
      largest_fiber = std::max(largest_fiber, std::abs(fiber_by.back()));
    }
    EXPECT_GT(largest, 0.0) << j;
    // Thelen's velocity curve has a corner at rest, near which single samples are off.
    for (std::size_t k = 0; k < m.time.size(); ++k) {
      EXPECT_NEAR(exact.force_by(k, j), force_by[k], 5e-3 * largest) << "column " << j << " at " << m.time[k];
      EXPECT_NEAR(exact.fiber_by(k, j), fiber_by[k], 5e-3 * largest_fiber + 1e-9)
          << "column " << j << " at " << m.time[k];
    }
  }
}

// An error of the recorded excitation that is alike over the whole recording is an error of the gain: relative to e.
TEST_P(MuscleOnItsPath, AnErrorOfTheSignalIsOneOfTheGainWhereItIsWide) {
  const DrivenBrachialis m(GetParam());
  const std::vector<PathMuscleColumn> columns{{.kind = Kind::kGain},
                                              {.kind = Kind::kError, .knot = 0.3, .spacing = 1e4, .relative = 0.1}};
  PathMuscleResponse response;
  ASSERT_TRUE(simulate_along_path(m.along(), columns, response)) << response.trouble;
  const double largest = response.force_by.col(0).cwiseAbs().maxCoeff();
  for (Eigen::Index k = 0; k < response.force_by.rows(); ++k)
    EXPECT_NEAR(response.force_by(k, 1), 0.1 * 1.2 * response.force_by(k, 0), 1e-5 * largest) << k;
}

// A narrow one does nothing before it begins, and what is left of it dies away.
TEST_P(MuscleOnItsPath, AnErrorOfTheSignalActsAroundItsInstantOnly) {
  const DrivenBrachialis m(GetParam());
  const std::vector<PathMuscleColumn> columns{{.kind = Kind::kError, .knot = 0.25, .spacing = 0.05, .absolute = 0.1}};
  PathMuscleResponse response;
  ASSERT_TRUE(simulate_along_path(m.along(), columns, response)) << response.trouble;
  double largest = 0.0;
  for (std::size_t k = 0; k < m.time.size(); ++k) {
    const double by = std::abs(response.force_by(k, 0));
    largest = std::max(largest, by);
    // The signal acts 34 ms later.
    if (m.time[k] < 0.25 - 0.05 + 0.034) {
      EXPECT_EQ(by, 0.0) << m.time[k];
    }
  }
  EXPECT_GT(largest, 1.0);
  EXPECT_LT(std::abs(response.force_by(response.force_by.rows() - 1, 0)), 0.2 * largest);
}

INSTANTIATE_TEST_SUITE_P(Tendons, MuscleOnItsPath, ::testing::Bool());

TEST(MuscleAlongPath, CutsOffAnExcitationBeyondItsLimitAndItsDerivativeToo) {
  DrivenBrachialis m(false);
  m.controls.excitation = ControlSignals({0.9});  // times a gain of 1.2
  const std::vector<PathMuscleColumn> columns{{.kind = Kind::kGain}};
  PathMuscleResponse cut, full;
  ASSERT_TRUE(simulate_along_path(m.along(), columns, cut));
  EXPECT_EQ(cut.force_by.cwiseAbs().maxCoeff(), 0.0);
  m.controls.excitation = ControlSignals({1.0 / 1.2});
  ASSERT_TRUE(simulate_along_path(m.along(), {}, full));
  for (std::size_t k = 0; k < m.time.size(); ++k) EXPECT_NEAR(cut.force[k], full.force[k], 1e-6 * full.force[k]);
}

TEST(MuscleAlongPath, SaysWhereItCannotBeIntegrated) {
  DrivenBrachialis m(false);
  m.length =
      numerics::PiecewisePolynomial::quintic_spline(std::vector<double>{0.0, 0.3, 0.6}, std::vector<double>(3, kNaN));
  PathMuscleResponse response;
  EXPECT_FALSE(simulate_along_path(m.along(), {}, response));
  EXPECT_THAT(response.trouble, ::testing::HasSubstr("diverges at 0.1 s"));
}

}  // namespace
}  // namespace veridyn::muscle
