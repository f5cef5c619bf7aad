#include "veridyn/muscle/sensitivity/muscle_sensitivity.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "tests/muscle/sensitivity/sampled_arm.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/batches/block_store.hpp"

namespace veridyn::muscle {
namespace {

using test::four_tasks;
using test::SampledArm;
using test::small_study;
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

}  // namespace
}  // namespace veridyn::muscle
