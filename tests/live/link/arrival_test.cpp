#include "veridyn/live/link/arrival.hpp"

#include <gtest/gtest.h>

#include "veridyn/live/telemetry/sender_clock.hpp"

namespace veridyn::live {
namespace {

constexpr Nanoseconds kHour = 3600 * kSecond;
constexpr Nanoseconds kNow = 100 * kSecond, kDay = 1'700'000'000 * kSecond;

/// A datagram that waited 3 ms in a socket that was empty 5 ms ago; the time of day was then set by `jump`.
ArrivalClues waited(Nanoseconds jump) {
  return {
      .stamp = kDay - 3 * kMillisecond, .time_of_day = kDay + jump, .now = kNow, .empty_at = kNow - 5 * kMillisecond};
}

TEST(Arrival, IsTheKernelsStampByTheMonotonicClock) {
  EXPECT_EQ(arrival_by_monotonic(waited(0)), kNow - 3 * kMillisecond);
}

TEST(Arrival, IsNeverBeforeTheSocketWasEmptyNorAfterNowWhateverTheTimeOfDayIsSetTo) {
  for (const Nanoseconds jump : {-kHour, -5 * kSecond, 5 * kSecond, kHour})
    EXPECT_EQ(arrival_by_monotonic(waited(jump)), kNow) << jump;
  for (Nanoseconds jump = -20 * kMillisecond; jump <= 20 * kMillisecond; jump += kMillisecond / 4) {
    const Nanoseconds arrival = arrival_by_monotonic(waited(jump));
    EXPECT_GE(arrival, kNow - 5 * kMillisecond) << jump;
    EXPECT_LE(arrival, kNow) << jump;
  }
}

TEST(Arrival, ADatagramOnItsWayWhileTheSocketWasEmptyCountsFromThen) {
  ArrivalClues clues = waited(0);
  clues.empty_at = kNow - 2 * kMillisecond;  // its stamp is 1 ms before
  EXPECT_EQ(arrival_by_monotonic(clues), kNow - 2 * kMillisecond);
}

TEST(Arrival, AProgramThatStoodStillForSecondsKeepsTheStampsOfWhatWaited) {
  ArrivalClues clues = waited(0);
  clues.stamp = kDay - 4 * kSecond;
  clues.empty_at = kNow - 5 * kSecond;
  EXPECT_EQ(arrival_by_monotonic(clues), kNow - 4 * kSecond);
}

/// By how much the sender's clock is off after the time of day was set by `jump`, in the middle of a drive at 100 Hz.
double moved_by(Nanoseconds jump) {
  SenderClock clock;
  double before = 0.0, most = 0.0;
  Nanoseconds set_by = 0;
  for (int k = 0; k < 4000; ++k) {
    const Nanoseconds came = kNow + k * 10 * kMillisecond, read = came + kMillisecond;
    if (k == 2000) {
      before = clock.ours(0.0);
      set_by = jump;
    }
    // The datagram that waits while the time of day is set has a stamp of before.
    const Nanoseconds stamp = kDay + k * 10 * kMillisecond + (k == 2000 ? 0 : set_by);
    clock.add(0.01 * k, arrival_by_monotonic({.stamp = stamp,
                                              .time_of_day = kDay + k * 10 * kMillisecond + kMillisecond + set_by,
                                              .now = read,
                                              .empty_at = came - kMillisecond}));
    if (k >= 2000) most = std::max(most, std::abs(clock.ours(0.0) - before));
  }
  return most;
}

TEST(Arrival, SettingTheTimeOfDayDoesNotMoveTheSendersClock) {
  for (const Nanoseconds jump : {-kHour, -5 * kSecond, 5 * kSecond, kHour}) EXPECT_LT(moved_by(jump), 1e-6) << jump;
}

}  // namespace
}  // namespace veridyn::live
