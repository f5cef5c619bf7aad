#include "veridyn/core/progress.hpp"

#include <gtest/gtest.h>

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
  EXPECT_EQ(nobody.threads(), 0);
}

TEST(TerminalProgress, StopsTheWorkWhenItsInterruptionIsRequested) {
  Interruption interruption;
  TerminalProgress progress(true, 3, interruption);
  EXPECT_EQ(progress.threads(), 3);
  EXPECT_TRUE(progress.update(0.1));
  interruption.request();
  EXPECT_FALSE(progress.update(0.2));
  EXPECT_TRUE(progress.interrupted());
}

}  // namespace
}  // namespace veridyn
