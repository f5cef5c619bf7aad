#include "veridyn/live/threads/triple_buffer.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace veridyn::live {
namespace {

TEST(TripleBuffer, GivesTheNewestValueOnce) {
  TripleBuffer<int> buffer(7);
  EXPECT_FALSE(buffer.update());
  EXPECT_EQ(buffer.value(), 7);
  buffer.to_write() = 1;
  buffer.publish();
  buffer.to_write() = 2;
  buffer.publish();
  EXPECT_TRUE(buffer.update());
  EXPECT_EQ(buffer.value(), 2);
  EXPECT_FALSE(buffer.update());
  EXPECT_EQ(buffer.value(), 2);
}

TEST(TripleBuffer, IsSeenWholeAndNeverGoesBackBetweenThreads) {
  struct Both {
    std::uint64_t a = 0;
    std::array<std::uint64_t, 64> same{};
  };
  TripleBuffer<Both> buffer;
  constexpr std::uint64_t kLast = 200000;
  std::thread writer([&] {
    for (std::uint64_t k = 1; k <= kLast; ++k) {
      Both& b = buffer.to_write();
      b.a = k;
      b.same.fill(k);
      buffer.publish();
    }
  });
  std::uint64_t last = 0, torn = 0, back = 0;
  while (last < kLast) {
    buffer.update();
    const Both& b = buffer.value();
    for (const std::uint64_t v : b.same) torn += v != b.a ? 1U : 0U;
    back += b.a < last ? 1U : 0U;
    last = b.a;
  }
  writer.join();
  EXPECT_EQ(torn, 0U);
  EXPECT_EQ(back, 0U);
}

}  // namespace
}  // namespace veridyn::live
