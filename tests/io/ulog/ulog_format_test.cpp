#include "veridyn/io/ulog/ulog_format.hpp"

#include <gtest/gtest.h>

namespace veridyn::io {
namespace {

TEST(ULogFormat, ResolvesArraysAndNestedMessages) {
  const ULogFormats formats{{"esc_status", "uint64_t timestamp;esc_report[2] esc;uint8_t[4] _padding0;"},
                            {"esc_report", "float esc_voltage;int16_t[2] rpm;char[6] name;"}};
  const auto layout = resolve_ulog_format(formats, "esc_status");
  ASSERT_TRUE(layout.has_value());
  ASSERT_EQ(layout->fields.size(), 9u);
  EXPECT_EQ(layout->fields[0].name, "timestamp");
  EXPECT_EQ(layout->fields[5].name, "esc[1].esc_voltage");
  EXPECT_EQ(layout->fields[5].base_name, "esc_voltage");
  EXPECT_EQ(layout->fields[5].offset, 8u + 14u);
  EXPECT_EQ(layout->fields[7].name, "esc[1].rpm[1]");
  EXPECT_EQ(layout->fields[7].type, GatherType::kInt16);
  EXPECT_EQ(layout->fields[8].type, GatherType::kText);
  EXPECT_EQ(layout->fields[8].size, 6u);
  // Padding at the end is not logged.
  EXPECT_EQ(layout->size, 8u + 2u * 14u);
}

TEST(ULogFormat, RefusesWhatCannotBeResolved) {
  const auto resolved = [](const ULogFormats& formats) { return resolve_ulog_format(formats, "a").has_value(); };
  EXPECT_TRUE(resolved({{"a", "float x;"}}));
  EXPECT_FALSE(resolved({}));
  EXPECT_FALSE(resolved({{"a", "unknown x;"}}));
  EXPECT_FALSE(resolved({{"a", "float;"}}));
  EXPECT_FALSE(resolved({{"a", "float[2 x;"}}));
  EXPECT_FALSE(resolved({{"a", "float[20000] x;"}}));
  EXPECT_FALSE(resolved({{"a", "a inner;"}}));
  EXPECT_FALSE(resolved({{"a", "b[60000] x;"}, {"b", "c[60000] y;"}, {"c", "int8_t z;"}}));
}

}  // namespace
}  // namespace veridyn::io
