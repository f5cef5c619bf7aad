#include "veridyn/core/text.hpp"

#include <gtest/gtest.h>

#include "veridyn/core/study.hpp"

namespace veridyn {
namespace {

TEST(Text, IsTrimmedAtItsEndsOnly) {
  EXPECT_EQ(trimmed(" \ta b\r\n "), "a b");
  EXPECT_EQ(trimmed(" \t\r"), "");
}

TEST(Text, IsShownPrintableAndShort) {
  EXPECT_EQ(shown(std::string("a\0b\xff", 4)), "a?b?");
  const std::string shortened = shown(std::string(50, 'x'));
  EXPECT_EQ(shortened.size(), 43u);
  EXPECT_TRUE(shortened.ends_with("x..."));
}

TEST(Text, CapitalsAreThoseOfAscii) { EXPECT_EQ(upper("pac2002_\xc3\xa9"), "PAC2002_\xc3\xa9"); }

TEST(Text, SmallLettersAreThoseOfAscii) { EXPECT_EQ(lower("PAC2002_\xc3\x89"), "pac2002_\xc3\x89"); }

TEST(Text, IsAStringOfToml) {
  EXPECT_EQ(toml_text("C:\\logs \"new\""), R"("C:\\logs \"new\"")");
  EXPECT_EQ(toml_text("a\nb\x7f"), R"("a\u000Ab\u007F")");
  EXPECT_EQ(toml_text("\xc3\xa9"), "\"\xc3\xa9\"");
  for (const char* text : {"", "two\nlines\twith \"quotes\" and \\", "\x01"})
    EXPECT_EQ(Study::parse(std::string("name = ") + toml_text(text), "s.toml").root().text("name"), text);
}

}  // namespace
}  // namespace veridyn
