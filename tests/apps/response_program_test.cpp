// veridyn sensitivity on studies of vehicles and aircraft, and profile likelihood of drives.
#include <nlohmann/json.hpp>

#include "tests/apps/program.hpp"
#include "tests/support/folders.hpp"

namespace veridyn {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class ResponseProgram : public ProgramTest {
 protected:
  static std::string example(const char* name) { return (test::source_folder() / "examples/studies" / name).string(); }
  static constexpr const char* kDrive =
      "[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n[drive]\nmodel = \"bicycle\"\n"
      "manoeuvre = \"step steer\"\nspeed = 20\nstep = 0.01\n[sensitivity]\nindex_samples = 16\n";
};

TEST_F(ResponseProgram, SaysWhatMovesADrive) {
  const std::string study = file("study.toml", kDrive);
  const Outcome done = run("sensitivity " + study + " --json --threads 2" + out());
  ASSERT_EQ(done.exit_code, 0) << done.text;
  EXPECT_THAT(results(), ElementsAre("indices.csv", "report.html", "run.json"));
  const auto summary = nlohmann::json::parse(done.text);
  EXPECT_EQ(summary["runs"], 16 * 7);
  EXPECT_EQ(summary["failed"], 0);
  EXPECT_EQ(summary["inputs"].size(), 5u);
  EXPECT_EQ(summary["inputs"][0]["unit"], "kg");
  EXPECT_GT(summary["indices"][0]["inputs"]["C_f"]["total"], 0.1);
  EXPECT_GT(summary["indices"][0]["sd"], 0.0);
  const std::string indices = read_file(in_out("indices.csv"));
  ASSERT_EQ(run("sensitivity " + study + " --threads 1" + out()).exit_code, 0);
  EXPECT_EQ(read_file(in_out("indices.csv")), indices);
  // The study is one of the other commands too.
  ASSERT_EQ(run("simulate " + study + out()).exit_code, 0);
}

TEST_F(ResponseProgram, GoesOnFromACheckpointAndSharesIt) {
  const std::string study = file("study.toml", kDrive);
  ASSERT_EQ(run("sensitivity " + study + out()).exit_code, 0);
  const std::string indices = read_file(in_out("indices.csv"));
  const std::string kept = " --checkpoint " + (folder_ / "kept").string();
  ASSERT_EQ(run("sensitivity " + study + kept + " --shard 1/2" + out()).exit_code, 0);
  const Outcome early = run("sensitivity " + study + kept + " --merge" + out());
  EXPECT_EQ(early.exit_code, 1);
  EXPECT_THAT(early.text, HasSubstr("blocks are missing"));
  ASSERT_EQ(run("sensitivity " + study + kept + " --shard 2/2" + out()).exit_code, 0);
  ASSERT_EQ(run("sensitivity " + study + kept + " --merge" + out()).exit_code, 0);
  EXPECT_EQ(read_file(in_out("indices.csv")), indices);
}

TEST_F(ResponseProgram, SaysWhatMovesAFlight) {
  const Outcome done = run("sensitivity " + example("flight_sensitivity.toml") +
                           " --json --set sensitivity.method=morris --set sensitivity.trajectories=2" + out());
  ASSERT_EQ(done.exit_code, 0) << done.text;
  EXPECT_THAT(results(), ElementsAre("indices.csv", "report.html", "run.json"));
  const auto summary = nlohmann::json::parse(done.text);
  EXPECT_EQ(summary["runs"], 2 * 10);
  EXPECT_EQ(summary["indices"][0]["result"], "5 s: 3211 elevator");
  EXPECT_GT(summary["indices"][0]["inputs"]["Cm_de"]["mu_star"], 0.0);
}

TEST_F(ResponseProgram, RefusesWhatItCannotUse) {
  const std::string study = file("study.toml", kDrive);
  const auto refused = [&](const std::string& key, const std::string& message) {
    expect_refusal("sensitivity " + study + " --set " + key + out(), message);
  };
  refused("sensitivity.index_samples=0", "study.toml:1: sensitivity.index_samples: = 0 must be from 2");
  refused("sensitivity.samples=4", "sensitivity.samples: is of muscles; here it is index_samples");
  refused("sensitivity.range=5", "sensitivity.range");
  refused("drive.manoeuver=sine", "did you mean 'manoeuvre'?");
  expect_refusal("sensitivity " +
                     file("input.toml", std::string(kDrive) + "[[sensitivity.input]]\nparameter = \"C_ff\"\n") + out(),
                 "input.toml:12: sensitivity.input");
  const std::string recorded = std::string(kDrive) + "[data]\nfile = \"drive.csv\"\n";
  expect_refusal("sensitivity " + file("recorded.toml", recorded) + out(),
                 "recorded.toml:11: data: names a recording, whose parameters cannot be varied: sensitivity is of what "
                 "[drive] simulates");
  expect_refusal(
      "sensitivity " + file("flight.toml", "[subject]\nbuiltin = \"unatrap\"\n[data]\nfile = \"x.bin\"\n") + out(),
      "sensitivity is of what [flight] simulates");
  expect_refusal(
      "identify " + file("flight2.toml", "[subject]\nbuiltin = \"unatrap\"\n[identify]\nprofiles = true\n") + out(),
      "flight2.toml:4: identify.profiles: is for studies of vehicles and muscles");
}

TEST_F(ResponseProgram, ProfilesADrive) {
  const Outcome done = run("identify " + example("vehicle/identify_sweep.toml") +
                           " --json --set drive.length=30 --set 'identify.profiles=[\"C_f\"]'" + out());
  ASSERT_EQ(done.exit_code, 0) << done.text;
  EXPECT_THAT(results(), testing::IsSupersetOf({"profiles.csv", "profile_intervals.csv"}));
  const auto summary = nlohmann::json::parse(done.text);
  EXPECT_EQ(summary["profiles"]["C_f"]["low_end"], "closed");
  EXPECT_LT(summary["profiles"]["C_f"]["low95"], 60000.0);
  EXPECT_GT(summary["profiles"]["C_f"]["high95"], 60000.0);
  EXPECT_THAT(read_file(in_out("report.html")), HasSubstr("Profile likelihood"));
}

}  // namespace
}  // namespace veridyn
