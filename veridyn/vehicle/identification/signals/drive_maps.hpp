#pragma once

#include <string>
#include <utility>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/recording/channel_map.hpp"

namespace veridyn::vehicle::internal {

/// Adds what a recording of ROS holds of a drive, by the types of its topics (`recording::ros_motion`): motion of Imu
/// and Odometry, steering of Autoware's SteeringReport or the one AckermannDriveStamped, speed of VelocityReport or
/// Odometry, course of a GNSS receiver. Frame flu, as ROS has it. Other recordings stay as they are.
[[nodiscard]] recording::MappedRecording with_ros_channels(recording::MappedRecording mapped, const Recording& log);

/// Adds what the log of a rover's autopilot holds of a drive: a telemetry log of MAVLink. Frame frd, as it was logged.
/// Other recordings stay as they are. Of an output that steers there are pulses, not angles: a note says how to map
/// them.
[[nodiscard]] recording::MappedRecording with_autopilot_channels(recording::MappedRecording mapped,
                                                                 const Recording& log);

/// Adds a channel and where it is from, where there is none of its name yet.
inline void put_mapped(recording::MappedRecording& mapped, const char* channel, const char* unit, const TimeBase& time,
                       std::vector<double> values, const std::string& source, const std::string& note) {
  if (mapped.recording.has(channel)) return;
  Channel made = make_channel(channel, unit, time, std::move(values));
  mapped.origins.push_back({made.name, source, made.rate_Hz(), note});
  mapped.recording.add(std::move(made));
}

}  // namespace veridyn::vehicle::internal
