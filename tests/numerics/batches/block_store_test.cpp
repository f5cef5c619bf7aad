#include "veridyn/numerics/batches/block_store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>

#include "tests/support/temporary_folder.hpp"
#include "tests/support/thread_ranks.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn::numerics {
namespace {

using ::testing::HasSubstr;

/// Stops after so many looks. The calling thread alone looks: with one thread it is known how much is done by then.
class StoreProgress : public Progress {
 public:
  explicit StoreProgress(long looks = 1000000000, int threads = 2) : looks_(looks), threads_(threads) {}
  [[nodiscard]] bool update(double) override { return !interrupted(); }
  [[nodiscard]] bool interrupted() const override { return --looks_ < 0; }
  [[nodiscard]] int threads() const override { return threads_; }

 private:
  mutable std::atomic<long> looks_;
  int threads_;
};

class BlockStoreTest : public ::testing::Test {
 protected:
  /// 47 items in blocks of 5; every value is odd bits, some are NaN, infinite or -0.
  [[nodiscard]] Batch batch() {
    const auto value = [this](std::size_t i) {
      ++computed_;
      if (i == 3) return std::numeric_limits<double>::quiet_NaN();
      if (i == 4) return std::bit_cast<double>(std::uint64_t{0xfff8000000000123});  // a NaN with a payload
      if (i == 7) return -std::numeric_limits<double>::infinity();
      return i == 8 ? -0.0 : std::sin(1.0 + static_cast<double>(i));
    };
    return {.name = "waves", .fingerprint = 77, .items = 47, .items_per_block = 5, .value = value};
  }
  [[nodiscard]] BlockStore store(const ProcessShare& share = {}) const { return {folder_, kIdentity, share}; }
  static std::vector<std::uint64_t> bits(const BatchValues& values) {
    std::vector<std::uint64_t> all;
    for (const double v : values.values) all.push_back(std::bit_cast<std::uint64_t>(v));
    return all;
  }
  [[nodiscard]] std::vector<std::uint64_t> undisturbed() {
    std::vector<std::uint64_t> all = bits(BlockStore().compute(batch(), progress_));
    computed_ = 0;
    return all;
  }
  [[nodiscard]] std::filesystem::path block(int number) const {
    return folder_ / ("waves-00000" + std::to_string(number) + ".block");
  }
  static std::string refusal(const std::function<void()>& call) {
    try {
      call();
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }

  static inline const BlockStore::Identity kIdentity = {{"program", "veridyn 1"}, {"study", "samples = 4"}};
  test::TemporaryFolder temporary_;
  std::filesystem::path folder_ = temporary_.path() / "checkpoint";
  StoreProgress progress_;
  std::atomic<int> computed_ = 0;
};

TEST_F(BlockStoreTest, GivesBackEveryBitAndComputesNothingTwice) {
  const std::vector<std::uint64_t> expected = undisturbed();
  BlockStore first = store();
  EXPECT_EQ(bits(first.compute(batch(), progress_)), expected);
  EXPECT_EQ(computed_, 47);
  EXPECT_EQ(first.found(), 0u);
  BlockStore second = store();
  const BatchValues again = second.compute(batch(), progress_);
  EXPECT_TRUE(again.completed);
  EXPECT_EQ(bits(again), expected);
  EXPECT_EQ(computed_, 47);
  EXPECT_EQ(second.found(), 10u);
  EXPECT_EQ(second.blocks(), 10u);
}

TEST_F(BlockStoreTest, GoesOnWhereItWasInterrupted) {
  const std::vector<std::uint64_t> expected = undisturbed();
  int runs = 0;
  for (bool completed = false; !completed && runs < 100; ++runs) {
    StoreProgress stopping(6, 1);
    BlockStore s = store();
    const BatchValues values = s.compute(batch(), stopping);
    completed = values.completed;
    EXPECT_EQ(s.missing(), 0u);
    if (completed) {
      EXPECT_EQ(bits(values), expected);
    }
  }
  EXPECT_GT(runs, 1);
  EXPECT_LT(runs, 11);
}

TEST_F(BlockStoreTest, ComputesDamagedBlocksAgain) {
  const std::vector<std::uint64_t> expected = undisturbed();
  ASSERT_TRUE(store().compute(batch(), progress_).completed);
  const std::string whole = read_file(block(3));
  std::string changed = whole, no_head = "veridyn block 1\n";
  changed[changed.size() / 2] ^= 1;
  for (const std::string& damaged :
       {std::string(), whole.substr(0, 60), whole.substr(0, whole.size() - 1), changed, whole + "x", no_head}) {
    write_file(block(3), damaged);
    computed_ = 0;
    BlockStore s = store();
    EXPECT_EQ(bits(s.compute(batch(), progress_)), expected);
    EXPECT_EQ(computed_, 5);
    ASSERT_EQ(s.warnings().size(), 1u);
    EXPECT_THAT(s.warnings()[0], HasSubstr("waves-000003.block: is damaged"));
    // Its processor time is measured, not the same.
    EXPECT_EQ(read_file(block(3)).substr(0, 64), whole.substr(0, 64));
  }
}

TEST_F(BlockStoreTest, RefusesWhatIsOfSomethingElse) {
  ASSERT_TRUE(store().compute(batch(), progress_).completed);
  const auto opened = [&](const BlockStore::Identity& identity) {
    return refusal([&] { const BlockStore s(folder_, identity); });
  };
  EXPECT_THAT(opened({{"program", "veridyn 2"}, {"study", "samples = 4"}}),
              HasSubstr("'program: veridyn 1' there, 'program: veridyn 2' here"));
  EXPECT_THAT(opened({{"program", "veridyn 1"}, {"study", "samples = 8"}}),
              HasSubstr("'study: samples = 4' there, 'study: samples = 8' here"));
  EXPECT_THAT(opened({{"program", "veridyn 1"}}), HasSubstr("'study: samples = 4' there, nothing here"));
  Batch other = batch();
  other.fingerprint = 78;
  EXPECT_THAT(refusal([&] { (void)store().compute(other, progress_); }), HasSubstr("waves-000000.block: was computed"));
  other = batch();
  other.items = 48;
  EXPECT_THAT(refusal([&] { (void)store().compute(other, progress_); }), HasSubstr("waves-000009.block: was computed"));
  std::filesystem::remove_all(folder_);
  make_folder(folder_);
  write_file(folder_ / "thesis.tex", "x");
  EXPECT_THAT(refusal([&] { const BlockStore s = store(); }), HasSubstr("holds thesis.tex and is no checkpoint"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "checkpoint.txt"));
}

TEST_F(BlockStoreTest, HasTheSameBitsFromAnyNumberOfShards) {
  const std::vector<std::uint64_t> expected = undisturbed();
  for (const std::size_t count : {1u, 2u, 3u, 11u}) {
    std::filesystem::remove_all(folder_);
    computed_ = 0;
    for (std::size_t index = 0; index < count; ++index) {
      BlockStore s = store({.index = index, .count = count});
      const bool completed = s.compute(batch(), progress_).completed;
      EXPECT_EQ(completed, s.missing() == 0);
      // Of ten blocks this share and those before it have theirs.
      std::size_t there = 0;
      for (std::size_t b = 0; b < 10; ++b) there += b % count <= index ? 1U : 0U;
      EXPECT_EQ(s.missing(), 10 - there);
      EXPECT_EQ(s.last_blocks(), 10u);
    }
    EXPECT_EQ(computed_, 47);
    BlockStore merge = store({.count = 0});
    EXPECT_EQ(bits(merge.compute(batch(), progress_)), expected);
    EXPECT_EQ(computed_, 47);
  }
  std::filesystem::remove(block(4));
  BlockStore merge = store({.count = 0});
  EXPECT_FALSE(merge.compute(batch(), progress_).completed);
  EXPECT_EQ(merge.missing(), 1u);
  EXPECT_EQ(computed_, 47);
}

TEST_F(BlockStoreTest, ProcessesOfALauncherComputeTogetherAndTheFirstAloneKeepsTheBlocks) {
  const std::vector<std::uint64_t> expected = undisturbed();
  for (const std::size_t size : {2U, 3U, 4U}) {
    std::filesystem::remove_all(folder_);
    computed_ = 0;
    // What a process alone left is taken from the folder.
    StoreProgress stopping(20, 1);
    EXPECT_FALSE(store().compute(batch(), stopping).completed);
    const int left = computed_;
    std::vector<std::vector<std::uint64_t>> found(size);
    std::vector<char> completed(size, 0);
    test::run_ranks(size, [&](const Ranks& ranks) {
      StoreProgress progress(1000000000, 1);
      BlockStore s = ranks.first() ? BlockStore(folder_, kIdentity, {}, ranks) : BlockStore(ranks);
      const BatchValues values = s.compute(batch(), progress);
      found[ranks.rank()] = bits(values);
      completed[ranks.rank()] = values.completed ? 1 : 0;
    });
    for (const auto& f : found) EXPECT_EQ(f, expected);
    EXPECT_EQ(std::count(completed.begin(), completed.end(), 1), static_cast<long>(size));
    EXPECT_LT(left, 25);
    EXPECT_GE(left, 15);
    // Whole blocks of those count.
    EXPECT_EQ(computed_, left + 47 - left / 5 * 5);
    computed_ = 0;
    EXPECT_EQ(bits(store().compute(batch(), progress_)), expected);
    EXPECT_EQ(computed_, 0);
  }
}

TEST_F(BlockStoreTest, AnEmptyBatchIsComplete) {
  Batch none = batch();
  none.items = 0;
  const BatchValues values = store().compute(none, progress_);
  EXPECT_TRUE(values.completed);
  EXPECT_TRUE(values.values.empty());
}

TEST_F(BlockStoreTest, KeepsSeveralValuesOfAnItemTogether) {
  std::atomic<std::size_t> filled{0};
  const Batch pairs{.name = "pairs",
                    .fingerprint = 5,
                    .items = 13,
                    .items_per_block = 4,
                    .values_per_item = 2,
                    .fill = [&](std::size_t i, std::span<double> values) {
                      ++filled;
                      ASSERT_EQ(values.size(), 2u);
                      values[0] = static_cast<double>(i);
                      values[1] = -static_cast<double>(i);
                    }};
  BlockStore half = store({.index = 0, .count = 2});
  EXPECT_FALSE(half.compute(pairs, progress_).completed);
  EXPECT_EQ(filled, 8u);
  BlockStore rest = store();
  const BatchValues values = rest.compute(pairs, progress_);
  ASSERT_TRUE(values.completed);
  EXPECT_EQ(filled, 13u);
  ASSERT_EQ(values.values.size(), 26u);
  for (std::size_t i = 0; i < 13; ++i) {
    EXPECT_EQ(values.values[2 * i], static_cast<double>(i));
    EXPECT_EQ(values.values[2 * i + 1], -static_cast<double>(i));
  }
}

TEST(ProcessShare, EveryItemIsComputedByOne) {
  for (std::size_t item = 0; item < 20; ++item) {
    int computing = 0;
    for (std::size_t i = 0; i < 4; ++i) computing += ProcessShare{.index = i, .count = 4}.computes(item) ? 1 : 0;
    EXPECT_EQ(computing, 1);
    EXPECT_FALSE(ProcessShare{.count = 0}.computes(item));
  }
}

}  // namespace
}  // namespace veridyn::numerics
