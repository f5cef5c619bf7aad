#include "veridyn/vehicle/identification/signals/drive_log.hpp"

namespace veridyn::vehicle {

std::span<const recording::ChannelAlias> drive_channel_aliases() {
  static constexpr recording::ChannelAlias kAliases[] = {
      {"delta", "steer"},
      {"roadwheelangle", "steer"},
      {"steeringwheelangle", "steering_wheel"},
      {"swa", "steering_wheel"},
      {"handwheelangle", "steering_wheel"},
      {"steeringangle", "steering_wheel", "hand wheel, or road wheels (then `steer`)?", true},
      {"steerangle", "steering_wheel", "hand wheel, or road wheels (then `steer`)?", true},
      {"vx", "speed"},
      {"v", "speed"},
      {"velocity", "speed"},
      {"vehiclespeed", "speed"},
      {"vehspeed", "speed"},
      {"groundspeed", "speed"},
      {"yawrate", "yaw_rate"},
      {"r", "yaw_rate"},
      {"rollrate", "roll_rate"},
      {"ax", "accel_x"},
      {"longacc", "accel_x"},
      {"longitudinalacceleration", "accel_x"},
      {"ay", "accel_y"},
      {"latacc", "accel_y"},
      {"lateralacceleration", "accel_y"},
      {"az", "accel_z"},
      {"vy", "lateral_velocity"},
      {"lateralvelocity", "lateral_velocity"},
      {"beta", "sideslip"},
      {"sideslipangle", "sideslip"},
      {"slipangle", "sideslip", "of the car, not of a tyre?", true},
      {"phi", "roll"},
      {"rollangle", "roll"},
      {"theta", "pitch"},
      {"pitchangle", "pitch"},
      {"psi", "yaw"},
      {"heading", "yaw", "compass headings turn the other way: frame = \"frd\"?", true},
      {"courseoverground", "course", "compass courses turn the other way: frame = \"frd\"?", true},
      {"wheelspeedfrontleft", "wheel_speed_fl"},
      {"wheelspeedfrontright", "wheel_speed_fr"},
      {"wheelspeedrearleft", "wheel_speed_rl"},
      {"wheelspeedrearright", "wheel_speed_rr"},
  };
  return kAliases;
}

}  // namespace veridyn::vehicle
