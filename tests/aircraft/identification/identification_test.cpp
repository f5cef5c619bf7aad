#include "veridyn/aircraft/identification/identification.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Identification, SaysHowMuchLargerTheResidualIsThanTheSensorsLeave) {
  CoefficientResult result;
  result.error_ratio = 9.0;
  result.unmodelled_share = 0.25;
  EXPECT_THAT(unmodelled_text(result), HasSubstr("25 % of its variance"));
  EXPECT_THAT(unmodelled_text(result), HasSubstr("residual 3.0 times"));
}

// Where the errors of the regressors leave no signal, the ratio is unknown or, as a difference of variances, negative:
// this used to print "residual -nan times".
TEST(Identification, PrintsNoRatioWhereTheRegressorsLeaveNoSignal) {
  for (const double ratio : {kNaN, -0.4, 0.0}) {
    CoefficientResult result;
    result.error_ratio = ratio;
    result.unmodelled_share = ratio == ratio ? 1.2 : kNaN;
    EXPECT_THAT(unmodelled_text(result), Not(HasSubstr("nan"))) << ratio;
    EXPECT_THAT(unmodelled_text(result), HasSubstr("leave no signal")) << ratio;
  }
}

TEST(Identification, AxisOfACoefficientIsWhatItsMotionIs) {
  for (const Coefficient c : {Coefficient::kCL, Coefficient::kCD, Coefficient::kCm})
    EXPECT_EQ(axis_of(c), Axis::kLongitudinal);
  for (const Coefficient c : {Coefficient::kCY, Coefficient::kCl, Coefficient::kCn})
    EXPECT_EQ(axis_of(c), Axis::kLateral);
}

}  // namespace
}  // namespace veridyn::aircraft
