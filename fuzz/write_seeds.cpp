// fuzz_seeds FOLDER: writes FOLDER/<format>/small, a valid log of each format to start from.
#include <cstdio>
#include <filesystem>
#include <string>

#include "tests/support/small_logs.hpp"
#include "tests/support/synthetic_logs.hpp"
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
    const auto write = [&](const std::string& format, const std::string& bytes, const std::string& name = "small") {
      veridyn::make_folder(folder / format);
      veridyn::write_file(folder / format / name, bytes);
    };
    for (const veridyn::testing::SmallLog& log : veridyn::testing::small_logs()) {
      // The target of packets takes a first byte that says which.
      const std::string first(log.key == "packet" ? 1 : 0, '\0');
      write(std::string(log.key), first + log.bytes, std::string(log.name));
    }
    // As studies ask for tables: at a rate, with names for the columns, the second part (log_fuzz.cpp).
    write("mat", "\x05" + veridyn::testing::small_mat(), "rate");
    write("mat", "\x06" + veridyn::testing::small_mat(), "columns");
    std::string twice = "time,x\n";
    for (int i = 0; i < 24; ++i) twice += std::to_string(i % 12) + ",1\n";
    write("csv", "\x07" + twice, "part");
    // Layouts of others: metadata, names and units in comments, columns between bars.
    write("csv", "\"Product\",\"x\"\n\"acc\",2\nloopIteration,time,p\n0,1000,1\n1,2000,2\n2,3000,3\n", "metadata");
    write("csv", "#t\tV\n#double\tfloat\n#s\tkm/h\n0\t1\n1\t2\n", "comments");
    write("csv", "\n _totl,_time | __P,rad/s | \n 0.0 | 1.0 | \n 0.5 | 2.0 | \n", "bars");
    write("csv", "#a\n#hh:mm:ss, deg, G\n Time, Pitch, Az\n , 1, 1\n10:00:00, 1, 1\n10:00:01, 2, 1\n", "comment_units");
    write("csv", "\x08title\nremark\ntime,x\n0,1\n1,2\n", "skip_lines");
    write("csv_folder",
          "timestamp,q[0]\n1000000,1\n1020000,1\n" + std::string(1, '\0') + "timestamp,p\n1000000,7\n1200000,8\n");
    write("csv_folder", "\x02" + twice + '\0' + twice + '\0' + "time,x\n0,1\n1,2\n", "restart");
    write("unit_words", "degrees per sec^2");
    write("unit_words", "m/s\xC2\xB2", "utf8");
    write("number_table", "# of three runs\nrun,alpha[rad],CL,day\n1,0.1,0.4,Mon\n1,0.2,NaN,Mon\n2,-1e-1,,Tue\n");
    write("npy", veridyn::testing::small_npy());
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
