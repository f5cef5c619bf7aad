#include "veridyn/aircraft/identification/evidence/air_data_evidence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/recording/sensor_matrix.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Evidence;
using estimation::kAllPurposes;
using estimation::kBeyondChance;
using estimation::Outcome;
using estimation::outcome_of;
using estimation::Tolerance;

/// Standard deviations of air data of which nothing is known but that they were installed with care: position error of
/// a pitot tube, upwash at a vane ahead of a wing, a vane aligned by eye.
constexpr double kUnverifiedAirspeed = 0.1;
constexpr double kUnverifiedVane = 0.2;
constexpr double kUnverifiedZero = 3.0 * kDegree;

FlightEvidence airspeed_row(const Determined& scale) {
  constexpr double kCare = 0.02;
  /// A scale that is off by so much changes coefficients by twice as much.
  constexpr double kWellDetermined = 0.01;
  constexpr double kUndetermined = 0.1;
  Evidence row{.name = "airspeed against ground velocity",
               .about = "airspeed",
               .value = scale.value,
               .limit = kCare,
               .scale = "reading over truth",
               .bears_on = kAllPurposes};
  row.outcome = outcome_of(scale.value, scale.sigma, Tolerance::about(1.0, kCare, 0.15));
  const SignalDoubt doubt{.signal = FlightSignal::kAirspeed, .scale = doubt_of(scale, 1.0, kUnverifiedAirspeed)};
  if (row.outcome == Outcome::kPassed && scale.sigma > kWellDetermined) {
    row.outcome = Outcome::kNotVerified;
    row.text =
        scale.sigma > kUndetermined
            ? std::string(
                  "the scale of the airspeed is not verified: the headings flown do not separate it from the wind")
            : fmt::format(
                  "the scale of the airspeed is verified to no better than {:.0f} % by the headings flown "
                  "({:.3f} +- {:.3f}); an error of 1 % changes coefficients by 2 %",
                  100.0 * kBeyondChance * scale.sigma, scale.value, scale.sigma);
    row.advice = "fly several full circles, or calibrate the pitot tube";
    return {std::move(row), {}, doubt};
  }
  const std::string unit =
      row.outcome == Outcome::kPassed ? std::string() : recording::mistaken_unit(std::abs(scale.value));
  row.text = fmt::format(
      "over the headings flown the airspeed reads {:.3f} +- {:.3f} times what ground velocity and a "
      "steady wind say{}{}",
      scale.value, scale.sigma, unit.empty() ? "" : ": ", unit);
  if (row.outcome != Outcome::kPassed)
    row.advice = "check unit and calibration of the pitot tube, or let the reconstruction estimate pitot_scale";
  return {std::move(row), {}, doubt};
}

/// The row of a vane with what it leaves in doubt.
FlightEvidence of_vane(Evidence row, const std::string& name, double scale, double zero) {
  const bool alpha = name == "alpha";
  return {std::move(row), alpha ? by_alpha() : by_beta(),
          SignalDoubt{.signal = alpha ? FlightSignal::kAlpha : FlightSignal::kBeta, .scale = scale, .zero = zero}};
}

FlightEvidence vane_row(const VaneFit& fit, const std::string& name) {
  constexpr double kCare = 0.5 * kDegree, kFailed = 5.0 * kDegree;
  constexpr double kLargestFlowAngle = 0.5 * kPi;
  const bool impossible = fit.largest_reading > kLargestFlowAngle;
  Evidence row{.name = fmt::format("{} vane against inertial angle", name),
               .about = name,
               .outcome = impossible
                              ? Outcome::kFailed
                              : outcome_of(fit.bias.value, fit.bias.sigma, Tolerance::about(0.0, kCare, kFailed)),
               .value = fit.bias.value / kDegree,
               .limit = kCare / kDegree,
               .scale = "deg",
               .bears_on = kAllPurposes};
  if (row.outcome == Outcome::kPassed) row.outcome = Outcome::kNotVerified;
  row.text = impossible ? fmt::format("the {} vane reads up to {:.0f} deg: over 90 deg is no flow angle in flight",
                                      name, fit.largest_reading / kDegree)
                        : fmt::format(
                              "in the mean the {} vane reads {:.2f} +- {:.2f} deg more than attitude, ground velocity "
                              "and the mean wind imply",
                              name, fit.bias.value / kDegree, fit.bias.sigma / kDegree);
  if (!row.passed())
    row.advice = fmt::format("check unit and zero of the vane, or leave it out: reconstruct.without = [\"{}\"]", name);
  return of_vane(std::move(row), name, 0.0, doubt_of(fit.bias, 0.0, kUnverifiedZero));
}

FlightEvidence slope_row(const std::optional<VaneSlope>& fit, const std::string& name) {
  constexpr double kCare = 0.1, kFailed = 0.4;
  /// An error of the scale is one of the derivatives by the angle.
  constexpr double kVerified = 0.15;
  Evidence row{.name = fmt::format("scale of the {} vane", name),
               .about = name,
               .outcome = Outcome::kNotVerified,
               .value = fit ? fit->slope.value : kNaN,
               .limit = kCare,
               .scale = "reading over angle",
               .text = fmt::format("the scale of the {} vane is not verified by this recording: the controls do not "
                                   "move the angle enough",
                                   name),
               .bears_on = kAllPurposes,
               .advice = fmt::format("fly sharp {} doublets, or calibrate the vane in a wind tunnel",
                                     name == "alpha" ? "elevator" : "rudder")};
  if (fit) {
    const double doubt = std::abs(fit->slope.value - 1.0) + kBeyondChance * fit->slope.sigma;
    row.outcome = outcome_of(fit->slope.value, fit->slope.sigma, Tolerance::about(1.0, kCare, kFailed));
    const bool passed = row.outcome == Outcome::kPassed;
    row.text = fmt::format("in manoeuvres the {} vane reads {:.2f} +- {:.2f} times what gyro and accelerometer say{}",
                           name, fit->slope.value, fit->slope.sigma,
                           !passed && fit->slope.value < 0.0 ? ": its sign is reversed" : "");
    if (passed && doubt > kVerified) {
      row.outcome = Outcome::kNotVerified;
      row.text += fmt::format(", which verifies its scale to no better than {:.0f} %", 100.0 * doubt);
    } else if (passed) {
      row.advice.clear();
    } else {
      row.advice = fmt::format(
          "check sign, unit, scale (upwash) and delay of the vane, or leave it out: reconstruct.without = [\"{}\"]",
          name);
    }
  }
  const std::optional<Determined> slope = fit ? std::optional(fit->slope) : std::nullopt;
  return of_vane(std::move(row), name, doubt_of(slope, 1.0, kUnverifiedVane), 0.0);
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

std::vector<FlightEvidence> air_data_evidence(const Recording& recording, const Reconstruction& reconstruction,
                                              bool airspeed_is_true, const Segments& segments) {
  std::vector<FlightEvidence> rows;
  const Channel* density = reconstruction.smoothed.find("air_density");
  if (density == nullptr) return rows;
  const AirDataConsistency air =
      corrected(air_data_consistency(recording, *density, airspeed_is_true, segments.airborne), reconstruction);
  if (air.airspeed_scale) rows.push_back(airspeed_row(*air.airspeed_scale));
  if (air.alpha) {
    rows.push_back(vane_row(*air.alpha, "alpha"));
    rows.push_back(
        slope_row(alpha_slope(recording, *density, airspeed_is_true, segments.longitudinal.excited), "alpha"));
  }
  if (air.beta) {
    rows.push_back(vane_row(*air.beta, "beta"));
    rows.push_back(slope_row(beta_slope(recording, *density, airspeed_is_true, segments.lateral.excited), "beta"));
  }
  return rows;
}

}  // namespace veridyn::aircraft
