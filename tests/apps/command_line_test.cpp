// What is common to all commands: the command line, the version, what becomes of stdout, interruption.
#include <nlohmann/json.hpp>

#include "tests/apps/program.hpp"
#include "tests/support/folders.hpp"

namespace veridyn {
namespace {

using testing::HasSubstr;

using CommandLine = ProgramTest;

TEST_F(CommandLine, NamesTheNearestCommandForAMistypedOne) {
  expect_refusal("identfy study.toml" + out(),
                 "veridyn: identfy: there is no such command (did you mean 'identify'?)\n");
  expect_refusal("simulat study.toml" + out(), "(did you mean 'simulate'?)");
  expect_refusal("init aircaft" + out(), "veridyn: init aircaft: there is no such command (did you mean 'aircraft'?)");
  expect_refusal("reproduce limb" + out(),
                 "reproduce limb: there is no such command (known: aircraft, vehicle, muscle, cueing)");
  expect_refusal("--quiet identify study.toml" + out(), "--quiet: is no option here");
}

TEST_F(CommandLine, NamesAllCommandsWhereNoneIsGiven) {
  expect_refusal("", "veridyn: command line: a command is missing (known: demo, init, inspect, ");
  expect_refusal("reproduce", "veridyn: reproduce: a command is missing (known: aircraft, vehicle, muscle, cueing)");
}

TEST_F(CommandLine, RefusesWrongArgumentsInOneLine) {
  const std::string study = file("s.toml", "[subject]\nbuiltin = \"aerosonde\"\n");
  const auto refused = [&](const std::string& arguments, const std::string& message) {
    expect_refusal(arguments + out(), message);
    const std::string text = run(arguments + out()).text;
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
    EXPECT_TRUE(text.starts_with("veridyn: ")) << text;
    EXPECT_THAT(results(), testing::IsEmpty());
  };
  refused("export", "veridyn: export: STUDY is required (`veridyn export --help` says more)");
  refused("export " + study + " --threads -1", "--threads: is -1; must be a whole number from 0 to 1024");
  refused("export " + study + " --threads 1.5", "--threads: is 1.5; must be a whole number");
  refused("export " + study + " --seed -3", "--seed: is -3; must be a whole number from 0 to 9223372036854775807");
  refused("export " + study + " --seed 99999999999999999999", "--seed: is 99999999999999999999; must be");
  refused("export " + study + " --format xml", "--format: is 'xml'; must be one of all, json, toml, csv, jsbsim");
  refused("export " + study + " --fromat csv", "there is no option --fromat (did you mean '--format'?)");
  refused("export " + study + " " + study, "s.toml' is one argument too many");
  refused("track " + study + " --idle nan", "--idle: is nan; must be a number > 0");
  refused("track " + study + " --interval 0", "--interval: is 0; must be a number > 0");
  refused("init aircraft --log a b", "init aircraft: 'b' is one argument too many");
}

TEST_F(CommandLine, RefusesStudiesThatAreNone) {
  std::filesystem::create_directory(folder_ / "folder");
  const std::string binary = file("binary.toml", std::string("\x7f") + "ELF\0\1\xff\xfe");
  for (const char* command : {"simulate", "reconstruct", "identify", "track", "export"}) {
    const auto refused = [&](const std::string& study, const std::string& message) {
      expect_refusal(std::string(command) + " " + study + out(), message);
      EXPECT_FALSE(std::filesystem::exists(folder_ / "out")) << command;
    };
    refused(file("empty.toml", ""), "empty.toml:1: subject: is missing");
    refused((folder_ / "folder").string(), "folder: is a directory, expected a file");
    refused(binary, "binary.toml:1:");
    refused("''", "veridyn: file: its name is empty");
    refused((folder_ / "nothing" / "subject.toml").string(), "subject.toml: no such file");
    const std::string study = file("s.toml", "[subject]\nbuiltin = \"aerosonde\"\n[flight]\nairspeed = 20\n");
    refused(study + " --set flight.duration=nan", "flight.duration: is nan, expected a finite number [s]");
    refused(study + " --set flight..duration=5", "--set flight..duration=5: 'flight..duration' is not a key");
  }
}

TEST_F(CommandLine, EveryCommandPrintsAMachineReadableSummary) {
  const std::string examples = test::source_folder().string() + "/examples/studies/";
  const std::string flight = file(
      "flight.toml", "[subject]\nbuiltin = \"unatrap\"\n[flight]\nduration = 30\nairspeed = 20\nplan = \"none\"\n");
  const std::string drive =
      file("drive.toml",
           "[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n[drive]\nmodel = \"bicycle\"\n"
           "manoeuvre = \"step steer\"\namplitude = \"2 deg\"\nduration = 3\n[scale]\nlength_ratio = 0.2\n");
  for (const std::string& arguments :
       {"simulate " + flight, "reconstruct " + flight, "export " + flight, "track " + flight, "scale " + drive,
        "simulate " + drive, "identify " + examples + "calibration/study.toml", std::string("init vehicle"),
        std::string("inspect arm"), std::string("reproduce aircraft --only 01_")}) {
    const Outcome done = run(arguments + " --json" + out());
    EXPECT_EQ(done.exit_code, 0) << arguments << ": " << done.text;
    EXPECT_TRUE(nlohmann::json::accept(done.text)) << arguments << ": " << done.text;
  }
}

TEST_F(CommandLine, PrintsTheVersionOfTheProject) {
  const Outcome version = run("--version");
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_EQ(version.text, std::string(VERIDYN_VERSION) + "\n");
}

TEST_F(CommandLine, SaysWhenStdoutCannotBeWritten) {
  const std::string study = file("s.toml", "[subject]\nbuiltin = \"aerosonde\"\n");
  for (const std::string& arguments :
       {"export " + study + out() + " --json", std::string("inspect arm"), std::string("inspect arm --json"),
        std::string("inspect arm --pose \"elbow_flexion=90 deg\""), std::string("--help"), std::string("--version")}) {
    const Outcome full = run_in_shell("exec 3>&1", arguments + " 2>&3 >/dev/full");
    EXPECT_EQ(full.exit_code, 1) << arguments;
    EXPECT_THAT(full.text, HasSubstr("veridyn: stdout: cannot be written")) << arguments;
    EXPECT_EQ(std::count(full.text.begin(), full.text.end(), '\n'), 1) << full.text;
  }
  EXPECT_THAT(results(), testing::IsEmpty());
}

TEST_F(CommandLine, EveryCommandSaysThatItWasInterruptedAndWritesNothing) {
  const std::string flight =
      file("flight.toml", "[subject]\nbuiltin = \"unatrap\"\n[flight]\nduration = 3000\nairspeed = 20\n");
  const std::string drive =
      file("drive.toml",
           "[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n[drive]\n"
           "manoeuvre = \"step steer\"\namplitude = \"2 deg\"\nduration = 3000\n[scale]\nlength_ratio = 0.2\n");
  const std::string platform = file("platform.toml",
                                    "[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n[drive]\n"
                                    "manoeuvre = \"step steer\"\namplitude = \"2 deg\"\nduration = 3000\n"
                                    "[cue]\nalgorithms = [\"classical\"]\n");
  const std::string arm = file("arm.toml", "[subject]\nmodel = \"arm\"\n[motion]\nduration = 500\n");
  const std::string estimate =
      " --estimate-file " + file("estimate.json",
                                 "{\"subject\": \"x\", \"method\": \"OLS\", \"parameters\": [], "
                                 "\"covariance\": [], \"verdict\": \"\", \"warnings\": []}");
  const std::string to = " --out " + (folder_ / "out").string();
  for (const std::string& arguments :
       {"simulate " + flight, "reconstruct " + flight, "identify " + flight, "validate " + flight + estimate,
        "track " + flight, "simulate " + drive, "identify " + drive, "validate " + drive + estimate, "track " + drive,
        "scale " + drive, "cue " + platform, "simulate " + arm, std::string("demo --set flight.duration=3000"),
        std::string("reproduce aircraft")}) {
    const Outcome stopped = run_interrupted(arguments + to, folder_);
    EXPECT_EQ(stopped.exit_code, 1) << arguments << ": " << stopped.text;
    EXPECT_THAT(stopped.text, testing::EndsWith("veridyn: interrupted, nothing was written\n")) << arguments;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out")) << arguments;
  }
}

}  // namespace
}  // namespace veridyn
