#include "veridyn/io/log/column.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::io {
namespace {

TEST(Column, HoldsNumbersInTheTypeOfTheLog) {
  Column counts(std::vector<std::uint8_t>{1, 200, 255});
  EXPECT_FALSE(counts.is_text());
  EXPECT_EQ(counts.size(), 3u);
  EXPECT_DOUBLE_EQ(counts.number(1), 200.0);
  EXPECT_EQ(counts.numbers(0.5, 1.0), (std::vector<double>{1.5, 101.0, 128.5}));
  EXPECT_TRUE(counts.text(0).empty());
  counts.shorten(1);
  EXPECT_EQ(counts.size(), 1u);
}

TEST(Column, HoldsTextsInOnePieceOfMemory) {
  TextColumn texts;
  for (const char* text : {"MANUAL", "", "AUTO"}) texts.push_back(text);
  Column column(texts);
  EXPECT_TRUE(column.is_text());
  EXPECT_EQ(column.text(0), "MANUAL");
  EXPECT_EQ(column.text(1), "");
  EXPECT_EQ(column.text(2), "AUTO");
  EXPECT_TRUE(std::isnan(column.number(0)));
  EXPECT_TRUE(column.numbers().empty());
  column.shorten(2);
  EXPECT_EQ(column.size(), 2u);
  column.shorten(5);
  EXPECT_EQ(column.size(), 2u);
}

}  // namespace
}  // namespace veridyn::io
