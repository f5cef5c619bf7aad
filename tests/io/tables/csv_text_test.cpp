#include "veridyn/io/tables/csv_text.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace veridyn::io {
namespace {

TEST(CsvText, QuotesOnlyWhatWouldBreakARow) {
  EXPECT_EQ(csv_text("task 8"), "task 8");
  EXPECT_EQ(csv_text("task 8: flexion, shoulder 0 deg"), "\"task 8: flexion, shoulder 0 deg\"");
  EXPECT_EQ(csv_text("the \"long\" one"), "\"the \"\"long\"\" one\"");
  EXPECT_EQ(csv_text("two\nlines"), "\"two\nlines\"");
}

TEST(CsvText, LeavesACellWithoutANumberEmpty) {
  EXPECT_EQ(csv_number(0.1), "0.1");
  EXPECT_EQ(csv_number(std::numeric_limits<double>::quiet_NaN()), "");
  EXPECT_EQ(csv_number(-std::numeric_limits<double>::infinity()), "");
}

}  // namespace
}  // namespace veridyn::io
