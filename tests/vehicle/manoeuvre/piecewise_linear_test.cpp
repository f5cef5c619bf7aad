#include "veridyn/vehicle/manoeuvre/piecewise_linear.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/refusal.hpp"

namespace veridyn::vehicle {
namespace {

using ::testing::HasSubstr;

TEST(PiecewiseLinear, IsStraightBetweenItsSamplesAndConstantBeyond) {
  const PiecewiseLinear f({1.0, 2.0, 4.0}, {3.0, 5.0, 1.0});
  EXPECT_EQ(f(0.0), 3.0);
  EXPECT_EQ(f(1.5), 4.0);
  EXPECT_EQ(f(2.0), 5.0);
  EXPECT_EQ(f(3.5), 2.0);
  EXPECT_EQ(f(9.0), 1.0);
  EXPECT_EQ(PiecewiseLinear(7.0)(-3.0), 7.0);
  EXPECT_EQ(PiecewiseLinear()(1.0), 0.0);
}

TEST(PiecewiseLinear, RefusesWhatIsNoFunctionOfTime) {
  const auto refusal = [](std::vector<double> time, std::vector<double> value) {
    return why([&] { static_cast<void>(PiecewiseLinear(time, value)); });
  };
  EXPECT_THAT(refusal({0.0, 1.0}, {0.0}), HasSubstr("2 times and 1 values"));
  EXPECT_THAT(refusal({0.0, 0.0}, {0.0, 1.0}), HasSubstr("sample 2 at 0 s is not after"));
  EXPECT_THAT(refusal({0.0, std::nan("")}, {0.0, 1.0}), HasSubstr("sample 2 is not finite"));
}

}  // namespace
}  // namespace veridyn::vehicle
