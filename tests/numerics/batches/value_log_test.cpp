#include "veridyn/numerics/batches/value_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <fstream>
#include <limits>
#include <string>
#include <thread>

#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn::numerics {
namespace {

using ::testing::ElementsAre;

class ValueLogTest : public ::testing::Test {
 protected:
  /// Three records.
  void fill() const {
    ValueLog log(folder_);
    log.append(1, std::vector{1.0, 2.0});
    log.append(2, std::vector<double>{});
    log.append(3, std::vector{-0.0, std::numeric_limits<double>::quiet_NaN(), 1e-310});
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

TEST_F(ValueLogTest, IsKeptToTheRunThatHasItOpen) {
  {
    const ValueLog log(folder_);
    EXPECT_THROW(ValueLog second(folder_), InputError);
  }
  EXPECT_NO_THROW(ValueLog second(folder_));
}

TEST_F(ValueLogTest, NoticesAFileThatChangesWhileItRuns) {
  ValueLog log(folder_);
  log.append(9, std::vector{4.5});
  std::string text = read_file(file_);
  text[17 + 16] ^= 1;
  std::ofstream(file_, std::ios::binary | std::ios::in | std::ios::out) << text;
  EXPECT_THROW(static_cast<void>(log.find(9, values_)), std::runtime_error);
}

}  // namespace
}  // namespace veridyn::numerics
