#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/index.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"
#include "veridyn/muscle/simulation/system_linearization.hpp"

namespace veridyn::muscle {
namespace {

using Parameters = std::vector<MusculotendonParameters<double>>;

Parameters parameters_of(const MusculoskeletalSystem& system) {
  Parameters all;
  for (std::size_t m = 0; m < system.muscles().size(); ++m) all.push_back(system.muscles().settings(m).musculotendon);
  return all;
}

/// The arm, its brachialis driven by one unknown as each case says.
class TangentsOfTheArm : public ::testing::Test {
 protected:
  /// The state from which a simulation starts at this elbow angle, with these parameters and activations.
  [[nodiscard]] std::vector<double> started(double elbow, const Parameters& parameters,
                                            const std::vector<double>& activation) const {
    SystemEvaluator<double> evaluator(system, system.muscles().with<double>(parameters));
    std::vector<double> x(system.layout().size, 0.0);
    x[0] = 0.3;
    x[1] = elbow;
    evaluator.set_motion(x.data(), x.data() + 2);
    evaluator.start_muscles(activation.data(), x.data());
    return x;
  }
  /// Tangents of the start by one column: the elbow's angle where `by_elbow`, else the forcing.
  [[nodiscard]] std::vector<double> start_tangents(std::vector<TangentForcing> forcings, bool by_elbow,
                                                   bool follows_excitation, std::vector<double> activation) {
    SystemLinearization linearization(system, parameters_of(system), std::move(forcings), 1);
    std::vector<double> x(system.layout().size, 0.0), S(x.size(), 0.0);
    x[0] = 0.3;
    x[1] = 0.9;
    if (by_elbow) S[1] = 1.0;
    linearization.start_muscles(activation.data(), follows_excitation, x.data(), S.data());
    expect_near(x, started(0.9, parameters_of(system), activation), 1e-12);
    return S;
  }
  static void expect_near(const std::vector<double>& got, const std::vector<double>& expected, double tolerance) {
    ASSERT_EQ(got.size(), expected.size());
    for (std::size_t i = 0; i < got.size(); ++i) EXPECT_NEAR(got[i], expected[i], tolerance) << i;
  }
  static std::vector<double> difference(const std::vector<double>& up, const std::vector<double>& down, double h) {
    std::vector<double> by(up.size());
    for (std::size_t i = 0; i < by.size(); ++i) by[i] = (up[i] - down[i]) / (2.0 * h);
    return by;
  }
  MusculoskeletalSystem system{load_model("arm").model(), {.paths = PathSource::kFitted}};
  std::size_t brachialis = at(system.model().muscle("brachialis"));
  std::vector<double> at_rest = std::vector<double>(6, 0.3);
};

TEST_F(TangentsOfTheArm, AtTheStartGoWithThePose) {
  const double h = 1e-4;
  const Parameters own = parameters_of(system);
  expect_near(start_tangents({}, true, false, at_rest),
              difference(started(0.9 + h, own, at_rest), started(0.9 - h, own, at_rest), h), 1e-7);
}

TEST_F(TangentsOfTheArm, AtTheStartGoWithANumberOfTheMuscle) {
  // Optimal fibre length and tendon slack length, both by 0.5 a unit.
  const double h = 1e-5;
  for (const std::size_t field : {std::size_t{1}, std::size_t{2}}) {
    Parameters more = parameters_of(system), less = more;
    field_of(more[brachialis], field) += 0.5 * h;
    field_of(less[brachialis], field) -= 0.5 * h;
    const std::vector<double> S = start_tangents({{0, brachialis, field, 0.5}}, false, false, at_rest);
    expect_near(S, difference(started(0.9, more, at_rest), started(0.9, less, at_rest), h), 1e-6);
    EXPECT_GT(std::abs(S[system.layout().fiber_length[brachialis]]), 1e-4);
  }
}

TEST_F(TangentsOfTheArm, AtTheStartGoWithTheExcitationWhereItIsTheActivation) {
  const double h = 1e-5;
  std::vector<double> more = at_rest, less = at_rest;
  more[brachialis] += 2.0 * h;
  less[brachialis] -= 2.0 * h;
  const std::vector<TangentForcing> gain{{0, brachialis, TangentForcing::kExcitation, 2.0}};
  const std::vector<double> S = start_tangents(gain, false, true, at_rest);
  const Parameters own = parameters_of(system);
  expect_near(S, difference(started(0.9, own, more), started(0.9, own, less), h), 1e-6);
  EXPECT_EQ(S[system.layout().activation[brachialis]], 2.0);
  for (const double value : start_tangents(gain, false, false, at_rest))
    EXPECT_EQ(value, 0.0) << "activations of their own do not follow the excitation";
}

TEST_F(TangentsOfTheArm, AtTheStartStandStillWhereTheActivationIsAtItsLimit) {
  std::vector<double> beyond = at_rest;
  beyond[brachialis] = 1.2;
  const std::vector<TangentForcing> gain{{0, brachialis, TangentForcing::kExcitation, 1.0}};
  SystemLinearization linearization(system, parameters_of(system), gain, 1);
  std::vector<double> x(system.layout().size, 0.0), S(x.size(), 0.0);
  linearization.start_muscles(beyond.data(), true, x.data(), S.data());
  EXPECT_EQ(x[system.layout().activation[brachialis]], 1.0);
  for (const double value : S) EXPECT_EQ(value, 0.0);
}

// A stage that is implicit in the fibre lengths: its tangents against differences of whole stages, each of
// which solves l = base + step l' again.
TEST_F(TangentsOfTheArm, OfAnImplicitStageAreThoseOfItsSolution) {
  const StateLayout& layout = system.layout();
  const double step = 5e-3;
  const std::vector<double> u(6, 0.5);
  std::vector<double> base = started(0.9, parameters_of(system), at_rest);
  base[3] = 0.7;
  // Thelen's force-velocity curve has a corner at rest.
  for (const int l : layout.fiber_length) base[l] *= 0.98;
  const std::size_t n = base.size();
  SystemLinearization linearization(system, parameters_of(system), {}, n);
  std::vector<double> x = base, rate(n), S(n * n, 0.0), S_rate(n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i) S[i * n + i] = 1.0;
  ASSERT_TRUE(linearization.stage(step, x.data(), {u, {}}, rate.data()));
  linearization.tangent_rate(step, S.data(), S_rate.data());
  for (const int l : layout.fiber_length) EXPECT_NEAR(x[l], base[l] + step * rate[l], 1e-12) << "the stage is solved";
  SystemEvaluator<double> evaluator(system);
  // The evaluator's solution is good to some 1e-9, which differences would magnify: improved by steps of Newton.
  const auto solved = [&](const std::vector<double>& from, std::vector<double>& rate_there) {
    std::vector<double> at_end = from, moved_rate(n);
    EXPECT_TRUE(evaluator.stage(step, at_end.data(), {u, {}}, rate_there.data()));
    for (int k = 0; k < 3; ++k) {
      constexpr double kMove = 1e-7;
      std::vector<double> moved = at_end;
      for (const int l : layout.fiber_length) moved[l] += kMove;
      EXPECT_TRUE(evaluator.derivative(moved.data(), {u, {}}, moved_rate.data()));
      EXPECT_TRUE(evaluator.derivative(at_end.data(), {u, {}}, rate_there.data()));
      for (const int l : layout.fiber_length) {
        const double slope = (moved_rate[l] - rate_there[l]) / kMove;
        at_end[l] -= (at_end[l] - from[l] - step * rate_there[l]) / (1.0 - step * slope);
      }
    }
    EXPECT_TRUE(evaluator.derivative(at_end.data(), {u, {}}, rate_there.data()));
    return at_end;
  };
  for (std::size_t j = 0; j < n; ++j) {
    // Rows of activations that no unknown moves are not carried along.
    if (j >= 2 * layout.free &&
        std::find(layout.activation.begin(), layout.activation.end(), static_cast<int>(j)) != layout.activation.end())
      continue;
    const double h = 1e-5;
    std::vector<double> up = base, down = base, rate_up(n), rate_down(n);
    up[j] += h;
    down[j] -= h;
    up = solved(up, rate_up);
    down = solved(down, rate_down);
    const std::vector<double> by = difference(up, down, h), rate_by = difference(rate_up, rate_down, h);
    double largest = 1.0;
    for (const double value : rate_by) largest = std::max(largest, std::abs(value));
    for (const int l : layout.fiber_length) {
      EXPECT_NEAR(S[l * n + j], by[l], 1e-6) << "fibre " << l << " by " << system.state_name(j);
      EXPECT_NEAR(S_rate[l * n + j], rate_by[l], 1e-5 * largest) << l << " by " << system.state_name(j);
    }
    for (std::size_t i = layout.free; i < 2 * layout.free; ++i)
      EXPECT_NEAR(S_rate[i * n + j], rate_by[i], 1e-4 * largest) << i << " by " << system.state_name(j);
  }
}

}  // namespace
}  // namespace veridyn::muscle
