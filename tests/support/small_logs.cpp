#include "tests/support/small_logs.hpp"

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include "tests/support/mat_object_writer.hpp"
#include "tests/support/ros_writer.hpp"
#include "tests/support/synthetic_logs.hpp"
#include "tests/support/tlog_writer.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn::testing {
namespace {

std::string small_bag_database() {
  std::string folder = (std::filesystem::temp_directory_path() / "veridyn_small_logs_XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) throw std::runtime_error("temporary folder " + folder);
  const std::filesystem::path path = std::filesystem::path(folder) / "small.db3";
  write_bag_database(
      path, {{1, "/imu", "sensor_msgs/msg/Imu"}, {2, "/own", "a/msg/Own", "int8[] a\nstring[2] name\nfloat32[] b\n"}},
      {{1, 5, imu_message(5, 0.1, {1, 2, 3}, {4, 5, 6})},
       {2, 6, MessageWriter().number(std::uint32_t{1}).number('a').text("x").text("y").sequence({}).bytes()}});
  std::string bytes = read_file(path);
  std::filesystem::remove_all(folder);
  return bytes;
}

std::string small_storage() {
  return "Coordinates\nversion=1\nnRows=2\nnColumns=3\ninDegrees=yes\nendheader\ntime\tshoulder\telbow\n"
         "0.0\t1.5\t-2e1\n0.1\t3\t+4\n";
}

/// One stored member, its checksum left out: the reader goes as far as that.
std::string small_npz() {
  std::string zip("PK\x03\x04\x14\0\0\0\0\0\0\0\0\0\0\0\0\0", 18);
  const std::string sizes("\x58\0\0\0\x58\0\0\0", 8);
  zip += sizes + std::string("\x05\0\0\0", 4) + "t.npy" + small_npy();
  zip += std::string("PK\x01\x02\x14\0\x14\0\0\0\0\0\0\0\0\0\0\0\0\0", 20) + sizes +
         std::string("\x05\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0", 18) + "t.npy";
  return zip + std::string("PK\x05\x06\0\0\0\0\x01\0\x01\0", 12) + std::string("\x33\0\0\0\x7b\0\0\0\0\0", 10);
}

std::string timetable() {
  MatObjectWriter objects;
  const std::string times = mat_duration(objects, {500, 520, 540});
  return timetable_mat(times, objects);
}

/// OutSim, the first known packet: twelve of them, a second apart, standing.
std::string small_packets() {
  std::string packets;
  for (int k = 1; k <= 12; ++k) packets += std::string({'\0', static_cast<char>(k)}) + std::string(62, '\0');
  return packets;
}

/// A clock that restarts.
std::string restarted_csv() {
  std::string twice = "time,x\n";
  for (int i = 0; i < 24; ++i) twice += std::to_string(i % 12) + ",1\n";
  return twice;
}

}  // namespace

std::string small_npy() {
  std::string array("\x93NUMPY\x01\0\x46\0", 10);
  array += "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 1), }";
  array.resize(80, ' ');
  return array + std::string("\x00\x00\xc0\x3f\x00\x00\x00\xc0", 8);
}

std::vector<SmallLog> small_logs() {
  using enum DamageLaw;
  return {{"dataflash", small_dataflash(), kCounts},
          {"dataflash_text", small_dataflash_text(), kCounts},
          {"ulog", small_ulog(), kCounts},
          {"tlog", small_tlog(), kOwnTests},
          {"mcap", tiny_mcap(), kCounts},
          {"bag_database", small_bag_database(), kOwnTests},
          {"mat", small_mat(), kCounts},
          {"storage", small_storage(), kOwnTests},
          {"npz", small_npz(), kOwnTests},
          {"packet", small_packets(), kOwnTests},
          {"csv", small_csv(), kRefuses},
          {"mcap", small_mcap().substr(0, 30'000), kOwnTests, "cut"},
          {"mat", timetable(), kOwnTests, "timetable"},
          {"csv", "# t p (deg/s) V\n0 1 20\n20\t2 21\n40 3 22\n", kOwnTests, "blanks"},
          {"csv", "Zeit;V;V\ns;km/h;\n0,0;1,5;2\n0,1;2,5;3\n", kOwnTests, "decimal_comma"},
          {"csv", "time,x\n2024-05-03T23:59:59.5+02:00,1\n2024-05-03T22:00:00Z,2\n", kOwnTests, "zones"},
          {"csv", "time,x\n23:59:59.5,1\n00:00:00.5,2\n", kOwnTests, "midnight"},
          {"csv", "time,x\n0.0 sec,1\n0.1 sec,2\n", kOwnTests, "durations"},
          {"csv", restarted_csv(), kOwnTests, "restart"}};
}

}  // namespace veridyn::testing
