#include "veridyn/aircraft/sensors/channel_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/sensors/channel_rules.hpp"
#include "veridyn/core/assert.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/recording/ros_topics.hpp"

namespace veridyn::aircraft {
namespace {

const StandardChannel& standard(std::string_view name) {
  const auto all = standard_channels();
  const auto found = std::find_if(all.begin(), all.end(), [&](const StandardChannel& c) { return c.name == name; });
  VERIDYN_ASSERT(found != all.end());
  return *found;
}

}  // namespace

std::span<const StandardChannel> standard_channels() {
  static const std::vector<StandardChannel> channels{{"accel_x", "m/s^2"},
                                                     {"accel_y", "m/s^2"},
                                                     {"accel_z", "m/s^2"},
                                                     {"gyro_x", "rad/s"},
                                                     {"gyro_y", "rad/s"},
                                                     {"gyro_z", "rad/s"},
                                                     {"roll", "rad"},
                                                     {"pitch", "rad"},
                                                     {"yaw", "rad"},
                                                     {"vel_north", "m/s"},
                                                     {"vel_east", "m/s"},
                                                     {"vel_down", "m/s"},
                                                     {"lat", "rad"},
                                                     {"lon", "rad"},
                                                     {"alt", "m"},
                                                     {"pos_north", "m"},
                                                     {"pos_east", "m"},
                                                     {"pos_down", "m"},
                                                     {"airspeed", "m/s"},
                                                     {"dynamic_pressure", "Pa"},
                                                     {"static_pressure", "Pa"},
                                                     {"air_temperature", "K"},
                                                     {"air_density", "kg/m^3"},
                                                     {"alpha", "rad"},
                                                     {"beta", "rad"},
                                                     {"elevator", "rad"},
                                                     {"aileron", "rad"},
                                                     {"rudder", "rad"},
                                                     {"throttle", "1"},
                                                     {"thrust", "N"},
                                                     {"engine_speed", "rad/s"},
                                                     {"mag_x", "T"},
                                                     {"mag_y", "T"},
                                                     {"mag_z", "T"}};
  return channels;
}

MappedRecording map_channels(const Recording& log, const StudyTable& map, const SurfaceThrows& throws) {
  MappedRecording mapped;
  mapped.recording = recording::without_channels(log);
  mapped.recording.frame = Frame::kFrd;
  const bool ros = recording::is_ros(log);
  if (log.frame == Frame::kFlu && !ros) {
    throw InputError(log.source, "its frame is flu (z up), an aircraft recording is frd (z down): convert it first");
  }
  mapped.log_kind = "study";
  mapped = recording::with_standard_channels(std::move(mapped), log, standard_channels(), map);
  internal::MapBuilder builder(log, mapped, map);
  if (internal::is_ardupilot(log)) {
    mapped.log_kind = "ArduPilot";
    internal::map_ardupilot(builder, throws);
  } else if (internal::is_px4(log)) {
    mapped.log_kind = "PX4";
    internal::map_px4(builder, throws);
  } else if (internal::is_mavlink(log)) {
    mapped.log_kind = "MAVLink";
    internal::map_mavlink(builder, throws);
  }
  if (ros) {
    if (mapped.log_kind != "PX4") mapped.log_kind = "ROS";
    internal::map_ros(builder);
  }
  internal::map_table_quaternion(builder);
  mapped = recording::with_recognised_channels(std::move(mapped), log, standard_channels(), channel_aliases(), map);
  mapped = recording::with_channel_map(std::move(mapped), log, standard_channels(), map);
  return mapped;
}

namespace internal {

void MapBuilder::apply(std::span<const ChannelRule> rules) {
  for (const ChannelRule& rule : rules) {
    if (mapped(rule.channel)) {
      leave(rule.source, rule.channel);
      continue;
    }
    const Channel* raw = alive(rule.source);
    if (raw == nullptr) continue;
    put(rule.channel, standard(rule.channel).unit, raw->time,
        recording::in_si(*raw, 0.0, raw->unit.same_dimension(Unit{}) ? rule.scale : 1.0, rule.unit), rule.source,
        rule.note);
  }
}

void MapBuilder::put(std::string channel, const std::string& unit, TimeBase time, std::vector<double> value,
                     std::string source, std::string note) {
  Channel made = make_channel(std::move(channel), unit, std::move(time), std::move(value));
  mapped_.origins.push_back({made.name, std::move(source), made.rate_Hz(), std::move(note)});
  mapped_.recording.set(std::move(made));
}

void map_filter_velocity(MapBuilder& builder, const VelocitySources& sources, const Channel* gps,
                         const std::string& filter) {
  constexpr double kFaster = 1.5;
  const Channel* north = builder.alive(sources[0]);
  if (north == nullptr || builder.mapped("vel_north")) return;
  if (gps != nullptr && north->rate_Hz() < kFaster * gps->rate_Hz()) return;
  const std::string note = gps != nullptr
                               ? fmt::format("{}, which is faster than GPS ({:.3g} Hz)", filter, gps->rate_Hz())
                               : fmt::format("{}, since GPS gives none", filter);
  builder.apply(std::vector<ChannelRule>{{"vel_north", sources[0], "m/s", note},
                                         {"vel_east", sources[1], "m/s", note},
                                         {"vel_down", sources[2], "m/s", note}});
}

void MapBuilder::leave(std::string source, std::string channel) {
  const Channel* raw = log_.find(source);
  const auto origin = std::ranges::find(mapped_.origins, channel, &recording::ChannelOrigin::channel);
  if (raw == nullptr || (origin != mapped_.origins.end() && origin->source == source)) return;
  mapped_.left.push_back({std::move(channel), std::move(source), raw->rate_Hz(), ""});
}

void MapBuilder::note(std::string text) {
  if (std::find(mapped_.notes.begin(), mapped_.notes.end(), text) == mapped_.notes.end())
    mapped_.notes.push_back(std::move(text));
}

const Channel* MapBuilder::alive(std::string_view name) {
  const Channel* channel = log_.find(name);
  if (channel == nullptr) return nullptr;
  const auto first =
      std::find_if(channel->value.begin(), channel->value.end(), [](double v) { return std::isfinite(v); });
  if (first == channel->value.end()) {
    note(fmt::format("{} holds no numbers", name));
    return nullptr;
  }
  const bool changes =
      std::any_of(first, channel->value.end(), [&](double v) { return std::isfinite(v) && v != *first; });
  if (!changes && channel->size() > 1) {
    note(fmt::format("{} is {} throughout", name, *first));
    return nullptr;
  }
  return channel;
}

}  // namespace internal

}  // namespace veridyn::aircraft
