#include "veridyn/muscle/study/task_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/error.hpp"

namespace veridyn::muscle {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TaskStudy task_study(const std::string& text) {
  Progress progress;
  return read_task_study(Study::parse("[subject]\nmodel = \"arm\"\n" + text, "s.toml"), progress);
}

std::string task_study_error(const std::string& text) {
  try {
    static_cast<void>(task_study(text));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

const std::string kTasks = "[tasks]\nnumbers = [8, 12]\n";

TEST(TaskStudy, HasDefaultsForParametersAndOutputs) {
  const TaskStudy study = task_study(kTasks + "[person]\nnoise = 0.002\n");
  EXPECT_EQ(study.unknowns.size(), 18u);
  for (const MuscleUnknown& u : study.unknowns) {
    EXPECT_NEAR(u.high, 1.2 * u.start, 1e-12);
    EXPECT_NEAR(u.prior_sigma, 0.4 * u.start / std::sqrt(12.0), 1e-12);
  }
  // The shoulder is held in every task.
  ASSERT_EQ(study.outputs.size(), 1u);
  EXPECT_EQ(study.outputs[0].index, 1);
  EXPECT_EQ(study.outputs[0].noise_sd, 0.002);
  EXPECT_FALSE(study.estimate_start);
}

TEST(TaskStudy, APriorOfTheStudyStays) {
  const TaskStudy study = task_study(
      kTasks +
      "[person]\n[[parameter]]\nmuscles = [\"brachialis\"]\nfields = [\"max_isometric_force\"]\nprior = \"3 %\"\n");
  ASSERT_EQ(study.unknowns.size(), 1u);
  EXPECT_NEAR(study.unknowns[0].prior_sigma, 0.03 * study.unknowns[0].start, 1e-9);
}

TEST(TaskStudy, TheMotionOfASimulationMayStay) {
  EXPECT_NO_THROW(static_cast<void>(task_study(kTasks + "[person]\n[motion]\nmethod = \"forward\"\n")));
  EXPECT_THAT(task_study_error("[motion]\nmethod = \"forward\"\n"), HasSubstr("estimated from tasks"));
}

TEST(TaskStudy, MistakesAreNamedWithFileLineAndKey) {
  EXPECT_THAT(task_study_error(kTasks), AllOf(HasSubstr("s.toml"), HasSubstr("no recording")));
  EXPECT_THAT(task_study_error(kTasks + "[person]\nspread = 2\n"), AllOf(HasSubstr("s.toml:6"), HasSubstr("spread")));
  EXPECT_THAT(task_study_error(kTasks + "[person]\nmuscles = \"thelen\"\n"), HasSubstr("millard"));
  EXPECT_THAT(task_study_error(kTasks + "[person]\nnoise_correlation = -1\n"), HasSubstr("must be >= 0"));
  EXPECT_THAT(task_study_error(kTasks + "[person]\nmodel = \"nowhere.osim\"\n"), HasSubstr("nowhere.osim"));
  EXPECT_THAT(task_study_error(kTasks + "[person]\n[person.parameters]\n\"brachiali.max_isometric_force\" = 900\n"),
              HasSubstr("brachialis.max_isometric_force"));
  EXPECT_THAT(task_study_error(kTasks + "[person]\n[person.parameters]\n\"brachialis.max_isometric_force\" = 90\n"),
              HasSubstr("outside the bounds"));
  EXPECT_THAT(task_study_error(kTasks + "[person]\n[identify]\nstarts = 0\n"), HasSubstr("identify.starts"));
  EXPECT_THAT(task_study_error(kTasks + "[person]\n[identify]\nstart = 3\n"), HasSubstr("starts"));
  EXPECT_THAT(task_study_error(kTasks + "[person]\n[identify]\nroute = \"publshed\"\n"), HasSubstr("published"));
  EXPECT_THAT(task_study_error(kTasks + "[person]\n[identify]\ntolerance = 0.01\n"), HasSubstr("tolerance"));
  EXPECT_THAT(task_study_error(kTasks + "[person]\n[identify]\nroute = \"published\"\nevaluations = 0\n"),
              HasSubstr("evaluations"));
  EXPECT_THAT(task_study_error(kTasks + "[person]\n[identify]\nroute = \"published\"\nestimate_start = true\n"),
              HasSubstr("estimate_start = false"));
  EXPECT_THAT(task_study_error("paths = \"opensim\"\n" + kTasks + "[person]\n"), HasSubstr("no derivatives"));
}

}  // namespace
}  // namespace veridyn::muscle
