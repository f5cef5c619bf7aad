#include "veridyn/live/teleoperation/sequence_counter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "veridyn/numerics/random.hpp"

namespace veridyn::live {
namespace {

TEST(SequenceCounter, CountsGapsLateOnesAndDuplicates) {
  SequenceCounter counter;
  EXPECT_TRUE(counter.empty());
  EXPECT_EQ(counter.take(100), SequenceVerdict::kNewer);
  EXPECT_EQ(counter.take(101), SequenceVerdict::kNewer);
  EXPECT_EQ(counter.take(105), SequenceVerdict::kNewer);
  EXPECT_EQ(counter.lost(), 3U);
  EXPECT_EQ(counter.take(103), SequenceVerdict::kLate);
  EXPECT_EQ(counter.lost(), 2U);
  EXPECT_EQ(counter.take(103), SequenceVerdict::kDuplicate);
  EXPECT_EQ(counter.take(105), SequenceVerdict::kDuplicate);
  EXPECT_EQ(counter.take(99), SequenceVerdict::kTooOld);  // before the first
  EXPECT_EQ(counter.take(168), SequenceVerdict::kNewer);
  EXPECT_EQ(counter.take(105), SequenceVerdict::kDuplicate);  // 63 behind
  EXPECT_EQ(counter.take(104), SequenceVerdict::kTooOld);     // 64 behind
  EXPECT_EQ(counter.received(), 5U);
  EXPECT_EQ(counter.lost(), 64U);
  EXPECT_EQ(counter.duplicates(), 3U);
  EXPECT_EQ(counter.late(), 1U);
  EXPECT_EQ(counter.too_old(), 2U);
}

TEST(SequenceCounter, GoesOnOverTheEndOfItsNumbers) {
  SequenceCounter counter;
  for (std::uint32_t k = 0xFFFF'FFF0U; k != 16; ++k) EXPECT_EQ(counter.take(k), SequenceVerdict::kNewer);
  EXPECT_EQ(counter.take(0xFFFF'FFF8U), SequenceVerdict::kDuplicate);
  EXPECT_EQ(counter.received(), 32U);
  EXPECT_EQ(counter.lost(), 0U);
}

TEST(SequenceCounter, AgreesWithASetOfAllThatCame) {
  numerics::RandomStream random(1, "sequences");
  for (int round = 0; round < 200; ++round) {
    SequenceCounter counter;
    const auto first = static_cast<std::uint32_t>(random.index(std::uint64_t{1} << 32U));
    std::set<std::uint32_t> seen = {0};  // counted from the first
    std::uint32_t newest = 0, next = 0;
    counter.take(first);
    for (int k = 0; k < 200; ++k) {
      next += static_cast<std::uint32_t>(random.index(4));
      const auto back = static_cast<std::uint32_t>(random.index(60));
      const std::uint32_t number = next >= back && random.index(4) == 0 ? next - back : next;
      const bool known = seen.contains(number);
      const SequenceVerdict verdict = counter.take(first + number);
      if (number > newest) {
        ASSERT_EQ(verdict, SequenceVerdict::kNewer);
      } else {
        ASSERT_EQ(verdict, known ? SequenceVerdict::kDuplicate : SequenceVerdict::kLate);
      }
      newest = std::max(newest, number);
      seen.insert(number);
    }
    ASSERT_EQ(counter.received(), seen.size());
    ASSERT_EQ(counter.lost(), newest + 1 - seen.size());
  }
}

}  // namespace
}  // namespace veridyn::live
