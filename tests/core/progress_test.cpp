#include "veridyn/core/progress.hpp"

#include <gtest/gtest.h>

#include <csignal>

namespace veridyn {
namespace {

TEST(Duration, IsWrittenInWords) {
  EXPECT_EQ(duration_text(3.4), "3 s");
  EXPECT_EQ(duration_text(130.0), "2 min 10 s");
  EXPECT_EQ(duration_text(3900.0), "1 h 05 min");
  EXPECT_EQ(duration_text(-1.0), "0 s");
}

TEST(Progress, NeverStopsTheWorkByItself) {
  Progress nobody;
  EXPECT_TRUE(nobody.update(0.5));
  EXPECT_FALSE(nobody.interrupted());
}

// In a process of its own: the flag stays set once a signal came.
TEST(TerminalProgressDeathTest, StopsTheWorkAfterASignal) {
  EXPECT_EXIT(
      {
        TerminalProgress progress(true);
        TerminalProgress::watch_signals();
        if (!progress.update(0.1)) std::exit(1);
        std::raise(SIGINT);
        std::exit(progress.update(0.2) || !progress.interrupted() ? 2 : 0);
      },
      testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace veridyn
