// fuzz_seeds FOLDER: writes FOLDER/<format>/small, a valid log of each format to start from.
#include <cstdio>
#include <filesystem>
#include <string>

#include "tests/support/mat_object_writer.hpp"
#include "tests/support/ros_writer.hpp"
#include "tests/support/synthetic_logs.hpp"
#include "tests/support/tlog_writer.hpp"
#include "tests/vehicle/tyre/small_tir.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/io/packets/known_packets.hpp"
#include "veridyn/live/recording/live_file.hpp"

int main(int count, char** arguments) {
  if (count != 2) {
    std::fprintf(stderr, "usage: fuzz_seeds FOLDER\n");
    return 2;
  }
  try {
    const std::filesystem::path folder = arguments[1];
    const auto write = [&](const char* format, const std::string& bytes, const char* name = "small") {
      veridyn::make_folder(folder / format);
      veridyn::write_file(folder / format / name, bytes);
    };
    write("dataflash", veridyn::testing::small_dataflash());
    write("dataflash_text", veridyn::testing::small_dataflash_text());
    write("ulog", veridyn::testing::small_ulog());
    write("tlog", veridyn::testing::small_tlog());
    write("mcap", veridyn::testing::tiny_mcap());
    write("mcap", veridyn::testing::small_mcap().substr(0, 30'000), "cut");
    veridyn::make_folder(folder / "bag_database");
    veridyn::testing::write_bag_database(
        folder / "bag_database" / "small",
        {{1, "/imu", "sensor_msgs/msg/Imu"}, {2, "/own", "a/msg/Own", "int8[] a\nstring[2] name\nfloat32[] b\n"}},
        {{1, 5, veridyn::testing::imu_message(5, 0.1, {1, 2, 3}, {4, 5, 6})},
         {2, 6,
          veridyn::testing::MessageWriter()
              .number(std::uint32_t{1})
              .number('a')
              .text("x")
              .text("y")
              .sequence({})
              .bytes()}});
    write("csv", veridyn::testing::small_csv());
    write("csv", "# t p (deg/s) V\n0 1 20\n20\t2 21\n40 3 22\n", "blanks");
    write("csv", "Zeit;V;V\ns;km/h;\n0,0;1,5;2\n0,1;2,5;3\n", "decimal_comma");
    write("csv", "time,x\n2024-05-03T23:59:59.5+02:00,1\n2024-05-03T22:00:00Z,2\n", "zones");
    write("csv", "time,x\n23:59:59.5,1\n00:00:00.5,2\n", "midnight");
    write("csv", "time,x\n0.0 sec,1\n0.1 sec,2\n", "durations");
    std::string twice = "\x07time,x\n";
    for (int i = 0; i < 24; ++i) twice += std::to_string(i % 12) + ",1\n";
    write("csv", twice, "restart");
    write("csv_folder",
          "timestamp,q[0]\n1000000,1\n1020000,1\n" + std::string(1, '\0') + "timestamp,p\n1000000,7\n1200000,8\n");
    write("csv_folder", "\x02" + twice.substr(1) + '\0' + twice.substr(1) + '\0' + "time,x\n0,1\n1,2\n", "restart");
    write("unit_words", "degrees per sec^2");
    write("unit_words", "m/s\xC2\xB2", "utf8");
    write("number_table", "# of three runs\nrun,alpha[rad],CL,day\n1,0.1,0.4,Mon\n1,0.2,NaN,Mon\n2,-1e-1,,Tue\n");
    write("mat", veridyn::testing::small_mat());
    veridyn::testing::MatObjectWriter objects;
    const std::string times = veridyn::testing::mat_duration(objects, {500, 520, 540});
    write("mat", veridyn::testing::timetable_mat(times, objects), "timetable");
    write("storage",
          "Coordinates\nversion=1\nnRows=2\nnColumns=3\ninDegrees=yes\nendheader\ntime\tshoulder\telbow\n0.0\t1.5\t-"
          "2e1\n0.1\t3\t+4\n");
    std::string array = std::string("\x93NUMPY\x01\0\x46\0", 10);
    array += "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 1), }";
    array.resize(80, ' ');
    array += std::string("\x00\x00\xc0\x3f\x00\x00\x00\xc0", 8);
    write("npy", array);
    // One stored member, its checksum left out: the reader goes as far as that.
    std::string zip("PK\x03\x04\x14\0\0\0\0\0\0\0\0\0\0\0\0\0", 18), sizes = std::string("\x58\0\0\0\x58\0\0\0", 8);
    const std::string name = std::string("\x05\0\0\0", 4) + "t.npy";
    zip += sizes + name + array;
    const std::string directory = std::string("PK\x01\x02\x14\0\x14\0\0\0\0\0\0\0\0\0\0\0\0\0", 20) + sizes +
                                  std::string("\x05\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0", 18) + "t.npy";
    zip += directory + std::string("PK\x05\x06\0\0\0\0\x01\0\x01\0", 12) + std::string("\x33\0\0\0\x7b\0\0\0\0\0", 10);
    write("npz", zip);
    // OutSim, the first known packet: twelve of them, a second apart, standing.
    std::string packets(1, '\0');
    for (int k = 1; k <= 12; ++k) packets += std::string({'\0', static_cast<char>(k)}) + std::string(62, '\0');
    write("packet", packets);
    // Twelve packets of a car that stands, as a socket gives them.
    const veridyn::io::PacketLayout& motion = veridyn::io::known_packet("veridyn");
    std::vector<double> values(motion.fields.size(), 0.0);
    std::string packet(motion.size, '\0'), datagrams;
    for (int k = 0; k < 12; ++k) {
      values[motion.find("time")] = 1.0 + 0.01 * k;
      values[motion.find("accel_z")] = 9.8;
      veridyn::io::encode(motion, values, packet);
      datagrams += static_cast<char>(packet.size());
      datagrams += packet;
    }
    write("telemetry", datagrams);
    veridyn::live::LiveRecord step;
    step.order = "order";
    std::string records(veridyn::live::kLargestRecord, '\0');
    records.resize(veridyn::live::encode(step, records));
    write("live_file",
          veridyn::live::framed(veridyn::live::encode(veridyn::live::LiveHead{})) + veridyn::live::framed(records));
    // The frame that docs/teleoperation.md gives, in chunks of eight bytes.
    write("teleoperation", std::string("\x07\x06\x01\x02\x03\x04\x05\x01\x01\x03\x02\xaa\x05\x84\x23\x6f\x16\0", 18));
    // A steering axis at its left end, then the report.
    write("wheel", std::string("\x01\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x03\0\0\0\x01\0\0\0", 24) +
                       std::string("\x01\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0", 24));
    // Points of a track, and a pose: the first byte says which.
    write("camera", std::string(1, '\0') +
                        "world_x[m];world_y;image_x;image_y;\n0;0;1;400;\n1;0;400;401;\n1;1;402;2;\n0;1;3;1;\n");
    write("tir", veridyn::vehicle::testing::small_tir());
    const std::string road =
        "$ROAD_CRG\nREFERENCE_LINE_INCREMENT = 2.0\nLONG_SECTION_V_RIGHT = -1\nLONG_SECTION_V_INCREMENT = 2\n$\n";
    write("crg", road +
                     "$KD_Definition\n#:LRFI\nD:long section 1,m\nD:long section 2,m\n$\n$$$$\n 0.0000000 0.1000000\n"
                     " 0.2000000-1.0000000\n");
  } catch (const veridyn::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
