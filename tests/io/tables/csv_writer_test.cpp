#include <cmath>
#include <utility>
#include <vector>

#include "tests/io/support.hpp"
#include "veridyn/io/tables/csv.hpp"

namespace veridyn::io {
namespace {

TEST(Csv, WrittenRecordingsReadBackToTheSameDoubles) {
  testing::Dice dice(7);
  Recording recording;
  recording.source = "test";
  recording.frame = Frame::kFlu;
  std::vector<double> fast;
  std::vector<double> slow{0.0, 0.05, 0.05, 0.07};  // a doubled stamp, and one that the fast base lacks
  for (int i = 0; i < 100; ++i) fast.push_back(0.01 * i / 3.0);
  const TimeBase fast_base = make_time_base(fast);
  const TimeBase slow_base = make_time_base(slow);
  std::vector<double> values(fast.size());
  for (double& value : values)
    value = std::ldexp(static_cast<double>(dice.roll(1U << 30U)) / 3.0, static_cast<int>(dice.roll(200)) - 100);
  values[7] = std::nan("");
  recording.add(make_channel("IMU[1].AccX", "m/s^2", fast_base, values));
  recording.add(make_channel("a \"quoted\", name", "rad", slow_base, {1.0, 2.0, 3.0, 4.0}));
  recording.add(make_channel("control[0]", "1", slow_base, {5.0, 6.0, 7.0, 8.0}));

  const testing::TemporaryFolder folder;
  write_csv(recording, folder.path() / "out.csv");
  const Recording back = to_recording(read_csv_file(folder.path() / "out.csv"));
  EXPECT_EQ(back.frame, Frame::kFlu);
  EXPECT_EQ(back.names(), recording.names());
  for (const Channel& channel : recording.channels()) {
    const Channel& read_back = back.at(channel.name);
    EXPECT_EQ(read_back.unit.name, channel.unit.si_name());
    // Rows of the other base are empty cells; what is left must be the same numbers at the same stamps.
    std::vector<std::pair<double, double>> expected;
    std::vector<std::pair<double, double>> got;
    for (std::size_t i = 0; i < channel.size(); ++i) {
      if (std::isfinite(channel.value[i])) expected.emplace_back(channel.times()[i], channel.value[i]);
    }
    for (std::size_t i = 0; i < read_back.size(); ++i) {
      if (std::isfinite(read_back.value[i])) got.emplace_back(read_back.times()[i], read_back.value[i]);
    }
    EXPECT_EQ(got, expected) << channel.name;
  }
}

}  // namespace
}  // namespace veridyn::io
