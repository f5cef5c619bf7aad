#include "veridyn/io/ros/message_cursor.hpp"

#include <gtest/gtest.h>

#include <string>

namespace veridyn::io::internal {
namespace {

using namespace std::string_view_literals;

TEST(MessageCursor, ReadsNumbersAndTextsOfBothByteOrders) {
  // A text of two letters and its zero, four bytes to the next multiple of 8, then 1.5.
  MessageCursor little("\3\0\0\0ab\0\0\0\0\0\0\0\0\xf8\x3f"sv, RosEncoding::kCdr, false);
  EXPECT_EQ(little.text(), "ab");
  EXPECT_EQ(little.real(), 1.5);
  EXPECT_EQ(little.left(), 0U);
  MessageCursor big("\0\0\0\3ab\0\0\x3f\xf8\0\0\0\0\0\0"sv, RosEncoding::kCdr, true);
  EXPECT_EQ(big.text(), "ab");
  EXPECT_EQ(big.real(), 1.5);
  EXPECT_FALSE(big.failed());
  MessageCursor packed("\2\0\0\0ab\0\0\0\0\0\0\xf8\x3f"sv, RosEncoding::kRos1, false);
  EXPECT_EQ(packed.text(), "ab");
  EXPECT_EQ(packed.real(), 1.5);
}

TEST(MessageCursor, ReadsNothingPastTheEnd) {
  for (const std::string_view bytes : {""sv, "\1\0\0"sv, "\xff\xff\xff\xff"sv, "\5\0\0\0abc"sv}) {
    MessageCursor cursor(bytes, RosEncoding::kCdr, false);
    EXPECT_EQ(cursor.text(), "");
    EXPECT_TRUE(cursor.failed());
    EXPECT_EQ(cursor.count(), 0U);
    EXPECT_EQ(cursor.real(), 0.0);
    EXPECT_EQ(cursor.skip(0), nullptr);
  }
  MessageCursor many("\0\0\0\0\0\0\0\0"sv, RosEncoding::kCdr, false);
  EXPECT_EQ(many.numbers(SIZE_MAX / 4, 8), nullptr) << "the product overflows";
}

TEST(MessageCursor, DoesNotAlignForNoNumbers) {
  MessageCursor cursor("\1\0\0\0\0\0\0\0\0\0"sv, RosEncoding::kCdr, false);
  (void)cursor.skip(5);
  EXPECT_NE(cursor.numbers(0, 8), nullptr);
  EXPECT_EQ(cursor.at(), 5U);
}

}  // namespace
}  // namespace veridyn::io::internal
