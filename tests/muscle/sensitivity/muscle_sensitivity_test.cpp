#include "veridyn/muscle/sensitivity/muscle_sensitivity.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/tasks/elbow_tasks.hpp"
#include "veridyn/numerics/batches/block_store.hpp"

namespace veridyn::muscle {
namespace {

using testing::HasSubstr;

/// So many threads; stops after so many looks.
class SensitivityProgress : public Progress {
 public:
  explicit SensitivityProgress(int threads, long looks = 1000000000) : threads_(threads), looks_(looks) {}
  [[nodiscard]] bool update(double) override { return !interrupted(); }
  [[nodiscard]] bool interrupted() const override { return --looks_ < 0; }
  [[nodiscard]] int threads() const override { return threads_; }

 private:
  int threads_;
  mutable long looks_;
};

/// The built-in arm with some of the 42 tasks.
struct SampledArm {
  explicit SampledArm(const std::vector<int>& numbers)
      : arm(load_model("arm").model(), {.paths = PathSource::kFitted}) {
    std::vector<Task> list;
    for (const int n : numbers) list.push_back(make_elbow_task(arm.model(), resolved(arm.model(), {}), n));
    Progress progress;
    tasks = prepare_tasks(arm, std::move(list), progress);
  }
  MusculoskeletalSystem arm;
  std::vector<PreparedTask> tasks;
};

const SampledArm& four_tasks() {
  static const SampledArm sampled({8, 11, 29, 33});
  return sampled;
}

SensitivityStudyOptions small_study() {
  SensitivityStudyOptions options;
  options.sampling.samples = 8;
  options.cover.tasks = 2;
  options.indices.method = IndexMethod::kMorris;
  options.indices.morris_trajectories = 2;
  return options;
}

TEST(MuscleSensitivity, HasTheSameBitsOnOneAndTwoThreads) {
  SensitivityProgress one(1), two(2);
  SensitivityStudyOptions options = small_study();
  options.indices.method = IndexMethod::kVariance;
  options.indices.variance = {.samples = 4};
  const SampledArm& s = four_tasks();
  const MuscleSensitivity a = analyse_sensitivity(s.arm, s.tasks, options, one);
  const MuscleSensitivity b = analyse_sensitivity(s.arm, s.tasks, options, two);
  ASSERT_TRUE(a.usable() && b.usable());
  EXPECT_EQ(a.sampling.simulations, 8U * 6U * 4U);
  EXPECT_TRUE((a.sampling.mean.array() == b.sampling.mean.array()).all());
  EXPECT_TRUE((a.sampling.sd.array() == b.sampling.sd.array()).all());
  EXPECT_EQ(a.cover.chosen->tasks, b.cover.chosen->tasks);
  ASSERT_EQ(a.indices.results.size(), 3U);  // two tasks and their sum
  EXPECT_EQ(a.indices.simulations, 4U * 20U * 2U);
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t i = 0; i < 18; ++i) {
      EXPECT_EQ(a.indices.results[r].variance.inputs[i].total, b.indices.results[r].variance.inputs[i].total);
      EXPECT_EQ(a.indices.results[r].variance.inputs[i].total_high, b.indices.results[r].variance.inputs[i].total_high);
    }
  }
  EXPECT_EQ(a.warnings, b.warnings);
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
    EXPECT_NEAR(found.sampling.mean(static_cast<Eigen::Index>(m), 1), nrmse, 1e-5) << m;
    EXPECT_GT(nrmse, 1e-3);
  }
}

TEST(MuscleSensitivity, CountsWhatCannotBeSimulatedAndGoesOn) {
  SampledArm s({8, 11});
  // A task that no one can perform, and one that nothing moves.
  s.tasks[0].trouble = "the standard model cannot follow it: diverged at 0.3 s";
  Progress progress;
  const MuscleSensitivity found = analyse_sensitivity(s.arm, s.tasks, small_study(), progress);
  EXPECT_TRUE(found.usable());
  EXPECT_EQ(found.tasks[0].failed, 8U * 6U);
  EXPECT_TRUE(std::isnan(found.sampling.mean(0, 0)));
  EXPECT_EQ(found.cover.chosen->tasks, std::vector<std::size_t>{1});
  EXPECT_THAT(found.warnings, testing::Contains(HasSubstr("not to be chosen, the standard model cannot follow it")));
  EXPECT_THAT(found.warnings, testing::Contains(HasSubstr("only 1 tasks may be chosen, 2 were asked for")));
}

TEST(MuscleSensitivity, EndsWhenAsked) {
  const SampledArm& s = four_tasks();
  SensitivityProgress short_one(2, 20);
  EXPECT_FALSE(analyse_sensitivity(s.arm, s.tasks, small_study(), short_one).completed);
}

TEST(MuscleSensitivity, RefusesOptionsOutOfRange) {
  const SampledArm& s = four_tasks();
  Progress progress;
  SensitivityStudyOptions options = small_study();
  options.sampling.range = 0.7;
  EXPECT_THROW((void)analyse_sensitivity(s.arm, s.tasks, options, progress), InputError);
  options = small_study();
  options.sampling.samples = 0;
  EXPECT_THROW((void)analyse_sensitivity(s.arm, s.tasks, options, progress), InputError);
}

TEST(TaskIndices, OfMorrisAreTheChangeAcrossTheRange) {
  // One unknown only: each walk is one step of 2/3 of the range, so that mu* is the mean of |change| / (2/3).
  const SampledArm& s = four_tasks();
  std::vector<MuscleUnknown> inputs = {muscle_factors(s.arm.model(), 5, 0.05)[0]};
  const TaskResponses responses(s.arm, inputs, s.tasks, 1e-6);
  TaskIndexOptions options{.method = IndexMethod::kMorris, .morris_trajectories = 1};
  Progress progress;
  const std::vector<std::string> names = {"a", "b", "c", "d"};
  numerics::BlockStore nothing;
  const TaskIndices found = task_indices(responses, std::vector<std::size_t>{2}, names, options, nothing, progress);
  ASSERT_EQ(found.results.size(), 1U);
  EXPECT_EQ(found.simulations, 2U);
  std::vector<double> candidates;
  for (const double low : {0.0, 1.0 / 3.0}) {
    const auto at = [&](double x) { return responses.nrmse(2, Eigen::VectorXd::Constant(1, 0.95 + 0.1 * x)); };
    candidates.push_back(std::abs(at(low + 2.0 / 3.0) - at(low)) * 1.5);
  }
  const double mu = found.results[0].morris[0].absolute;
  EXPECT_GT(mu, 0.0);
  EXPECT_LT(std::min(std::abs(mu - candidates[0]), std::abs(mu - candidates[1])), 1e-9 + 1e-6 * mu);
}

TEST(TaskIndices, WarnWhereAnIntervalExceedsATenthOfItsIndex) {
  EXPECT_FALSE(wide_interval(0.5, 0.48, 0.52));
  EXPECT_TRUE(wide_interval(0.5, 0.46, 0.52));
  EXPECT_TRUE(wide_interval(0.0, -0.01, 0.01));
  EXPECT_TRUE(wide_interval(0.5, std::nan(""), 0.5));
}

TEST(MuscleSensitivity, GoesOnFromAStore) {
  const SampledArm& s = four_tasks();
  Progress progress;
  const MuscleSensitivity expected = analyse_sensitivity(s.arm, s.tasks, small_study(), progress);
  const auto folder = std::filesystem::temp_directory_path() / ("veridyn_muscle_blocks_" + std::to_string(::getpid()));
  std::filesystem::remove_all(folder);
  for (std::size_t shard = 0; shard < 2; ++shard) {
    numerics::BlockStore part(folder, {}, {.index = shard, .count = 2});
    const MuscleSensitivity found = analyse_sensitivity(s.arm, s.tasks, small_study(), part, progress);
    EXPECT_FALSE(found.completed);
    EXPECT_EQ(part.missing(), 1u);  // 192 simulations; 2 x 19 of each of two tasks are one block, of the first shard
    if (shard == 1) {
      EXPECT_EQ(found.sampling.mean, expected.sampling.mean);
    }
  }
  numerics::BlockStore rest(folder, {});
  const MuscleSensitivity found = analyse_sensitivity(s.arm, s.tasks, small_study(), rest, progress);
  EXPECT_TRUE(found.usable());
  EXPECT_EQ(rest.found(), 2u);
  EXPECT_EQ(found.sampling.mean, expected.sampling.mean);
  EXPECT_EQ(found.indices.results[0].morris[0].mean, expected.indices.results[0].morris[0].mean);
  // Blocks of the same name of another accuracy: what a library user's identity does not say.
  SensitivityStudyOptions other = small_study();
  other.sampling.accuracy = 1e-4;
  EXPECT_THROW((void)analyse_sensitivity(s.arm, s.tasks, other, rest, progress), InputError);
  std::filesystem::remove_all(folder);
}

TEST(MuscleSensitivity, FingerprintsFollowTheMotionsAndTheUnknowns) {
  const SampledArm& s = four_tasks();
  const auto print = [&](std::size_t muscle, std::size_t tasks, double accuracy) {
    const std::vector<MuscleUnknown> unknowns = muscle_factors(s.arm.model(), muscle, 0.05);
    return TaskResponses(s.arm, unknowns, std::span(s.tasks).first(tasks), accuracy).fingerprint();
  };
  EXPECT_EQ(print(0, 2, 1e-5), print(0, 2, 1e-5));
  EXPECT_NE(print(0, 2, 1e-5), print(1, 2, 1e-5));
  EXPECT_NE(print(0, 2, 1e-5), print(0, 1, 1e-5));
  EXPECT_NE(print(0, 2, 1e-5), print(0, 2, 1.1e-5));
}

}  // namespace
}  // namespace veridyn::muscle
