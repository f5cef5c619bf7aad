#include "veridyn/live/threads/timely_thread.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <thread>

namespace veridyn::live {
namespace {

TEST(TimelyThread, IsWokenWithoutSlackAndSaysWhatWasRefused) {
  std::string refused;
  int scheduler = -1, slack_ns = -1;
  std::thread([&] {
    refused = make_thread_timely();
    scheduler = ::sched_getscheduler(0);
    slack_ns = ::prctl(PR_GET_TIMERSLACK, 0UL, 0UL, 0UL, 0UL);
  }).join();
  ::munlockall();
  // Real-time priority comes first, and from then on the kernel has no slack for it to ask for.
  const bool real_time = scheduler == SCHED_FIFO;
  EXPECT_EQ(real_time, refused.find("real-time priority") == std::string::npos) << refused;
  EXPECT_LE(slack_ns, 1);
  if (!refused.empty()) {
    EXPECT_THAT(refused, ::testing::HasSubstr("refused to this user"));
    EXPECT_THAT(refused, ::testing::HasSubstr("ulimit"));
  }
}

// Each thread asks for itself.
TEST(TimelyThread, LeavesOtherThreadsAsTheyWere) {
  const int before = ::sched_getscheduler(0);
  std::thread([] { static_cast<void>(make_thread_timely()); }).join();
  ::munlockall();
  EXPECT_EQ(::sched_getscheduler(0), before);
}

}  // namespace
}  // namespace veridyn::live
