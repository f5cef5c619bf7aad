#include "veridyn/recording/ros_topics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/ros_recording.hpp"

namespace veridyn::recording {
namespace {

using testing::RosRecording;

TEST(RosTopics, AreFoundByTheirTypesWhereTheyHoldNumbersThatChange) {
  RosRecording made(3);
  made.topic("a", "std_msgs/msg/Float64").channel(".x", "1", {1, 1, 1});
  made.topic("b", "std_msgs/msg/Float64", "/map").channel(".x", "1", {1, 2, 1});
  made.topic("c", "std_msgs/Float32").channel(".x", "1", {1, 2, 1});
  const RosTopics topics(made.log());
  const auto found = topics.alive({"std_msgs/Float64", "std_msgs/Int8"}, ".x");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].name, "b");
  EXPECT_EQ(found[0].frame, "map");
  EXPECT_TRUE(is_ros(made.log()));
  EXPECT_FALSE(is_ros(Recording()));
}

// A sensor kit turned by a quarter turn to the left on the car, an IMU that hangs upside down in it.
TEST(RosTopics, TurnFramesIntoBaseLinkAlongTheTree) {
  RosRecording made(1);
  made.transform("base_link", "kit", "1 0 2 0 0 0.70710678118654752 0.70710678118654752");
  made.transform("kit", "imu", "0 0 0 1 0 0 0").transform("base_footprint", "base_link", "0 0 0.3 0 0 0 1");
  const RosTopics topics(made.log());
  Eigen::Matrix3d expected;
  // Its x shows to the car's left, its y to the right of the kit's x... forward, its z down.
  expected << 0, 1, 0, 1, 0, 0, 0, 0, -1;
  EXPECT_LT((*topics.R_base_from("imu") - expected).norm(), 1e-12);
  EXPECT_EQ(*topics.R_base_from("base_link"), Eigen::Matrix3d::Identity());
  EXPECT_FALSE(topics.R_base_from("other"));
}

TEST(RosTopics, LayChannelsOfATopicOnTheSameStamps) {
  const TimeBase whole = make_time_base({0.0, 0.1, 0.2}), part = make_time_base({0.0, 0.2});
  const Channel a = make_channel("a", "1", whole, {1, 2, 3}), b = make_channel("b", "1", part, {5, 7});
  EXPECT_EQ(at_stamps_of(a, a), a.value);
  EXPECT_THAT(at_stamps_of(b, a), ::testing::ElementsAre(5.0, ::testing::DoubleNear(6.0, 1e-12), 7.0));
  EXPECT_THAT(at_stamps_of(a, b), ::testing::ElementsAre(1.0, 3.0));
}

TEST(RosTopics, StandTransformsInACircle) {
  RosRecording made(1);
  made.transform("a", "b", "0 0 0 0 0 0 1").transform("b", "a", "0 0 0 0 0 0 1").transform("x", "y", "no numbers");
  EXPECT_FALSE(RosTopics(made.log()).R_base_from("a"));
}

}  // namespace
}  // namespace veridyn::recording
