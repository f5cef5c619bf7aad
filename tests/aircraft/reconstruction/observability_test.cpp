#include "veridyn/aircraft/reconstruction/observability.hpp"

#include <gtest/gtest.h>

#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

TEST(Observability, IsJudgedByTheShareOfThePriorThatIsLeft) {
  EXPECT_EQ(observability_of(0.34, 1.0), Observability::kObservable);
  EXPECT_EQ(observability_of(0.36, 1.0), Observability::kWeak);
  EXPECT_EQ(observability_of(0.79, 1.0), Observability::kWeak);
  EXPECT_EQ(observability_of(1.62, 2.0), Observability::kNotObservable);
}

TEST(Observability, SentencesHaveAnglesInDegrees) {
  EXPECT_DOUBLE_EQ(display_value(0.5 * kPi, "rad"), 90.0);
  EXPECT_DOUBLE_EQ(display_value(kPi, "rad/s"), 180.0);
  EXPECT_EQ(display_value(3.0, "m/s"), 3.0);
  EXPECT_EQ(display_unit("rad/s"), " deg/s");
  EXPECT_EQ(display_unit("1"), "");
}

}  // namespace
}  // namespace veridyn::aircraft
