#include "veridyn/numerics/batches/companions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>

#include "tests/support/temporary_folder.hpp"

namespace veridyn::numerics {
namespace {

using namespace std::chrono_literals;

class CompanionsTest : public ::testing::Test {
 protected:
  static ProcessShare share(std::size_t index) {
    return {.index = index, .count = 2, .wait = true, .patience_s = 0.05};
  }
  test::TemporaryFolder temporary_;
  const std::filesystem::path& folder_ = temporary_.path();
};

TEST_F(CompanionsTest, ShowThatTheyLiveOnlyWhereTheyWait) {
  const Companions alone(folder_, {.index = 0, .count = 2});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "process-1.alive"));
  {
    const Companions second(folder_, share(1));
    while (!std::filesystem::exists(folder_ / "process-2.alive")) std::this_thread::sleep_for(1ms);
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "process-2.alive"));
}

TEST_F(CompanionsTest, CountHowLongSomethingIsWaitedFor) {
  const Heartbeat other(folder_ / "process-2.alive", 5ms);
  Companions first(folder_, share(0));
  EXPECT_LT(first.wait_for(1, "all"), 0.02);
  double waited = 0.0;
  while (waited < 0.1) {
    std::this_thread::sleep_for(2ms);
    waited = first.wait_for(1, "all");
  }
  first.arrived(1);
  EXPECT_LT(first.wait_for(1, "all"), 0.02);
}

TEST_F(CompanionsTest, NameWhoShowsNoLifeAndWhoWasNeverSeen) {
  const auto failure_after = [&](std::chrono::milliseconds time) {
    Companions first(folder_, share(0));
    EXPECT_EQ(first.wait_for(1, "3 blocks are missing"), 0.0);
    std::this_thread::sleep_for(time);
    try {
      static_cast<void>(first.wait_for(1, "3 blocks are missing"));
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(failure_after(60ms), "");
  EXPECT_THAT(failure_after(260ms), ::testing::HasSubstr("process 2 of 2 was never seen in 0.25 s, and 3 blocks are "
                                                         "missing; start all 2 at the same time"));
  std::ofstream(folder_ / "process-2.alive") << "node7, process 4711\n12\n";
  EXPECT_THAT(failure_after(60ms),
              ::testing::HasSubstr("process 2 of 2 (node7, process 4711) has shown no life for 0.05 s, and 3 blocks "
                                   "are missing; run again to go on"));
}

}  // namespace
}  // namespace veridyn::numerics
