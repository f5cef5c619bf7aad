#include "veridyn/numerics/ranks/ranks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <stdexcept>

#include "tests/support/thread_ranks.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/ranks/mpi_library.hpp"

namespace veridyn::numerics {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(Ranks, OneProcessIsAloneAndTheFirst) {
  const Ranks alone;
  EXPECT_TRUE(alone.alone());
  EXPECT_TRUE(alone.first());
  EXPECT_EQ(alone.size(), 1U);
  EXPECT_EQ(alone.finish({1, "text"}).text, "text");
}

TEST(Ranks, EveryProcessKnowsItself) {
  std::array<std::string, 3> names;
  test::run_ranks(3, [&](const Ranks& ranks) { names[ranks.rank()] = ranks.name(ranks.rank()); });
  EXPECT_THAT(names, ::testing::ElementsAre("process 1 of 3", "process 2 of 3", "process 3 of 3"));
}

/// What the first of processes with these endings says in the end.
RankEnding ending_of(const std::vector<RankEnding>& endings) {
  RankEnding said;
  test::run_ranks(endings.size(), [&](const Ranks& ranks) {
    const RankEnding end = ranks.finish(endings[ranks.rank()]);
    if (ranks.first()) said = end;
  });
  return said;
}

TEST(Ranks, TheFirstSaysWhatWentWrongInAnyProcess) {
  EXPECT_EQ(ending_of({{}, {}, {}}).exit_code, 0);
  const RankEnding other = ending_of({{}, {}, {1, "out of memory"}});
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_EQ(other.text, "process 3 of 3: out of memory");
  // What all found wrong is said once.
  const RankEnding all = ending_of({{2, "a.toml: no"}, {2, "a.toml: no"}});
  EXPECT_EQ(all.exit_code, 2);
  EXPECT_EQ(all.text, "a.toml: no");
}

TEST(Ranks, TheConnectionIsClosedByAllWhenAllHaveEnded) {
  const auto mailbox = std::make_shared<test::Mailbox>();
  std::array<std::shared_ptr<test::ThreadTransport>, 2> ends;
  for (std::size_t r = 0; r < 2; ++r) ends[r] = std::make_shared<test::ThreadTransport>(mailbox, r, 2);
  std::thread other([&] { static_cast<void>(Ranks(ends[1], {}).finish({})); });
  static_cast<void>(Ranks(ends[0], {}).finish({}));
  other.join();
  EXPECT_TRUE(ends[0]->closed);
  EXPECT_TRUE(ends[1]->closed);
}

TEST(Ranks, AfterAFailureTheFirstDoesNotWaitForAProcessThatComputesOn) {
  const auto mailbox = std::make_shared<test::Mailbox>();
  const auto end = std::make_shared<test::ThreadTransport>(mailbox, 0, 2);
  EXPECT_EQ(Ranks(end, {}).finish({1, "the disk is full"}).text, "the disk is full");
  EXPECT_FALSE(end->closed);
}

TEST(Ranks, WaitingEndsWhenTheUserWantsIt) {
  Interruption interruption;
  interruption.request();
  const Ranks first(std::make_shared<test::ThreadTransport>(std::make_shared<test::Mailbox>(), 0, 2), interruption);
  EXPECT_THROW(static_cast<void>(first.finish({})), std::runtime_error);
}

TEST(Ranks, AProgramWithoutMpiSaysSoInOneLine) {
  try {
    static_cast<void>(mpi_transport("libveridyn_none.so"));
    FAIL() << "was loaded";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("libveridyn_none.so: several processes were started, but this program has "
                                "no MPI"),
                      HasSubstr("VERIDYN_MPI=ON"), ::testing::Not(HasSubstr("\n"))));
  }
}

}  // namespace
}  // namespace veridyn::numerics
