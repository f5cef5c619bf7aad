#include "veridyn/live/virtual/noisy_line.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace veridyn::live {
namespace {

TEST(NoisyLine, TakesTenBitsAByte) {
  NoisyLine line(0.0, 1, 100'000);
  const std::vector<std::uint8_t> bytes = {1, 2, 3};
  line.send(bytes, kSecond);
  EXPECT_EQ(line.last_arrival(), kSecond + 300'000);
  EXPECT_TRUE(line.arrived(kSecond + 99'999).empty());
  EXPECT_EQ(line.arrived(kSecond + 200'000), (std::vector<std::uint8_t>{1, 2}));
  line.send(bytes, kSecond + 250'000);  // waits for the byte before
  EXPECT_EQ(line.last_arrival(), kSecond + 600'000);
  line.cut = true;
  line.send(bytes, kSecond + 700'000);
  EXPECT_EQ(line.arrived(2 * kSecond).size(), 4U);
  EXPECT_FALSE(line.last_arrival());
}

TEST(NoisyLine, FlipsTheShareThatIsSaid) {
  NoisyLine line(0.01, 1);
  constexpr std::size_t kBytes = 100'000;
  line.send(std::vector<std::uint8_t>(kBytes, 7), 0);
  const std::vector<std::uint8_t> arrived = line.arrived(100 * kSecond);
  const auto flipped = std::count_if(arrived.begin(), arrived.end(), [](std::uint8_t b) { return b != 7; });
  // Binomial: 1000 +- 31.5; four times of that.
  EXPECT_NEAR(static_cast<double>(flipped), 1000.0, 4.0 * std::sqrt(990.0));
}

}  // namespace
}  // namespace veridyn::live
