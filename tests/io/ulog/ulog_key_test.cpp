#include "veridyn/io/ulog/ulog_key.hpp"

#include "tests/io/support.hpp"
#include "tests/support/synthetic_logs.hpp"

namespace veridyn::io {
namespace {

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
