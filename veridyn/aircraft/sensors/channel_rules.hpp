#pragma once

#include <array>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/aircraft/sensors/channel_map.hpp"

namespace veridyn::aircraft::internal {

/// One way to obtain a standard channel. Rules for a channel are tried in order; the first whose source is there and
/// alive is taken.
struct ChannelRule {
  std::string channel;  ///< standard name
  std::string source;   ///< channel of the log
  std::string unit;     ///< unit of the raw numbers where the log gives none
  std::string note;     ///< for the report
  double scale = 1.0;   ///< applied to the raw number before its unit
};

/// View of a log and of what is mapped of it so far, to which it adds.
class MapBuilder {
 public:
  /// @param given  the study's `[data.map]`
  MapBuilder(const Recording& log, MappedRecording& mapped, const StudyTable& given)
      : log_(log), mapped_(mapped), given_(given) {}

  /// Applies the first usable rule of each channel that is not mapped yet; the others are left.
  void apply(std::span<const ChannelRule> rules);
  /// Adds a channel that was computed from others.
  void put(std::string channel, const std::string& unit, TimeBase time, std::vector<double> value, std::string source,
           std::string note = {});
  void note(std::string text);
  /// Says of a channel of the log that it was not taken for `channel`, which is another's.
  void leave(std::string source, std::string channel);
  /// The log's channel when it is there and changes at all, else null; dead channels are noted once.
  [[nodiscard]] const Channel* alive(std::string_view name);
  [[nodiscard]] const Recording& log() const { return log_; }
  [[nodiscard]] bool mapped(std::string_view channel) const { return mapped_.recording.has(channel); }
  /// Whether the study maps a channel itself.
  [[nodiscard]] bool given(std::string_view channel) const { return given_.has(channel); }

 private:
  const Recording& log_;
  MappedRecording& mapped_;
  const StudyTable& given_;
};

using recording::interpolated;

/// By the messages that only its logs have.
[[nodiscard]] bool is_ardupilot(const Recording& log);
/// By the topics that only its logs have.
[[nodiscard]] bool is_px4(const Recording& log);
/// By the messages of a telemetry log.
[[nodiscard]] bool is_mavlink(const Recording& log);
/// Adds the channels of an ArduPilot log.
void map_ardupilot(MapBuilder& builder, const SurfaceThrows& throws);
/// Adds the channels of a PX4 log.
void map_px4(MapBuilder& builder, const SurfaceThrows& throws);

/// Adds the channels of a telemetry log of MAVLink.
void map_mavlink(MapBuilder& builder, const SurfaceThrows& throws);

/// Adds the channels of a recording of ROS, turned from forward, left, up and east, north, up.
void map_ros(MapBuilder& builder);

/// Where a log of ArduPilot has the pulses of its servos: `RCOU.C1`, or `SERVO_OUTPUT_RAW.servo1_raw`.
enum class ServoOutputs { kDataflash, kMavlink };
/// Surfaces and throttle from servo pulses, by the SERVOn_FUNCTION of the log's parameters. Without these, usual servos
/// are assumed of a log of the autopilot itself; of telemetry, which may be of another, nothing is.
void map_servos(MapBuilder& builder, const SurfaceThrows& throws, ServoOutputs outputs);
/// North, east and down of the velocity of an autopilot's filter.
using VelocitySources = std::array<std::string, 3>;
/// Takes that velocity, all components or none, where there is no GPS or it is at least half as fast again, unless one
/// is there.
/// @param gps  the first channel of the velocity of GPS, or null
/// @param filter  its name in the report: "autopilot's EKF3"
void map_filter_velocity(MapBuilder& builder, const VelocitySources& sources, const Channel* gps,
                         const std::string& filter);
/// Roll, pitch and yaw of a quaternion, scalar first.
void put_attitude(MapBuilder& builder, const std::array<const Channel*, 4>& q, const std::string& source,
                  const std::string& note = "autopilot's filter");
/// The attitude of a quaternion among columns of a table, unless roll, pitch or yaw are there or the study maps one:
/// `q0`..`q3`, `q[0]`..`q[3]` or `qw`, `qx`, `qy`, `qz` of unit length, from the body to north, east, down.
void map_table_quaternion(MapBuilder& builder);

}  // namespace veridyn::aircraft::internal
