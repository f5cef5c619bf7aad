#include "veridyn/muscle/study/muscle_study_tasks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/study/muscle_study_parts.hpp"

namespace veridyn::muscle {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kSubject = "[subject]\nmodel = \"arm\"\n";

StudyTasks study_tasks(const std::string& text, const std::filesystem::path& folder = {}) {
  const Study source = Study::parse(kSubject + text, "s.toml", folder);
  Progress progress;
  const MuscleSubject subject = internal::read_subject(source.root(), progress);
  const std::vector<MuscleOutput> outputs{{MuscleOutputKind::kValue, 1, 1e-3}};
  StudyTasks tasks = read_tasks(source.root(), subject, outputs);
  source.root().finish();
  return tasks;
}

std::string study_tasks_error(const std::string& text, const std::filesystem::path& folder = {}) {
  try {
    static_cast<void>(study_tasks(text, folder));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

const std::string kCurl =
    "[[task]]\nname = \"curl\"\n[[task.ramp]]\ncoordinate = \"elbow_flexion\"\nfrom = \"10 deg\"\nto = \"90 deg\"\n"
    "start = 0.05\nduration = 1\n[task.held]\nshoulder_flexion = \"20 deg\"\n";

TEST(MuscleStudyTasks, TheElbowTasksByNumber) {
  const StudyTasks t = study_tasks(
      "[tasks]\nnumbers = [8, 11]\nhold_out = [30]\nload = 2\nload_location = [0, -0.3, 0]\n"
      "rate = 50\nreserve_force = 0.5\n[tasks.control]\nwindow = 0.02\n");
  ASSERT_EQ(t.tasks.size(), 3u);
  EXPECT_EQ(t.tasks[1].number, 11);
  EXPECT_FALSE(t.tasks[1].hold_out);
  EXPECT_TRUE(t.tasks[2].hold_out);
  EXPECT_EQ(t.tasks[0].loads[0].mass, 2.0);
  EXPECT_EQ(t.tasks[0].loads[0].location.y(), -0.3);
  EXPECT_EQ(t.tasks[0].rate_Hz, 50.0);
  EXPECT_EQ(t.tasks[0].control.window, 0.02);
  EXPECT_EQ(t.tasks[0].control.reserve_force, 0.5);
}

TEST(MuscleStudyTasks, AllAreThoseThatTheModelCanPerform) {
  const StudyTasks t = study_tasks("[tasks]\nnumbers = \"all\"\nhold_out = [8]\n");
  EXPECT_EQ(t.tasks.size(), 30u);
  EXPECT_EQ(t.notes.size(), 12u);
  EXPECT_THAT(t.notes.front(), HasSubstr("task 1"));
}

TEST(MuscleStudyTasks, ALoadOfTheSubjectIsTheLoad) {
  const StudyTasks t = study_tasks("[[subject.load]]\nbody = \"forearm\"\nmass = 1.5\n[tasks]\nnumbers = [8]\n");
  EXPECT_TRUE(t.tasks[0].loads.empty());
}

TEST(MuscleStudyTasks, OfTheStudysOwn) {
  const StudyTasks t = study_tasks(kCurl + "[[task.load]]\nbody = \"forearm\"\nmass = 0.5\n");
  ASSERT_EQ(t.tasks.size(), 1u);
  const Task& task = t.tasks[0];
  EXPECT_EQ(task.name, "curl");
  EXPECT_NEAR(task.end, 1.05, 1e-12);
  EXPECT_NEAR(task.held.at(0).value, 20.0 * kDegree, 1e-12);
  EXPECT_EQ(task.loads.at(0).mass, 0.5);
  EXPECT_NEAR(task.desired.coordinate[1]->evaluate(0.0).value, 10.0 * kDegree, 1e-9);
  EXPECT_NEAR(task.desired.coordinate[1]->evaluate(1.05).value, 90.0 * kDegree, 1e-9);
}

TEST(MuscleStudyTasks, MistakesAreNamedWithFileLineAndKey) {
  EXPECT_THAT(study_tasks_error("[tasks]\n"), AllOf(HasSubstr("s.toml"), HasSubstr("leave no task")));
  EXPECT_THAT(study_tasks_error("[tasks]\nhold_out = [8]\n"), HasSubstr("all are held out"));
  EXPECT_THAT(study_tasks_error("[tasks]\nnumbers = [43]\n"), AllOf(HasSubstr("s.toml:4"), HasSubstr("43")));
  EXPECT_THAT(study_tasks_error("[tasks]\nnumbers = [8.5]\n"), HasSubstr("8.5"));
  EXPECT_THAT(study_tasks_error("[tasks]\nnumbers = [8, 8]\n"), HasSubstr("twice"));
  EXPECT_THAT(study_tasks_error("[tasks]\nnumbers = [1]\n"), AllOf(HasSubstr("s.toml:4"), HasSubstr("range")));
  EXPECT_THAT(study_tasks_error("[tasks]\nnumbers = [8]\nhold_out = [8]\n"), HasSubstr("numbers has too"));
  EXPECT_THAT(study_tasks_error("[tasks]\nnumbers = [8]\nelbow = \"elbow_flex\"\n"),
              AllOf(HasSubstr("s.toml:5"), HasSubstr("elbow_flexion")));
  EXPECT_THAT(study_tasks_error("[tasks]\nnumbers = [8]\nload_body = \"forarm\"\n"),
              AllOf(HasSubstr("s.toml:5: tasks.load_body"), HasSubstr("forearm")));
  EXPECT_THAT(study_tasks_error("[tasks]\nnumbers = [8]\nnumber = 4\n"), HasSubstr("number"));
  EXPECT_THAT(study_tasks_error("[[task]]\nname = \"rest\"\n"), AllOf(HasSubstr("s.toml:4"), HasSubstr("no motion")));
  EXPECT_THAT(study_tasks_error(kCurl + kCurl), HasSubstr("another task"));
  EXPECT_THAT(study_tasks_error(kCurl + "shoulder = 0.1\n"),
              AllOf(HasSubstr("s.toml:"), HasSubstr("task[0].held.shoulder"), HasSubstr("shoulder_flexion")));
  EXPECT_THAT(study_tasks_error(kCurl + "elbow_flexion = 0.1\n"), HasSubstr("holds every coordinate"));
  EXPECT_THAT(study_tasks_error(kCurl + "[[task.load]]\nbody = \"hand\"\nmass = 1\n"), HasSubstr("no body"));
}

/// A folder with controls and a recording of a task.
class RecordedTask : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) { std::ofstream(folder_ / name) << text; }
  [[nodiscard]] std::string error_of(const std::string& more = "") {
    return study_tasks_error("[[task]]\nname = \"trial\"\nexcitation_file = \"u.csv\"\nmeasured = \"q.csv\"\n" + more,
                             folder_);
  }
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    write("u.csv", "time,brachialis\n0,0.1\n1,0.3\n");
  }
  /// Rows of an angle over time.
  static std::string rows(double from, double to, double step, double end, const std::string& more = "") {
    std::string text = "time,elbow_flexion\n";
    for (int i = 0; i * step <= end + 1e-9; ++i)
      text += fmt::format("{},{}\n", i * step, from + (to - from) * i * step / end);
    return text + more;
  }
  std::filesystem::path folder_ =
      std::filesystem::path(::testing::TempDir()) / ::testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(RecordedTask, StartsWhereTheRecordingStarts) {
  write("q.csv", rows(0.4, 1.2, 0.05, 1.0));
  const StudyTasks t = study_tasks(
      "[[task]]\nname = \"trial\"\nexcitation_file = \"u.csv\"\nmeasured = \"q.csv\"\n"
      "[task.held]\nshoulder_flexion = 0\n",
      folder_);
  const Task& task = t.tasks.at(0);
  ASSERT_TRUE(task.measured && task.controls);
  EXPECT_EQ(task.measured->values.rows(), 21);
  EXPECT_NEAR(task.desired.coordinate[1]->evaluate(0.0).value, 0.4, 1e-9);
  EXPECT_NEAR(task.end, 1.0, 1e-12);
  EXPECT_EQ(t.inputs.size(), 2u);
}

TEST_F(RecordedTask, IsRefusedWithWhatIsWrong) {
  write("q.csv", rows(20.0, 110.0, 0.05, 1.0));
  EXPECT_THAT(error_of(), AllOf(HasSubstr("q.csv"), HasSubstr("factor of 57")));
  write("q.csv", rows(0.4, 0.4, 0.05, 1.0));
  EXPECT_THAT(error_of(), HasSubstr("does not move"));
  write("q.csv", rows(0.4, 0.8, 0.05, 1.0, "1.5,0.8\n"));
  EXPECT_THAT(error_of(), HasSubstr("gap from 1 to 1.5 s"));
  write("q.csv", rows(0.4, 0.8, 0.05, 1.0, "1.05,nan\n"));
  EXPECT_THAT(error_of(), AllOf(HasSubstr("q.csv"), HasSubstr("1.05")));
  write("q.csv", "time,elbow\n0,0.1\n0.1,0.2\n");
  EXPECT_THAT(error_of(), HasSubstr("no column of an output"));
  write("q.csv", "time,elbow_flexion\n10,0.1\n10.1,0.2\n10.2,0.4\n");
  EXPECT_THAT(error_of(), HasSubstr("one clock"));
  write("q.csv", rows(0.4, 1.2, 0.05, 1.0));
  EXPECT_THAT(study_tasks_error("[[task]]\nname = \"trial\"\nmeasured = \"q.csv\"\n", folder_),
              HasSubstr("excitation_file"));
  EXPECT_THAT(error_of("duration = 2\n"), HasSubstr("duration"));
}

}  // namespace
}  // namespace veridyn::muscle
