#include "veridyn/numerics/batches/value_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>
#include <thread>

#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/numerics/batches/heartbeat.hpp"

namespace veridyn::numerics {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ValueLogTest : public ::testing::Test {
 protected:
  /// Three records.
  void fill() const {
    ValueLog log(folder_);
    log.append(1, std::vector{1.0, 2.0});
    log.append(2, std::vector<double>{});
    log.append(3, std::vector{-0.0, std::numeric_limits<double>::quiet_NaN(), 1e-310});
  }

  /// The share of process `index` of `count`.
  static ProcessShare share(std::size_t index, std::size_t count, double patience_s = 60.0) {
    return {.index = index, .count = count, .wait = true, .patience_s = patience_s};
  }

  test::TemporaryFolder temporary_;
  std::filesystem::path folder_ = temporary_.path() / "log", file_ = folder_ / "evaluations.log";
  std::vector<double> values_;
};

TEST_F(ValueLogTest, GivesTheSameBitsInThisRunAndTheNext) {
  fill();
  const ValueLog log(folder_);
  EXPECT_EQ(log.loaded(), 3U);
  ASSERT_TRUE(log.find(1, values_));
  EXPECT_THAT(values_, ElementsAre(1.0, 2.0));
  ASSERT_TRUE(log.find(2, values_));
  EXPECT_TRUE(values_.empty());
  ASSERT_TRUE(log.find(3, values_));
  ASSERT_EQ(values_.size(), 3U);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(values_[0]), std::bit_cast<std::uint64_t>(-0.0));
  EXPECT_NE(values_[1], values_[1]);
  EXPECT_EQ(values_[2], 1e-310);
  EXPECT_FALSE(log.find(4, values_));
}

TEST_F(ValueLogTest, FindsWhatWasAppendedAMomentAgo) {
  ValueLog log(folder_);
  log.append(9, std::vector{4.5});
  ASSERT_TRUE(log.find(9, values_));
  EXPECT_THAT(values_, ElementsAre(4.5));
  log.append(9, std::vector{7.0});
  ASSERT_TRUE(log.find(9, values_));
  EXPECT_THAT(values_, ElementsAre(4.5));
  EXPECT_EQ(log.loaded(), 0U);
}

TEST_F(ValueLogTest, CutAnywhereItHoldsWholeRecordsAndGoesOn) {
  fill();
  const std::string whole = read_file(file_);
  const std::size_t head = 17, second = head + 40, third = second + 24;
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    write_file(file_, whole.substr(0, size));
    const std::size_t kept = size == whole.size() ? 3U : size >= third ? 2U : size >= second ? 1U : 0U;
    {
      ValueLog log(folder_);
      ASSERT_EQ(log.loaded(), kept) << size;
      log.append(100, std::vector{8.0});
    }
    const ValueLog again(folder_);
    ASSERT_EQ(again.loaded(), kept + 1) << size;
    ASSERT_TRUE(again.find(100, values_));
    ASSERT_THAT(values_, ElementsAre(8.0));
  }
}

TEST_F(ValueLogTest, RefusesChangedValuesAndOtherFiles) {
  fill();
  std::string text = read_file(file_);
  text[17 + 16] ^= 1;
  write_file(file_, text);
  EXPECT_THROW(ValueLog log(folder_), InputError);
  write_file(file_, "time,angle\n0,1\n");
  EXPECT_THROW(ValueLog log(folder_), InputError);
}

TEST_F(ValueLogTest, ThreadsWriteSideBySide) {
  {
    ValueLog log(folder_);
    std::vector<std::thread> threads;
    for (std::uint64_t t = 0; t < 4; ++t) {
      threads.emplace_back([&log, t] {
        for (std::uint64_t i = 0; i < 200; ++i) log.append(1000 * t + i, std::vector(i % 7, static_cast<double>(i)));
      });
    }
    for (std::thread& t : threads) t.join();
  }
  const ValueLog log(folder_);
  EXPECT_EQ(log.loaded(), 800U);
  ASSERT_TRUE(log.find(3020, values_));
  EXPECT_THAT(values_, ElementsAre(20.0, 20.0, 20.0, 20.0, 20.0, 20.0));
}

TEST_F(ValueLogTest, ProcessesComputeTheirShareAndSeeTheSameBits) {
  constexpr std::size_t kProcesses = 3, kRounds = 40, kItems = 7;
  // Each step depends on all values of the one before.
  std::array<std::vector<double>, kProcesses> paths;
  std::array<int, kProcesses> computed{};
  std::vector<std::thread> processes;
  for (std::size_t p = 0; p < kProcesses; ++p)
    processes.emplace_back([&, p] {
      ValueLog log(folder_, share(p, kProcesses));
      double x = 0.5;
      for (std::size_t round = 0; round < kRounds; ++round) {
        std::vector<double> values(kItems), kept;
        for (const std::size_t item : log.share().own_first(kItems)) {
          const std::uint64_t key = std::bit_cast<std::uint64_t>(x) + item;
          if (log.find(key, kept, item)) {
            values[item] = kept.front();
            continue;
          }
          values[item] = std::sin(x + static_cast<double>(item));
          log.append(key, std::span(&values[item], 1));
          ++computed[p];
        }
        for (const double v : values) x = std::fmod(x + v, 1.0);
        paths[p].push_back(x);
      }
    });
  for (std::thread& p : processes) p.join();
  EXPECT_THAT(computed, ElementsAre(3 * kRounds, 2 * kRounds, 2 * kRounds));
  EXPECT_EQ(paths[1], paths[0]);
  EXPECT_EQ(paths[2], paths[0]);
  // What three computed serves one, or four.
  EXPECT_EQ(ValueLog(folder_).loaded(), kItems * kRounds);
  EXPECT_EQ(ValueLog(folder_, share(3, 4)).loaded(), kItems * kRounds);
}

TEST_F(ValueLogTest, TakesOnlyWholeRecordsOfAnotherProcess) {
  { ValueLog(folder_, share(1, 2)).append(5, std::vector{1.0, 2.0}); }
  const std::filesystem::path other = folder_ / "evaluations-2.log";
  const std::string whole = read_file(other);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    write_file(other, whole.substr(0, size));
    const ValueLog log(folder_, share(0, 2));
    ASSERT_EQ(log.loaded(), 0U) << size;
    std::thread writer([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      std::ofstream(other, std::ios::app | std::ios::binary) << whole.substr(size);
    });
    const bool there = log.find(5, values_, 1);
    writer.join();
    ASSERT_TRUE(there) << size;
    ASSERT_THAT(values_, ElementsAre(1.0, 2.0)) << size;
  }
}

TEST_F(ValueLogTest, NamesTheProcessThatShowsNoLifeAndTheOneThatGoesAnotherWay) {
  const auto failure = [&] {
    try {
      (void)ValueLog(folder_, share(0, 2, 0.05)).find(7, values_, 1);
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(failure(), HasSubstr("process 2 of 2 was never seen in 0.25 s, and what it computes is missing; start "
                                   "all 2 at the same time"));
  const Heartbeat other(folder_ / "process-2.alive", std::chrono::milliseconds(5));
  EXPECT_THAT(failure(), HasSubstr("process 2 of 2 lives, but has computed nothing for"));
}

TEST_F(ValueLogTest, GoesOnWaitingForAProcessThatComputesOtherThings) {
  std::atomic<bool> done = false;
  std::thread other([&] {
    ValueLog log(folder_, share(1, 2, 0.03));
    // Ten times the patience are over long before the key that is waited for comes.
    for (std::uint64_t k = 0; k < 80; ++k) {
      log.append(100 + k, std::vector{0.0});
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    log.append(7, std::vector{3.0});
    while (!done) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  const ValueLog log(folder_, share(0, 2, 0.03));
  EXPECT_TRUE(log.find(7, values_, 1));
  EXPECT_THAT(values_, ElementsAre(3.0));
  done = true;
  other.join();
}

TEST_F(ValueLogTest, FindsWhatTheOwnerHasFromAnotherProcessFile) {
  const ValueLog log(folder_, share(0, 2));
  const Heartbeat second(folder_ / "process-2.alive");
  // Of an earlier run with three processes, of which the third had not ended.
  std::thread third([&] { ValueLog(folder_, share(2, 3)).append(7, std::vector{5.0}); });
  EXPECT_TRUE(log.find(7, values_, 1));
  EXPECT_THAT(values_, ElementsAre(5.0));
  third.join();
}

TEST_F(ValueLogTest, OneProcessAtATimeWritesAFile) {
  const ValueLog running(folder_, share(1, 2));
  try {
    const ValueLog again(folder_, share(1, 3));
    FAIL() << "both write";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("evaluations-2.log"));
    EXPECT_THAT(error.what(), HasSubstr("is written by another process that runs"));
  }
  EXPECT_NO_THROW(ValueLog(folder_, share(0, 2)));
}

TEST_F(ValueLogTest, NoticesAFileThatChangesWhileItRuns) {
  ValueLog log(folder_);
  log.append(9, std::vector{4.5});
  std::string text = read_file(file_);
  text[17 + 16] ^= 1;
  std::ofstream(file_, std::ios::binary | std::ios::in | std::ios::out) << text;
  EXPECT_THROW(static_cast<void>(log.find(9, values_)), std::runtime_error);
}

TEST_F(ValueLogTest, AFailureOnOneThreadEndsTheWaitingOfOthers) {
  ValueLog log(folder_, share(0, 2));
  bool found = true;
  std::thread waiting([&] { found = log.find(7, values_, 1); });
  // Until nothing is left: who waits may be writing there.
  std::error_code busy;
  do std::filesystem::remove_all(folder_, busy);
  while (std::filesystem::exists(folder_));
  EXPECT_THROW(log.append(8, std::vector{1.0}), std::runtime_error);
  waiting.join();
  EXPECT_FALSE(found);
}

TEST_F(ValueLogTest, WaitsNoLongerWhenInterrupted) {
  const ValueLog log(folder_, share(0, 2), [] { return true; });
  EXPECT_FALSE(log.find(7, values_, 1));
}

}  // namespace
}  // namespace veridyn::numerics
