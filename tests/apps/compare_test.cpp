#include "tests/apps/program.hpp"

namespace veridyn {
namespace {

class Compare : public ProgramTest {};

TEST_F(Compare, PutsRunsSideBySide) {
  std::vector<std::string> runs;
  for (const int slope : {2, 2, 3}) {
    const std::string name = "run" + std::to_string(runs.size());
    std::string table = "z,x\n";
    for (int i = 0; i < 200; ++i) {
      const int noise = (i * 7919 + 13 * static_cast<int>(runs.size())) % 101 - 50;
      table +=
          std::to_string(slope * (i % 13)) + "." + std::to_string(50 + noise / 2) + "," + std::to_string(i % 13) + "\n";
    }
    write_file((folder_ / (name + ".csv")).string(), table);
    runs.push_back((folder_ / name).string());
    ASSERT_EQ(
        run("regress " + (folder_ / (name + ".csv")).string() + " --response z --quiet --out " + runs.back()).exit_code,
        0);
  }
  const std::string out = (folder_ / "compared").string();
  const Outcome outcome = run("compare " + runs[0] + " " + runs[1] + " " + runs[2] + "/estimate.json --out " + out);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, testing::HasSubstr("run0 and run1 agree"));
  EXPECT_THAT(outcome.text, testing::HasSubstr("run0 and run2 contradict each other"));
  EXPECT_THAT(read_file(out + "/comparison.csv"), testing::HasSubstr("parameter,unit,\"run0\""));
  EXPECT_TRUE(std::filesystem::exists(out + "/report.html"));
  EXPECT_EQ(run("compare " + runs[0] + " --out " + out).exit_code, 2);
}

}  // namespace
}  // namespace veridyn
