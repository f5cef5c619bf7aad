#include "veridyn/io/ros/message_clock.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace veridyn::io::internal {
namespace {

constexpr Nanoseconds kMs = 1'000'000, kS = 1000 * kMs;

TEST(MessageTimes, AreTheStampsOfTheMessages) {
  std::vector<Nanoseconds> stamps, logged;
  for (int i = 0; i < 200; ++i) {
    stamps.push_back(1000 * kS + 10 * kMs * i);
    logged.push_back(stamps.back() + (3 + i % 7) * kMs);
  }
  const MessageTimes made = message_times(stamps, logged);
  EXPECT_EQ(made.times, stamps);
  EXPECT_EQ(made.moved, 0U);
}

TEST(MessageTimes, AreThoseOfTheLogWhereAMessageHasNone) {
  const std::vector<Nanoseconds> stamps{MessageTable::kNoStamp, 1000 * kS, MessageTable::kNoStamp},
      logged{1000 * kS, 1000 * kS + 2 * kMs, 1001 * kS};
  const MessageTimes made = message_times(stamps, logged);
  EXPECT_THAT(made.times, ::testing::ElementsAre(1000 * kS, 1000 * kS, 1001 * kS));
  EXPECT_EQ(made.without_stamp, 2U);
}

// A sensor that counts from its start: 990 s away, delivered 2 to 8 ms late.
TEST(MessageTimes, MoveStampsOfAnotherClockByTheLeastDelay) {
  std::vector<Nanoseconds> stamps, logged;
  for (int i = 0; i < 300; ++i) {
    stamps.push_back(10 * kS + 10 * kMs * i);
    logged.push_back(stamps.back() + 990 * kS + (2 + i % 7) * kMs);
  }
  const MessageTimes made = message_times(stamps, logged);
  EXPECT_EQ(made.moved, 300U);
  EXPECT_EQ(made.moved_by, 990 * kS + 2 * kMs);
  for (std::size_t i = 0; i < stamps.size(); ++i) EXPECT_EQ(made.times[i] - stamps[i], 990 * kS + 2 * kMs);
}

// A simulation that is reset: its clock begins again while the log's goes on.
TEST(MessageTimes, GoOnWhereTheOtherClockBeginsAgain) {
  std::vector<Nanoseconds> stamps, logged;
  for (int i = 0; i < 200; ++i) {
    stamps.push_back((i < 100 ? 50 * kS : 0) + 20 * kMs * i);
    logged.push_back(5000 * kS + 20 * kMs * i);
  }
  EXPECT_EQ(message_times(stamps, logged).times, logged);
}

TEST(MessageTimes, StandADamagedStamp) {
  std::vector<Nanoseconds> stamps, logged;
  for (int i = 0; i < 100; ++i) {
    stamps.push_back(1000 * kS + 10 * kMs * i);
    logged.push_back(stamps.back() + kMs);
  }
  const std::vector<Nanoseconds> sound = stamps;
  stamps[40] = INT64_MAX;
  stamps[41] = -5;
  const MessageTimes made = message_times(stamps, logged);
  for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(made.times[i], i == 40 || i == 41 ? logged[i] : sound[i]) << i;
  EXPECT_LE(made.moved, 2U);
}

}  // namespace
}  // namespace veridyn::io::internal
