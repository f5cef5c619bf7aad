#include "veridyn/numerics/threads/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

namespace veridyn::numerics {
namespace {

TEST(ParallelFor, DoesEveryItemOnceOnAnyNumberOfThreads) {
  for (const int threads : {1, 2, 7}) {
    std::vector<int> done(1000, 0);
    EXPECT_TRUE(parallel_for(done.size(), threads, [&](std::size_t i) { ++done[i]; }));
    EXPECT_EQ(done, std::vector<int>(1000, 1));
  }
  EXPECT_TRUE(parallel_for(0, 2, [](std::size_t) { FAIL(); }));
}

TEST(ParallelFor, ThrowsTheExceptionOfAnItemOnceAllThreadsHaveEnded) {
  std::atomic<int> running = 0;
  const auto work = [&](std::size_t i) {
    ++running;
    if (i == 5) {
      --running;
      throw std::runtime_error("five");
    }
    --running;
  };
  EXPECT_THROW(parallel_for(100, 3, work), std::runtime_error);
  EXPECT_EQ(running, 0);
}

TEST(ParallelFor, StopsWhenAskedTo) {
  std::atomic<int> done = 0;
  // Work takes a while: on a busy machine the helper could otherwise finish it all before the caller asks.
  const auto work = [&](std::size_t) {
    ++done;
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  };
  EXPECT_FALSE(parallel_for(100000, 2, work, [](std::size_t n) { return n < 10; }));
  EXPECT_LT(done, 100000);
}

}  // namespace
}  // namespace veridyn::numerics
