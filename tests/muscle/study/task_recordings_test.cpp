#include "veridyn/muscle/study/task_recordings.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/muscle/identification/task_segments.hpp"

namespace veridyn::muscle {
namespace {

TaskStudy recorded_study(int seed, const std::string& person) {
  Progress progress;
  const std::string text = fmt::format(
      "seed = {}\n[subject]\nmodel = \"arm\"\npaths = \"fitted\"\n[tasks]\naccuracy = 1e-5\nnumbers = [8, 29]\n"
      "hold_out = [11]\n[person]\n{}",
      seed, person);
  return read_task_study(Study::parse(text, "s.toml"), progress);
}

TEST(TaskRecordings, OfAPersonWithoutNoiseAreItsSimulation) {
  const TaskStudy study = recorded_study(3, "spread = \"5 %\"\nnoise = 0\n");
  Progress progress;
  const TaskRecordings all = task_recordings(study, progress);
  ASSERT_EQ(all.tasks.size(), 3U);
  EXPECT_THAT(all.unused, testing::IsEmpty());
  EXPECT_FALSE(all.tasks[1].hold_out);
  EXPECT_TRUE(all.tasks[2].hold_out);
  // What is hidden lies within the spread, and differs from the model.
  const Eigen::VectorXd start = start_values(study.unknowns);
  ASSERT_EQ(all.truth.size(), study.unknowns.size());
  for (std::size_t i = 0; i < study.unknowns.size(); ++i) {
    const double ratio = all.truth.at(study.unknowns[i].name) / start(i);
    EXPECT_NEAR(ratio, 1.0, 0.05) << study.unknowns[i].name;
    EXPECT_NE(ratio, 1.0) << study.unknowns[i].name;
  }
  Eigen::VectorXd truth(start.size());
  for (std::size_t i = 0; i < study.unknowns.size(); ++i) truth(i) = all.truth.at(study.unknowns[i].name);
  for (const TaskRecording& task : all.tasks) {
    ASSERT_TRUE(task.forward) << task.name;
    EXPECT_FALSE(task.along);
    const MuscleParametricModel model(*study.subject.system, study.unknowns, {*task.forward},
                                      {.accuracy = study.accuracy, .outputs = study.outputs});
    EXPECT_EQ(task.measured, simulate_tasks(model, truth, 1)[0]) << task.name;
  }
}

TEST(TaskRecordings, HaveTheNoiseOfTheStudyAndTheSameOfOneSeed) {
  Progress progress;
  const auto measured = [&](int seed, const std::string& noise) {
    return task_recordings(recorded_study(seed, "spread = 0\nnoise = " + noise + "\n"), progress).tasks[0].measured;
  };
  const estimation::RowMatrix clean = measured(1, "0"), noisy = measured(1, "0.002");
  const auto n = static_cast<double>(clean.size());
  // Four standard errors of a standard deviation of as many values: sigma/sqrt(2 n).
  EXPECT_NEAR(std::sqrt((noisy - clean).squaredNorm() / n), 0.002, 4.0 * 0.002 / std::sqrt(2.0 * n));
  EXPECT_EQ(noisy, measured(1, "0.002"));
  EXPECT_NE(noisy, measured(2, "0.002"));
}

// exp(-dt/T) from one sample to the next, and a standard deviation of one whatever the distances are.
TEST(RecordingNoise, IsStationaryAndCorrelatedOverItsTime) {
  numerics::RandomStream random(1, "noise");
  internal::RecordingNoise noise(0.02);
  constexpr int kSamples = 40000;
  double last = 0.0, time = 0.0, square = 0.0, product = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    const double value = noise.next(time, random);
    square += value * value / kSamples;
    if (k % 2 == 1) product += value * last / (0.5 * kSamples);
    last = value;
    time += k % 2 == 0 ? 0.01 : 0.05;  // pairs 10 ms apart
  }
  // Of 20000 pairs that are nearly independent: four standard errors.
  EXPECT_NEAR(square, 1.0, 4.0 * std::sqrt(2.0 / (0.5 * kSamples)));
  EXPECT_NEAR(product, std::exp(-0.5), 4.0 * std::sqrt(2.0 / (0.5 * kSamples)));
}

}  // namespace
}  // namespace veridyn::muscle
