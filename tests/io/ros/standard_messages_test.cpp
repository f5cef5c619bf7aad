#include "veridyn/io/ros/standard_messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/io/ros/mcap_by_others.hpp"
#include "veridyn/io/ros/message_layout.hpp"

namespace veridyn::io::internal {
namespace {

TEST(StandardMessages, CanAllBeLaidOut) {
  for (const char* type : {"sensor_msgs/Imu",
                           "sensor_msgs/NavSatFix",
                           "sensor_msgs/MagneticField",
                           "sensor_msgs/FluidPressure",
                           "sensor_msgs/Temperature",
                           "sensor_msgs/JointState",
                           "sensor_msgs/Joy",
                           "geometry_msgs/Twist",
                           "geometry_msgs/TwistStamped",
                           "geometry_msgs/TwistWithCovarianceStamped",
                           "geometry_msgs/PoseStamped",
                           "geometry_msgs/PoseWithCovarianceStamped",
                           "geometry_msgs/Vector3Stamped",
                           "geometry_msgs/AccelStamped",
                           "geometry_msgs/AccelWithCovarianceStamped",
                           "geometry_msgs/WrenchStamped",
                           "geometry_msgs/TransformStamped",
                           "geometry_msgs/QuaternionStamped",
                           "geometry_msgs/PointStamped",
                           "nav_msgs/Odometry",
                           "ackermann_msgs/AckermannDriveStamped",
                           "std_msgs/Float64",
                           "std_msgs/Float32",
                           "std_msgs/Float64MultiArray",
                           "std_msgs/Int32",
                           "mavros_msgs/VfrHud",
                           "mavros_msgs/RCOut",
                           "autoware_vehicle_msgs/VelocityReport",
                           "autoware_vehicle_msgs/SteeringReport"}) {
    RosDefinitions definitions;
    definitions.root = type;
    const auto layout = ros_layout(definitions, RosEncoding::kCdr);
    ASSERT_TRUE(layout) << type;
    EXPECT_GT(layout->columns.size() + layout->sequences.size(), 0U) << type;
  }
  EXPECT_EQ(find_standard_message("sensor_msgs/Image"), nullptr);
  EXPECT_EQ(find_standard_message(""), nullptr);
}

// Numbers as ROS counts them (float64 [9] and so on): the bytes of a message without texts.
TEST(StandardMessages, HaveTheSizesOfRos) {
  const auto bytes_of = [](const char* type) {
    RosDefinitions definitions;
    definitions.root = type;
    return ros_layout(definitions, RosEncoding::kCdr)->steps.at(0).size[0];
  };
  EXPECT_EQ(bytes_of("geometry_msgs/Twist"), 48U);
  EXPECT_EQ(bytes_of("geometry_msgs/PoseWithCovariance"), (7U + 36U) * 8U);
  EXPECT_EQ(bytes_of("ackermann_msgs/AckermannDrive"), 20U);
}

TEST(RosUnits, AreThoseThatTheMessagesDefine) {
  EXPECT_EQ(ros_unit("sensor_msgs/Imu", "angular_velocity"), "rad/s");
  EXPECT_EQ(ros_unit("sensor_msgs/NavSatFix", "latitude"), "deg");
  EXPECT_EQ(ros_unit("sensor_msgs/JointState", "position"), "") << "metres or radians";
}

}  // namespace
}  // namespace veridyn::io::internal
