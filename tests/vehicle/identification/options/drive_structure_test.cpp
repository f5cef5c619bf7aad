#include "veridyn/vehicle/identification/options/drive_structure.hpp"

#include <gtest/gtest.h>

namespace veridyn::vehicle {
namespace {

TEST(DriveStructure, NamesWhatEachHas) {
  EXPECT_EQ(to_string(DriveStructure::kScaledAccel), "bicycle, accel_y scaled");
  EXPECT_EQ(to_string(DriveStructure::kRelaxation), "roll and relaxation");
  EXPECT_FALSE(has_roll(DriveStructure::kBicycle) || has_roll(DriveStructure::kScaledAccel));
  EXPECT_TRUE(has_roll(DriveStructure::kRoll) && has_roll(DriveStructure::kRelaxation));
  EXPECT_TRUE(has_relaxation(DriveStructure::kRelaxation) && !has_relaxation(DriveStructure::kRoll));
}

TEST(DriveStructure, NamesWhatIsAddedToIt) {
  EXPECT_EQ(name_of(DriveStructure::kRoll, {}), "roll");
  EXPECT_EQ(name_of(DriveStructure::kBicycle, {true, false, true}), "bicycle, banked road, load moved by pedals");
}

}  // namespace
}  // namespace veridyn::vehicle
