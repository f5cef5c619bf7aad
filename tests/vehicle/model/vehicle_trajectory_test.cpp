#include "veridyn/vehicle/model/vehicle_trajectory.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string_view>
#include <utility>

namespace veridyn::vehicle {
namespace {

TEST(VehicleTrajectory, SaysHowItEndedAndWhenBeforeTheEnd) {
  VehicleTrajectory t;
  t.end_time = 12.5;
  EXPECT_EQ(t.message(), "driven to the end");
  t.end = DriveEnd::kSpun;
  EXPECT_EQ(t.message(), "the vehicle spun: it goes backwards (at 12.500 s)");
}

TEST(VehicleTrajectory, HasAnotherWordForEveryEndOfADrive) {
  std::set<std::string_view> words;
  for (const DriveEnd end : {DriveEnd::kCompleted, DriveEnd::kStopped, DriveEnd::kSpun, DriveEnd::kRolledOver,
                             DriveEnd::kInterrupted, DriveEnd::kDiverged}) {
    EXPECT_FALSE(to_string(end).empty());
    words.insert(to_string(end));
  }
  EXPECT_EQ(words.size(), 6U);
}

TEST(VehicleTrajectory, NamesWheelsThatLeftTheGroundEightAtMost) {
  VehicleTrajectory t;
  t.lift_offs = {{.wheel = 1, .from = 2.0, .to = 2.25}};
  EXPECT_EQ(t.message(), "driven to the end; wheel fr off the ground from 2.000 to 2.250 s");
  t.lift_offs.assign(8, {.wheel = 3, .from = 1.0, .to = 1.5});
  EXPECT_EQ(t.message().find(" more"), std::string::npos);
  t.lift_offs.assign(11, {.wheel = 3, .from = 1.0, .to = 1.5});
  EXPECT_TRUE(t.message().ends_with("wheel rr off the ground from 1.000 to 1.500 s; 3 more")) << t.message();
}

TEST(VehicleTrajectory, IsUsableUnlessInterruptedOrDiverged) {
  VehicleTrajectory t;
  for (const auto& [end, usable] : {std::pair{DriveEnd::kCompleted, true},
                                    {DriveEnd::kStopped, true},
                                    {DriveEnd::kRolledOver, true},
                                    {DriveEnd::kInterrupted, false},
                                    {DriveEnd::kDiverged, false}}) {
    t.end = end;
    EXPECT_EQ(t.usable(), usable) << to_string(end);
  }
}

}  // namespace
}  // namespace veridyn::vehicle
