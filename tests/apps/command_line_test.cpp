// What is common to all commands: the command line, the version, what becomes of stdout, interruption.
#include "tests/apps/program.hpp"

namespace veridyn {
namespace {

using testing::HasSubstr;

using CommandLine = ProgramTest;

TEST_F(CommandLine, NamesTheNearestCommandForAMistypedOne) {
  expect_refusal("identfy study.toml" + out(),
                 "veridyn: identfy: there is no such command (did you mean 'identify'?)\n");
  expect_refusal("simulat study.toml" + out(), "(did you mean 'simulate'?)");
  expect_refusal("init aircaft" + out(), "veridyn: init aircaft: there is no such command (did you mean 'aircraft'?)");
  expect_refusal("reproduce muscle" + out(), "reproduce muscle: there is no such command (known: aircraft, vehicle)");
  expect_refusal("--quiet identify study.toml" + out(), "--quiet: is no option here");
}

TEST_F(CommandLine, NamesAllCommandsWhereNoneIsGiven) {
  expect_refusal("", "veridyn: command line: a command is missing (known: demo, init, inspect, ");
  expect_refusal("reproduce", "veridyn: reproduce: a command is missing (known: aircraft, vehicle)");
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
  const std::string arm = file("arm.toml", "[subject]\nmodel = \"arm\"\n[motion]\nduration = 500\n");
  const std::string estimate = " --estimate " + file("estimate.json",
                                                     "{\"subject\": \"x\", \"method\": \"OLS\", \"parameters\": [], "
                                                     "\"covariance\": [], \"verdict\": \"\", \"warnings\": []}");
  const std::string to = " --out " + (folder_ / "out").string();
  for (const std::string& arguments :
       {"simulate " + flight, "reconstruct " + flight, "identify " + flight, "validate " + flight + estimate,
        "track " + flight, "simulate " + drive, "identify " + drive, "validate " + drive + estimate, "track " + drive,
        "scale " + drive, "simulate " + arm, std::string("demo --set flight.duration=3000"),
        std::string("reproduce aircraft")}) {
    const Outcome stopped = run_interrupted(arguments + to, folder_);
    EXPECT_EQ(stopped.exit_code, 1) << arguments << ": " << stopped.text;
    EXPECT_THAT(stopped.text, testing::EndsWith("veridyn: interrupted, nothing was written\n")) << arguments;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out")) << arguments;
  }
}

}  // namespace
}  // namespace veridyn
