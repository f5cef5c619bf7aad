#include "veridyn/io/ros/message_definition.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace veridyn::io::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

std::vector<std::string> in_words(const RosFields& fields) {
  std::vector<std::string> words;
  for (const RosField& f : fields) {
    std::string text = f.type + " " + f.name;
    if (f.shape == RosField::Shape::kSequence) text += " []";
    if (f.shape == RosField::Shape::kArray) text += " [" + std::to_string(f.count) + "]";
    words.push_back(text);
  }
  return words;
}

TEST(RosDefinitions, HasTheFieldsAndLeavesOutConstantsCommentsAndDefaults) {
  const auto parsed = parse_ros_definitions("my_msgs/msg/Wheel",
                                            "# a wheel\r\n"
                                            "uint8 LEFT=1\n"
                                            "string NAME = \"a # no comment\"  # a constant\n"
                                            "\n"
                                            "  Header header\n"
                                            "float64 speed 1.5  # m/s\n"
                                            "string<=10 label \"x\"\n"
                                            "int8[<=4] codes\n"
                                            "float32[9] covariance\n"
                                            "Point[] points\n"
                                            "geometry_msgs/msg/Pose pose\n"
                                            "time stamp\n"
                                            "================================================================\n"
                                            "MSG: my_msgs/Point\n"
                                            "float64 x\n");
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->root, "my_msgs/Wheel");
  EXPECT_THAT(
      in_words(parsed->types.at("my_msgs/Wheel")),
      ElementsAre("std_msgs/Header header", "float64 speed", "string label", "int8 codes []", "float32 covariance [9]",
                  "my_msgs/Point points []", "geometry_msgs/Pose pose", "builtin_interfaces/Time stamp"));
  EXPECT_THAT(in_words(parsed->types.at("my_msgs/Point")), ElementsAre("float64 x"));
}

TEST(RosDefinitions, AreNoneWhereALineCannotBeUnderstood) {
  for (const char* text : {"float64", "float64[ x", "float64[0] x", "float64[two] x", "flo@t x", "float64 ?",
                           "float64 x\n==========\nIDL: a/b\n", "[3] x"})
    EXPECT_FALSE(parse_ros_definitions("a/msg/B", text)) << text;
  std::string many;
  for (int i = 0; i < 10001; ++i) many += "bool b\n";
  EXPECT_FALSE(parse_ros_definitions("a/msg/B", many));
}

TEST(RosDefinitions, OfAMessageWithoutFieldsHasNone) {
  const auto parsed = parse_ros_definitions("std_msgs/msg/Empty", "\n# nothing\n");
  ASSERT_TRUE(parsed);
  EXPECT_TRUE(parsed->types.at("std_msgs/Empty").empty());
}

}  // namespace
}  // namespace veridyn::io::internal
