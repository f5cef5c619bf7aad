#include "veridyn/vehicle/identification/signals/drive_log.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/rotation.hpp"
#include "veridyn/recording/study_data.hpp"
#include "veridyn/vehicle/identification/signals/drive_maps.hpp"

namespace veridyn::vehicle {
namespace {

/// Time between runs that are laid one after the other: longer than any gap that interpolation bridges.
constexpr double kBetweenRuns_s = 10.0;

/// Channels that point left, up or counter-clockwise, and so change their sign with the frame.
constexpr std::array<std::string_view, 13> kTurned{
    "steer",    "steering_wheel", "yaw_rate", "gyro_y", "gyro_z", "accel_y", "accel_z", "lateral_velocity",
    "sideslip", "pitch",          "yaw",      "course", "pos_y"};

Recording turned_to_flu(const Recording& recording) {
  Recording out = recording::without_channels(recording);
  out.frame = Frame::kFlu;
  for (Channel channel : recording.channels()) {
    if (std::find(kTurned.begin(), kTurned.end(), channel.name) != kTurned.end()) {
      for (double& v : channel.value) v = -v;
    }
    out.add(std::move(channel));
  }
  return out;
}

/// Wheel speeds in km/h are speeds of the tread, not of rotation.
Recording with_wheel_velocities(const Recording& recording) {
  constexpr std::string_view kSpeed = "wheel_speed_";
  Recording out = recording::without_channels(recording);
  for (Channel channel : recording.channels()) {
    const std::string velocity = "wheel_velocity_" + channel.name.substr(std::min(kSpeed.size(), channel.name.size()));
    if (channel.name.starts_with(kSpeed) && channel.unit.same_dimension(parse_unit("m/s")) && !recording.has(velocity))
      channel.name = velocity;
    out.add(std::move(channel));
  }
  return out;
}

/// Several recordings as one, and where each is in it.
struct JoinedRuns {
  Recording recording;
  std::vector<TimeSpan> spans;
};

/// The runs one after the other on one time axis.
JoinedRuns joined(const std::vector<Recording>& runs) {
  if (runs.size() == 1) return {runs.front(), {runs.front().span()}};
  std::vector<TimeSpan> spans;
  Recording out = recording::without_channels(runs.front());
  std::vector<std::string> sources, names;
  for (const Recording& run : runs) {
    sources.push_back(std::filesystem::path(run.source).filename().string());
    for (const std::string& name : run.names()) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  out.source = fmt::format("{}", fmt::join(sources, ", "));
  std::vector<double> shift;
  double at = 0.0;
  for (const Recording& run : runs) {
    const TimeSpan span = run.span();
    shift.push_back(at - span.begin);
    spans.push_back({at, at + span.duration()});
    at += span.duration() + kBetweenRuns_s;
  }
  for (const std::string& name : names) {
    std::vector<double> stamps, values;
    Channel made;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const Channel* part = runs[i].find(name);
      if (part == nullptr) continue;
      if (made.name.empty()) {
        made = *part;
      } else if (!made.unit.same_dimension(part->unit)) {
        throw InputError(runs[i].source, fmt::format("channel '{}' is in [{}], but in [{}] in {}", name,
                                                     part->unit.si_name(), made.unit.si_name(), sources.front()));
      }
      for (const double t : part->times()) stamps.push_back(t + shift[i]);
      values.insert(values.end(), part->value.begin(), part->value.end());
    }
    made.time = make_time_base(std::move(stamps));
    made.value = std::move(values);
    out.add(std::move(made));
  }
  return {std::move(out), std::move(spans)};
}

/// With the names and the frame that a run has, or else all of them.
recording::MappedRecording map_run(const Recording& recording, const StudyTable& own, const StudyTable& shared) {
  const StudyTable &map = recording::table_with("map", own, shared),
                   &frame = recording::table_with("frame", own, shared);
  return map_drive_channels(recording, map.table_or_empty("map"), frame.text_or("frame", ""),
                            frame.has("frame") ? frame.place("frame") : std::string());
}

/// Runs that were mapped each by itself, as one: what was noted of one of them counts for all.
recording::MappedRecording together(const std::vector<recording::MappedRecording>& runs, Recording recording) {
  recording::MappedRecording out = runs.front();
  for (const recording::MappedRecording& run : runs) {
    for (const recording::ChannelOrigin& origin : run.origins)
      if (std::ranges::find(out.origins, origin.channel, &recording::ChannelOrigin::channel) == out.origins.end())
        out.origins.push_back(origin);
    for (const std::string& note : run.notes)
      if (std::ranges::find(out.notes, note) == out.notes.end()) out.notes.push_back(note);
  }
  out.recording = std::move(recording);
  return out;
}

/// Roll, pitch and sideslip within half a turn of zero: recorded from 0 to 360 deg, a little to the other side reads as
/// nearly a whole turn.
recording::MappedRecording with_angles_about_zero(recording::MappedRecording mapped) {
  for (const char* name : {"roll", "pitch", "sideslip"}) {
    const Channel* recorded = mapped.recording.find(name);
    if (recorded == nullptr) continue;
    const auto beyond = [](double angle) { return std::abs(angle) > kPi; };
    const auto count = std::ranges::count_if(recorded->value, beyond);
    if (count == 0) continue;
    Channel channel = *recorded;
    for (double& angle : channel.value)
      if (beyond(angle)) angle = numerics::wrap_angle(angle);
    mapped.notes.push_back(
        fmt::format("{}: {} readings of more than half a turn are taken as less than one the other way", name, count));
    mapped.recording.set(std::move(channel));
  }
  return mapped;
}

}  // namespace

std::span<const recording::StandardChannel> standard_drive_channels() {
  static const std::vector<recording::StandardChannel> channels{{"steer", "rad"},
                                                                {"steering_wheel", "rad"},
                                                                {"speed", "m/s"},
                                                                {"yaw_rate", "rad/s"},
                                                                {"gyro_x", "rad/s"},
                                                                {"gyro_y", "rad/s"},
                                                                {"gyro_z", "rad/s"},
                                                                {"accel_x", "m/s^2"},
                                                                {"accel_y", "m/s^2"},
                                                                {"accel_z", "m/s^2"},
                                                                {"lateral_velocity", "m/s"},
                                                                {"sideslip", "rad"},
                                                                {"roll", "rad"},
                                                                {"pitch", "rad"},
                                                                {"yaw", "rad"},
                                                                {"course", "rad"},
                                                                {"roll_rate", "rad/s"},
                                                                {"wheel_speed_fl", "rad/s"},
                                                                {"wheel_speed_fr", "rad/s"},
                                                                {"wheel_speed_rl", "rad/s"},
                                                                {"wheel_speed_rr", "rad/s"},
                                                                {"wheel_velocity_fl", "m/s"},
                                                                {"wheel_velocity_fr", "m/s"},
                                                                {"wheel_velocity_rl", "m/s"},
                                                                {"wheel_velocity_rr", "m/s"},
                                                                {"pos_x", "m"},
                                                                {"pos_y", "m"}};
  return channels;
}

recording::MappedRecording map_drive_channels(const Recording& recorded, const StudyTable& map, std::string_view frame,
                                              std::string_view frame_place) {
  const Recording log = with_wheel_velocities(recorded);
  recording::MappedRecording mapped;
  mapped.recording = recording::without_channels(log);
  mapped.log_kind = "study";
  mapped = recording::with_standard_channels(std::move(mapped), log, standard_drive_channels(), map);
  for (recording::ChannelOrigin& origin : mapped.origins)
    if (!recorded.has(origin.source))
      origin.source = "wheel_speed_" + origin.source.substr(origin.source.rfind('_') + 1);
  mapped = internal::with_autopilot_channels(std::move(mapped), log);
  mapped = internal::with_ros_channels(std::move(mapped), log);
  mapped = recording::with_recognised_channels(std::move(mapped), log, standard_drive_channels(),
                                               drive_channel_aliases(), map);
  mapped = recording::with_channel_map(std::move(mapped), log, standard_drive_channels(), map);
  bool turn = log.frame == Frame::kFrd;
  if (frame == "flu") {
    turn = false;
  } else if (frame == "frd") {
    turn = true;
  } else if (!frame.empty()) {
    throw InputError(
        frame_place.empty() ? std::string_view("data.frame") : frame_place,
        fmt::format("= '{}' must be 'flu' (x forward, y left, z up; ISO 8855) or 'frd' (y right, z down)", frame));
  } else if (log.frame == Frame::kUnspecified) {
    mapped.notes.emplace_back("the recording does not say its frame: taken as flu (y left, z up; data.frame)");
  }
  if (turn) {
    mapped.recording = turned_to_flu(mapped.recording);
    mapped.notes.emplace_back("turned from frd (y right, z down) to flu (y left, z up)");
  }
  mapped.recording.frame = Frame::kFlu;
  return with_angles_about_zero(std::move(mapped));
}

DriveLog read_drive_log(const StudyTable& data) {
  DriveLog log;
  const std::vector<recording::StudyRecording> runs = recording::read_study_recordings(data);
  for (const recording::StudyRecording& run : runs)
    log.inputs.insert(log.inputs.end(), run.files.begin(), run.files.end());
  const bool own_names = std::ranges::any_of(
      runs, [](const recording::StudyRecording& run) { return run.own.has("map") || run.own.has("frame"); });
  std::vector<Recording> recordings;
  std::vector<recording::MappedRecording> mapped;
  for (const recording::StudyRecording& run : runs) {
    if (own_names) mapped.push_back(map_run(run.recording, run.own, data));
    recordings.push_back(own_names ? mapped.back().recording : run.recording);
  }
  JoinedRuns all = joined(recordings);
  log.runs = std::move(all.spans);
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (runs[i].held_out) log.holdout_runs.push_back(log.runs[i]);
  log.mapped = own_names ? together(mapped, std::move(all.recording)) : map_run(all.recording, data, data);
  return log;
}

}  // namespace veridyn::vehicle
