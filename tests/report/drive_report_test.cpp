#include "veridyn/report/drive_report.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace veridyn::report {
namespace {

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

TEST(ResponseSpeed, IsTheMeanOfWhatWasDrivenFast) {
  EXPECT_DOUBLE_EQ(response_speed(std::vector<double>{0.0, 1.0, 10.0, 20.0, kNoValue}).value(), 15.0);
}

TEST(ResponseSpeed, OfASlowDriveIsItsOwn) {
  EXPECT_DOUBLE_EQ(response_speed(std::vector<double>{0.0, 1.0, 2.0}).value(), 1.5);
}

TEST(ResponseSpeed, IsMissingWhereNothingMoved) {
  EXPECT_FALSE(response_speed(std::vector<double>{0.0, kNoValue}).has_value());
  EXPECT_FALSE(response_speed(std::vector<double>{}).has_value());
}

}  // namespace
}  // namespace veridyn::report
