#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/recording.hpp"

namespace veridyn::recording {

/// Three components with one time base, and where they are from.
struct RosVector {
  TimeBase time;
  std::array<std::vector<double>, 3> value;
  std::string source;
  std::string note;
};

/// Angles of base_link against the world, 3-2-1 [rad].
struct RosAngles {
  TimeBase time;
  std::vector<double> roll;   ///< left side up
  std::vector<double> pitch;  ///< nose down
  std::vector<double> yaw;    ///< left, from the world's first axis (east)
  std::string source;
  std::string note;
};

/// The motion of what carries the sensors of a recording of ROS, in the axes of REP 103: x forward, y left, z up of
/// base_link; the world in east, north, up.
struct RosMotion {
  std::optional<RosVector> specific_force;  ///< of an Imu [m/s^2]
  std::optional<RosVector> rates;           ///< of an Imu, else of an Odometry [rad/s]
  std::optional<RosVector> magnetic_field;  ///< [T]
  std::optional<RosVector> velocity_body;   ///< of an Odometry, else of a Twist in base_link [m/s]
  std::optional<RosVector> velocity_world;  ///< of a receiver's Twist, else of an Odometry turned by its own attitude
  std::optional<RosVector> position;        ///< of an Odometry [m]
  std::optional<RosAngles> attitude;        ///< of the Odometry where the velocity is its, else of the Imu
  bool receiver_velocity = false;           ///< `velocity_world` is a topic's own
  bool odometry_attitude = false;           ///< `attitude` is the Odometry's
  std::vector<std::string> notes;
};

/// Finds it by the types of the topics, never by their names: sensor_msgs/Imu and MagneticField, nav_msgs/Odometry,
/// geometry_msgs/TwistStamped and TwistWithCovarianceStamped whose frame says what they are in (map, odom, a
/// receiver's: the world; base_link: the body). Of several topics of a type that with the most samples is taken, and
/// noted. Vectors in a sensor's frame are turned into base_link by /tf_static; where it holds no transform of the frame
/// its axes are taken for those of base_link, and noted.
///
/// An Imu whose upward specific force has a median that is not near gravity is not in these axes, or has no gravity in
/// it: it is left out, and noted.
[[nodiscard]] RosMotion ros_motion(const Recording& log);

}  // namespace veridyn::recording
