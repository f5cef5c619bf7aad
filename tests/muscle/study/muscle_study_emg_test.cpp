#include "veridyn/muscle/study/muscle_study_emg.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>

#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/study/task_study.hpp"

namespace veridyn::muscle {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A second and a half of elbow flexion with the shoulder at rest, its moments and the EMG of three electrodes, each
/// file at a rate of its own. What a test changes of a column is a function of (time, value).
class EmgStudy : public ::testing::Test {
 protected:
  using Change = std::function<double(double, double)>;
  void SetUp() override {
    angles();
    moments();
    emg();
  }

  void angles(const Change& elbow = as_it_is, const std::string& column = "elbow_flexion",
              const std::string& degrees = "no") {
    std::string text = fmt::format(
        "motion\nversion=1\nnRows=151\nnColumns=3\ninDegrees={}\nendheader\ntime\t{}\t"
        "shoulder_flexion\n",
        degrees, column);
    for (int k = 0; k <= 150; ++k) {
      const double t = 10.0 + 0.01 * k;
      text += fmt::format("{}\t{}\t0.1\n", t, elbow(t, 1.0 - 0.8 * std::cos(4.0 * t)));
    }
    write("ik.mot", text);
  }
  void moments(const Change& change = as_it_is, const std::string& column = "elbow_flexion_moment",
               double begin = 10.0) {
    std::string text = "time," + column + "\n";
    for (int k = 0; k <= 300; ++k) {
      const double t = begin + 0.005 * k;
      text += fmt::format("{},{}\n", t, change(t, 4.0 + 3.0 * std::sin(4.0 * t)));
    }
    write("id.csv", text);
  }
  void emg(const Change& change = as_it_is, double begin = 9.9, const std::string& biceps = "BIC") {
    std::string text = "time," + biceps + ",BRA,TRI\n";
    for (int k = 0; k <= 400; ++k) {
      const double t = begin + 0.004 * k;
      text += fmt::format("{},{},{},{}\n", t, change(t, 0.3 + 0.2 * std::sin(4.0 * t)), 0.25, 0.05);
    }
    write("emg.csv", text);
  }
  void write(const std::string& name, const std::string& text) { std::ofstream(folder_ / name) << text; }

  [[nodiscard]] TaskStudy read(const std::string& more = {}, const std::string& columns = kColumns) const {
    Progress progress;
    const std::string text =
        "[subject]\nmodel = \"arm\"\npaths = \"fitted\"\n[emg]\n" + columns +
        "[[task]]\nname = \"curl\"\nangles = \"ik.mot\"\nmoments = \"id.csv\"\nemg = \"emg.csv\"\n" + more;
    return read_task_study(Study::parse(text, "s.toml", folder_), progress);
  }
  [[nodiscard]] std::string error(const std::string& more = {}, const std::string& columns = kColumns) const {
    try {
      static_cast<void>(read(more, columns));
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  }

  static double as_it_is(double, double value) { return value; }
  inline static const std::string kColumns =
      "[emg.columns]\nbiceps_long = \"BIC\"\nbiceps_short = \"BIC\"\nbrachialis = \"BRA\"\ntriceps_long = \"TRI\"\n"
      "triceps_lateral = \"TRI\"\ntriceps_medial = \"TRI\"\n";
  veridyn::test::TemporaryFolder scratch_;
  std::filesystem::path folder_ = scratch_.path();
};

TEST_F(EmgStudy, ReadsFilesWithTimesOfTheirOwn) {
  const TaskStudy study = read();
  ASSERT_TRUE(study.emg);
  EXPECT_EQ(study.emg->signals, (std::vector<std::string>{"TRI", "BIC", "BRA"}));
  EXPECT_EQ(study.emg->signal_of, (std::vector<int>{0, 0, 0, 1, 1, 2}));
  ASSERT_EQ(study.outputs.size(), 1u);  // no moment of the shoulder in the file
  EXPECT_EQ(study.outputs[0].kind, MuscleOutputKind::kMoment);
  const EmgRecording& r = *study.tasks[0].recording;
  EXPECT_DOUBLE_EQ(r.begin, 10.0);
  EXPECT_NEAR(r.time.front(), 10.1, 1e-9);         // after 0.1 s
  EXPECT_NEAR(r.time[1] - r.time[0], 0.01, 1e-9);  // 200 Hz are more than moments have in them
  EXPECT_NEAR(r.measured(0, 0), 4.0 + 3.0 * std::sin(4.0 * r.time[0]), 1e-9);
  EXPECT_EQ(study.unknowns.size(), 7u);  // the gains and the delay
  EXPECT_FALSE(study.estimate_start);
}

TEST_F(EmgStudy, ADelayOfTheEmgIsAnUnknownUnlessTheStudySaysMore) {
  const MuscleUnknown delay = read().unknowns.back();
  EXPECT_EQ(delay.name, "EMG delay");
  EXPECT_EQ(delay.parameters.size(), 6u) << "all muscles with EMG";
  EXPECT_DOUBLE_EQ(delay.start, 0.04);
  EXPECT_DOUBLE_EQ(delay.prior_sigma, 0.02);
  EXPECT_LT(delay.low, 0.0) << "clocks that are right may give 0";
  const MuscleUnknown told = read({}, "delay = \"25 ms\"\ndelay_sigma = \"5 ms\"\n" + kColumns).unknowns.back();
  EXPECT_DOUBLE_EQ(told.start, 0.025);
  EXPECT_DOUBLE_EQ(told.prior_sigma, 0.005);
  const MuscleUnknown known = read({}, "delay = 0\ndelay_sigma = 0\n" + kColumns).unknowns.back();
  EXPECT_TRUE(known.fixed);
  EXPECT_EQ(known.start, 0.0);
  const TaskStudy own = read("[[parameter]]\nname = \"late\"\nmuscles = [\"all\"]\nfields = [\"excitation_delay\"]\n");
  ASSERT_EQ(own.unknowns.size(), 1u);
  EXPECT_EQ(own.unknowns[0].name, "late");
}

TEST_F(EmgStudy, SubtractsTheModelsLimitForcesFromTheMoments) {
  // Beyond the elbow's limit of extension the model's own spring holds part of the moment.
  angles([](double, double) { return -0.02; });
  const TaskStudy study = read();
  const auto& limits = study.subject.system->model().limit_forces;
  const bool has_limit = !limits.empty();
  const EmgRecording& r = *study.tasks[0].recording;
  const double difference = r.measured(0, 0) - (4.0 + 3.0 * std::sin(4.0 * r.time[0]));
  EXPECT_EQ(difference != 0.0, has_limit);
}

TEST_F(EmgStudy, DividesByTheMaximum) {
  emg([](double, double value) { return 2e-3 * value; });
  EXPECT_THAT(error(), AllOf(HasSubstr("s.toml:"), HasSubstr("task[0].emg: "), HasSubstr("emg.csv"), HasSubstr("'BIC'"),
                             HasSubstr("volts"), HasSubstr("emg.maximum.BIC")));
  const TaskStudy study = read({}, kColumns + "[emg.maximum]\nBIC = 0.002\n");
  EXPECT_NEAR(study.tasks[0].recording->emg[1].row(0)[0], 0.3 + 0.2 * std::sin(4.0 * 9.9), 1e-9);
  EXPECT_THAT(error({}, kColumns + "[emg.maximum]\nBICC = 0.002\n"),
              AllOf(HasSubstr("emg.maximum.BICC"), HasSubstr("did you mean 'BIC'")));
}

TEST_F(EmgStudy, RefusesWhatIsNoEnvelope) {
  emg([](double t, double value) { return value * std::sin(300.0 * t); });
  EXPECT_THAT(error(), AllOf(HasSubstr("task[0].emg: "), HasSubstr("raw signal"), HasSubstr("'BIC'")));
  emg([](double, double value) { return 100.0 * value; });
  EXPECT_THAT(error(), AllOf(HasSubstr("task[0].emg: "), HasSubstr("within 0 .. 1"), HasSubstr("emg.maximum.BIC")));
  emg([](double t, double value) { return t > 10.5 && t < 10.51 ? std::nan("") : value; });
  EXPECT_THAT(error(), AllOf(HasSubstr("task[0].emg: "), HasSubstr("no value at 10.5")));
}

TEST_F(EmgStudy, NamesTheNearestColumn) {
  emg(as_it_is, 9.9, "BICEP");
  EXPECT_THAT(error(), AllOf(HasSubstr("has no column 'BIC' for biceps_long, biceps_short"), HasSubstr("emg.resting")));
  emg();
  EXPECT_THAT(error({}, "[emg.columns]\nbicep_long = \"BIC\"\n"), HasSubstr("did you mean 'biceps_long'"));
  EXPECT_THAT(error({}, "resting = [\"brachialis\"]\n" + kColumns), HasSubstr("has a column in [emg.columns]"));
  angles(as_it_is, "elbow_flexon");
  EXPECT_THAT(error(), AllOf(HasSubstr("task[0].angles: "), HasSubstr("'elbow_flexion'"), HasSubstr("[task.held]")));
  angles();
  moments(as_it_is, "elbow_moment");
  EXPECT_THAT(error(),
              AllOf(HasSubstr("task[0].moments: "), HasSubstr("elbow_flexion.moment"), HasSubstr("elbow_moment")));
}

TEST_F(EmgStudy, RefusesDegreesTakenForRadians) {
  angles([](double, double value) { return 57.3 * value; });
  EXPECT_THAT(error(), AllOf(HasSubstr("task[0].angles: "), HasSubstr("degrees taken for radians")));
  angles([](double, double value) { return 57.3 * value; }, "elbow_flexion", "yes");
  EXPECT_EQ(error(), "no error");
}

TEST_F(EmgStudy, RefusesNewtonMillimetres) {
  moments([](double, double value) { return 1000.0 * value; });
  EXPECT_THAT(error(), AllOf(HasSubstr("task[0].moments: "), HasSubstr("N mm taken for N m")));
}

TEST_F(EmgStudy, RefusesGapsAndClocksThatDiffer) {
  emg(as_it_is, 0.0);
  EXPECT_THAT(error(), AllOf(HasSubstr("task[0].emg: "), HasSubstr("one clock")));
  emg();
  moments(as_it_is, "elbow_flexion_moment", 11.2);
  EXPECT_THAT(error(), AllOf(HasSubstr("task[0].moments: "), HasSubstr("one clock")));
  moments();
  angles([](double t, double value) { return t > 10.5 ? std::nan("") : value; });
  EXPECT_THAT(error(), AllOf(HasSubstr("task[0].angles: "), HasSubstr("ik.mot")));
  std::string gap = "time,BIC,BRA,TRI\n";
  for (int k = 0; k <= 400; ++k)
    if (k < 100 || k > 150) gap += fmt::format("{},0.2,0.3,0.1\n", 9.9 + 0.004 * k);
  angles();
  write("emg.csv", gap);
  EXPECT_THAT(error(), AllOf(HasSubstr("task[0].emg: "), HasSubstr("gap")));
}

TEST_F(EmgStudy, RefusesWhatDoesNotGoTogether) {
  EXPECT_THAT(error("[[output]]\nname = \"elbow_flexion\"\n"), AllOf(HasSubstr("output"), HasSubstr("is an angle")));
  EXPECT_THAT(error("[[output]]\nname = \"shoulder_flexion.moment\"\n"), HasSubstr("has no column of an output"));
  EXPECT_THAT(error("[identify]\nroute = \"published\"\n"), HasSubstr("identify.route"));
  EXPECT_THAT(error("[identify]\nadvice = true\n"), HasSubstr("identify.advice"));
  EXPECT_THAT(error("[identify]\nestimate_start = true\n"), HasSubstr("estimate_start"));
  EXPECT_THAT(error("[person]\n"), HasSubstr("exclude each other"));
  EXPECT_THAT(error("[[task]]\nname = \"b\"\nangles = \"ik.mot\"\n"),
              AllOf(HasSubstr("task[1].moments"), HasSubstr("is missing")));
  EXPECT_THAT(error({}, "noise = -0.1\n" + kColumns), HasSubstr("emg.noise"));
  Progress progress;
  const std::string without = "[subject]\nmodel = \"arm\"\n[[task]]\nname = \"a\"\nangles = \"ik.mot\"\n";
  EXPECT_THROW(static_cast<void>(read_task_study(Study::parse(without, "s.toml", folder_), progress)), InputError);
}

}  // namespace
}  // namespace veridyn::muscle
