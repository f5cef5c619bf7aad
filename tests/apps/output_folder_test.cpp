// The folder of the results, --out, as all commands use it.
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/apps/program.hpp"
#include "tests/support/folders.hpp"

namespace veridyn {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class OutputFolder : public ProgramTest {
 protected:
  [[nodiscard]] std::string subject() const { return file("s.toml", "[subject]\nbuiltin = \"aerosonde\"\n"); }
  [[nodiscard]] nlohmann::json record() const { return nlohmann::json::parse(read_file(in_out("run.json"))); }
};

TEST_F(OutputFolder, IsCheckedBeforeAnyComputation) {
  const std::string examples = test::source_folder().string() + "/examples/studies/";
  const std::string flight =
      file("flight.toml", "[subject]\nbuiltin = \"unatrap\"\n[flight]\nduration = 3000\nairspeed = 20\n");
  const std::string drive =
      file("drive.toml",
           "[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n[drive]\n"
           "manoeuvre = \"step steer\"\namplitude = \"2 deg\"\nduration = 3000\n[scale]\nlength_ratio = 0.2\n");
  const std::string arm = file("arm.toml", "[subject]\nmodel = \"arm\"\n[motion]\nduration = 500\n");
  const std::string estimate = " --estimate-file missing.json";
  file("out", "a file stands in the way");
  for (const std::string& arguments :
       {"simulate " + flight, "reconstruct " + flight, "identify " + flight, "validate " + flight + estimate,
        "track " + flight, "export " + flight, "simulate " + drive, "identify " + drive, "validate " + drive + estimate,
        "track " + drive, "scale " + drive, "simulate " + arm, "identify " + examples + "swing_test/study.toml",
        "identify " + examples + "calibration/study.toml", std::string("reproduce vehicle"),
        std::string("inspect arm --pose \"elbow_flexion=90 deg\""), std::string("init muscle")}) {
    const auto begun = std::chrono::steady_clock::now();
    expect_refusal(arguments + out(), "out: is a file, expected a folder");
    EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(10)) << arguments;
  }
  EXPECT_EQ(read_file(folder_ / "out"), "a file stands in the way");
  expect_refusal("export " + subject() + " --out ''", "--out: is empty");
}

TEST_F(OutputFolder, ShowsNothingWhenTheDiskIsFull) {
  // A limit of 8 kB for a file stands for the full disk: the small files fit, the report does not.
  const std::string arm = file("arm.toml", "[subject]\nmodel = \"arm\"\n[motion]\nduration = 0.05\n");
  const Outcome full = run_in_shell("ulimit -f 16", "simulate " + arm + out() + "/deep/er");
  EXPECT_EQ(full.exit_code, 1) << full.text;
  EXPECT_THAT(full.text, HasSubstr("cannot be written: File too large"));
  EXPECT_THAT(full.text, HasSubstr("out/deep/er/"));
  EXPECT_THAT(full.text, Not(HasSubstr(".part")));
  EXPECT_EQ(std::count(full.text.begin(), full.text.end(), '\n'), 1) << full.text;
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(OutputFolder, KeepsTheEarlierResultsWhenAllCannotBeWritten) {
  const std::string arm = file("arm.toml", "[subject]\nmodel = \"arm\"\n[motion]\nduration = 0.05\n");
  ASSERT_EQ(run("simulate " + arm + out()).exit_code, 0);
  const std::string motion = read_file(in_out("motion.csv"));
  const auto before = results();
  EXPECT_EQ(run_in_shell("ulimit -f 16", "simulate " + arm + " --set motion.duration=0.01" + out()).exit_code, 1);
  EXPECT_EQ(read_file(in_out("motion.csv")), motion);
  EXPECT_EQ(results(), before);
  // A folder in the place of the last file: none of the others is replaced.
  fs::remove(in_out("report.html"));
  fs::create_directory(in_out("report.html"));
  const Outcome blocked = run("simulate " + arm + " --set motion.duration=0.01" + out());
  EXPECT_EQ(blocked.exit_code, 2);
  EXPECT_THAT(blocked.text, HasSubstr("report.html: cannot be written: it is a folder"));
  EXPECT_EQ(read_file(in_out("motion.csv")), motion);
}

TEST_F(OutputFolder, IsListedInTheRunRecord) {
  ASSERT_EQ(run("export " + subject() + " --format csv" + out()).exit_code, 0);
  EXPECT_EQ(record()["command"], "export");
  EXPECT_EQ(record()["files"], nlohmann::json({"model.csv", "run.json"}));
  EXPECT_THAT(results(), ElementsAre("model.csv", "run.json"));
}

TEST_F(OutputFolder, LosesWhatTheRunBeforeWroteAndThisOneDidNot) {
  ASSERT_EQ(run("export " + subject() + out()).exit_code, 0);
  EXPECT_THAT(results(), Contains("jsbsim.xml"));
  file("out/mine.csv", "mine");
  ASSERT_EQ(run("export " + subject() + " --format csv" + out()).exit_code, 0);
  EXPECT_THAT(results(), ElementsAre("mine.csv", "model.csv", "run.json"));
}

TEST_F(OutputFolder, KeepsAnInputThatTheRunBeforeWrote) {
  ASSERT_EQ(run("export " + subject() + out()).exit_code, 0);
  ASSERT_EQ(run("export " + in_out("subject.toml").string() + " --format csv" + out()).exit_code, 0);
  EXPECT_THAT(results(), ElementsAre("model.csv", "run.json", "subject.toml"));
}

TEST_F(OutputFolder, TakesTheKnownResultsOfAnEarlierVersionThatDidNotListThem) {
  fs::create_directories(folder_ / "out");
  for (const char* name : {"jsbsim.xml", "validation.csv", "recording.csv", "study.toml", "notes.txt"})
    file(std::string("out/") + name, "old");
  file("out/run.json", "{\"program\": \"veridyn\", \"verb\": \"identify\"}");
  ASSERT_EQ(run("export " + subject() + " --format csv" + out()).exit_code, 0);
  EXPECT_THAT(results(), ElementsAre("model.csv", "notes.txt", "run.json", "study.toml"));
}

TEST_F(OutputFolder, RemovesNothingThatIsNotAFileOfItsOwn) {
  const auto exported = [&](const std::string& run_json) {
    fs::create_directories(folder_ / "out" / "sub");
    file("elsewhere.txt", "x");
    file("out/sub/kept.txt", "x");
    file("out/study.toml", "x");
    file("out/jsbsim.xml", "x");
    file("out/run.json", run_json);
    EXPECT_EQ(run("export " + subject() + " --format csv" + out()).exit_code, 0);
    EXPECT_TRUE(fs::exists(folder_ / "elsewhere.txt"));
    EXPECT_TRUE(fs::exists(in_out("sub") / "kept.txt"));
    EXPECT_TRUE(fs::exists(in_out("study.toml")));
    EXPECT_TRUE(fs::exists(in_out("jsbsim.xml"))) << run_json;
  };
  exported(
      "{\"program\": \"veridyn\", \"command\": \"export\", \"files\": [\"../elsewhere.txt\", \"sub/kept.txt\", "
      "\"sub\", \"study.toml\", \"\", \".\", \"..\", 7]}");
  exported("{\"program\": \"another\", \"command\": \"export\", \"files\": [\"jsbsim.xml\"]}");
  exported("not JSON");
  exported("[]");
}

TEST_F(OutputFolder, IsNotMadeForARefusedStudy) {
  expect_refusal("identify " + file("w.toml", "[subject]\nbuiltin = \"nothing\"\n") + out(), "subject.builtin");
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

}  // namespace
}  // namespace veridyn
