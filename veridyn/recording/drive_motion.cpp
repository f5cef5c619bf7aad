#include "veridyn/recording/drive_motion.hpp"

#include <algorithm>

#include "veridyn/recording/channel_map.hpp"

namespace veridyn::recording {

using enum InertialChannel;

PerInertialChannel<Unit> DriveMotion::si_units() {
  static const PerInertialChannel<Unit> units = [] {
    const Unit force = parse_unit("m/s^2"), rate = parse_unit("rad/s"), angle = parse_unit("rad"),
               speed = parse_unit("m/s"), length = parse_unit("m");
    return PerInertialChannel<Unit>{force, force, force, rate,  rate,   rate,  angle,
                                    angle, angle, speed, angle, length, length};
  }();
  return units;
}

ChannelNames DriveMotion::standard_names() {
  ChannelNames names;
  for (const InertialChannel channel : enumerators<InertialChannel, kInertialChannels>())
    names[channel] = kInertialChannelNames[channel];
  return names;
}

void DriveMotion::take_unit(InertialChannel to, const Channel& channel) {
  if (channel.recorded_unit.empty() || channel.recorded_unit == "1") return;
  if (const Unit unit = parse_unit(channel.recorded_unit); unit.same_dimension(recorded_in[to])) recorded_in[to] = unit;
}

DriveMotion drive_motion(const Recording& recording) {
  DriveMotion m;
  const TimeSpan span = recording.span();
  const auto count = static_cast<std::size_t>(std::max(0.0, span.duration() / m.grid.step)) + 1;
  m.grid = {.begin = span.begin, .step = m.grid.step, .count = count};
  std::vector<double> times(count);
  for (std::size_t k = 0; k < count; ++k) times[k] = m.grid.at(k);
  const PerInertialChannel<Unit> si = DriveMotion::si_units();
  const auto take = [&](InertialChannel to, std::string_view name) {
    const Channel* channel = recording.find(name);
    if (m.has(to) || channel == nullptr || channel->size() < 2) return;
    Channel whole = *channel;
    if (si[to].same_dimension(si[kYaw])) numerics::unwrap_angles(whole.value);
    m.signals[to] = interpolated(whole, times);
    m.names[to] = name;
    m.take_unit(to, *channel);
  };
  for (const InertialChannel channel : enumerators<InertialChannel, kInertialChannels>())
    take(channel, kInertialChannelNames[channel]);
  take(kGyroZ, "yaw_rate");
  take(kGyroX, "roll_rate");
  m.hand_wheel = !m.has(kSteer);
  take(kSteer, "steering_wheel");
  m.course_for_yaw = !m.has(kYaw);
  take(kYaw, "course");
  return m;
}

}  // namespace veridyn::recording
