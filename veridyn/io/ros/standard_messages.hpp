#pragma once

#include <string_view>

#include "veridyn/io/ros/message_definition.hpp"

namespace veridyn::io::internal {

/// The fields of a standard message of ROS 2 by its plain type ("sensor_msgs/Imu"), for recordings that do not hold
/// definitions: motion, air and GNSS of std_msgs, geometry_msgs, sensor_msgs, nav_msgs, ackermann_msgs, and of
/// mavros_msgs and Autoware what an aircraft or a car is identified from. Null for all others.
[[nodiscard]] const RosFields* find_standard_message(std::string_view type);

/// The unit that a message defines for one of its fields, and for all below it; empty where it defines none.
[[nodiscard]] std::string_view ros_unit(std::string_view type, std::string_view field);

}  // namespace veridyn::io::internal
