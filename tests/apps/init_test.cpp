// veridyn init: a study, whole or not at all.
#include <fmt/format.h>

#include <cmath>

#include "tests/apps/program.hpp"

namespace veridyn {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using Init = ProgramTest;

TEST_F(Init, WritesNothingButTheStudy) {
  ASSERT_EQ(run("init calibration" + out()).exit_code, 0);
  EXPECT_THAT(results(), ElementsAre("study.toml"));
}

TEST_F(Init, LeavesNothingWhereItCannotWrite) {
  file("x", "a file");
  for (const char* kind : {"aircraft", "vehicle", "muscle", "cueing", "swing-test", "calibration"}) {
    expect_refusal(std::string("init ") + kind + " --out " + (folder_ / "x" / "y").string(), "y: cannot be made");
    // A limit of size stands for the full disk.
    const Outcome full = run_in_shell("ulimit -f 1", std::string("init ") + kind + out() + "/deep");
    EXPECT_EQ(full.exit_code, 1) << full.text;
    EXPECT_THAT(full.text, HasSubstr("study.toml: cannot be written: File too large"));
    EXPECT_FALSE(fs::exists(folder_ / "out")) << kind;
  }
}

TEST_F(Init, MapsWhatItRecognisesInTheLog) {
  const std::string log =
      file("flight.txt", "clock p (deg/s) q V_mps odd\n0.0 1 0.1 20 5\n0.5 2 0.2 21 5\n1.0 3 0.1 22 6\n");
  expect_refusal("init aircraft --log " + log + out(),
                 "flight.txt:1: no time column found among clock, p, q, V_mps, odd");
  EXPECT_THAT(results(), IsEmpty());
  ASSERT_EQ(run("init aircraft --log " + log + " --set data.time.column=clock" + out()).exit_code, 0);
  const std::string study = read_file(in_out("study.toml"));
  EXPECT_THAT(study, HasSubstr("\ntime.column = \"clock\"\n"));
  EXPECT_THAT(study, HasSubstr("gyro_x <- p (2 Hz), by its name"));
  EXPECT_THAT(study, HasSubstr("\ngyro_y = { channel = \"q\", unit = \"?\" }"));
  EXPECT_THAT(study, HasSubstr("\n#   airspeed <- V_mps (2 Hz), by its name, in m/s: by the end of its name"));
  EXPECT_THAT(study, HasSubstr("# channels of the log that were not recognised: odd\n"));
  // A unit that is left open is asked for by its place.
  const std::string vehicle = " --set subject.builtin=thor";
  EXPECT_THAT(run("reconstruct " + in_out("study.toml").string() + vehicle + out()).text, HasSubstr("study.toml:"));
  EXPECT_EQ(run("init vehicle --log " + log + " --set data.time.colum=clock --force" + out()).exit_code, 2);
  EXPECT_EQ(run("init vehicle --log " + log + " --set data.time.column=clock --force" + out()).exit_code, 0);
  EXPECT_THAT(run("inspect " + log + " --set data.time.column=clock").text, HasSubstr("gyro_x             <- p"));
}

TEST_F(Init, SaysWhereItRecognisesNothing) {
  const std::string log = file("odd.csv", "time[s],odd[1]\n0.0,1\n0.5,2\n1.0,3\n");
  const Outcome made = run("init aircraft --log " + log + " --out " + (folder_ / "out").string());
  EXPECT_EQ(made.exit_code, 0);
  EXPECT_THAT(made.text, HasSubstr("odd.csv: no channel is known by its name; `veridyn inspect"));
}

TEST_F(Init, SaysWhichChannelContradictsTheOthers) {
  // Speed in km/h under the name of m/s; steady turns of a wheelbase of 2.6 m.
  std::string log = "time[s],steer[rad],speed[m/s],yaw_rate[rad/s],accel_y[m/s^2]\n";
  for (int k = 0; k < 6000; ++k) {
    const double t = 0.01 * k, v = 20.0, steer = 0.02 * std::sin(0.8 * t), r = v * steer / 2.6;
    log += fmt::format("{},{},{},{},{}\n", t, steer, 3.6 * v, r, v * r);
  }
  const Outcome made = run("init vehicle --log " + file("drive.csv", log) + out());
  ASSERT_EQ(made.exit_code, 0) << made.text;
  const std::string study = read_file(in_out("study.toml"));
  EXPECT_THAT(study, HasSubstr("speed"));
  EXPECT_THAT(study, HasSubstr("km/h"));
  EXPECT_THAT(study, HasSubstr("`veridyn inspect` has the figures"));
}

TEST_F(Init, KeepsTheStudyThatItCannotReplace) {
  file("study.toml", "mine");
  const std::string here = " --quiet --out " + folder_.string();
  EXPECT_EQ(run("init aircraft" + here).exit_code, 2);
  EXPECT_EQ(run_in_shell("ulimit -f 1", "init aircraft --force" + here).exit_code, 1);
  EXPECT_EQ(read_file(folder_ / "study.toml"), "mine");
  EXPECT_EQ(run("init aircraft --force" + here).exit_code, 0);
  EXPECT_THAT(read_file(folder_ / "study.toml"), HasSubstr("[subject]"));
}

}  // namespace
}  // namespace veridyn
