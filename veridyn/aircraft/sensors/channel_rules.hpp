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
  MapBuilder(const Recording& log, MappedRecording& mapped) : log_(log), mapped_(mapped) {}

  /// Applies the first usable rule of each channel that is not mapped yet.
  void apply(std::span<const ChannelRule> rules);
  /// Adds a channel that was computed from others.
  void put(std::string channel, const std::string& unit, TimeBase time, std::vector<double> value, std::string source,
           std::string note = {});
  void note(std::string text);
  /// The log's channel when it is there and changes at all, else null; dead channels are noted once.
  [[nodiscard]] const Channel* alive(std::string_view name);
  [[nodiscard]] const Recording& log() const { return log_; }
  [[nodiscard]] bool mapped(std::string_view channel) const { return mapped_.recording.has(channel); }

 private:
  const Recording& log_;
  MappedRecording& mapped_;
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
/// Roll, pitch and yaw of a quaternion, scalar first.
void put_attitude(MapBuilder& builder, const std::array<const Channel*, 4>& q, const std::string& source);

}  // namespace veridyn::aircraft::internal
