#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace veridyn::io::internal {

/// One field of a ROS message as its definition has it.
struct RosField {
  enum class Shape {
    kOne,
    kArray,     ///< `count` elements
    kSequence,  ///< as many as the message says
  };

  std::string name;
  std::string type;  ///< "float64", "string", or a message: "geometry_msgs/Vector3"
  Shape shape = Shape::kOne;
  std::size_t count = 1;
};

using RosFields = std::vector<RosField>;

/// A message and those that it is made of.
struct RosDefinitions {
  std::string root;  ///< "sensor_msgs/Imu"
  std::map<std::string, RosFields, std::less<>> types;
};

/// "sensor_msgs/Imu" of "sensor_msgs/msg/Imu".
[[nodiscard]] std::string plain_ros_type(std::string_view type);

/// Parses the text of a definition (`.msg`, of ROS 1 or 2) with the definitions of its fields' types below it, each
/// after a line of `=` and one with `MSG: package/Type`. `time` and `duration` become builtin_interfaces/Time and
/// Duration, `Header` std_msgs/Header; constants, defaults and bounds are left out. Nothing where it cannot be
/// understood, or has more than 10 000 fields.
[[nodiscard]] std::optional<RosDefinitions> parse_ros_definitions(std::string_view type, std::string_view text);

}  // namespace veridyn::io::internal
