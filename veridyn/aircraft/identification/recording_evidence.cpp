#include "veridyn/aircraft/identification/recording_evidence.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/aircraft/identification/contradicted_flight.hpp"
#include "veridyn/aircraft/sensors/air_data_consistency.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/units.hpp"
#include "veridyn/recording/inertial_consistency.hpp"
#include "veridyn/recording/sample_evidence.hpp"
#include "veridyn/recording/time_order.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Evidence;
using estimation::kAllPurposes;
using estimation::Outcome;
using estimation::Purpose;

const std::vector<Coefficient> kByAlpha{Coefficient::kCL, Coefficient::kCD, Coefficient::kCm};
const std::vector<Coefficient> kByBeta{Coefficient::kCY, Coefficient::kCl, Coefficient::kCn};

using estimation::kBeyondChance;
using estimation::outcome_of;
using estimation::Tolerance;

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
  return {std::move(row), name == "alpha" ? kByAlpha : kByBeta};
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
  return {std::move(row), name == "alpha" ? kByAlpha : kByBeta};
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

/// What the alignment of the clocks found that no sensor can be: early, or of opposite sign.
std::vector<FlightEvidence> delay_rows(std::span<const DelayReport> delays) {
  const auto order_of = [](const DelayReport& report) -> recording::TimeOrder {
    return {.is_control = report.group == "elevator" || report.group == "aileron" || report.group == "rudder"};
  };
  std::vector<FlightEvidence> rows;
  const auto attitude = std::ranges::find(delays, "attitude", &DelayReport::group);
  const bool gyro_is_late = attitude != delays.end() && recording::is_early(*attitude, order_of(*attitude));
  if (gyro_is_late)
    rows.push_back({recording::late_row("gyro", "attitude", -attitude->delay_s, order_of(*attitude).early_s)});
  for (const DelayReport& report : delays) {
    const recording::TimeOrder order = order_of(report);
    if (recording::is_opposite(report))
      rows.push_back({recording::opposite_row(report)});
    else if (recording::is_early(report, order) && !gyro_is_late)
      rows.push_back({recording::early_row(report, order)});
    else if (order.is_control && recording::is_doubtful(report, order))
      rows.push_back({recording::doubtful_row(report, order)});
  }
  return rows;
}

/// Deflections whose single delays a recording does not show.
std::vector<FlightEvidence> together_rows(std::span<const DelayReport> delays) {
  std::vector<FlightEvidence> rows;
  for (const DelayReport& report : delays) {
    if (report.together.empty() || report.group != report.together.front()) continue;
    const std::string names = fmt::format("{}", fmt::join(report.together, " and "));
    rows.push_back({{.name = "delay of inputs that move together",
                     .about = names,
                     .outcome = Outcome::kNotVerified,
                     .value = report.delay_s,
                     .limit = kNaN,
                     .scale = "s",
                     .text = fmt::format("{} move together, so that neither single delays nor single effects can be "
                                         "seen: one delay was searched for, {:.3f} +- {:.3f} s ({})",
                                         names, report.delay_s, report.sigma_s, report.text),
                     .bears_on = Purpose::kData | Purpose::kParameters,
                     .advice = fmt::format("move {} one at a time in doublets of their own", names)}});
  }
  return rows;
}

/// No surface moves so far.
std::vector<FlightEvidence> range_rows(const Recording& recording, const Segments& segments) {
  constexpr double kLargestDeflection = 60.0 * kDegree;
  std::vector<FlightEvidence> rows;
  for (const char* name : {"elevator", "aileron", "rudder"}) {
    const Channel* channel = recording.find(name);
    if (channel == nullptr) continue;
    double largest = 0.0;
    for (std::size_t i = 0; i < channel->size(); ++i) {
      const double t = channel->times()[i];
      if (std::ranges::any_of(segments.airborne, [&](const TimeSpan& span) { return span.contains(t); }))
        largest = std::fmax(largest, std::abs(channel->value[i]));
    }
    if (!(largest > kLargestDeflection)) continue;
    rows.push_back({{.name = fmt::format("range of {}", name),
                     .about = name,
                     .outcome = Outcome::kFailed,
                     .value = largest / kDegree,
                     .limit = kLargestDeflection / kDegree,
                     .scale = "deg",
                     .text = fmt::format("{} reads up to {:.0f} deg: no surface moves so far", name, largest / kDegree),
                     .bears_on = kAllPurposes,
                     .advice = fmt::format("check the unit of {} in [data.map]", name)}});
  }
  return rows;
}

std::vector<FlightEvidence> sample_rows(const Recording& recording, const Segments& segments) {
  static const std::vector<recording::SampledChannel> kChannels{{"accel_x", "accelerometer"},
                                                                {"accel_y", "accelerometer"},
                                                                {"accel_z", "accelerometer"},
                                                                {"gyro_x", "gyro"},
                                                                {"gyro_y", "gyro"},
                                                                {"gyro_z", "gyro"},
                                                                {"roll", "attitude"},
                                                                {"pitch", "attitude"},
                                                                {"yaw", "attitude"},
                                                                {"vel_north", "ground velocity"},
                                                                {"vel_east", "ground velocity"},
                                                                {"vel_down", "ground velocity"},
                                                                {"dynamic_pressure", "airspeed"},
                                                                {"airspeed", "airspeed"},
                                                                {"alpha", "alpha"},
                                                                {"beta", "beta"},
                                                                {"elevator", "elevator", true},
                                                                {"aileron", "aileron", true},
                                                                {"rudder", "rudder", true}};
  std::vector<FlightEvidence> rows;
  for (Evidence& row : recording::sample_evidence(recording, kChannels, segments.airborne)) {
    const bool alpha = row.about == "alpha", beta = row.about == "beta";
    rows.push_back({std::move(row), alpha ? kByAlpha : beta ? kByBeta : std::vector<Coefficient>{}});
  }
  return rows;
}

/// What the reconstruction had to refuse shows that a contradiction found before matters: the row that names the sensor
/// counts as much as what follows from it.
void raise_causes(std::vector<FlightEvidence>& causes, std::span<const FlightEvidence> symptoms, bool lost) {
  const bool refused = lost || std::ranges::any_of(symptoms, [](const FlightEvidence& symptom) {
                         return symptom.row.outcome == Outcome::kFailed;
                       });
  const bool named =
      std::ranges::any_of(causes, [](const FlightEvidence& cause) { return cause.row.outcome == Outcome::kFailed; });
  if (!refused || named) return;
  for (FlightEvidence& cause : causes)
    if (cause.row.outcome == Outcome::kCare) {
      cause.row.outcome = Outcome::kFailed;
      cause.row.text += ", more than the reconstruction can take";
    }
}

/// A sensor whose samples the reconstruction had to refuse, or that is noisier than assumed.
FlightEvidence innovation_row(const SensorReport& sensor) {
  constexpr double kCare = 0.01, kFailed = 0.2;
  const estimation::InnovationSummary& s = sensor.innovations;
  const double count = static_cast<double>(std::max<std::size_t>(1, s.count));
  const double refused = static_cast<double>(s.rejected + s.recovered) / count;
  Evidence row{.name = "agreement with the reconstruction",
               .about = sensor.channel,
               .value = refused,
               .limit = kCare,
               .scale = "share of the samples",
               .bears_on = kAllPurposes};
  row.outcome = outcome_of(refused, 0.0, Tolerance::about(0.0, kCare, kFailed));
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
    const Outcome of_axis = outcome_of(mean, sigma_of_mean, Tolerance::about(0.0, 0.3, 3.0));
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
       .text = fmt::format(
           "sign, scale, zero and undetected delay of {} are taken as recorded: control derivatives and constant terms "
           "are as right as they are",
           surfaces.empty() ? "deflections" : fmt::format("{}", fmt::join(surfaces, ", "))),
       .bears_on = Purpose::kData | Purpose::kParameters,
       .advice = "measure deflections against servo outputs on the ground"}};
}

/// A flight shows force over mass and moment over inertia, and coefficients are referred to areas and lengths.
FlightEvidence body_row() {
  return {
      {.name = "mass, inertia, geometry, thrust",
       .about = "body",
       .outcome = Outcome::kNotVerified,
       .value = kNaN,
       .limit = kNaN,
       .text = "mass, inertia, wing area, span, chord and the thrust model are taken as given: coefficients are as "
               "right as they are",
       .bears_on = Purpose::kData | Purpose::kParameters,
       .advice =
           "weigh and swing the aircraft (veridyn init swing-test), and give what is uncertain in [subject.sigma]"}};
}

}  // namespace

std::vector<FlightEvidence> recording_evidence(const Recording& recording, const Reconstruction& reconstruction,
                                               const ReconstructOptions& options, const Segments& segments,
                                               std::span<const DelayReport> delays) {
  std::vector<FlightEvidence> rows = sample_rows(recording, segments);
  const auto add = [&](std::vector<FlightEvidence> more) {
    for (FlightEvidence& row : more) rows.push_back(std::move(row));
  };
  for (Evidence& row : recording::inertial_evidence(recording::inertial_consistency(recording, segments.airborne)))
    rows.push_back({std::move(row)});
  add(delay_rows(delays));
  add(together_rows(delays));
  if (const Channel* density = reconstruction.smoothed.find("air_density")) {
    const AirDataConsistency air = corrected(
        air_data_consistency(recording, *density, options.airspeed_is_true, segments.airborne), reconstruction);
    if (air.airspeed_scale) rows.push_back(airspeed_row(*air.airspeed_scale));
    if (air.alpha) {
      rows.push_back(vane_row(*air.alpha, "alpha"));
      rows.push_back(slope_row(
          alpha_slope(recording, *density, options.airspeed_is_true, segments.longitudinal.excited), "alpha"));
    }
    if (air.beta) {
      rows.push_back(vane_row(*air.beta, "beta"));
      rows.push_back(
          slope_row(beta_slope(recording, *density, options.airspeed_is_true, segments.lateral.excited), "beta"));
    }
  }
  add(range_rows(recording, segments));
  rows.push_back(deflection_row(recording));
  rows.push_back(body_row());
  std::vector<FlightEvidence> symptoms;
  for (const SensorReport& sensor : reconstruction.sensors)
    if (sensor.innovations.count > 0) symptoms.push_back(innovation_row(sensor));
  if (std::optional<FlightEvidence> gust = gust_row(reconstruction, segments)) symptoms.push_back(std::move(*gust));
  const bool lost = reconstruction.contradiction.has_value();
  raise_causes(rows, symptoms, lost);
  // First of all rows, as the reason that there is no more.
  if (lost)
    rows.insert(rows.begin(), contradiction_row(*reconstruction.contradiction, options.gate.dead_reckoning_s, rows));
  add(std::move(symptoms));
  return rows;
}

}  // namespace veridyn::aircraft
