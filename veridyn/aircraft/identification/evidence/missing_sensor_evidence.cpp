#include "veridyn/aircraft/identification/evidence/missing_sensor_evidence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/moments.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Evidence;
using estimation::Outcome;
using estimation::Purpose;

/// Mean, spread and root mean square of a channel over spans; nothing where it has no sample there.
std::optional<numerics::Moments> moments_of(const Recording& recording, const std::string& name,
                                            std::span<const TimeSpan> spans) {
  const Channel* channel = recording.find(name);
  if (channel == nullptr) return std::nullopt;
  numerics::Moments moments;
  for (std::size_t k = 0; k < channel->size(); ++k) {
    const double v = channel->value[k];
    if (!std::isfinite(v)) continue;
    if (std::ranges::none_of(spans, [&](const TimeSpan& span) { return span.contains(channel->times()[k]); })) continue;
    moments.add(v);
  }
  return moments.count > 0.0 ? std::optional(moments) : std::nullopt;
}

bool has_airspeed(const Recording& recording) { return recording.has("airspeed") || recording.has("dynamic_pressure"); }

FlightEvidence ground_velocity_row() {
  return {{.name = "ground velocity",
           .about = "ground velocity",
           .outcome = Outcome::kNotVerified,
           .value = kNaN,
           .limit = kNaN,
           .text = "no ground velocity is recorded: scale of the airspeed, zeros of the vanes, accelerometer and wind "
                   "cannot be verified, and are taken as right",
           .bears_on = Purpose::kData | Purpose::kParameters,
           .advice = "record GNSS velocity, or calibrate pitot tube and vanes"}};
}

FlightEvidence attitude_row() {
  return {{.name = "attitude",
           .about = "attitude",
           .outcome = Outcome::kNotVerified,
           .value = kNaN,
           .limit = kNaN,
           .text = "no roll and pitch are recorded: gyro and accelerometer cannot be verified against them",
           .bears_on = Purpose::kData | Purpose::kParameters,
           .advice = "record the attitude"}};
}

/// The airspeed is ground speed less wind.
std::optional<FlightEvidence> airspeed_row(const Reconstruction& reconstruction, const Segments& segments) {
  constexpr double kCare = 0.01, kFailed = 0.03;
  const Recording& r = reconstruction.smoothed;
  const auto speed = moments_of(r, "airspeed", segments.airborne);
  const auto sigma = moments_of(r, "sigma_airspeed", segments.airborne);
  if (!speed || !sigma || !(speed->mean() > 0.0)) return std::nullopt;
  // Gusts with it: in gusts that no sensor feels the slow wind is found worse than the filter says.
  const double along = sigma->rms() / speed->mean();
  return FlightEvidence{
      {.name = "no airspeed sensor",
       .about = "airspeed",
       .outcome = along > kFailed ? Outcome::kFailed
                  : along > kCare ? Outcome::kCare
                                  : Outcome::kNotVerified,
       .value = along,
       .limit = kCare,
       .scale = "doubt over airspeed",
       .text =
           fmt::format("no sensor measures the airspeed: it is the ground speed less a wind that this flight leaves "
                       "in doubt by {:.0f} % of it, and coefficients by twice as much, which their intervals hold",
                       100.0 * along),
       .bears_on = Purpose::kData | Purpose::kParameters,
       .advice = "record a pitot tube, or fly full circles"},
      {},
      SignalDoubt{.signal = FlightSignal::kAirspeed, .scale = along, .in_interval = true}};
}

/// A flow angle that no vane measures.
std::optional<FlightEvidence> vane_row(const Reconstruction& reconstruction, const Segments& segments,
                                       const std::string& name) {
  constexpr double kCare = 0.003, kFailed = 0.01;
  const bool alpha = name == "alpha";
  const Recording& r = reconstruction.smoothed;
  const std::vector<TimeSpan>& excited = (alpha ? segments.longitudinal : segments.lateral).excited;
  const auto angle = moments_of(r, name, excited);
  const auto sigma = moments_of(r, "sigma_" + name, excited);
  const auto speed = moments_of(r, "airspeed", segments.airborne);
  if (!angle || !sigma || !speed || !(angle->sd() > 0.0)) return std::nullopt;
  // The wind across the path is in doubt for long, gusts are not.
  const auto down = moments_of(r, "sigma_wind_down", segments.airborne);
  const auto north = moments_of(r, "sigma_wind_north", segments.airborne);
  const auto east = moments_of(r, "sigma_wind_east", segments.airborne);
  const double across = alpha           ? (down ? down->rms() : 0.0)
                        : north && east ? std::sqrt(0.5 * (north->rms() * north->rms() + east->rms() * east->rms()))
                                        : 0.0;
  const double ratio = std::pow(sigma->rms() / angle->sd(), 2.0);
  Evidence row{.name = fmt::format("no {} vane", name),
               .about = name,
               .outcome = ratio > kFailed ? Outcome::kFailed
                          : ratio > kCare ? Outcome::kCare
                                          : Outcome::kNotVerified,
               .value = ratio,
               .limit = kFailed,
               .scale = "variance unknown over variance in manoeuvres",
               .bears_on = Purpose::kParameters};
  row.text = fmt::format(
      "no vane measures {}: gusts leave it in doubt by {:.2f} deg, where manoeuvres move it by {:.2f} deg{}", name,
      sigma->rms() / kDegree, angle->sd() / kDegree,
      row.outcome == Outcome::kNotVerified
          ? ""
          : "; the aircraft answers gusts that no sensor feels, which biases its derivatives unseen");
  row.advice = fmt::format(
      "record the {} vane, fly larger manoeuvres in calm air, and say so "
      "(reconstruct.turbulence = \"none\")",
      name);
  return FlightEvidence{std::move(row), alpha ? by_alpha() : by_beta(),
                        SignalDoubt{.signal = alpha ? FlightSignal::kAlpha : FlightSignal::kBeta,
                                    .scale = ratio,
                                    .zero = across / std::max(1.0, speed->mean()),
                                    .in_interval = true}};
}

/// Without a filter the noise of the airspeed is in every sample of a coefficient, twice, and of a computed thrust.
std::optional<FlightEvidence> noise_row(const Reconstruction& reconstruction, const Segments& segments) {
  constexpr double kCare = 0.015;
  const auto speed = moments_of(reconstruction.smoothed, "airspeed", segments.airborne);
  const auto sigma = moments_of(reconstruction.smoothed, "sigma_airspeed", segments.airborne);
  if (!speed || !sigma || !(sigma->rms() > kCare * speed->mean())) return std::nullopt;
  return FlightEvidence{{.name = "noise of the airspeed",
                         .about = "airspeed",
                         .outcome = Outcome::kCare,
                         .value = sigma->rms() / speed->mean(),
                         .limit = kCare,
                         .scale = "noise over airspeed",
                         .text = fmt::format("no filter averages the airspeed, whose noise is {:.1f} % of it: constant "
                                             "terms, of drag above all, may be wrong by more than their intervals say",
                                             100.0 * sigma->rms() / speed->mean()),
                         .bears_on = Purpose::kParameters,
                         .advice = "let a filter reconstruct the motion (reconstruct.filter = \"model-free\")"}};
}

}  // namespace

std::vector<FlightEvidence> missing_sensor_evidence(const Recording& recording, const Reconstruction& reconstruction,
                                                    const Segments& segments) {
  std::vector<FlightEvidence> rows;
  const auto add = [&rows](std::optional<FlightEvidence> row) {
    if (row) rows.push_back(std::move(*row));
  };
  if (!recording.has("vel_north") || !recording.has("vel_east")) rows.push_back(ground_velocity_row());
  if (!recording.has("roll") || !recording.has("pitch")) rows.push_back(attitude_row());
  if (reconstruction.filter == FilterKind::kNone) {
    add(noise_row(reconstruction, segments));
    return rows;
  }
  if (!has_airspeed(recording)) add(airspeed_row(reconstruction, segments));
  for (const char* vane : {"alpha", "beta"})
    if (!recording.has(vane)) add(vane_row(reconstruction, segments, vane));
  return rows;
}

}  // namespace veridyn::aircraft
