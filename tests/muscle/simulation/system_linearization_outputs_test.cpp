#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/index.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"
#include "veridyn/muscle/simulation/system_linearization.hpp"

namespace veridyn::muscle {
namespace {

using LinearisedParameters = std::vector<MusculotendonParameters<double>>;

/// What the rows are derivatives of, at a state and with parameters.
struct LinearisedOutputs {
  std::vector<double> force, fiber;
  double moment = 0.0;
};

constexpr int kElbow = 1;

class OutputsOfTheArm : public ::testing::TestWithParam<bool> {
 protected:
  static Model arm() {
    Model model = load_model("arm").model();
    if (GetParam()) {
      for (Muscle& muscle : model.muscles) muscle.parameters.rigid_tendon = true;
    }
    return model;
  }
  OutputsOfTheArm() {
    for (std::size_t m = 0; m < system.muscles().size(); ++m)
      parameters.push_back(system.muscles().settings(m).musculotendon);
    SystemEvaluator<double> evaluator(system);
    const std::vector<double> activation(6, 0.3);
    x.assign(system.layout().size, 0.0);
    x[0] = 0.3;
    x[1] = 0.9;
    x[3] = 0.2;
    evaluator.set_motion(x.data(), x.data() + 2);
    evaluator.start_muscles(activation.data(), x.data());
  }
  [[nodiscard]] LinearisedOutputs outputs_at(const std::vector<double>& state, const LinearisedParameters& p) const {
    SystemLinearization linearization(system, p, {}, 0);
    std::vector<double> rate(state.size());
    EXPECT_TRUE(linearization.derivative(state.data(), {u, {}}, rate.data()));
    LinearisedOutputs outputs;
    for (std::size_t m = 0; m < p.size(); ++m) {
      outputs.force.push_back(linearization.tendon_force(m));
      outputs.fiber.push_back(linearization.fiber_length(m, state.data()));
    }
    outputs.moment = linearization.muscle_moment(kElbow);
    return outputs;
  }
  MusculoskeletalSystem system{arm(), {.paths = PathSource::kFitted}};
  LinearisedParameters parameters;
  std::vector<double> x, u = std::vector<double>(6, 0.4);
};

TEST_P(OutputsOfTheArm, AreThoseOfTheEvaluator) {
  SystemEvaluator<double> evaluator(system);
  std::vector<double> rate(x.size());
  ASSERT_TRUE(evaluator.derivative(x.data(), {u, {}}, rate.data()));
  const LinearisedOutputs outputs = outputs_at(x, parameters);
  double moment = 0.0;
  for (std::size_t p = 0; p < system.pairs().size(); ++p) {
    const MusclePaths::Pair pair = system.pairs()[p];
    if (pair.coordinate == kElbow) moment -= evaluator.tendon_force()[pair.muscle] * evaluator.path_gradient()[p];
  }
  EXPECT_NEAR(outputs.moment, moment, 1e-9 * std::abs(moment));
  for (std::size_t m = 0; m < 6; ++m) {
    EXPECT_NEAR(outputs.force[m], evaluator.tendon_force()[m], 1e-9 * (1.0 + evaluator.tendon_force()[m]));
    if (!GetParam()) {
      EXPECT_EQ(outputs.fiber[m], x[system.layout().fiber_length[m]]);
      continue;
    }
    // A rigid tendon leaves the rest of the path to a fibre of constant height.
    const MusculotendonParameters<double>& p = parameters[m];
    const double height = p.optimal_fiber_length * std::sin(p.pennation_angle_at_optimal);
    EXPECT_NEAR(std::sqrt(std::pow(outputs.fiber[m], 2) - height * height) + p.tendon_slack_length,
                evaluator.path_length()[m], 1e-12);
  }
}

// Columns: each state that is no activation, then four numbers of the first muscle (force, fibre, tendon, pennation).
TEST_P(OutputsOfTheArm, HaveTheRowsOfDifferences) {
  const StateLayout& layout = system.layout();
  std::vector<std::size_t> states{0, 1, 2, 3};
  for (const int l : layout.fiber_length)
    if (l >= 0) states.push_back(at(l));
  constexpr std::size_t kMuscle = 0;
  std::vector<TangentForcing> forcings;
  const std::size_t columns = states.size() + 4;
  for (std::size_t f = 0; f < 4; ++f) forcings.push_back({states.size() + f, kMuscle, f, 1.0});
  SystemLinearization linearization(system, parameters, forcings, columns);
  std::vector<double> rate(x.size()), S(x.size() * columns, 0.0), row(columns);
  for (std::size_t j = 0; j < states.size(); ++j) S[states[j] * columns + j] = 1.0;
  ASSERT_TRUE(linearization.derivative(x.data(), {u, {}}, rate.data()));
  for (std::size_t j = 0; j < columns; ++j) {
    const bool state = j < states.size();
    const double size = state ? 1.0 : field_of(parameters[kMuscle], j - states.size());
    const double h = 1e-6 * std::max(size, 0.1);
    std::vector<double> up = x, down = x;
    LinearisedParameters more = parameters, less = parameters;
    if (state) {
      up[states[j]] += h;
      down[states[j]] -= h;
    } else {
      field_of(more[kMuscle], j - states.size()) += h;
      field_of(less[kMuscle], j - states.size()) -= h;
    }
    const LinearisedOutputs a = outputs_at(up, more), b = outputs_at(down, less);
    const auto expect_near = [&](double got, double high, double low, double scale, const char* what, std::size_t m) {
      const double expected = (high - low) / (2.0 * h);
      EXPECT_NEAR(got, expected, 1e-5 * (scale + std::abs(expected))) << what << ' ' << m << " by column " << j;
    };
    for (std::size_t m = 0; m < 6; ++m) {
      linearization.tendon_force_row(m, S.data(), row.data());
      expect_near(row[j], a.force[m], b.force[m], 100.0, "force", m);
      linearization.fiber_length_row(m, S.data(), row.data());
      expect_near(row[j], a.fiber[m], b.fiber[m], 1e-3, "fibre", m);
    }
    linearization.muscle_moment_row(kElbow, S.data(), row.data());
    expect_near(row[j], a.moment, b.moment, 10.0, "moment", 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Tendons, OutputsOfTheArm, ::testing::Bool());

}  // namespace
}  // namespace veridyn::muscle
