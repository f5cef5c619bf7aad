#include "veridyn/aircraft/identification/evidence/air_data_evidence.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/recording/consistency.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Cause;
using estimation::Check;
using estimation::Evidence;
using estimation::info_of;
using estimation::kBeyondChance;
using estimation::Outcome;
using estimation::row_of;

Evidence airspeed_row(const Determined& scale) {
  /// An error of 1 % changes coefficients by 2 %: a scale that is not known to that is not verified.
  constexpr double kWellDetermined = 0.01;
  constexpr double kUndetermined = 0.1;
  const estimation::Tolerance& limits = info_of(Check::kAirspeedScale).tolerance;
  Evidence row = row_of(Check::kAirspeedScale, "airspeed", scale.value, scale.sigma);
  // A scale that is known is judged by its estimate: what is beyond the limit and beyond chance is an error.
  const bool known_to_be_off = scale.sigma <= kWellDetermined &&
                               std::abs(scale.value - 1.0) > kBeyondChance * scale.sigma &&
                               (scale.value < limits.low || scale.value > limits.high);
  if (row.passed() && (known_to_be_off || scale.sigma > kWellDetermined)) {
    row = row_of(Check::kAirspeedScale, "airspeed", known_to_be_off ? Outcome::kCare : Outcome::kNotVerified);
    row.value = scale.value;
    row.sigma = scale.sigma;
    row.limit = scale.value < 1.0 ? limits.low : limits.high;
    if (!known_to_be_off) row.cause = scale.sigma > kUndetermined ? Cause::kExcitation : Cause::kNoise;
  }
  std::string unit;
  if (!row.passed()) {
    // Of an airspeed, or of the dynamic pressure that it was made of.
    const double size = std::abs(scale.value);
    unit = recording::mistaken_unit(parse_unit("m/s"), size);
    if (unit.empty()) unit = recording::mistaken_unit(parse_unit("Pa"), size * size);
  }
  if (!row.passed()) row.cause = unit.empty() ? Cause::kScale : Cause::kUnit;
  return std::move(row).with("unit", unit).with("three_sigma", kBeyondChance * scale.sigma);
}

Evidence vane_row(const VaneFit& fit, const std::string& name) {
  constexpr double kLargestFlowAngle = 0.5 * kPi;
  const bool impossible = fit.largest_reading > kLargestFlowAngle;
  const double value = fit.bias.value / kDegree, sigma = fit.bias.sigma / kDegree;
  Evidence row = row_of(Check::kVaneAngle, name, value, sigma);
  if (impossible || row.outcome == Outcome::kPassed) {
    // The mean agrees with a mean wind that was found with it: that verifies no zero.
    const double limit = row.limit;
    row = row_of(Check::kVaneAngle, name, impossible ? Outcome::kFailed : Outcome::kNotVerified);
    row.value = value;
    row.sigma = sigma;
    row.limit = limit;
  }
  if (!row.passed()) row.cause = impossible ? Cause::kUnit : Cause::kZero;
  row.affects = name == "alpha" ? kByAlpha : kByBeta;
  return std::move(row).with("largest", fit.largest_reading);
}

Evidence slope_row(const std::optional<VaneSlope>& fit, const std::string& name) {
  /// An error of the scale is one of the derivatives by the angle.
  constexpr double kVerified = 0.15;
  const double doubt = fit ? std::abs(fit->slope.value - 1.0) + kBeyondChance * fit->slope.sigma : kNaN;
  Evidence row = fit ? row_of(Check::kVaneScale, name, fit->slope.value, fit->slope.sigma)
                     : row_of(Check::kVaneScale, name, Outcome::kNotVerified);
  if (fit && row.passed() && doubt > kVerified) {
    row = row_of(Check::kVaneScale, name, Outcome::kNotVerified);
    row.value = fit->slope.value;
    row.sigma = fit->slope.sigma;
  }
  row.cause = !fit ? Cause::kExcitation : row.passed() ? Cause::kNone : row.value < 0.0 ? Cause::kSign : Cause::kScale;
  row.affects = name == "alpha" ? kByAlpha : kByBeta;
  return std::move(row).with("doubt", doubt).with("control", name == "alpha" ? "elevator" : "rudder");
}

/// The air data as the reconstruction took them: without the error of the pitot tube that it estimated and took off.
AirDataConsistency corrected(AirDataConsistency air, const Reconstruction& reconstruction) {
  const Channel* scale = reconstruction.smoothed.find("pitot_scale");
  if (scale != nullptr && !scale->empty() && air.airspeed_scale)
    air.airspeed_scale->value /= std::sqrt(std::max(1.0 + scale->value.front(), 0.01));
  return air;
}

double mean_in(const Channel& channel, std::span<const TimeSpan> spans) {
  double sum = 0.0, count = 0.0;
  for (std::size_t k = 0; k < channel.size(); ++k) {
    const double t = channel.times()[k], v = channel.value[k];
    if (!std::isfinite(v) || std::ranges::none_of(spans, [&](const TimeSpan& span) { return span.contains(t); }))
      continue;
    sum += v;
    count += 1.0;
  }
  return sum / count;
}

/// Scale of the airspeed and zero of its pressure are one unknown at the airspeed flown: dV/V = dq/(rho V^2).
SensorError airspeed_prior(const Reconstruction& reconstruction, const Channel& density, const Segments& segments,
                           const KnownSensors& known) {
  SensorError prior = prior_of(BudgetSensor::kAirspeed, SensorErrorKind::kScale, known);
  const SensorError zero = prior_of(BudgetSensor::kAirspeed, SensorErrorKind::kZero, known);
  const Channel* airspeed = reconstruction.smoothed.find("airspeed");
  if (airspeed == nullptr) return prior;
  const double V = mean_in(*airspeed, segments.airborne);
  const double per_pascal = 1.0 / (density.value.front() * V * V);
  if (!std::isfinite(per_pascal)) return prior;
  prior.mean += zero.mean * per_pascal;
  prior.sigma = std::hypot(prior.sigma, zero.sigma * per_pascal);
  return prior;
}

/// A prior of a scale or a zero after what was measured of `nominal` plus the error.
SensorError measured(const SensorError& prior, const std::optional<Determined>& found, double nominal,
                     double reference_sigma) {
  if (!found) return prior;
  return updated(prior, found->value - nominal, std::hypot(found->sigma, reference_sigma));
}

/// A vane, its prior and what it is compared with.
struct CheckedVane {
  BudgetSensor sensor;
  double reference_zero;
};

CheckedFlight vane_evidence(const CheckedVane& vane, const std::optional<VaneFit>& fit,
                            const std::optional<VaneSlope>& slope, const KnownSensors& known) {
  CheckedFlight found;
  if (fit) {
    const std::string name(kBudgetSensorNames[vane.sensor]);
    found.add(vane_row(*fit, name));
    found.add(slope_row(slope, name));
  }
  const auto mean = fit ? std::optional(fit->bias) : std::nullopt;
  const auto scale = slope ? std::optional(slope->slope) : std::nullopt;
  found.errors = {measured(prior_of(vane.sensor, SensorErrorKind::kZero, known), mean, 0.0, vane.reference_zero),
                  measured(prior_of(vane.sensor, SensorErrorKind::kScale, known), scale, 1.0, 0.0)};
  return found;
}

}  // namespace

CheckedFlight air_data_evidence(const Recording& recording, const Reconstruction& reconstruction, bool airspeed_is_true,
                                const Segments& segments, const KnownSensors& known) {
  CheckedFlight found;
  const Channel* density = reconstruction.smoothed.find("air_density");
  if (density == nullptr || density->empty()) return found;
  const AirDataConsistency air =
      corrected(air_data_consistency(recording, *density, airspeed_is_true, segments.airborne), reconstruction);
  if (air.airspeed_scale) found.add(airspeed_row(*air.airspeed_scale));
  if (recording.has("airspeed") || recording.has("dynamic_pressure"))
    found.errors.push_back(
        measured(airspeed_prior(reconstruction, *density, segments, known), air.airspeed_scale, 1.0, 0.0));
  found.errors.push_back(prior_of(BudgetSensor::kAirDensity, SensorErrorKind::kScale, known));
  if (recording.has("alpha"))
    found.add(vane_evidence({BudgetSensor::kAlpha, kAttitudeZero}, air.alpha,
                            alpha_slope(recording, *density, airspeed_is_true, segments.longitudinal.excited), known));
  if (recording.has("beta"))
    found.add(vane_evidence({BudgetSensor::kBeta, kHeadingZero}, air.beta,
                            beta_slope(recording, *density, airspeed_is_true, segments.lateral.excited), known));
  return found;
}

}  // namespace veridyn::aircraft
