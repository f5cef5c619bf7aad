#include "veridyn/vehicle/identification/signals/drive_segments.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/vehicle/changed_drive.hpp"

namespace veridyn::vehicle {
namespace {

using testing::changed;
using testing::prepared;
using testing::recorded;

TEST(DriveSegments, SayWhyADriveCannotBeUsed) {
  const Recording r = recorded();
  const auto segments = [](const Recording& of) {
    return why([&] { static_cast<void>(find_drive_segments(prepared(of), {})); });
  };
  EXPECT_NE(segments(changed(r, "speed", [](double, double) { return 0.0; })).find("never drives"), std::string::npos);
  EXPECT_NE(segments(changed(r, "steer", [](double, double v) { return 1.6 + 0.1 * v; })).find("beyond 60 deg"),
            std::string::npos);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(segments(changed(r, "steer", [&](double t, double v) { return std::fmod(t, 2.0) < 1.0 ? nan : v; }))
                .find("no stretch"),
            std::string::npos);
}

TEST(DriveSegments, LeaveGapsOutAndKeepTheHoldOutApart) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Recording r =
      changed(recorded(120.0), "steer", [&](double t, double v) { return t > 40.0 && t < 45.0 ? nan : v; });
  const DriveSegments s = find_drive_segments(prepared(r), {});
  ASSERT_FALSE(s.identification.empty());
  ASSERT_FALSE(s.holdout.empty());
  for (const std::vector<TimeSpan>* spans : {&s.identification, &s.holdout}) {
    for (const TimeSpan& span : *spans) EXPECT_TRUE(span.end <= 40.02 || span.begin >= 44.98);
  }
  for (const TimeSpan& a : s.identification) {
    for (const TimeSpan& b : s.holdout) EXPECT_TRUE(a.end + 0.49 <= b.begin || b.end + 0.49 <= a.begin);
  }
  const double share =
      recording::total_s(s.holdout) / (recording::total_s(s.holdout) + recording::total_s(s.identification));
  EXPECT_NEAR(share, 1.0 / 3.0, 0.1);
}

// Slow driving on a motorway: a tenth of a metre per second squared, and straight stretches of noise.
TEST(DriveSegments, FollowADriveThatIsGentleThroughout) {
  const auto bends = [](double t, double) { return (t > 30.0 && t < 50.0 ? 0.008 : 0.0005) * std::sin(2.0 * t); };
  const Recording r = changed(recorded(120.0), "yaw_rate", bends);
  const double speed = prepared(r)[DriveSignal::kSpeed].value.front();
  const DriveSegments s = find_drive_segments(prepared(r), {});
  ASSERT_FALSE(s.excited.empty());
  EXPECT_LT(s.least_lateral_mps2, 0.008 * speed);
  EXPECT_NEAR(s.excited.front().begin, 30.0, 2.0);
  EXPECT_NEAR(s.excited.back().end, 50.0, 2.0);
  EXPECT_DOUBLE_EQ(find_drive_segments(prepared(recorded(120.0)), {}).least_lateral_mps2, 0.3) << "a lively drive";
  DriveSegmentOptions strict;
  strict.min_lateral_mps2 = 0.3;
  EXPECT_TRUE(find_drive_segments(prepared(r), strict).excited.empty()) << "as it was before";
  const DriveSegments straight = find_drive_segments(
      prepared(changed(r, "yaw_rate", [](double t, double) { return 0.004 * std::sin(7.0 * t); })), {});
  EXPECT_TRUE(straight.excited.empty()) << "noise alone excites nothing";
}

}  // namespace
}  // namespace veridyn::vehicle
