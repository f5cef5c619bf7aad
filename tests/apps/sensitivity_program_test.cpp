// veridyn sensitivity on studies of muscles.
#include <nlohmann/json.hpp>

#include "tests/apps/program.hpp"
#include "tests/support/folders.hpp"

namespace veridyn {
namespace {

using testing::HasSubstr;
using testing::Not;

class SensitivityProgram : public ProgramTest {
 protected:
  static std::string example() {
    return (test::source_folder() / "examples/studies/muscle/arm_sensitivity.toml").string();
  }
  static constexpr const char* kTasks =
      "[subject]\nmodel = \"arm\"\npaths = \"fitted\"\n[tasks]\nnumbers = [8, 33]\n[sensitivity]\nsamples = 2\n"
      "method = \"none\"\n";
};

TEST_F(SensitivityProgram, WritesItsResultsTheSameOnAnyNumberOfThreads) {
  const std::string three = "sensitivity " + example() + " --set tasks.numbers=[8,14,33]";
  const Outcome done = run(three + " --json --threads 2" + out());
  ASSERT_EQ(done.exit_code, 0) << done.text;
  EXPECT_THAT(results(),
              testing::ElementsAre("indices.csv", "report.html", "run.json", "sensitivity.csv", "tasks.csv"));
  const auto summary = nlohmann::json::parse(done.text);
  EXPECT_EQ(summary["chosen"]["tasks"].size(), 2u);
  EXPECT_EQ(summary["simulations"], 32 * 6 * 3);
  EXPECT_EQ(summary["tasks"].size(), 3u);
  EXPECT_GT(summary["tasks"][2]["mean_nrmse"]["triceps_long"], 0.01);
  const std::string table = read_file(in_out("sensitivity.csv")), indices = read_file(in_out("indices.csv"));
  ASSERT_EQ(run(three + " --threads 1" + out()).exit_code, 0);
  EXPECT_EQ(read_file(in_out("sensitivity.csv")), table);
  EXPECT_EQ(read_file(in_out("indices.csv")), indices);
  ASSERT_EQ(run(three + " --seed 2 --set sensitivity.method=none" + out()).exit_code, 0);
  EXPECT_NE(read_file(in_out("sensitivity.csv")), table);
  // Not asked for: what the run before wrote is gone.
  EXPECT_THAT(results(), Not(testing::Contains("indices.csv")));
}

TEST_F(SensitivityProgram, RefusesWhatItCannotUse) {
  const auto refused = [&](const std::string& key, const std::string& message) {
    expect_refusal("sensitivity " + file("study.toml", kTasks) + " --set " + key + out(), message);
  };
  refused("sensitivity.sample=4", "did you mean 'samples'?");
  refused("sensitivity.range=5", "sensitivity.range");
  refused("sensitivity.samples=0", "sensitivity.samples");
  refused("sensitivity.method=sobol", "variance");
  refused("sensitivity.levels=3", "must be even");
  refused("subject.paths=opensim", "take \"exact\" or \"fitted\"");
  refused("tasks.numbers=[43]", "43");
  expect_refusal("sensitivity " + file("empty.toml", "[subject]\nmodel = \"arm\"\n") + out(), "leave no task");
  expect_refusal("sensitivity " + file("swing.toml", "[swing_test]\nmass = 1\n") + out(),
                 "sensitivity is for aircraft, vehicles and musculoskeletal models");
}

TEST_F(SensitivityProgram, SaysWhyNoTaskCanBeChosen) {
  // 400 kg in the hand: reserves would hold them.
  const Outcome done = run("sensitivity " + file("study.toml", kTasks) + " --set tasks.load=400" + out());
  EXPECT_EQ(done.exit_code, 1) << done.text;
  EXPECT_THAT(done.text, HasSubstr("none of 2 tasks may be chosen"));
  EXPECT_THAT(read_file(in_out("tasks.csv")), HasSubstr("muscles cannot perform it: reserves add"));
}

TEST_F(SensitivityProgram, LeavesNothingWhenInterrupted) {
  const Outcome stopped = run_interrupted(
      "sensitivity " + example() + " --set sensitivity.samples=100000 --out " + (folder_ / "out").string(), folder_);
  EXPECT_EQ(stopped.exit_code, 1) << stopped.text;
  EXPECT_THAT(stopped.text, HasSubstr("interrupted"));
  EXPECT_TRUE(results().empty());
}

}  // namespace
}  // namespace veridyn
