#include "veridyn/aircraft/sensors/accelerometer_at_centre.hpp"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/recording/channel_map.hpp"
#include "veridyn/recording/lever_arm.hpp"

namespace veridyn::aircraft {
namespace {

constexpr std::array<const char*, 3> kForces{"accel_x", "accel_y", "accel_z"};
constexpr std::array<const char*, 3> kRates{"gyro_x", "gyro_y", "gyro_z"};

/// Of neighbouring samples; NaN at the ends and where stamps repeat.
Channel derivative_of(const Channel& channel) {
  Channel rate = channel;
  rate.value.assign(channel.size(), kNaN);
  const std::span<const double> t = channel.times();
  for (std::size_t k = 1; k + 1 < channel.size(); ++k)
    if (t[k + 1] > t[k - 1]) rate.value[k] = (channel.value[k + 1] - channel.value[k - 1]) / (t[k + 1] - t[k - 1]);
  return rate;
}

}  // namespace

Recording with_accelerometer_at_centre(Recording recording, const std::array<double, 3>& position) {
  const Eigen::Vector3d r(position[0], position[1], position[2]);
  const auto has = [&](const char* name) { return recording.has(name); };
  if (r.isZero(0.0) || !std::ranges::all_of(kForces, has) || !std::ranges::all_of(kRates, has)) return recording;
  std::array<Channel, 3> force;
  for (std::size_t i = 0; i < 3; ++i) force[i] = recording.at(kForces[i]);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::array<std::vector<double>, 3> rate, derivative;
    for (std::size_t i = 0; i < 3; ++i) {
      const Channel& gyro = recording.at(kRates[i]);
      rate[i] = recording::interpolated(gyro, force[axis].times());
      derivative[i] = recording::interpolated(derivative_of(gyro), force[axis].times());
    }
    for (std::size_t k = 0; k < force[axis].size(); ++k) {
      const Eigen::Vector3d w(rate[0][k], rate[1][k], rate[2][k]);
      const Eigen::Vector3d dw(derivative[0][k], derivative[1][k], derivative[2][k]);
      force[axis].value[k] -= recording::lever_arm_acceleration(dw, w, r)(static_cast<Eigen::Index>(axis));
    }
  }
  for (Channel& channel : force) recording.set(std::move(channel));
  return recording;
}

}  // namespace veridyn::aircraft
