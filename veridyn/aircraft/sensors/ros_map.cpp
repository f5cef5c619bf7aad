#include <fmt/format.h>

#include <cmath>

#include "veridyn/aircraft/sensors/channel_rules.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/numerics/rotation.hpp"
#include "veridyn/recording/ros_motion.hpp"
#include "veridyn/recording/ros_topics.hpp"

namespace veridyn::aircraft::internal {
namespace {

using recording::RosAngles;
using recording::RosTopic;
using recording::RosTopics;
using recording::RosVector;

/// Which component becomes a channel, and its sign: forward, left, up into forward, right, down; east, north, up into
/// north, east, down.
struct Component {
  const char* channel;
  std::size_t axis;
  double sign;
};

void put_components(MapBuilder& builder, const std::optional<RosVector>& from, const char* unit,
                    std::initializer_list<Component> components) {
  if (!from) return;
  for (const Component& c : components) {
    // What stands still is not measured.
    if (builder.mapped(c.channel) || !recording::changes(from->value[c.axis])) continue;
    std::vector<double> values = from->value[c.axis];
    for (double& v : values) v *= c.sign;
    builder.put(c.channel, unit, from->time, std::move(values), fmt::format("{}.{}", from->source, "xyz"[c.axis]),
                from->note);
  }
}

void put_angles(MapBuilder& builder, const RosAngles& from) {
  if (builder.mapped("roll") || builder.mapped("pitch") || builder.mapped("yaw")) return;
  std::vector<double> pitch(from.pitch.size()), yaw(from.yaw.size());
  for (std::size_t i = 0; i < yaw.size(); ++i) {
    pitch[i] = -from.pitch[i];
    // From north to the right.
    yaw[i] = numerics::wrap_angle(0.5 * kPi - from.yaw[i]);
  }
  builder.put("roll", "rad", from.time, from.roll, from.source, from.note);
  builder.put("pitch", "rad", from.time, std::move(pitch), from.source, from.note);
  builder.put("yaw", "rad", from.time, std::move(yaw), from.source, from.note);
}

void put_channel(MapBuilder& builder, const RosTopics& topics, const RosTopic& topic, std::string_view field,
                 const char* channel, const char* unit, const char* note) {
  const Channel* const raw = topics.alive_channel(topic, field);
  if (raw != nullptr && !builder.mapped(channel))
    builder.put(channel, unit, raw->time, recording::in_si(*raw, 0.0, 1.0, unit), raw->name, note);
}

/// A FluidPressure may be of the air around, or of a pitot tube.
void put_pressures(MapBuilder& builder, const RosTopics& topics) {
  for (const RosTopic& topic : topics.alive({"sensor_msgs/FluidPressure"}, ".fluid_pressure")) {
    const Channel& raw = *topics.alive_channel(topic, ".fluid_pressure");
    const bool pitot = lower(topic.name).find("diff") != std::string::npos;
    double low = kInfinity, high = -kInfinity;
    for (const double v : raw.value) {
      low = std::fmin(low, v);
      high = std::fmax(high, v);
    }
    if (pitot && high < 2e4) {
      put_channel(builder, topics, topic, ".fluid_pressure", "dynamic_pressure", "Pa", "by its name");
    } else if (!pitot && low > 2e4 && high < 1.2e5) {
      put_channel(builder, topics, topic, ".fluid_pressure", "static_pressure", "Pa", "");
    }
  }
}

}  // namespace

void map_ros(MapBuilder& builder) {
  const RosTopics topics(builder.log());
  const recording::RosMotion motion = recording::ros_motion(builder.log());
  put_components(builder, motion.specific_force, "m/s^2",
                 {{"accel_x", 0, 1.0}, {"accel_y", 1, -1.0}, {"accel_z", 2, -1.0}});
  put_components(builder, motion.rates, "rad/s", {{"gyro_x", 0, 1.0}, {"gyro_y", 1, -1.0}, {"gyro_z", 2, -1.0}});
  put_components(builder, motion.magnetic_field, "T", {{"mag_x", 0, 1.0}, {"mag_y", 1, -1.0}, {"mag_z", 2, -1.0}});
  put_components(builder, motion.velocity_world, "m/s",
                 {{"vel_north", 1, 1.0}, {"vel_east", 0, 1.0}, {"vel_down", 2, -1.0}});
  if (motion.attitude) put_angles(builder, *motion.attitude);
  for (const RosTopic& topic : topics.alive({"sensor_msgs/NavSatFix"}, ".latitude")) {
    if (builder.mapped("lat")) break;
    put_channel(builder, topics, topic, ".latitude", "lat", "rad", "");
    put_channel(builder, topics, topic, ".longitude", "lon", "rad", "");
    put_channel(builder, topics, topic, ".altitude", "alt", "m", "above the ellipsoid");
  }
  for (const RosTopic& topic : topics.alive({"mavros_msgs/VfrHud"}, ".airspeed")) {
    put_channel(builder, topics, topic, ".airspeed", "airspeed", "m/s", "indicated");
    put_channel(builder, topics, topic, ".throttle", "throttle", "1", "");
  }
  put_pressures(builder, topics);
  for (const std::string& note : motion.notes) builder.note(note);
}

}  // namespace veridyn::aircraft::internal
