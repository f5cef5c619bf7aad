// Recordings of ROS as their users meet them.
#include <map>
#include <nlohmann/json.hpp>

#include "tests/apps/program.hpp"
#include "tests/support/drive_mcap.hpp"
#include "tests/support/folders.hpp"
#include "veridyn/io/read.hpp"

namespace veridyn {
namespace {

using ::testing::HasSubstr;

class RosProgram : public ProgramTest {};

struct Found {
  double value = 0.0, sigma = 0.0;
};
std::map<std::string, Found> estimates_in(const std::filesystem::path& folder) {
  std::map<std::string, Found> found;
  const auto estimate = nlohmann::json::parse(read_file(folder / "estimate.json"));
  for (const auto& p : estimate["parameters"]) found[p["name"]] = {p["value"], p["sigma"]};
  return found;
}

// The same drive by CSV and as the bag that a car with ROS 2 makes of it.
TEST_F(RosProgram, ABagGivesTheParametersOfItsDrive) {
  const std::string sweep = (test::source_folder() / "examples/studies/vehicle/identify_sweep.toml").string();
  ASSERT_EQ(run("identify " + sweep + " --set drive.length=40 --out " + (folder_ / "csv").string()).exit_code, 0);
  const std::filesystem::path bag = folder_ / "bag";
  make_folder(bag);
  write_file(bag / "drive_0.mcap", test::as_mcap(io::read_recording(folder_ / "csv" / "recording.csv")));
  write_file(bag / "metadata.yaml",
             "rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n    - drive_0.mcap\n");
  const std::filesystem::path study = folder_ / "study.toml";
  write_file(study, "[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n[data]\nfile = \"bag\"\n");
  const Outcome identified = run("identify " + study.string() + " --out " + (folder_ / "ros").string());
  ASSERT_EQ(identified.exit_code, 0) << identified.text;
  const auto csv = estimates_in(folder_ / "csv"), ros = estimates_in(folder_ / "ros");
  // Speed and steering are single precision there, and each search ends within some thousandths of a standard error.
  for (const char* name : {"C_f", "C_r", "I_z"})
    EXPECT_NEAR((ros.at(name).value - csv.at(name).value) / csv.at(name).sigma, 0.0, 0.02) << name;
  // run.json says by which files, as sha1sum counts them.
  const auto record = nlohmann::json::parse(read_file(folder_ / "ros" / "run.json"));
  const Outcome sum = run_in_shell(
      "cd " + bag.string() + " && sha1sum drive_0.mcap metadata.yaml | sed 's/  / /' | sha1sum", "--version");
  EXPECT_EQ(record["inputs"][0]["sha1"], sum.text.substr(0, 40));
}

TEST_F(RosProgram, InspectSaysWhatIsTakenAndWhatIsNot) {
  write_file(folder_ / "drive.mcap", test::small_drive_mcap());
  const Outcome seen = run("inspect " + (folder_ / "drive.mcap").string());
  EXPECT_EQ(seen.exit_code, 0);
  EXPECT_THAT(seen.text, HasSubstr("topics not decoded: note"));
  EXPECT_THAT(seen.text, HasSubstr("for a vehicle study (ROS log)"));
  EXPECT_THAT(seen.text, HasSubstr("<- imu/data.linear_acceleration.y"));
  write_file(folder_ / "cut.db3", "SQLite format 3");
  expect_refusal("inspect " + (folder_ / "cut.db3").string(), "cut.db3: is a damaged SQLite database");
}

}  // namespace
}  // namespace veridyn
