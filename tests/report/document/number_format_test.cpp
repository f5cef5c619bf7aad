#include "veridyn/report/document/number_format.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "veridyn/core/constants.hpp"

namespace veridyn::report {
namespace {

TEST(FormatNumber, ShowsSignificantDigits) {
  EXPECT_EQ(format_number(0.0, 4), "0");
  EXPECT_EQ(format_number(4.97312, 4), "4.973");
  EXPECT_EQ(format_number(-0.0113249, 3), "−0.0113");
  EXPECT_EQ(format_number(123456.0, 4), "123456");
  EXPECT_EQ(format_number(9.99996, 4), "10.00");
  EXPECT_EQ(format_number(3.1e-5, 2), "3.1e−5");
  EXPECT_EQ(format_number(-2.5e9, 2), "−2.5e9");
  EXPECT_EQ(format_number(kNaN, 4), "–");
  EXPECT_EQ(format_number(std::numeric_limits<double>::infinity(), 4), "–");
}

TEST(FormatDecimals, HasNoNegativeZero) {
  EXPECT_EQ(format_decimals(-0.001, 2), "0.00");
  EXPECT_EQ(format_decimals(-0.006, 2), "−0.01");
}

// The usual rule: two significant digits of sigma decide.
TEST(MeasuredCell, TakesItsDecimalsFromSigma) {
  EXPECT_EQ(cell_text(measured_cell(0.42317, 0.0123), {}), "0.423");
  EXPECT_EQ(cell_text(measured_cell(0.42317, 0.0996), {}), "0.42");
  EXPECT_EQ(cell_text(measured_cell(-14.812, 0.731), {}), "−14.81");
  EXPECT_EQ(cell_text(measured_cell(1234.5, 210.0), {}), "1234" /* half to even */);
  EXPECT_EQ(cell_text(measured_cell(0.42317, 0.0), {}), "0.4232");
  EXPECT_EQ(cell_text(measured_cell(0.42317, kNaN), {}), "0.4232");
  EXPECT_EQ(cell_text(measured_cell(kNaN, 0.1), {}), "–");
}

TEST(RoundForStorage, StaysWithinHalfAStep) {
  const std::vector<double> values = {17.123456789, 25.98765432, 18.0, kNaN};
  const std::vector<double> rounded = round_for_storage(values, 20000.0);
  EXPECT_THAT(rounded[0], testing::DoubleEq(17.1235));
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(rounded[k], values[k], 0.5 * (25.98765432 - 17.123456789) / 20000.0);
  }
  EXPECT_TRUE(std::isnan(rounded[3]));
}

TEST(RoundForStorage, KeepsTheExtremesOfDoubleUsable) {
  for (const double scale : {1e-300, 1e-12, 1.0, 1e12, 1e300}) {
    const std::vector<double> rounded = round_for_storage({0.0, 0.123456789 * scale, scale}, 20000.0);
    EXPECT_NEAR(rounded[1] / scale, 0.123456789, 1e-4) << scale;
  }
  // A small range far from zero has no digits to lose.
  const std::vector<double> far = round_for_storage({1e9, 1e9 + 1e-3}, 20000.0);
  EXPECT_NEAR(far[1] - far[0], 1e-3, 1e-6);
}

TEST(ResolvedAlign, SetsNumbersToTheRight) {
  const Table table{.columns = {{.name = "a"}, {.name = "b"}, {.name = "c", .align = Align::kCenter}},
                    .rows = {{.cells = {text_cell("x"), text_cell("–"), number_cell(1)}},
                             {.cells = {text_cell("y"), number_cell(2), number_cell(1)}}}};
  EXPECT_EQ(resolved_align(table, 0), Align::kLeft);
  EXPECT_EQ(resolved_align(table, 1), Align::kRight);
  EXPECT_EQ(resolved_align(table, 2), Align::kCenter);
}

}  // namespace
}  // namespace veridyn::report
