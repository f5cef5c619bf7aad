#include "veridyn/io/ulog/ulog_format.hpp"

#include <gtest/gtest.h>

#include "tests/io/support.hpp"
#include "tests/support/synthetic_logs.hpp"

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

std::string body(const std::string& key, const std::string& value) {
  return std::string(1, static_cast<char>(key.size())) + key + value;
}

TEST(ULogKey, HasTypeNameAndNumber) {
  const std::string bytes = body("int32_t SYS_AUTOSTART", testing::pack(std::int32_t{-2106}));
  const auto key = parse_ulog_key(bytes);
  ASSERT_TRUE(key.has_value());
  EXPECT_EQ(key->type, "int32_t");
  EXPECT_EQ(key->name, "SYS_AUTOSTART");
  EXPECT_EQ(ulog_number(*key), -2106.0);
  EXPECT_EQ(ulog_number(*parse_ulog_key(body("float X", testing::pack(0.5F)))), 0.5);
  EXPECT_EQ(ulog_number(*parse_ulog_key(body("bool X", "\x01"))), 1.0);
}

TEST(ULogKey, IsNoneWhereItIsCutAndNoNumberWhereItsValueIs) {
  EXPECT_FALSE(parse_ulog_key("").has_value());
  EXPECT_FALSE(parse_ulog_key("\x20too short").has_value());
  EXPECT_FALSE(parse_ulog_key(body("nameless", "1234")).has_value());
  EXPECT_FALSE(parse_ulog_key(body("float ", "1234")).has_value());
  EXPECT_FALSE(ulog_number(*parse_ulog_key(body("float X", "123"))).has_value());
  EXPECT_FALSE(ulog_number(*parse_ulog_key(body("char[4] X", "1234"))).has_value());
}

}  // namespace
}  // namespace veridyn::io
