#include "veridyn/io/ros/message_layout.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace veridyn::io::internal {
namespace {

using ::testing::ElementsAre;

std::optional<RosLayout> layout(const char* type, const char* text, RosEncoding encoding = RosEncoding::kCdr) {
  const auto definitions = parse_ros_definitions(type, text);
  EXPECT_TRUE(definitions);
  return ros_layout(*definitions, encoding);
}

std::vector<std::string> names(const std::vector<RosColumn>& columns) {
  std::vector<std::string> all;
  for (const RosColumn& c : columns) all.push_back(c.name + " [" + c.unit + "]");
  return all;
}

TEST(RosLayout, NamesTheNumbersOfNestedMessagesWithTheirUnits) {
  const auto made = layout("a/msg/B",
                           "std_msgs/Header header\ngeometry_msgs/Twist twist\nfloat32[2] pair\nWheel[2] wheels\n"
                           "float64[65] long\nfloat64[] some\nstring note\nWheel[] more\n"
                           "==========\nMSG: a/Wheel\nuint8 state\n");
  ASSERT_TRUE(made);
  EXPECT_TRUE(made->has_stamp);
  EXPECT_THAT(names(made->columns),
              ElementsAre("twist.linear.x [m/s]", "twist.linear.y [m/s]", "twist.linear.z [m/s]",
                          "twist.angular.x [rad/s]", "twist.angular.y [rad/s]", "twist.angular.z [rad/s]",
                          "pair[0] [1]", "pair[1] [1]", "wheels[0].state [1]", "wheels[1].state [1]"));
  EXPECT_THAT(names(made->sequences), ElementsAre("some [1]"));
}

TEST(RosLayout, CallsASingleNumberByItsTopicAlone) {
  EXPECT_THAT(names(layout("std_msgs/msg/Float64", "float64 data")->columns), ElementsAre(" [1]"));
  EXPECT_THAT(names(layout("my_msgs/msg/Float64", "float64 data")->columns), ElementsAre("data [1]"));
}

TEST(RosLayout, PutsNumbersAtMultiplesOfTheirSizeAndThoseOfRos1OneAfterTheOther) {
  // XCDR 1: after a byte at place 3 of 8, a short stands at 4, a double at 8, a byte at 16.
  const char* const text = "uint8 a\nint16 b\nfloat64 c\nuint8 d\n";
  const RosStep step = layout("a/msg/B", text)->steps.at(0);
  const auto offsets = [](const RosStep& s, std::size_t start) {
    std::vector<std::uint32_t> all;
    for (const RosNumber& n : s.numbers) all.push_back(n.offset[start]);
    return all;
  };
  EXPECT_THAT(offsets(step, 0), ElementsAre(0U, 2U, 8U, 16U));
  EXPECT_THAT(offsets(step, 3), ElementsAre(0U, 1U, 5U, 13U));
  EXPECT_EQ(step.size[0], 17U);
  EXPECT_EQ(step.size[3], 14U);
  EXPECT_THAT(offsets(layout("a/msg/B", text, RosEncoding::kRos1)->steps.at(0), 3), ElementsAre(0U, 1U, 3U, 11U));
}

TEST(RosLayout, IsNoneOfMessagesThatCannotBeLaidOut) {
  EXPECT_FALSE(layout("a/msg/B", "Unknown x"));
  EXPECT_FALSE(layout("a/msg/B", "B[] children")) << "holds itself";
  EXPECT_FALSE(layout("a/msg/B", "wstring text"));
  std::string deep;
  for (int i = 0; i < 40; ++i)
    deep += (i == 0 ? "" : "==========\nMSG: a/T" + std::to_string(i) + "\n") + std::string("T") +
            std::to_string(i + 1) + "[16] t\n";
  EXPECT_FALSE(layout("a/msg/B", deep.c_str())) << "16 to the power of 40 numbers";
}

// They would be counted for minutes.
TEST(RosLayout, HasNothingOfMessagesWithoutFieldsInRos1) {
  const char* const text = "Outer[4000000000] a\n==========\nMSG: a/Outer\nEmpty[5000] e\n==========\nMSG: a/Empty\n";
  const auto made = layout("a/B", text, RosEncoding::kRos1);
  ASSERT_TRUE(made);
  EXPECT_TRUE(made->steps.at(0).steps.empty());
  EXPECT_FALSE(layout("a/B", text)->steps.at(0).steps.empty()) << "ROS 2 has a byte for each";
}

TEST(RosLayout, TakesTheStampsOfPx4AsMicroseconds) {
  EXPECT_TRUE(layout("px4_msgs/msg/VehicleAttitude", "uint64 timestamp\nfloat32[4] q\n")->has_stamp);
  EXPECT_FALSE(layout("my_msgs/msg/A", "uint64 timestamp\n")->has_stamp);
}

}  // namespace
}  // namespace veridyn::io::internal
