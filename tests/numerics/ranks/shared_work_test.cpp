#include "veridyn/numerics/ranks/shared_work.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <thread>

#include "tests/support/thread_ranks.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::numerics {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::size_t kItems = 200;

void sine(std::span<const double> request, std::vector<double>& reply) {
  reply.clear();
  for (const double x : request) reply.push_back(std::sin(x));
}

/// Sines of the items by all processes, as each of them knows them in the end.
std::vector<double> sines(const Ranks& ranks, int threads, const SharedWork::Compute& compute) {
  SharedWork work(ranks, 7, threads, compute);
  if (!ranks.first()) return work.serve();
  std::vector<double> values(kItems);
  parallel_for(kItems, work.threads(), [&](std::size_t i) {
    std::vector<double> reply;
    work.ask(std::array{static_cast<double>(i)}, reply);
    values[i] = reply.front();
  });
  work.finish(values);
  return values;
}

/// What was thrown by `call`.
template <typename Call>
std::string failure(const Call& call) {
  try {
    call();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "nothing";
}

TEST(SharedWork, HasTheSameBitsInAllProcessesOnAnyNumberOfThem) {
  const std::vector<double> alone = sines({}, 1, sine);
  for (const std::size_t size : {2U, 3U, 5U}) {
    std::vector<std::vector<double>> found(size);
    std::vector<std::atomic<int>> computed(size);
    // However busy the machine is: the first leaves something to each of the others.
    const auto all_have_computed = [&] {
      return std::all_of(computed.begin() + 1, computed.end(), [](const auto& count) { return count > 0; });
    };
    test::run_ranks(size, [&](const Ranks& ranks) {
      found[ranks.rank()] = sines(ranks, 1 + static_cast<int>(ranks.rank() % 2), [&](auto request, auto& reply) {
        ++computed[ranks.rank()];
        for (int i = 0; i < 10000 && ranks.first() && !all_have_computed(); ++i)
          std::this_thread::sleep_for(std::chrono::milliseconds(1));
        sine(request, reply);
      });
    });
    int all = 0;
    for (std::size_t r = 0; r < size; ++r) {
      EXPECT_EQ(found[r], alone) << r << " of " << size;
      EXPECT_GT(computed[r], 0) << r << " of " << size;
      all += computed[r];
    }
    EXPECT_EQ(all, static_cast<int>(kItems));
  }
}

TEST(SharedWork, CountsTheThreadsOfAllProcesses) {
  std::atomic<int> threads = 0;
  test::run_ranks(3, [&](const Ranks& ranks) {
    SharedWork work(ranks, 7, 2 + static_cast<int>(ranks.rank()), sine);
    if (!ranks.first()) return static_cast<void>(work.serve());
    threads = work.threads();
    work.finish();
  });
  EXPECT_EQ(threads, 2 + 3 + 4);
  EXPECT_EQ(SharedWork({}, 7, 2, sine).threads(), 2);
  EXPECT_EQ(SharedWork({}, 7, 0, sine).threads(), 0);
}

TEST(SharedWork, UsesNoMoreThreadsOfAProcessThanItHas) {
  std::array<std::atomic<int>, 2> at_once{}, most{};
  test::run_ranks(2, [&](const Ranks& ranks) {
    const std::size_t r = ranks.rank();
    static_cast<void>(sines(ranks, 2, [&, r](auto request, auto& reply) {
      const int now = ++at_once[r];
      for (int before = most[r]; now > before && !most[r].compare_exchange_weak(before, now);) {
      }
      std::this_thread::sleep_for(std::chrono::microseconds(300));
      sine(request, reply);
      --at_once[r];
    }));
  });
  EXPECT_LE(most[0], 2);
  EXPECT_LE(most[1], 2);
}

TEST(SharedWork, AFailureElsewhereIsThrownWhereItWasAskedForWithItsProcess) {
  std::array<std::string, 2> said;
  test::run_ranks(2, [&](const Ranks& ranks) {
    said[ranks.rank()] = failure([&] {
      static_cast<void>(sines(ranks, 1, [&](auto request, auto& reply) {
        if (!ranks.first()) throw std::runtime_error("no such muscle");
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        sine(request, reply);
      }));
    });
  });
  EXPECT_EQ(said[0], "process 2 of 2: no such muscle");
  EXPECT_EQ(said[1], "the first process ended");
}

TEST(SharedWork, AFailureOfTheFirstEndsTheOthers) {
  std::array<std::string, 3> said;
  test::run_ranks(3, [&](const Ranks& ranks) {
    said[ranks.rank()] = failure([&] {
      SharedWork work(ranks, 7, 1, sine);
      if (!ranks.first()) return static_cast<void>(work.serve());
      throw std::runtime_error("the disk is full");
    });
  });
  EXPECT_THAT(said, ElementsAre("the disk is full", "the first process ended", "the first process ended"));
}

TEST(SharedWork, RefusesProcessesThatComeWithSomethingElse) {
  std::array<std::string, 3> said;
  test::run_ranks(3, [&](const Ranks& ranks) {
    said[ranks.rank()] = failure([&] { require_same(ranks, ranks.rank() == 2 ? 0x100000007U : 7U); });
    if (ranks.first()) ranks.end_others();
  });
  EXPECT_THAT(said[0], HasSubstr("process 3 of 3: has another study, other files or another version"));
  EXPECT_EQ(said[1], "the first process ended");
  EXPECT_EQ(said[2], "the first process ended");
  test::run_ranks(
      3, [&](const Ranks& ranks) { said[ranks.rank()] = failure([&] { require_same(ranks, 0xffffffffffffffffU); }); });
  EXPECT_THAT(said, ElementsAre("nothing", "nothing", "nothing"));
}

TEST(SharedWork, SaysWhatWentWrongInAProcessThatDoesNotCome) {
  std::array<std::string, 2> said;
  test::run_ranks(2, [&](const Ranks& ranks) {
    if (!ranks.first()) return static_cast<void>(ranks.finish({2, "arm.osim: cannot be opened"}));
    try {
      require_same(ranks, 7);
    } catch (const InputError& error) {
      said[0] = error.what();
    }
    static_cast<void>(ranks.finish({2, said[0]}));
  });
  EXPECT_EQ(said[0], "process 2 of 2: arm.osim: cannot be opened");
}

TEST(SharedWork, EndsInAllProcessesWhenTheUserWantsIt) {
  Interruption interruption;
  std::array<std::string, 3> said;
  test::run_ranks(
      3,
      [&](const Ranks& ranks) {
        said[ranks.rank()] = failure([&] {
          static_cast<void>(sines(ranks, 1, [&](auto request, auto& reply) {
            if (request.front() == 20.0) interruption.request();
            sine(request, reply);
          }));
        });
      },
      interruption);
  EXPECT_EQ(said[0], "interrupted");
  for (const std::size_t other : {1U, 2U})
    EXPECT_TRUE(said[other] == "interrupted" || said[other] == "the first process ended") << said[other];
}

}  // namespace
}  // namespace veridyn::numerics
