// How fast logs are read, in bytes of the file per second, on one core, every column decoded; alongside, the same bytes
// copied once with memcpy, which no reader can beat.
#include <benchmark/benchmark.h>

#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/ros_writer.hpp"
#include "tests/support/synthetic_logs.hpp"
#include "veridyn/io/dataflash/dataflash.hpp"
#include "veridyn/io/ros/bag_database.hpp"
#include "veridyn/io/ros/mcap.hpp"
#include "veridyn/io/tables/csv.hpp"
#include "veridyn/io/ulog/ulog.hpp"

namespace {

using veridyn::io::Log;

constexpr double kMegabytes = 100.0;

const std::string& dataflash() {
  static const std::string bytes = veridyn::testing::synthetic_dataflash(kMegabytes);
  return bytes;
}

const std::string& ulog() {
  static const std::string bytes = veridyn::testing::synthetic_ulog(kMegabytes);
  return bytes;
}

const std::string& csv() {
  static const std::string bytes = [] {
    std::string text = "time[s],p[rad/s],q[rad/s],r[rad/s],ax[m/s^2],ay[m/s^2],az[m/s^2],airspeed[m/s]\n";
    for (int i = 0; text.size() < static_cast<std::size_t>(kMegabytes * 1e6); ++i) {
      text += std::to_string(0.01 * i);
      for (int k = 0; k < 7; ++k) text += ',' + std::to_string(1e-3 * ((i * 37 + k * 11) % 20011) - 10.0);
      text += '\n';
    }
    return text;
  }();
  return bytes;
}

void count(benchmark::State& state, const std::string& bytes) {
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) * static_cast<std::int64_t>(bytes.size()));
}

void copy_once(benchmark::State& state, const std::string& bytes) {
  std::vector<char> target(bytes.size());
  for (auto _ : state) {
    std::memcpy(target.data(), bytes.data(), bytes.size());
    benchmark::ClobberMemory();
  }
  count(state, bytes);
}

void CopyDataFlash(benchmark::State& state) { copy_once(state, dataflash()); }
void CopyULog(benchmark::State& state) { copy_once(state, ulog()); }

void ReadDataFlash(benchmark::State& state) {
  const std::string& bytes = dataflash();
  for (auto _ : state) benchmark::DoNotOptimize(veridyn::io::read_dataflash(bytes, "bench"));
  count(state, bytes);
}

void ReadULog(benchmark::State& state) {
  const std::string& bytes = ulog();
  for (auto _ : state) benchmark::DoNotOptimize(veridyn::io::read_ulog(bytes, "bench"));
  count(state, bytes);
}

/// Bytes of the messages per second, whatever the file takes.
void read_mcap_by(benchmark::State& state, const char* compression) {
  const std::string plain = veridyn::testing::synthetic_mcap(kMegabytes, "");
  const std::string bytes = veridyn::testing::synthetic_mcap(kMegabytes, compression);
  for (auto _ : state) benchmark::DoNotOptimize(veridyn::io::read_mcap(bytes, "bench"));
  count(state, plain);
}

void ReadMcap(benchmark::State& state) { read_mcap_by(state, ""); }
void ReadMcapLz4(benchmark::State& state) { read_mcap_by(state, "lz4"); }
void ReadMcapZstd(benchmark::State& state) { read_mcap_by(state, "zstd"); }

/// From a file, of which the pages lie in memory already.
void ReadBagDatabase(benchmark::State& state) {
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "veridyn_read_bench.db3";
  std::vector<veridyn::testing::BagMessage> messages;
  for (int i = 0; i < 300'000; ++i)
    messages.push_back({1, 5'000'000LL * i, veridyn::testing::imu_message(5'000'000LL * i, 0.1, {1, 2, 3}, {4, 5, 6})});
  veridyn::testing::write_bag_database(path, {{1, "/imu", "sensor_msgs/msg/Imu"}}, messages);
  messages.clear();
  for (auto _ : state) benchmark::DoNotOptimize(veridyn::io::read_bag_database(path));
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) *
                          static_cast<std::int64_t>(std::filesystem::file_size(path)));
  std::filesystem::remove(path);
}

void ReadCsv(benchmark::State& state) {
  const std::string& bytes = csv();
  for (auto _ : state) benchmark::DoNotOptimize(veridyn::io::read_csv(bytes, "bench"));
  count(state, bytes);
}

/// With the conversion of every column to doubles in SI.
void DataFlashToRecording(benchmark::State& state) {
  const std::string& bytes = dataflash();
  for (auto _ : state) benchmark::DoNotOptimize(to_recording(veridyn::io::read_dataflash(bytes, "bench")));
  count(state, bytes);
}

BENCHMARK(CopyDataFlash)->Unit(benchmark::kMillisecond);
BENCHMARK(ReadDataFlash)->Unit(benchmark::kMillisecond);
BENCHMARK(DataFlashToRecording)->Unit(benchmark::kMillisecond);
BENCHMARK(CopyULog)->Unit(benchmark::kMillisecond);
BENCHMARK(ReadULog)->Unit(benchmark::kMillisecond);
BENCHMARK(ReadMcap)->Unit(benchmark::kMillisecond);
BENCHMARK(ReadMcapLz4)->Unit(benchmark::kMillisecond);
BENCHMARK(ReadMcapZstd)->Unit(benchmark::kMillisecond);
BENCHMARK(ReadBagDatabase)->Unit(benchmark::kMillisecond);
BENCHMARK(ReadCsv)->Unit(benchmark::kMillisecond);

}  // namespace
