// Hello, my data: what does a log hold?
//
//   example_01_read_a_log [FILE]      ArduPilot .bin or .log, PX4 .ulg, MATLAB .mat, CSV
//
// Without a file it writes a small one first, 01_read_a_log.csv, and reads that.
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "veridyn/io.hpp"

namespace {

// A recording has channels; each has a unit and a time base, which channels that were measured together share.
std::filesystem::path write_small_recording() {
  using namespace veridyn;
  std::vector<double> time, rate, deflection;
  for (int k = 0; k < 500; ++k) {
    time.push_back(0.01 * k);
    rate.push_back(0.2 * std::sin(3.0 * time.back()));
    deflection.push_back(0.05 * std::cos(3.0 * time.back()));
  }
  const TimeBase stamps = make_time_base(time);
  Recording recording;
  recording.frame = Frame::kFrd;
  recording.add(make_channel("gyro_y", "rad/s", stamps, rate));
  recording.add(make_channel("elevator", "rad", stamps, deflection));
  const std::filesystem::path path = "01_read_a_log.csv";
  io::write_csv(recording, path);
  return path;
}

}  // namespace

int main(int argc, char** argv) try {
  const std::filesystem::path path = argc > 1 ? std::filesystem::path(argv[1]) : write_small_recording();
  // The content decides about the format. Whatever the log's units are, values come in SI and radians.
  const veridyn::Recording recording = veridyn::io::read_recording(path);

  const veridyn::TimeSpan span = recording.span();
  std::printf("%s: %zu channels, %.2f s to %.2f s\n", path.string().c_str(), recording.channels().size(), span.begin,
              span.end);
  for (const veridyn::Channel& channel : recording.channels()) {
    std::printf("  %-24s [%-6s] %7zu samples, %8.2f Hz, %zu gaps\n", channel.name.c_str(), channel.unit.name.c_str(),
                channel.size(), channel.rate_Hz(), channel.gaps().size());
  }
  for (const std::string& warning : recording.warnings) std::printf("  note: %s\n", warning.c_str());
  return recording.channels().empty() ? 1 : 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
