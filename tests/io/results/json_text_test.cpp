#include "veridyn/io/results/json_text.hpp"

#include <gtest/gtest.h>

namespace veridyn::io {
namespace {

TEST(JsonText, IsOnOneLineOrIndented) {
  const nlohmann::ordered_json value = {{"b", 1}, {"a", "\"x\"\n"}};
  EXPECT_EQ(json_text(value), R"({"b":1,"a":"\"x\"\n"})");
  EXPECT_EQ(json_text(nlohmann::json{{"b", 1}}, 2), "{\n  \"b\": 1\n}");
}

TEST(JsonText, ReplacesBytesThatAreNoText) { EXPECT_EQ(json_text(nlohmann::json("a\xff")), "\"a\xef\xbf\xbd\""); }

}  // namespace
}  // namespace veridyn::io
