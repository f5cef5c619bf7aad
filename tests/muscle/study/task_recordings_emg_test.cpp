// Recordings with EMG, and what is found of a person from them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "veridyn/muscle/study/identify_muscles.hpp"
#include "veridyn/muscle/study/task_recordings.hpp"

namespace veridyn::muscle {
namespace {

using ::testing::HasSubstr;

/// Gains of three electrodes and one delay of the built-in arm, all hidden.
const std::string kEmg =
    "[emg]\nnoise = \"10 %\"\nlow_pass = \"6 Hz\"\n[emg.columns]\nbiceps_long = \"biceps\"\nbiceps_short = \"biceps\"\n"
    "triceps_long = \"triceps\"\ntriceps_lateral = \"triceps\"\ntriceps_medial = \"triceps\"\n"
    "[[output]]\nname = \"elbow_flexion.moment\"\nnoise = 0.3\n";
const std::string kGains =
    "[[parameter]]\nname = \"biceps\"\nmuscles = [\"biceps_long\", \"biceps_short\"]\nfields = [\"excitation_gain\"]\n"
    "bounds = \"60 %\"\n[[parameter]]\nname = \"brachialis\"\nmuscles = [\"brachialis\"]\n"
    "fields = [\"excitation_gain\"]\nbounds = \"60 %\"\n[[parameter]]\nname = \"triceps\"\n"
    "muscles = [\"triceps_long\", \"triceps_lateral\", \"triceps_medial\"]\nfields = [\"excitation_gain\"]\n"
    "bounds = \"60 %\"\n";
const std::string kDelay =
    "[[parameter]]\nname = \"delay\"\nmuscles = [\"all\"]\nfields = [\"excitation_delay\"]\nstart = 0.04\nlow = 0\n"
    "high = 0.1\n";
const std::string kSix = "[tasks]\naccuracy = 1e-5\nnumbers = [5, 8, 12, 26, 29, 33]\nhold_out = [11, 32]\nload = 2\n";
const std::string kPair = "[tasks]\naccuracy = 1e-5\nnumbers = [8, 29]\nhold_out = [11]\nload = 2\n";

TaskStudy emg_study(int seed, const std::string& text) {
  Progress progress;
  return read_task_study(
      Study::parse(fmt::format("seed = {}\n[subject]\nmodel = \"arm\"\npaths = \"fitted\"\n", seed) + text, "s.toml"),
      progress);
}

MuscleAnalysis emg_recovered(int seed, const std::string& text) {
  Progress progress;
  return identify(emg_study(seed, text), progress);
}

const estimation::Evidence& emg_row(const MuscleAnalysis& a, estimation::Check check) {
  const auto found = std::find_if(a.estimate.evidence.begin(), a.estimate.evidence.end(),
                                  [&](const estimation::Evidence& row) { return row.check == check; });
  if (found == a.estimate.evidence.end()) throw std::runtime_error("no row " + std::string(to_string(check)));
  return *found;
}

TEST(TaskRecordings, OfAPersonWithEmgAreOfItsOwnMotion) {
  const TaskStudy study = emg_study(1, kPair + kEmg + kGains + "[person]\nspread = \"30 %\"\n");
  Progress progress;
  const TaskRecordings all = task_recordings(study, progress);
  ASSERT_EQ(all.tasks.size(), 3u);
  EXPECT_TRUE(all.tasks[2].hold_out);
  ASSERT_EQ(all.truth.size(), 4u);
  for (const TaskRecording& task : all.tasks) {
    ASSERT_TRUE(task.along);
    EXPECT_EQ(task.along->emg.size(), 3u);
    EXPECT_GE(task.time.front(), 0.1 - 1e-9);
    EXPECT_EQ(task.measured.rows(), static_cast<Eigen::Index>(task.time.size()));
    // The elbow flexes by the task's range, as far as smoothed controls take it.
    EXPECT_GT(task.q.col(1).maxCoeff() - task.q.col(1).minCoeff(), 0.5);
  }
}

TEST(EmgRecovery, FindsHiddenGainsAndPredictsUnseenMoments) {
  const MuscleAnalysis a =
      emg_recovered(1, kPair + kEmg + kGains + "[person]\nspread = \"30 %\"\n[identify]\nstarts = 1\n");
  ASSERT_EQ(a.estimate.parameters.size(), 4u);
  std::size_t identified = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const estimation::Parameter& p = a.estimate.parameters[i];
    if (a.result.best.parameters[i].status != estimation::ParameterStatus::kIdentified) continue;
    ++identified;
    EXPECT_LT(std::abs(p.value - a.true_value(p.name)), 4.0 * p.sigma) << p.name;
  }
  EXPECT_GE(identified, 2u);
  EXPECT_EQ(emg_row(a, estimation::Check::kMomentSign).outcome, estimation::Outcome::kPassed);
  EXPECT_EQ(emg_row(a, estimation::Check::kEmgError).outcome, estimation::Outcome::kPassed);
  EXPECT_LT(a.result.chi_square, 1.5);
  ASSERT_EQ(a.tasks.size(), 3u);
  EXPECT_LT(a.tasks[2].after.rmse, a.tasks[2].before.rmse);
  EXPECT_EQ(a.moment_noise.size(), 1);
  EXPECT_GT(a.emg_share[0], 0.1);
}

// One task and values known to 5 %: force is gain times strength but for the activation's dynamics, so that one goes up
// as the other goes down.
TEST(EmgRecovery, AGainAndTheStrengthOfItsMuscleAreHardlyTwoNumbers) {
  // What is left open must not be the EMG's error, which is larger than these priors.
  const std::string exact_enough = "[emg]\nnoise = \"3 %\"\ndelay_sigma = 0\n" + kEmg.substr(kEmg.find("low_pass"));
  const std::string flexors = "muscles = [\"biceps_long\", \"biceps_short\", \"brachialis\"]\n";
  const MuscleAnalysis a = emg_recovered(
      1,
      "[tasks]\nnumbers = [8]\nload = 2\n" + exact_enough + "[[parameter]]\nname = \"gain\"\n" + flexors +
          "fields = [\"excitation_gain\"]\nbounds = \"20 %\"\nprior = \"5 %\"\n[[parameter]]\nname = \"strength\"\n" +
          flexors +
          "fields = [\"max_isometric_force\"]\nfactor = true\nbounds = \"20 %\"\nprior = \"5 %\"\n"
          "[person]\nspread = \"4 %\"\n[identify]\nstarts = 1\n");
  const Eigen::MatrixXd& P = a.result.best.covariance_white;
  EXPECT_LT(P(0, 1) / std::sqrt(P(0, 0) * P(1, 1)), -0.6);
  for (const estimation::Parameter& p : std::span(a.result.best.parameters).first(2))
    EXPECT_NE(p.status, estimation::ParameterStatus::kIdentified);
  ASSERT_FALSE(a.result.null_directions.empty());
  EXPECT_THAT(a.result.null_directions[0],
              ::testing::AnyOf(HasSubstr("gain against strength"), HasSubstr("strength against gain")));
  EXPECT_NE(emg_row(a, estimation::Check::kDeterminedByTasks).outcome, estimation::Outcome::kPassed);
}

/// Files of a person's recordings, as a laboratory would write them.
void write_files(const std::filesystem::path& folder, const TaskStudy& study, const TaskRecordings& all, double sign) {
  std::filesystem::create_directories(folder);
  for (std::size_t i = 0; i < all.tasks.size(); ++i) {
    const TaskRecording& task = all.tasks[i];
    std::string angles = "time,shoulder_flexion,elbow_flexion\n", moments = "time,elbow_flexion_moment\n", emg = "time";
    for (std::size_t k = 0; k < task.time.size(); ++k) {
      angles += fmt::format("{},{},{}\n", task.time[k], task.q(k, 0), task.q(k, 1));
      moments += fmt::format("{},{}\n", task.time[k], sign * task.measured(k, 0));
    }
    for (const std::string& signal : study.emg->signals) emg += "," + signal;
    emg += "\n";
    const auto times = task.along->emg[0].excitation.times();
    for (std::size_t k = 0; k < times.size(); ++k) {
      emg += fmt::format("{}", times[k]);
      for (const MuscleControls& controls : task.along->emg) emg += fmt::format(",{}", controls.excitation.row(k)[0]);
      emg += "\n";
    }
    std::ofstream(folder / fmt::format("ik{}.csv", i)) << angles;
    std::ofstream(folder / fmt::format("id{}.csv", i)) << moments;
    std::ofstream(folder / fmt::format("emg{}.csv", i)) << emg;
  }
}

MuscleAnalysis from_files(const std::filesystem::path& folder, std::size_t tasks, bool with_noise = true) {
  std::string emg = kEmg;
  if (!with_noise) emg = emg.substr(0, emg.find("[[output]]"));
  std::string text = "[subject]\nmodel = \"arm\"\npaths = \"fitted\"\n" + emg + kGains;
  for (std::size_t i = 0; i < tasks; ++i)
    text += fmt::format(
        "[[task]]\nname = \"{0}\"\nangles = \"ik{0}.csv\"\nmoments = \"id{0}.csv\"\n"
        "emg = \"emg{0}.csv\"\nhold_out = {1}\n",
        i, i + 1 == tasks);
  text += "[identify]\nstarts = 1\n";
  Progress progress;
  return identify(read_task_study(Study::parse(text, "s.toml", folder), progress), progress);
}

TEST(EmgRecovery, FilesOfARecordingGiveWhatTheRecordingGives) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "emg_files";
  const TaskStudy study = emg_study(2, kPair + kEmg + kGains + "[person]\nspread = \"30 %\"\n[identify]\nstarts = 1\n");
  Progress progress;
  const TaskRecordings all = task_recordings(study, progress);
  const MuscleAnalysis person = identify(study, progress);
  write_files(folder, study, all, 1.0);
  const MuscleAnalysis files = from_files(folder, all.tasks.size());
  for (std::size_t i = 0; i < 3; ++i) {
    const estimation::Parameter &p = person.estimate.parameters[i], &f = files.estimate.parameters[i];
    // Files begin 0.1 s later, and settle for as long again.
    EXPECT_NEAR(f.value, p.value, p.sigma) << p.name;
    EXPECT_NEAR(f.sigma, p.sigma, 0.5 * p.sigma) << p.name;
  }
  // Without a stated noise of the moments it is found together with the EMG's error.
  const MuscleAnalysis unknown = from_files(folder, all.tasks.size(), false);
  EXPECT_NEAR(unknown.moment_noise(0), 0.3, 0.1);
  EXPECT_EQ(emg_row(unknown, estimation::Check::kTaskResidual).outcome, estimation::Outcome::kNotVerified);
  // Moments with the other sign are named, and no parameter is for use.
  write_files(folder, study, all, -1.0);
  const MuscleAnalysis flipped = from_files(folder, all.tasks.size());
  EXPECT_EQ(emg_row(flipped, estimation::Check::kMomentSign).outcome, estimation::Outcome::kFailed);
  EXPECT_EQ(flipped.estimate.judgement.parameters.grade, estimation::Grade::kNo);
  std::filesystem::remove_all(folder);
}

/// 20 persons: three gains within 30 %, a delay, errors of the EMG of 10 %, noise of moments and angles.
TEST(EmgRecoverySoak, IdentifiedParametersAreCoveredAndUnseenMomentsPredicted) {
  std::size_t identified = 0, covered = 0, at_bound = 0, failed = 0;
  double before = 0.0, after = 0.0, worst = 0.0, tasks = 0.0, chi = 0.0;
  const int persons = 20;
  for (int seed = 1; seed <= persons; ++seed) {
    const MuscleAnalysis a =
        emg_recovered(seed, kSix + kEmg + kGains + kDelay + "[person]\nspread = \"30 %\"\n[identify]\nstarts = 1\n");
    std::string line;
    for (std::size_t i = 0; i < a.estimate.parameters.size(); ++i) {
      const estimation::Parameter& p = a.estimate.parameters[i];
      at_bound += a.result.best.parameters[i].status == estimation::ParameterStatus::kAtBound ? 1 : 0;
      const double truth = a.true_value(p.name);
      line += fmt::format(" {}:{:.4g}{:+.2g}({:+.1f})", p.name, truth, p.value - truth, (p.value - truth) / p.sigma);
      if (a.result.best.parameters[i].status != estimation::ParameterStatus::kIdentified) continue;
      ++identified;
      covered += p.low95 <= truth && truth <= p.high95 ? 1 : 0;
    }
    for (const TaskOutcome& t : a.tasks) {
      if (!t.hold_out) continue;
      before += t.before.nrmse;
      after += t.after.nrmse;
      worst = std::max(worst, t.after.nrmse);
      tasks += 1.0;
    }
    chi += a.result.chi_square / persons;
    failed += a.estimate.judgement.parameters.grade == estimation::Grade::kNo ? 1 : 0;
    std::printf("seed %2d chi2 %.2f %.1f s%s\n", seed, a.result.chi_square, a.result.seconds, line.c_str());
    std::fflush(stdout);
  }
  std::printf(
      "identified %zu covered %zu at bound %zu refused %zu; NRMSE of unseen tasks %.4f -> %.4f, worst %.4f; "
      "chi2 %.2f\n",
      identified, covered, at_bound, failed, before / tasks, after / tasks, worst, chi);
  EXPECT_GE(identified, 60u);
  const double share = static_cast<double>(covered) / static_cast<double>(identified);
  EXPECT_GE(share, 0.90);
  EXPECT_LT(after, 0.7 * before);
}

}  // namespace
}  // namespace veridyn::muscle
