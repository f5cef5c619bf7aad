#include "veridyn/live/telemetry/sign_checker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/live/weaving_drive.hpp"

namespace veridyn::live {
namespace {

using ::testing::HasSubstr;
using Kind = SignVerdict::Kind;

SignVerdict verdict(double duration, const std::function<void(recording::MotionSample&)>& change = {}) {
  auto drive = test::weaving_drive(duration);
  if (change) {
    for (recording::MotionSample& s : drive) change(s);
  }
  SignChecker checker;
  checker.add(drive);
  return checker.check();
}

TEST(SignChecker, FindsADriveRight) { EXPECT_EQ(verdict(40.0).kind, Kind::kRight); }

TEST(SignChecker, SaysWhatIsStillToBeDriven) {
  EXPECT_EQ(SignChecker().check().kind, Kind::kUnknown);
  EXPECT_EQ(SignChecker().check().text, "accelerate and brake, drive bends, turn");
  const SignVerdict stands = verdict(30.0, [](recording::MotionSample& s) {
    s.force = {0.0, 0.0, kGravity};
    s.rate.setZero();
    s.speed = 0.0;
    s.attitude.setIdentity();
    s.position.setZero();
  });
  EXPECT_EQ(stands.kind, Kind::kUnknown);
}

TEST(SignChecker, NamesAWrongSignAxisAndUnit) {
  const SignVerdict lateral = verdict(40.0, [](recording::MotionSample& s) { s.force.y() *= -1.0; });
  EXPECT_EQ(lateral.kind, Kind::kWrong);
  EXPECT_THAT(lateral.text, HasSubstr("accel_y has the wrong sign"));
  const SignVerdict forward = verdict(40.0, [](recording::MotionSample& s) { s.force.x() *= -1.0; });
  EXPECT_EQ(forward.kind, Kind::kWrong);
  EXPECT_THAT(forward.text, HasSubstr("accel_x"));
  const SignVerdict degrees = verdict(40.0, [](recording::MotionSample& s) { s.rate *= 57.3; });
  EXPECT_EQ(degrees.kind, Kind::kWrong);
}

}  // namespace
}  // namespace veridyn::live
