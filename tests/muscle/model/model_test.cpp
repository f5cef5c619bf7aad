#include "veridyn/muscle/model/model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

using testing::HasSubstr;

TEST(Coordinate, HasItsEndsInRangeAndNothingBeyondThem) {
  Coordinate c;
  c.name = "elbow";
  c.low = 0.0;
  c.high = 2.0;
  EXPECT_TRUE(c.in_range(0.0));
  EXPECT_TRUE(c.in_range(2.0 + 1e-7));
  EXPECT_FALSE(c.in_range(2.001));
  EXPECT_FALSE(c.in_range(-0.001));
  EXPECT_FALSE(c.in_range(std::nan("")));
  EXPECT_EQ(c.outside_range(3.0), "coordinate 'elbow' = 3 rad is outside its range 0 .. 2");
}

TEST(Model, NamesTheNearestCoordinateAndMuscle) {
  const Model model = load_model("arm").model();
  EXPECT_THAT(model.no_coordinate("elbow_flexon"), HasSubstr("has no coordinate 'elbow_flexon'"));
  EXPECT_THAT(model.no_coordinate("elbow_flexon"), HasSubstr("elbow_flexion"));
  EXPECT_THAT(model.no_muscle("brachiali"), HasSubstr("brachialis"));
  EXPECT_EQ(model.coordinate_names().size(), model.coordinates.size());
  EXPECT_EQ(model.muscle_names().front(), model.muscles.front().name());
}

}  // namespace
}  // namespace veridyn::muscle
