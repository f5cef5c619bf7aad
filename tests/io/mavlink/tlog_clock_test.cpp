#include "veridyn/io/mavlink/tlog_clock.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace veridyn::io::internal {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;

auto near(double t) { return DoubleNear(t, 1e-6); }

TEST(TlogClock, MovesTheSendersTimeByTheLeastDelay) {
  SenderClock clock;
  clock.add(0.30, 100.0);  // 0.20 late
  clock.add(0.32, {});     // with it
  clock.add(0.60, 100.5);
  clock.add(1.40, 101.0);  // 0.30 late
  EXPECT_THAT(clock.times(), ElementsAre(near(0.10), near(0.12), near(0.60), near(1.10)));
  EXPECT_TRUE(clock.restarts().empty());
}

TEST(TlogClock, GoesOnAfterARestartAndKnowsItsMoment) {
  SenderClock clock;
  clock.add(0.0, 100.0);
  clock.add(10.0, 110.0);
  clock.add(10.1, 105.0);  // overtaken: no restart
  clock.add(20.0, 3.0);
  clock.add(21.0, 4.0);
  EXPECT_THAT(clock.times(), ElementsAre(near(0.0), near(10.0), near(5.0), near(20.0), near(21.0)));
  EXPECT_THAT(clock.restarts(), ElementsAre(near(20.0)));
}

TEST(TlogClock, KeepsStampsSince1970ApartFromThoseSinceTheStart) {
  SenderClock clock;
  clock.add(0.0, 1.7e9);
  clock.add(0.0, 50.0);
  clock.add(1.0, 1.7e9 + 1.0);
  clock.add(1.0, 51.0);
  EXPECT_THAT(clock.times(), ElementsAre(near(0.0), near(0.0), near(1.0), near(1.0)));
}

TEST(TlogClock, TakesWhenAPacketCameWhereNothingElseIsKnown) {
  SenderClock clock;
  clock.add(3.0, {});
  clock.add(4.0, 10.0);
  clock.add(60.0, {});  // long after the last stamp
  EXPECT_THAT(clock.times(), ElementsAre(near(3.0), near(4.0), near(60.0)));
}

}  // namespace
}  // namespace veridyn::io::internal
