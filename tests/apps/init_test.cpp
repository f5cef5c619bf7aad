// veridyn init: a study, whole or not at all.
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
