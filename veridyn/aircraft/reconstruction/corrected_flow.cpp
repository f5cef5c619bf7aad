#include "veridyn/aircraft/reconstruction/corrected_flow.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/aircraft/model/air_data.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::aircraft {
namespace {

/// A channel at the stamps of another; no numbers where it is not there.
std::vector<double> at_stamps(const Recording& recording, const std::string& name, std::span<const double> stamps) {
  const Channel* channel = recording.find(name);
  if (channel == nullptr || channel->empty()) return std::vector<double>(stamps.size(), kNaN);
  return recording::interpolated(*channel, stamps);
}

/// All that the correction of a vane needs, at its stamps.
struct AtVane {
  std::vector<double> airspeed, alpha, beta;    ///< of the reconstruction
  std::array<std::vector<double>, 3> rate;      ///< [rad/s]
  std::vector<double> shown_alpha, shown_beta;  ///< by the vanes
};

/// The flow at the centre of gravity; NaN where it cannot be known.
AirData<double> corrected(const FlowSensors& sensors, const AtVane& at, std::size_t k) {
  const double V = at.airspeed[k];
  Eigen::Vector3d arm = Eigen::Vector3d::Zero();
  if (!sensors.position.isZero(0.0))
    arm = Eigen::Vector3d(at.rate[0][k], at.rate[1][k], at.rate[2][k]).cross(sensors.position);
  double alpha = (at.shown_alpha[k] - sensors.alpha_bias) / (1.0 + sensors.alpha_scale);
  double beta = at.shown_beta[k] - sensors.beta_bias;
  // What no vane shows is, at the vane, that of the reconstruction with the rotation added.
  const auto or_zero = [](double x) { return std::isfinite(x) ? x : 0.0; };
  if (!std::isfinite(alpha) || !std::isfinite(beta)) {
    const double speed = arm.isZero(0.0) ? 1.0 : V;
    const Eigen::Vector3d v = air_velocity(speed, or_zero(at.alpha[k]), or_zero(at.beta[k])) + arm;
    if (!std::isfinite(alpha)) alpha = std::atan2(v.z(), v.x());
    if (!std::isfinite(beta))
      beta = sensors.beta_is_flank ? std::atan2(v.y(), v.x()) : std::atan2(v.y(), std::hypot(v.x(), v.z()));
  }
  const double tan_beta = std::tan(beta) * (sensors.beta_is_flank ? std::cos(alpha) : 1.0);
  const Eigen::Vector3d direction = Eigen::Vector3d(std::cos(alpha), tan_beta, std::sin(alpha)).normalized();
  if (arm.isZero(0.0)) return air_data<double>(direction);
  // |s direction - arm| = V
  const double along = direction.dot(arm);
  const double s = along + std::sqrt(V * V - arm.squaredNorm() + along * along);
  if (!std::isfinite(s)) return {.Va = kNaN, .alpha = kNaN, .beta = kNaN};
  return air_data<double>(Eigen::Vector3d(s * direction - arm));
}

Channel with_values(const Channel& channel, std::vector<double> values) {
  Channel other = channel;
  other.value = std::move(values);
  return other;
}

std::string what_was_done(const FlowSensors& sensors, bool alpha, bool beta) {
  std::string text;
  const auto add = [&text](const std::string& more) { text += (text.empty() ? "vanes: " : "; ") + more; };
  if (alpha && sensors.alpha_bias != 0.0)
    add(fmt::format("estimated bias of alpha of {:.2f} deg taken off", sensors.alpha_bias / kDegree));
  if (beta && sensors.beta_bias != 0.0)
    add(fmt::format("estimated bias of beta of {:.2f} deg taken off", sensors.beta_bias / kDegree));
  if (alpha && sensors.alpha_scale != 0.0)
    add(fmt::format("alpha divided by the estimated scale {:.3f}", 1.0 + sensors.alpha_scale));
  if (beta && sensors.beta_is_flank) add("sideslip made of the flank angle");
  if (!sensors.position.isZero(0.0))
    add(fmt::format("moved by ({:.3f}, {:.3f}, {:.3f}) m to the centre of gravity", -sensors.position.x(),
                    -sensors.position.y(), -sensors.position.z()));
  return text;
}

}  // namespace

FlowSensors flow_sensors(const ReconstructOptions& options, const Recording& smoothed) {
  const auto found = [&](const char* name) {
    const Channel* channel = smoothed.find(name);
    return channel == nullptr || channel->empty() ? 0.0 : numerics::median(channel->value);
  };
  return {.position = options.vane_position,
          .beta_is_flank = options.beta_is_flank,
          .alpha_bias = found("alpha_bias"),
          .beta_bias = found("beta_bias"),
          .alpha_scale = found("alpha_scale")};
}

CorrectedFlow with_corrected_flow(recording::MappedRecording mapped, const FlowSensors& sensors,
                                  const Recording& smoothed) {
  Recording& recording = mapped.recording;
  const std::array<std::string, 2> vanes{"alpha", "beta"};
  if (sensors.exact() || (!recording.has(vanes[0]) && !recording.has(vanes[1]))) return {std::move(mapped), {}};
  std::array<std::optional<Channel>, 2> channels;
  for (std::size_t i = 0; i < 2; ++i) {
    const Channel* vane = recording.find(vanes[i]);
    if (vane == nullptr) continue;
    const std::span<const double> stamps = vane->times();
    AtVane at{.airspeed = at_stamps(smoothed, "airspeed", stamps),
              .alpha = at_stamps(smoothed, "alpha", stamps),
              .beta = at_stamps(smoothed, "beta", stamps),
              .rate = {at_stamps(recording, "gyro_x", stamps), at_stamps(recording, "gyro_y", stamps),
                       at_stamps(recording, "gyro_z", stamps)},
              .shown_alpha = i == 0 ? vane->value : at_stamps(recording, "alpha", stamps),
              .shown_beta = i == 1 ? vane->value : at_stamps(recording, "beta", stamps)};
    std::vector<double> values = vane->value;
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (!std::isfinite(values[k])) continue;
      const AirData<double> flow = corrected(sensors, at, k);
      values[k] = i == 0 ? flow.alpha : flow.beta;
    }
    channels[i] = with_values(*vane, std::move(values));
  }
  for (std::optional<Channel>& channel : channels)
    if (channel) recording.set(std::move(*channel));
  std::string done = what_was_done(sensors, recording.has(vanes[0]), recording.has(vanes[1]));
  return {std::move(mapped), std::move(done)};
}

}  // namespace veridyn::aircraft
