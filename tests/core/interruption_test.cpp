#include "veridyn/core/interruption.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

namespace veridyn {
namespace {

TEST(Interruption, IsSharedByItsCopiesOnly) {
  Interruption first;
  const Interruption copy = first, other;
  EXPECT_FALSE(copy.requested());
  first.request();
  EXPECT_TRUE(copy.requested());
  EXPECT_FALSE(other.requested());
}

// In processes of their own: a signal's action belongs to the whole process.
TEST(InterruptionDeathTest, IsRequestedByASignal) {
  for (const int signal : {SIGINT, SIGTERM}) {
    EXPECT_EXIT(
        {
          const Interruption interruption;
          request_on_signals(interruption);
          if (interruption.requested()) std::exit(1);
          std::raise(signal);
          std::exit(interruption.requested() ? 0 : 2);
        },
        testing::ExitedWithCode(0), "");
  }
}

TEST(InterruptionDeathTest, ASecondSignalEndsTheProgram) {
  EXPECT_EXIT(
      {
        request_on_signals(Interruption());
        std::raise(SIGINT);
        std::raise(SIGINT);
        std::exit(0);
      },
      testing::KilledBySignal(SIGINT), "");
}

}  // namespace
}  // namespace veridyn
