#include "veridyn/io/ros/standard_messages.hpp"

#include <map>
#include <string>

#include "veridyn/core/assert.hpp"

namespace veridyn::io::internal {
namespace {

/// As the packages common_interfaces, ackermann_msgs, mavros and autoware_msgs define them, comments left out.
constexpr std::string_view kMessages = R"(
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
================================================================================
MSG: builtin_interfaces/Duration
int32 sec
uint32 nanosec
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: std_msgs/Bool
bool data
================================================================================
MSG: std_msgs/Int8
int8 data
================================================================================
MSG: std_msgs/Int16
int16 data
================================================================================
MSG: std_msgs/Int32
int32 data
================================================================================
MSG: std_msgs/Int64
int64 data
================================================================================
MSG: std_msgs/UInt8
uint8 data
================================================================================
MSG: std_msgs/UInt16
uint16 data
================================================================================
MSG: std_msgs/UInt32
uint32 data
================================================================================
MSG: std_msgs/UInt64
uint64 data
================================================================================
MSG: std_msgs/Float32
float32 data
================================================================================
MSG: std_msgs/Float64
float64 data
================================================================================
MSG: std_msgs/MultiArrayDimension
string label
uint32 size
uint32 stride
================================================================================
MSG: std_msgs/MultiArrayLayout
MultiArrayDimension[] dim
uint32 data_offset
================================================================================
MSG: std_msgs/Float32MultiArray
MultiArrayLayout layout
float32[] data
================================================================================
MSG: std_msgs/Float64MultiArray
MultiArrayLayout layout
float64[] data
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
================================================================================
MSG: geometry_msgs/Vector3Stamped
std_msgs/Header header
Vector3 vector
================================================================================
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
================================================================================
MSG: geometry_msgs/PointStamped
std_msgs/Header header
Point point
================================================================================
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
================================================================================
MSG: geometry_msgs/QuaternionStamped
std_msgs/Header header
Quaternion quaternion
================================================================================
MSG: geometry_msgs/Pose
Point position
Quaternion orientation
================================================================================
MSG: geometry_msgs/PoseStamped
std_msgs/Header header
Pose pose
================================================================================
MSG: geometry_msgs/PoseWithCovariance
Pose pose
float64[36] covariance
================================================================================
MSG: geometry_msgs/PoseWithCovarianceStamped
std_msgs/Header header
PoseWithCovariance pose
================================================================================
MSG: geometry_msgs/Twist
Vector3 linear
Vector3 angular
================================================================================
MSG: geometry_msgs/TwistStamped
std_msgs/Header header
Twist twist
================================================================================
MSG: geometry_msgs/TwistWithCovariance
Twist twist
float64[36] covariance
================================================================================
MSG: geometry_msgs/TwistWithCovarianceStamped
std_msgs/Header header
TwistWithCovariance twist
================================================================================
MSG: geometry_msgs/Accel
Vector3 linear
Vector3 angular
================================================================================
MSG: geometry_msgs/AccelStamped
std_msgs/Header header
Accel accel
================================================================================
MSG: geometry_msgs/AccelWithCovariance
Accel accel
float64[36] covariance
================================================================================
MSG: geometry_msgs/AccelWithCovarianceStamped
std_msgs/Header header
AccelWithCovariance accel
================================================================================
MSG: geometry_msgs/Wrench
Vector3 force
Vector3 torque
================================================================================
MSG: geometry_msgs/WrenchStamped
std_msgs/Header header
Wrench wrench
================================================================================
MSG: geometry_msgs/Transform
Vector3 translation
Quaternion rotation
================================================================================
MSG: geometry_msgs/TransformStamped
std_msgs/Header header
string child_frame_id
Transform transform
================================================================================
MSG: sensor_msgs/Imu
std_msgs/Header header
geometry_msgs/Quaternion orientation
float64[9] orientation_covariance
geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance
geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance
================================================================================
MSG: sensor_msgs/NavSatStatus
int8 status
uint16 service
================================================================================
MSG: sensor_msgs/NavSatFix
std_msgs/Header header
NavSatStatus status
float64 latitude
float64 longitude
float64 altitude
float64[9] position_covariance
uint8 position_covariance_type
================================================================================
MSG: sensor_msgs/MagneticField
std_msgs/Header header
geometry_msgs/Vector3 magnetic_field
float64[9] magnetic_field_covariance
================================================================================
MSG: sensor_msgs/FluidPressure
std_msgs/Header header
float64 fluid_pressure
float64 variance
================================================================================
MSG: sensor_msgs/Temperature
std_msgs/Header header
float64 temperature
float64 variance
================================================================================
MSG: sensor_msgs/RelativeHumidity
std_msgs/Header header
float64 relative_humidity
float64 variance
================================================================================
MSG: sensor_msgs/JointState
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: sensor_msgs/Joy
std_msgs/Header header
float32[] axes
int32[] buttons
================================================================================
MSG: nav_msgs/Odometry
std_msgs/Header header
string child_frame_id
geometry_msgs/PoseWithCovariance pose
geometry_msgs/TwistWithCovariance twist
================================================================================
MSG: ackermann_msgs/AckermannDrive
float32 steering_angle
float32 steering_angle_velocity
float32 speed
float32 acceleration
float32 jerk
================================================================================
MSG: ackermann_msgs/AckermannDriveStamped
std_msgs/Header header
AckermannDrive drive
================================================================================
MSG: mavros_msgs/VfrHud
std_msgs/Header header
float32 airspeed
float32 groundspeed
int16 heading
float32 throttle
float32 altitude
float32 climb
================================================================================
MSG: mavros_msgs/RCOut
std_msgs/Header header
uint16[] channels
================================================================================
MSG: autoware_vehicle_msgs/VelocityReport
std_msgs/Header header
float32 longitudinal_velocity
float32 lateral_velocity
float32 heading_rate
================================================================================
MSG: autoware_vehicle_msgs/SteeringReport
builtin_interfaces/Time stamp
float32 steering_tire_angle
================================================================================
MSG: autoware_auto_vehicle_msgs/VelocityReport
std_msgs/Header header
float32 longitudinal_velocity
float32 lateral_velocity
float32 heading_rate
================================================================================
MSG: autoware_auto_vehicle_msgs/SteeringReport
builtin_interfaces/Time stamp
float32 steering_tire_angle
)";

struct UnitRow {
  std::string_view type, field, unit;
};

constexpr UnitRow kUnits[] = {
    {"geometry_msgs/Twist", "linear", "m/s"},
    {"geometry_msgs/Twist", "angular", "rad/s"},
    {"geometry_msgs/Accel", "linear", "m/s^2"},
    {"geometry_msgs/Accel", "angular", "rad/s^2"},
    {"geometry_msgs/Wrench", "force", "N"},
    {"geometry_msgs/Wrench", "torque", "N m"},
    {"geometry_msgs/Pose", "position", "m"},
    {"geometry_msgs/PointStamped", "point", "m"},
    {"geometry_msgs/Transform", "translation", "m"},
    {"sensor_msgs/Imu", "angular_velocity", "rad/s"},
    {"sensor_msgs/Imu", "linear_acceleration", "m/s^2"},
    {"sensor_msgs/NavSatFix", "latitude", "deg"},
    {"sensor_msgs/NavSatFix", "longitude", "deg"},
    {"sensor_msgs/NavSatFix", "altitude", "m"},
    {"sensor_msgs/MagneticField", "magnetic_field", "T"},
    {"sensor_msgs/FluidPressure", "fluid_pressure", "Pa"},
    {"sensor_msgs/Temperature", "temperature", "degC"},
    {"ackermann_msgs/AckermannDrive", "steering_angle", "rad"},
    {"ackermann_msgs/AckermannDrive", "steering_angle_velocity", "rad/s"},
    {"ackermann_msgs/AckermannDrive", "speed", "m/s"},
    {"ackermann_msgs/AckermannDrive", "acceleration", "m/s^2"},
    {"mavros_msgs/VfrHud", "airspeed", "m/s"},
    {"mavros_msgs/VfrHud", "groundspeed", "m/s"},
    {"mavros_msgs/VfrHud", "heading", "deg"},
    {"mavros_msgs/VfrHud", "altitude", "m"},
    {"mavros_msgs/VfrHud", "climb", "m/s"},
    {"mavros_msgs/RCOut", "channels", "us"},
    {"autoware_vehicle_msgs/VelocityReport", "longitudinal_velocity", "m/s"},
    {"autoware_vehicle_msgs/VelocityReport", "lateral_velocity", "m/s"},
    {"autoware_vehicle_msgs/VelocityReport", "heading_rate", "rad/s"},
    {"autoware_vehicle_msgs/SteeringReport", "steering_tire_angle", "rad"},
    {"autoware_auto_vehicle_msgs/VelocityReport", "longitudinal_velocity", "m/s"},
    {"autoware_auto_vehicle_msgs/VelocityReport", "lateral_velocity", "m/s"},
    {"autoware_auto_vehicle_msgs/VelocityReport", "heading_rate", "rad/s"},
    {"autoware_auto_vehicle_msgs/SteeringReport", "steering_tire_angle", "rad"},
};

}  // namespace

const RosFields* find_standard_message(std::string_view type) {
  static const RosDefinitions definitions = [] {
    std::optional<RosDefinitions> parsed = parse_ros_definitions("", kMessages);
    VERIDYN_ASSERT(parsed);
    return *std::move(parsed);
  }();
  const auto found = type.empty() ? definitions.types.end() : definitions.types.find(type);
  return found == definitions.types.end() ? nullptr : &found->second;
}

std::string_view ros_unit(std::string_view type, std::string_view field) {
  for (const UnitRow& row : kUnits)
    if (row.type == type && row.field == field) return row.unit;
  return {};
}

}  // namespace veridyn::io::internal
