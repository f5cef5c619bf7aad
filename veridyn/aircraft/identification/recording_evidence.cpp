#include "veridyn/aircraft/identification/recording_evidence.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/aircraft/sensors/air_data_consistency.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/units.hpp"
#include "veridyn/recording/inertial_consistency.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Evidence;
using estimation::kAllPurposes;
using estimation::Outcome;
using estimation::Purpose;

const std::vector<Coefficient> kByAlpha{Coefficient::kCL, Coefficient::kCD, Coefficient::kCm};
const std::vector<Coefficient> kByBeta{Coefficient::kCY, Coefficient::kCl, Coefficient::kCn};

/// Standard errors beyond which a difference is no chance.
constexpr double kStandardErrors = 3.0;

/// "with care" and "failed" limits on what exceeds chance.
struct Limits {
  double care, failed;
};

Outcome beyond(double difference, double sigma, Limits limits) {
  const double excess = std::abs(difference) - kStandardErrors * sigma;
  return excess > limits.failed ? Outcome::kFailed : excess > limits.care ? Outcome::kCare : Outcome::kPassed;
}

FlightEvidence airspeed_row(const Determined& scale) {
  constexpr Limits kLimits{0.02, 0.15};
  /// A scale that is off by so much changes coefficients by twice as much.
  constexpr double kWellDetermined = 0.01;
  constexpr double kUndetermined = 0.1;
  Evidence row{.name = "airspeed against ground velocity",
               .about = "airspeed",
               .value = scale.value,
               .limit = kLimits.care,
               .scale = "reading over truth",
               .bears_on = kAllPurposes};
  row.outcome = beyond(scale.value - 1.0, scale.sigma, kLimits);
  if (row.outcome == Outcome::kPassed && scale.sigma > kWellDetermined) {
    row.outcome = Outcome::kNotVerified;
    row.text =
        scale.sigma > kUndetermined
            ? std::string(
                  "the scale of the airspeed is not verified: the headings flown do not separate it from the wind")
            : fmt::format(
                  "the scale of the airspeed is verified to no better than {:.0f} % by the headings flown "
                  "({:.3f} +- {:.3f}); an error of 1 % changes coefficients by 2 %",
                  100.0 * kStandardErrors * scale.sigma, scale.value, scale.sigma);
    row.advice = "fly several full circles, or calibrate the pitot tube";
    return {std::move(row)};
  }
  const std::string unit =
      row.outcome == Outcome::kPassed ? std::string() : recording::mistaken_unit(std::abs(scale.value));
  row.text = fmt::format(
      "over the headings flown the airspeed reads {:.3f} +- {:.3f} times what ground velocity and a "
      "steady wind say{}{}",
      scale.value, scale.sigma, unit.empty() ? "" : ": ", unit);
  if (row.outcome != Outcome::kPassed)
    row.advice = "check unit and calibration of the pitot tube, or let the reconstruction estimate pitot_scale";
  return {std::move(row)};
}

FlightEvidence vane_row(const VaneFit& fit, const std::string& name) {
  constexpr Limits kBias{0.5 * kDegree, 5.0 * kDegree};
  constexpr double kLargestFlowAngle = 0.5 * kPi;
  const bool impossible = fit.largest_reading > kLargestFlowAngle;
  Evidence row{.name = fmt::format("{} vane against inertial angle", name),
               .about = name,
               .outcome = impossible ? Outcome::kFailed : beyond(fit.bias.value, fit.bias.sigma, kBias),
               .value = fit.bias.value / kDegree,
               .limit = kBias.care / kDegree,
               .scale = "deg",
               .bears_on = kAllPurposes};
  if (row.outcome == Outcome::kPassed) row.outcome = Outcome::kNotVerified;
  row.text = impossible ? fmt::format("the {} vane reads up to {:.0f} deg: over 90 deg is no flow angle in flight",
                                      name, fit.largest_reading / kDegree)
                        : fmt::format(
                              "in the mean the {} vane reads {:.2f} +- {:.2f} deg more than attitude, ground velocity "
                              "and the mean wind imply; its scale is not verified by this recording",
                              name, fit.bias.value / kDegree, fit.bias.sigma / kDegree);
  if (!row.passed())
    row.advice = fmt::format("check unit and zero of the vane, or leave it out: reconstruct.without = [\"{}\"]", name);
  return {std::move(row), name == "alpha" ? kByAlpha : kByBeta};
}

/// A sensor whose samples the reconstruction had to refuse, or that is noisier than assumed.
FlightEvidence innovation_row(const SensorReport& sensor) {
  constexpr Limits kRefused{0.01, 0.2};
  const estimation::InnovationSummary& s = sensor.innovations;
  const double count = static_cast<double>(std::max<std::size_t>(1, s.count));
  const double refused = static_cast<double>(s.rejected + s.recovered) / count;
  Evidence row{.name = "agreement with the reconstruction",
               .about = sensor.channel,
               .value = refused,
               .limit = kRefused.care,
               .scale = "share of the samples",
               .bears_on = kAllPurposes};
  row.outcome = beyond(refused, 0.0, kRefused);
  row.text = fmt::format(
      "{:.1f} % of the samples of {} contradict the reconstructed motion{}", 100.0 * refused, sensor.channel,
      row.outcome == Outcome::kFailed ? ": either the sensor is wrong or what it is compared with" : "");
  if (row.outcome != Outcome::kPassed)
    row.advice = fmt::format("look at {} in the report: unit, sign, delay, or a stretch to leave out", sensor.channel);
  if (sensor.channel == "alpha") return {std::move(row), kByAlpha};
  if (sensor.channel == "beta") return {std::move(row), kByBeta};
  return {std::move(row)};
}

/// Mean gusts of the reconstruction: what a recording that contradicts itself is pushed into.
std::optional<FlightEvidence> gust_row(const Reconstruction& reconstruction, const Segments& segments) {
  const std::array<double, 3> sigma{reconstruction.turbulence.sigma_u, reconstruction.turbulence.sigma_v,
                                    reconstruction.turbulence.sigma_w};
  const std::array<double, 3> length{reconstruction.turbulence.Lu, reconstruction.turbulence.Lv,
                                     reconstruction.turbulence.Lw};
  static constexpr std::array<const char*, 3> kNames{"gust_x", "gust_y", "gust_z"};
  Outcome outcome = Outcome::kPassed;
  double worst = 0.0, worst_sigma = 0.0;
  const char* name = kNames[0];
  const Recording& r = reconstruction.smoothed;
  if (!r.has("airspeed")) return std::nullopt;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!r.has(kNames[i])) return std::nullopt;
    const Channel& gust = r.at(kNames[i]);
    const Channel& airspeed = r.at("airspeed");
    double sum = 0.0, distance = 0.0, last = kNaN;
    std::size_t count = 0;
    for (const TimeSpan& span : segments.airborne) {
      last = kNaN;
      for (std::size_t k = 0; k < gust.size(); ++k) {
        const double t = gust.times()[k];
        if (t < span.begin || t > span.end || !std::isfinite(gust.value[k])) continue;
        sum += gust.value[k];
        ++count;
        if (std::isfinite(last)) distance += airspeed.value[k] * (t - last);
        last = t;
      }
    }
    if (count == 0) return std::nullopt;
    const double mean = sum / static_cast<double>(count);
    const double independent = std::max(1.0, distance / (2.0 * std::max(1.0, length[i])));
    const double sigma_of_mean = sigma[i] / std::sqrt(independent);
    const Outcome of_axis = beyond(mean, sigma_of_mean, {0.3, 3.0});
    if (i == 0 || of_axis > outcome || (of_axis == outcome && std::abs(mean) > std::abs(worst))) {
      outcome = of_axis;
      worst = mean;
      worst_sigma = sigma_of_mean;
      name = kNames[i];
    }
  }
  const bool passed = outcome == Outcome::kPassed;
  return FlightEvidence{
      {.name = "mean gust",
       .about = name,
       .outcome = outcome,
       .value = worst,
       .limit = 0.3,
       .scale = "m/s",
       .text =
           fmt::format("the mean of {} is {:.2f} m/s, where turbulence leaves 0 +- {:.2f}{}", name, worst, worst_sigma,
                       passed ? "" : ": sensors contradict each other, and the difference was taken for a gust"),
       .bears_on = kAllPurposes,
       .advice = passed ? std::string() : std::string("look for the sensor that is wrong among the rows above")}};
}

/// What no channel of a flight can tell: the aircraft answers a deflection the same whatever it is called.
FlightEvidence deflection_row(const Recording& recording) {
  std::vector<std::string> surfaces;
  for (const char* name : {"elevator", "aileron", "rudder"})
    if (recording.has(name)) surfaces.emplace_back(name);
  return {
      {.name = "deflections",
       .about = "controls",
       .outcome = Outcome::kNotVerified,
       .value = kNaN,
       .limit = kNaN,
       .text = fmt::format("sign, scale and zero of {} are taken as recorded: control derivatives and constant terms "
                           "are as right as they are",
                           surfaces.empty() ? "deflections" : fmt::format("{}", fmt::join(surfaces, ", "))),
       .bears_on = Purpose::kData | Purpose::kParameters,
       .advice = "measure deflections against servo outputs on the ground"}};
}

}  // namespace

std::vector<FlightEvidence> recording_evidence(const Recording& recording, const Reconstruction& reconstruction,
                                               const ReconstructOptions& options, const Segments& segments) {
  std::vector<FlightEvidence> rows;
  for (Evidence& row : recording::inertial_evidence(recording::inertial_consistency(recording, segments.airborne)))
    rows.push_back({std::move(row)});
  if (const Channel* density = reconstruction.smoothed.find("air_density")) {
    const AirDataConsistency air =
        air_data_consistency(recording, *density, options.airspeed_is_true, segments.airborne);
    if (air.airspeed_scale) rows.push_back(airspeed_row(*air.airspeed_scale));
    if (air.alpha) rows.push_back(vane_row(*air.alpha, "alpha"));
    if (air.beta) rows.push_back(vane_row(*air.beta, "beta"));
  }
  rows.push_back(deflection_row(recording));
  for (const SensorReport& sensor : reconstruction.sensors)
    if (sensor.innovations.count > 0) rows.push_back(innovation_row(sensor));
  if (std::optional<FlightEvidence> gust = gust_row(reconstruction, segments)) rows.push_back(std::move(*gust));
  return rows;
}

}  // namespace veridyn::aircraft
