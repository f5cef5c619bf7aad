#include "veridyn/aircraft/identification/evidence/missing_sensor_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/numerics/moments.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Cause;
using estimation::Check;
using estimation::Evidence;
using estimation::Outcome;
using estimation::row_of;

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

Evidence missing(Check check, const char* sensor) {
  Evidence row = row_of(check, sensor, Outcome::kNotVerified);
  row.cause = Cause::kMissing;
  return row;
}

/// Of what no sensor measures: by how much it is unknown. What is within the limits is stated all the same.
Evidence unknown_by(Check check, const std::string& what, double value) {
  Evidence row = row_of(check, what, value);
  if (row.outcome == Outcome::kPassed) {
    const double limit = row.limit;
    row = row_of(check, what, Outcome::kNotVerified);
    row.value = value;
    row.limit = limit;
  }
  row.cause = Cause::kMissing;
  return row;
}

/// The airspeed is ground speed less wind.
CheckedFlight airspeed_row(const Reconstruction& reconstruction, const Segments& segments) {
  const Recording& r = reconstruction.smoothed;
  const auto speed = moments_of(r, "airspeed", segments.airborne);
  const auto sigma = moments_of(r, "sigma_airspeed", segments.airborne);
  if (!speed || !sigma || !(speed->mean() > 0.0)) return {};
  // Gusts with it: in gusts that no sensor feels the slow wind is found worse than the filter says.
  const double along = sigma->rms() / speed->mean();
  return {{unknown_by(Check::kNoAirspeedSensor, "airspeed", along)},
          {{.sensor = BudgetSensor::kAirspeed, .kind = SensorErrorKind::kScale, .sigma = along}}};
}

/// A flow angle that no vane measures.
CheckedFlight vane_row(const Reconstruction& reconstruction, const Segments& segments, const std::string& name) {
  const bool alpha = name == "alpha";
  const Recording& r = reconstruction.smoothed;
  const std::vector<TimeSpan>& excited = (alpha ? segments.longitudinal : segments.lateral).excited;
  const auto angle = moments_of(r, name, excited);
  const auto sigma = moments_of(r, "sigma_" + name, excited);
  const auto speed = moments_of(r, "airspeed", segments.airborne);
  if (!angle || !sigma || !speed || !(angle->sd() > 0.0)) return {};
  // The wind across the path is in doubt for long, gusts are not.
  const auto down = moments_of(r, "sigma_wind_down", segments.airborne);
  const auto north = moments_of(r, "sigma_wind_north", segments.airborne);
  const auto east = moments_of(r, "sigma_wind_east", segments.airborne);
  const double across = alpha           ? (down ? down->rms() : 0.0)
                        : north && east ? std::sqrt(0.5 * (north->rms() * north->rms() + east->rms() * east->rms()))
                                        : 0.0;
  const double ratio = std::pow(sigma->rms() / angle->sd(), 2.0);
  Evidence row = unknown_by(Check::kNoVane, name, ratio);
  row.with("unknown", sigma->rms()).with("moved", angle->sd());
  row.affects = alpha ? kByAlpha : kByBeta;
  const BudgetSensor sensor = alpha ? BudgetSensor::kAlpha : BudgetSensor::kBeta;
  return {{std::move(row)},
          {{.sensor = sensor, .kind = SensorErrorKind::kScale, .sigma = ratio},
           {.sensor = sensor, .kind = SensorErrorKind::kZero, .sigma = across / std::max(1.0, speed->mean())}}};
}

/// Without a filter the noise of the airspeed is in every sample of a coefficient, twice, and of a computed thrust.
CheckedFlight noise_row(const Reconstruction& reconstruction, const Segments& segments) {
  const auto speed = moments_of(reconstruction.smoothed, "airspeed", segments.airborne);
  const auto sigma = moments_of(reconstruction.smoothed, "sigma_airspeed", segments.airborne);
  if (!speed || !sigma) return {};
  Evidence row = row_of(Check::kAirspeedNoise, "airspeed", sigma->rms() / speed->mean());
  if (row.passed()) return {};
  row.cause = Cause::kNoise;
  return {{std::move(row)}, {}};
}

}  // namespace

CheckedFlight missing_sensor_evidence(const Recording& recording, const Reconstruction& reconstruction,
                                      const Segments& segments) {
  CheckedFlight found;
  if (!recording.has("vel_north") || !recording.has("vel_east"))
    found.add(missing(Check::kNoGroundVelocity, "ground velocity"));
  if (!recording.has("roll") || !recording.has("pitch")) found.add(missing(Check::kNoAttitude, "attitude"));
  if (reconstruction.filter == FilterKind::kNone) {
    found.add(noise_row(reconstruction, segments));
    return found;
  }
  if (!has_airspeed(recording)) found.add(airspeed_row(reconstruction, segments));
  for (const char* vane : {"alpha", "beta"})
    if (!recording.has(vane)) found.add(vane_row(reconstruction, segments, vane));
  return found;
}

}  // namespace veridyn::aircraft
