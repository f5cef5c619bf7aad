#include "veridyn/muscle/sensitivity/muscle_sampling.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/muscle/sensitivity/sampled_arm.hpp"

namespace veridyn::muscle {
namespace {

using test::four_tasks;
using test::SampledArm;
using test::small_study;

TEST(MuscleFactors, AreThreeOfEachMuscleWithinTheRange) {
  const Model model = load_model("arm").model();
  const std::vector<MuscleUnknown> all = muscle_factors(model, 0.05);
  ASSERT_EQ(all.size(), 3 * model.muscles.size());
  const std::vector<MuscleUnknown> third = muscle_factors(model, 2, 0.05);
  ASSERT_EQ(third.size(), 3U);
  const char* fields[] = {"max_isometric_force", "optimal_fiber_length", "tendon_slack_length"};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(all[6 + i].name, third[i].name);
    EXPECT_EQ(third[i].name.rfind(model.muscles[2].name() + "." + fields[i], 0), 0U) << third[i].name;
    EXPECT_TRUE(third[i].factor);
    EXPECT_EQ(third[i].start, 1.0);
    EXPECT_DOUBLE_EQ(third[i].low, 0.95);
    EXPECT_DOUBLE_EQ(third[i].high, 1.05);
  }
}

TEST(MuscleSensitivity, IsTheMeanOfSimulationsOfTheChangedModel) {
  // One sample of the plain sequence is the origin: all of a muscle's parameters 5 % down. Simulated by another way: a
  // model with these numbers under the same controls and start.
  const SampledArm& s = four_tasks();
  SensitivityStudyOptions options = small_study();
  options.sampling.samples = 1;
  options.sampling.scrambled = false;
  options.sampling.accuracy = 1e-7;
  options.indices.method = IndexMethod::kNone;
  Progress progress;
  const MuscleSensitivity found = analyse_sensitivity(s.arm, s.tasks, options, progress);
  const PreparedTask& task = s.tasks[1];
  const ForwardOptions forward{.begin = task.time.front(), .end = task.time.back(), .rate_Hz = 100.0, .accuracy = 1e-7};
  const int elbow = task.system->reduction().free().front();
  const auto motion = [&](const MusculoskeletalSystem& system) {
    StartState start = task.start;
    start.fiber_length.resize(0);  // in equilibrium, of these muscles
    const MuscleTrajectory t = simulate_forward(system, start, task.controls, forward, progress);
    return Eigen::VectorXd(t.q.col(elbow));
  };
  const Eigen::VectorXd target = motion(*task.system);
  for (const std::size_t m : {std::size_t{0}, std::size_t{3}, std::size_t{5}}) {
    std::vector<MuscleParameters> parameters;
    for (const Muscle& muscle : s.arm.model().muscles) parameters.push_back(muscle.parameters);
    parameters[m].musculotendon.max_isometric_force *= 0.95;
    parameters[m].musculotendon.optimal_fiber_length *= 0.95;
    parameters[m].musculotendon.tendon_slack_length *= 0.95;
    const MusculoskeletalSystem other(*task.system, SystemChanges{.muscles = parameters});
    const Eigen::VectorXd q = motion(other);
    const double nrmse =
        std::sqrt((q - target).squaredNorm() / static_cast<double>(q.size())) / (target.maxCoeff() - target.minCoeff());
    // Two integrations to 1e-7 with steps of their own.
    EXPECT_NEAR(found.sampling.mean(m, 1), nrmse, 1e-5) << m;
    EXPECT_GT(nrmse, 1e-3);
  }
}

}  // namespace
}  // namespace veridyn::muscle
