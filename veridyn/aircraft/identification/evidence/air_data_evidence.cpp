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

/// Standard deviations of air data of which nothing is known but that they were installed with care: position error of
/// a pitot tube, upwash at a vane ahead of a wing, a vane aligned by eye.
constexpr double kUnverifiedAirspeed = 0.1;
constexpr double kUnverifiedVane = 0.2;
constexpr double kUnverifiedZero = 3.0 * kDegree;

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

/// The air data as the reconstruction took them: without the errors that it estimated and took off.
AirDataConsistency corrected(AirDataConsistency air, const Reconstruction& reconstruction) {
  const auto taken_off = [&](const char* error) {
    const Channel* channel = reconstruction.smoothed.find(error);
    return channel == nullptr || channel->empty() ? 0.0 : channel->value.front();
  };
  if (air.airspeed_scale) air.airspeed_scale->value /= std::sqrt(std::max(1.0 + taken_off("pitot_scale"), 0.01));
  if (air.alpha) air.alpha->bias.value -= taken_off("alpha_bias");
  if (air.beta) air.beta->bias.value -= taken_off("beta_bias");
  return air;
}

}  // namespace

double doubt_of(const std::optional<Determined>& measured, double nominal, double before) {
  if (!measured || !std::isfinite(measured->value) || !std::isfinite(measured->sigma)) return before;
  const double variance = measured->sigma * measured->sigma;
  const double weight = before * before / (before * before + variance);
  return std::hypot(weight * (measured->value - nominal), std::sqrt(weight * variance));
}

CheckedFlight air_data_evidence(const Recording& recording, const Reconstruction& reconstruction, bool airspeed_is_true,
                                const Segments& segments) {
  CheckedFlight found;
  const Channel* density = reconstruction.smoothed.find("air_density");
  if (density == nullptr) return found;
  const AirDataConsistency air =
      corrected(air_data_consistency(recording, *density, airspeed_is_true, segments.airborne), reconstruction);
  if (air.airspeed_scale) {
    found.add(airspeed_row(*air.airspeed_scale));
    found.doubts.push_back(
        {.signal = FlightSignal::kAirspeed, .scale = doubt_of(air.airspeed_scale, 1.0, kUnverifiedAirspeed)});
  }
  const auto vane = [&](const VaneFit& fit, const std::optional<VaneSlope>& slope, const char* name,
                        FlightSignal signal) {
    found.add(vane_row(fit, name));
    found.doubts.push_back({.signal = signal, .zero = doubt_of(fit.bias, 0.0, kUnverifiedZero)});
    found.add(slope_row(slope, name));
    const std::optional<Determined> scale = slope ? std::optional(slope->slope) : std::nullopt;
    found.doubts.push_back({.signal = signal, .scale = doubt_of(scale, 1.0, kUnverifiedVane)});
  };
  if (air.alpha)
    vane(*air.alpha, alpha_slope(recording, *density, airspeed_is_true, segments.longitudinal.excited), "alpha",
         FlightSignal::kAlpha);
  if (air.beta)
    vane(*air.beta, beta_slope(recording, *density, airspeed_is_true, segments.lateral.excited), "beta",
         FlightSignal::kBeta);
  return found;
}

}  // namespace veridyn::aircraft
