#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/recording/channel_map.hpp"
#include "veridyn/recording/channel_recognition.hpp"

namespace veridyn::vehicle {

/// All standard names of vehicle recordings with their SI units: `steer` (road wheels), `steering_wheel` (hand wheel),
/// `speed` (forward, of the centre of gravity), `yaw_rate` (or `gyro_z`), `accel_x|y|z` (specific force),
/// `lateral_velocity` (of the centre of gravity), `sideslip`, `roll`, `pitch`, `yaw`, `course`, `roll_rate`,
/// `wheel_speed_fl|fr|rl|rr` (of rotation), `wheel_velocity_fl|fr|rl|rr` (of the tread, as CAN has it; wheel speeds
/// that are recorded in km/h are these), `pos_x`, `pos_y`.
[[nodiscard]] std::span<const recording::StandardChannel> standard_drive_channels();

/// Other names under which these are recorded: "YawRate", "vx", "delta".
[[nodiscard]] std::span<const recording::ChannelAlias> drive_channel_aliases();

/// A drive as the study's `[data]` names it: channels with standard names, in frame flu.
struct DriveLog {
  recording::MappedRecording mapped;
  std::vector<TimeSpan> runs;          ///< the stretch of each recording; later runs follow earlier ones
  std::vector<TimeSpan> holdout_runs;  ///< of these, those that identification must not use
  std::vector<std::filesystem::path> inputs;
};

/// Gives the channels of a log their standard names and turns them into flu: those of telemetry logs of MAVLink and of
/// recordings of ROS by their messages, others by their names and by `map`, which wins.
///
/// `frame` is that of the log, "flu" or "frd" (then y, z, yaw, steering and course change their sign);
/// empty: the frame of the log itself, flu with a note where it has none.
/// @throws InputError for unknown names, sources that the log lacks, units of another kind, an unknown frame.
[[nodiscard]] recording::MappedRecording map_drive_channels(const Recording& recorded, const StudyTable& map,
                                                            std::string_view frame = {},
                                                            std::string_view frame_place = {});

/// Reads `[data]`: `frame`, `[data.map]`, and what recording::read_study_recordings reads: one drive, or several of the
/// same vehicle,
///
///     runs = ["run1.csv", "run2.csv"]       # for identification (and hold-out, where nothing else is named for that)
///     holdout_runs = ["run3.csv"]           # never used by identification
///     [[data.run]]                          # one that needs keys of its own: file, from, to, part, frame, map, ...
///
/// which are laid one after the other on the time axis with 10 s between them.
/// @throws InputError
[[nodiscard]] DriveLog read_drive_log(const StudyTable& data);

}  // namespace veridyn::vehicle
