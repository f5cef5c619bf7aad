#include "veridyn/io/tables/npy.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "tests/io/support.hpp"
#include "tests/support/folders.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/io/read.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::io {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::message_of;

/// A file as numpy.lib.format describes it.
std::string npy(const std::string& dictionary, const std::string& data, int version = 1) {
  const std::size_t length_bytes = version == 1 ? 2 : 4;
  std::string header = dictionary;
  while ((8 + length_bytes + header.size() + 1) % 64 != 0) header += ' ';
  header += '\n';
  std::string bytes = "\x93NUMPY";
  bytes += static_cast<char>(version);
  bytes += '\0';
  for (std::size_t k = 0; k < length_bytes; ++k) bytes += static_cast<char>(header.size() >> (8 * k) & 0xff);
  return bytes + header + data;
}

template <typename Stored>
std::string bytes_of(const std::vector<Stored>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Stored)};
}

template <typename Stored>
std::string array(const char* type, const std::vector<Stored>& values, const std::string& shape, bool fortran = false,
                  int version = 1) {
  return npy("{'descr': '" + std::string(type) + "', 'fortran_order': " + (fortran ? "True" : "False") +
                 ", 'shape': " + shape + ", }",
             bytes_of(values), version);
}

template <typename Stored>
void expect_reads(const char* type) {
  const NpyArray read = read_npy(array<Stored>(type, {1, 0, 3}, "(3,)"), "a.npy");
  ASSERT_EQ(read.columns.size(), 1U) << type;
  EXPECT_EQ(read.rows(), 3U);
  EXPECT_THAT(read.columns[0].numbers(), ElementsAre(1.0, 0.0, 3.0)) << type;
}

TEST(Npy, ReadsEveryTypeOfNumber) {
  expect_reads<double>("<f8");
  expect_reads<float>("<f4");
  expect_reads<std::int8_t>("|i1");
  expect_reads<std::uint8_t>("|u1");
  expect_reads<std::uint8_t>("|b1");
  expect_reads<std::int16_t>("<i2");
  expect_reads<std::uint16_t>("<u2");
  expect_reads<std::int32_t>("<i4");
  expect_reads<std::uint32_t>("<u4");
  expect_reads<std::int64_t>("<i8");
  expect_reads<std::uint64_t>("<u8");
  EXPECT_EQ(read_npy(array<std::int16_t>("<i2", {-2}, "(1,)"), "a").columns[0].number(0), -2.0);
}

TEST(Npy, ReadsBothOrdersOfAMatrixInEveryVersion) {
  for (const int version : {1, 2, 3}) {
    const NpyArray rows = read_npy(array<double>("<f8", {1, 2, 3, 4, 5, 6}, "(3, 2)", false, version), "a");
    EXPECT_THAT(rows.columns.at(0).numbers(), ElementsAre(1.0, 3.0, 5.0));
    EXPECT_THAT(rows.columns.at(1).numbers(), ElementsAre(2.0, 4.0, 6.0));
    const NpyArray columns = read_npy(array<double>("<f8", {1, 2, 3, 4, 5, 6}, "(3, 2)", true, version), "a");
    EXPECT_THAT(columns.columns.at(0).numbers(), ElementsAre(1.0, 2.0, 3.0));
    EXPECT_THAT(columns.columns.at(1).numbers(), ElementsAre(4.0, 5.0, 6.0));
  }
}

TEST(Npy, RefusesWhatItDoesNotReadByName) {
  const auto refusal = [](const std::string& bytes) { return message_of([&] { (void)read_npy(bytes, "a.npy"); }); };
  const std::vector<double> two{1.0, 2.0};
  EXPECT_THAT(refusal(""), HasSubstr("a.npy: is no NumPy array file"));
  EXPECT_THAT(refusal("\x93NUMPY"), HasSubstr("is cut"));
  EXPECT_THAT(refusal(array<double>(">f8", two, "(2,)")), HasSubstr("type '>f8' are not supported"));
  EXPECT_THAT(refusal(array<double>("|O", two, "(2,)")), HasSubstr("type '|O' are not supported"));
  EXPECT_THAT(refusal(array<double>("<c16", two, "(1,)")), HasSubstr("type '<c16'"));
  EXPECT_THAT(refusal(array<double>("<U4", two, "(1,)")), HasSubstr("type '<U4'"));
  EXPECT_THAT(refusal(array<double>("<f8", two, "()")), HasSubstr("has 0 dimensions"));
  EXPECT_THAT(refusal(array<double>("<f8", two, "(1, 2, 1)")), HasSubstr("has 3 dimensions"));
  EXPECT_THAT(refusal(array<double>("<f8", two, "(3,)")), HasSubstr("is cut: 2 numbers of 3 x 1"));
  EXPECT_THAT(refusal(array<double>("<f8", two, "(1,)")), HasSubstr("holds 8 bytes more"));
  // Extents whose product wraps around.
  EXPECT_THAT(refusal(array<double>("<f8", two, "(999999999999999, 999999999999999)")), HasSubstr("is cut"));
  EXPECT_THAT(refusal(array<double>("<f8", two, "(-1,)")), HasSubstr("an extent expected"));
  EXPECT_THAT(refusal(array<double>("<f8", two, "(99999999999999999999,)")), HasSubstr("NumPy header"));
  EXPECT_THAT(refusal(npy("{'descr': [('x', '<f8')], 'fortran_order': False, 'shape': (2,)}", "")),
              HasSubstr("records"));
  EXPECT_THAT(refusal(npy("{'descr': '<f8', 'shape': (2,)}", "")), HasSubstr("lacks"));
  EXPECT_THAT(refusal(npy("{'descr': '<f8', 'descr': '<f8', 'shape': (2,)}", "")), HasSubstr("there twice"));
  EXPECT_THAT(refusal(npy("{'descr': '<f8', 'fortran_order': 0, 'shape': (2,)}", "")), HasSubstr("True or False"));
  EXPECT_THAT(refusal(npy("__import__('os')", "")), HasSubstr("'{' expected"));
  EXPECT_THAT(refusal(array<double>("<f8", two, "(2,)", false, 9)), HasSubstr("version 9.0"));
}

TEST(Npy, TakesFilesThatAreCutOrDamagedAnywhere) {
  const auto takes = [](const std::string& bytes) {
    try {
      const NpyArray read = read_npy(std::string(bytes.data(), bytes.size()), "fuzz");
      for (const Column& column : read.columns) EXPECT_EQ(column.size(), read.rows());
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  };
  numerics::RandomStream random(9, "npy");
  const std::string whole = array<float>("<f4", {1, 2, 3, 4, 5, 6}, "(3, 2)", true, 2);
  for (std::size_t size = 0; size < whole.size(); ++size) takes(whole.substr(0, size));
  for (int n = 0; n < 10000; ++n) {
    std::string bytes = whole;
    for (std::uint64_t k = 0; k <= random.index(3); ++k)
      bytes[random.index(bytes.size())] = static_cast<char>(random.index(256));
    takes(bytes);
  }
}

class NpyFolder : public ::testing::Test {
 protected:
  void write(const std::string& path, const std::string& bytes) const {
    std::filesystem::create_directories((folder.path() / path).parent_path());
    write_file(folder.path() / path, bytes);
  }
  testing::TemporaryFolder folder;
};

TEST_F(NpyFolder, IsALogWithATimeBaseForEveryMessage) {
  write("log/CAN/speed/t.npy", array<double>("<f8", {0.0, 0.1, 0.2}, "(3,)"));
  write("log/CAN/speed/value.npy", array<float>("<f4", {5.0F, 6.0F, 7.0F}, "(3, 1)"));
  write("log/IMU/gyro/t.npy", array<double>("<f8", {0.0, 0.5}, "(2,)"));
  write("log/IMU/gyro/value.npy", array<double>("<f8", {1, 2, 3, 4, 5, 6}, "(2, 3)", true));
  write("pose/frame_times.npy", array<double>("<f8", {0.0, 1.0}, "(2,)"));
  write("pose/frame_positions.npy", array<double>("<f8", {1, 2, 3, 4}, "(2, 2)"));
  write("pose/other.npy", array<double>("<f8", {1}, "(1,)"));
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
  write("a/t.npy", array<double>("<f8", {0.0, 0.2, 0.1, std::nan(""), 0.3}, "(5,)"));
  write("a/value.npy", array<std::int32_t>("<i4", {10, 12, 11, 99, 13}, "(5,)"));
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
  write("a/t.npy", array<double>("<f8", {0.0, 0.1}, "(2,)"));
  write("a/value.npy", array<double>("<f8", {1.0}, "(1,)"));
  EXPECT_THAT(refusal(), HasSubstr("a/t.npy has 2 stamps for 1 rows"));
  write("a/value.npy", "\x93NUMPY broken");
  EXPECT_THAT(refusal(), HasSubstr("value.npy: NumPy format version"));
  write("a/value.npy", array<double>("<f8", {1.0, 2.0}, "(2,)"));
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
    squares += std::pow(std::sqrt(v) - speed.value[at(next)], 2);
  }
  EXPECT_LT(std::sqrt(squares / 24.0), 0.3);
}

}  // namespace
}  // namespace veridyn::io
