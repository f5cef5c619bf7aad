#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>

#include "tests/io/support.hpp"
#include "tests/io/tables/npy_bytes.hpp"
#include "tests/support/folders.hpp"
#include "veridyn/io/read.hpp"
#include "veridyn/io/tables/npy.hpp"

namespace veridyn::io {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::message_of;
using testing::npy_array;

class NpyFolder : public ::testing::Test {
 protected:
  void write(const std::string& path, const std::string& bytes) const {
    std::filesystem::create_directories((folder.path() / path).parent_path());
    write_file(folder.path() / path, bytes);
  }
  testing::TemporaryFolder folder;
};

TEST_F(NpyFolder, IsALogWithATimeBaseForEveryMessage) {
  write("log/CAN/speed/t.npy", npy_array<double>("<f8", {0.0, 0.1, 0.2}, "(3,)"));
  write("log/CAN/speed/value.npy", npy_array<float>("<f4", {5.0F, 6.0F, 7.0F}, "(3, 1)"));
  write("log/IMU/gyro/t.npy", npy_array<double>("<f8", {0.0, 0.5}, "(2,)"));
  write("log/IMU/gyro/value.npy", npy_array<double>("<f8", {1, 2, 3, 4, 5, 6}, "(2, 3)", true));
  write("pose/frame_times.npy", npy_array<double>("<f8", {0.0, 1.0}, "(2,)"));
  write("pose/frame_positions.npy", npy_array<double>("<f8", {1, 2, 3, 4}, "(2, 2)"));
  write("pose/other.npy", npy_array<double>("<f8", {1}, "(1,)"));
  write("notes.txt", "not an array");
  const Recording recording = read_recording(folder.path());
  EXPECT_THAT(recording.names(),
              ::testing::UnorderedElementsAre("CAN.speed", "IMU.gyro[0]", "IMU.gyro[1]", "IMU.gyro[2]",
                                              "pose.frame_positions[0]", "pose.frame_positions[1]"));
  EXPECT_THAT(recording.at("CAN.speed").value, ElementsAre(5.0, 6.0, 7.0));
  EXPECT_THAT(*recording.at("CAN.speed").time, ElementsAre(0.0, 0.1, 0.2));
  EXPECT_THAT(recording.at("IMU.gyro[1]").value, ElementsAre(3.0, 4.0));
  EXPECT_THAT(recording.at("pose.frame_positions[1]").value, ElementsAre(2.0, 4.0));
  EXPECT_THAT(recording.warnings, Contains(HasSubstr("1 arrays without stamps were left out: pose/other.npy")));
}

TEST_F(NpyFolder, PutsStampsIntoOrder) {
  write("a/t.npy", npy_array<double>("<f8", {0.0, 0.2, 0.1, std::nan(""), 0.3}, "(5,)"));
  write("a/value.npy", npy_array<std::int32_t>("<i4", {10, 12, 11, 99, 13}, "(5,)"));
  const Log log = read_npy_folder(folder.path());
  ASSERT_EQ(log.topics.size(), 1U);
  EXPECT_EQ(log.topics[0].reordered, 1U);
  EXPECT_EQ(log.topics[0].spikes, 1U);
  const Recording recording = to_recording(log);
  EXPECT_THAT(recording.at("a").value, ElementsAre(10.0, 11.0, 12.0, 13.0));
}

TEST_F(NpyFolder, RefusesArraysThatDoNotBelongTogether) {
  const auto refusal = [&] { return message_of([&] { (void)read_npy_folder(folder.path()); }); };
  EXPECT_THAT(refusal(), HasSubstr("is a directory without NumPy arrays"));
  write("a/t.npy", npy_array<double>("<f8", {0.0, 0.1}, "(2,)"));
  write("a/value.npy", npy_array<double>("<f8", {1.0}, "(1,)"));
  EXPECT_THAT(refusal(), HasSubstr("a/t.npy has 2 stamps for 1 rows"));
  write("a/value.npy", "\x93NUMPY broken");
  EXPECT_THAT(refusal(), HasSubstr("value.npy: NumPy format version"));
  write("a/value.npy", npy_array<double>("<f8", {1.0, 2.0}, "(2,)"));
  EXPECT_THAT(message_of([&] { (void)read_log(folder.path() / "a/value.npy"); }), HasSubstr("give the folder"));
}

TEST(RealNpy, ADriveOfOthersIsRead) {
  const std::filesystem::path log = test::shared_folder() / "data/vehicle/comma2k19_example";
  VERIDYN_NEEDS_SHARED(log);
  const Recording recording = read_recording(log);
  EXPECT_EQ(recording.channels().size(), 48U);
  EXPECT_EQ(recording.at("CAN.speed").size(), 4974U);
  EXPECT_EQ(recording.at("IMU.gyro[2]").size(), 6256U);
  // NumPy's own files, in both orders. The car's speed against that of its pose: the same drive on the same clock.
  const Channel& speed = recording.at("CAN.speed");
  double squares = 0.0;
  const Channel& vx = recording.at("global_pose.frame_velocities[0]");
  for (std::size_t i = 0; i < vx.size(); i += 50) {
    double v = 0.0;
    for (const char* axis : {"[0]", "[1]", "[2]"})
      v += std::pow(recording.at("global_pose.frame_velocities" + std::string(axis)).value[i], 2);
    const auto times = speed.times();
    const auto next = std::lower_bound(times.begin(), times.end(), vx.times()[i]) - times.begin();
    squares += std::pow(std::sqrt(v) - speed.value[next], 2);
  }
  EXPECT_LT(std::sqrt(squares / 24.0), 0.3);
}

}  // namespace
}  // namespace veridyn::io
