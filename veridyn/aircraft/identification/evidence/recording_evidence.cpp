#include "veridyn/aircraft/identification/evidence/recording_evidence.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "veridyn/aircraft/identification/evidence/air_data_evidence.hpp"
#include "veridyn/aircraft/identification/evidence/contradicted_flight.hpp"
#include "veridyn/aircraft/identification/evidence/missing_sensor_evidence.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/units.hpp"
#include "veridyn/numerics/threads/parallel.hpp"
#include "veridyn/recording/inertial_consistency.hpp"
#include "veridyn/recording/sample_evidence.hpp"
#include "veridyn/recording/time_order.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Evidence;
using estimation::kAllPurposes;
using estimation::Outcome;
using estimation::Purpose;

using estimation::outcome_of;
using estimation::passed_or;
using estimation::Tolerance;

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

/// A vane whose delay by its force and by the motion contradict each other: one of what they are computed from is
/// wrong.
FlightEvidence contradicted_vane_row(const DelayReport& report) {
  const recording::OtherDelay& other = *report.contradicted_by;
  return {
      {.name = "delay of a vane",
       .about = report.group,
       .outcome = Outcome::kCare,
       .value = other.delay_s - report.delay_s,
       .limit = estimation::kBeyondChance * std::hypot(report.sigma_s, other.sigma_s),
       .scale = "s",
       .text =
           fmt::format("the {} vane is {:.3f} +- {:.3f} s late by {}, but {:.3f} +- {:.3f} s by {}", report.group,
                       report.delay_s, report.sigma_s, report.reference, other.delay_s, other.sigma_s, other.reference),
       .bears_on = Purpose::kParameters,
       .advice = fmt::format("check airspeed, accelerometer and the vane's position (reconstruct.vane_position), or "
                             "measure the delay and give it: delays.{} = \"... ms\"",
                             report.group)},
      report.group == "alpha" ? by_alpha() : by_beta()};
}

/// Vanes whose delay a recording does not show: in gusts of the size of its manoeuvres, or with few of these, the
/// motion does not tell, and where lift follows alpha, pitch rate and elevator alike, the force does not.
std::vector<FlightEvidence> vane_delay_rows(std::span<const DelayReport> delays) {
  std::vector<FlightEvidence> rows;
  for (const DelayReport& report : delays) {
    const bool alpha = report.group == "alpha";
    if (!alpha && report.group != "beta") continue;
    if (report.contradicted_by) rows.push_back(contradicted_vane_row(report));
    if (report.determined() && !(estimation::kBeyondChance * report.sigma_s > recording::kDelayMatters_s)) continue;
    const std::string found =
        report.sigma_s > 0.0 ? fmt::format(" ({:.3f} +- {:.3f} s)", report.delay_s, report.sigma_s) : std::string();
    rows.push_back(
        {{.name = "delay of a vane",
          .about = report.group,
          .outcome = Outcome::kNotVerified,
          .value = report.sigma_s,
          .limit = recording::kDelayMatters_s / estimation::kBeyondChance,
          .scale = "s",
          .text = fmt::format("how late the {} vane {}{}: it is taken as {}, and what depends on {} is off by several "
                              "percent where that is wrong by a few hundredths of a second",
                              report.group, report.applied() ? "is, is not well known" : "is cannot be seen", found,
                              report.applied() ? "found" : "recorded", report.group),
          .bears_on = Purpose::kParameters,
          .advice = fmt::format("measure the delay of the vane and its filter, and give it: delays.{} = \"... ms\"",
                                report.group)},
         alpha ? by_alpha() : by_beta()});
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
                                         names, report.delay_s, report.sigma_s, recording::says(report)),
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

std::vector<FlightEvidence> sample_rows(const Recording& recording, const Segments& segments, int threads) {
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
                                                                {"elevator", "elevator", recording::Rest::kLongOnly},
                                                                {"aileron", "aileron", recording::Rest::kLongOnly},
                                                                {"rudder", "rudder", recording::Rest::kLongOnly}};
  std::vector<FlightEvidence> rows;
  for (Evidence& row : recording::sample_evidence(recording, kChannels, segments.airborne, threads)) {
    const bool alpha = row.about == "alpha", beta = row.about == "beta";
    rows.push_back({std::move(row), alpha ? by_alpha() : beta ? by_beta() : std::vector<Coefficient>{}});
  }
  return rows;
}

std::vector<FlightEvidence> inertial_rows(const Recording& recording, const Segments& segments) {
  std::vector<FlightEvidence> rows;
  for (Evidence& row : recording::inertial_evidence(recording::inertial_consistency(recording, segments.airborne)))
    rows.push_back({std::move(row)});
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
  if (sensor.channel == "alpha") return {std::move(row), by_alpha()};
  if (sensor.channel == "beta") return {std::move(row), by_beta()};
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

/// The slowest oscillation of an aircraft, the phugoid, has a period of about pi sqrt(2) V/g (Lanchester 1908): what is
/// shorter shows neither it nor trends that are as slow.
std::optional<FlightEvidence> length_row(const Reconstruction& reconstruction, const Segments& segments) {
  const Channel* airspeed = reconstruction.smoothed.find("airspeed");
  if (airspeed == nullptr || segments.airborne.empty()) return std::nullopt;
  double sum = 0.0, longest = 0.0;
  std::size_t count = 0;
  for (const TimeSpan& span : segments.airborne) {
    longest = std::max(longest, span.duration());
    for (std::size_t k = 0; k < airspeed->size(); ++k) {
      if (!span.contains(airspeed->times()[k]) || !std::isfinite(airspeed->value[k])) continue;
      sum += airspeed->value[k];
      ++count;
    }
  }
  if (count == 0) return std::nullopt;
  const double period = kPi * std::sqrt(2.0) * sum / static_cast<double>(count) / kGravity;
  const bool passed = longest >= period;
  return FlightEvidence{
      {.name = "length of the flight",
       .outcome = passed_or(passed, Outcome::kCare),
       .value = longest,
       .limit = period,
       .scale = "s",
       .text = fmt::format(
           "the longest stretch in the air lasts {:.0f} s, the slowest oscillation (phugoid) about {:.0f} s{}", longest,
           period, passed ? "" : ": slow motion is not in this recording"),
       .bears_on = Purpose::kPrediction,
       .advice = passed ? std::string() : fmt::format("record at least {:.0f} s in the air", 2.0 * period)}};
}

/// What no channel of a flight can show: the aircraft answers a deflection the same whatever it is called.
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
                                               std::span<const DelayReport> delays, int threads) {
  // What takes time, side by side.
  std::vector<FlightEvidence> rows = sample_rows(recording, segments, threads);
  const std::array<std::function<std::vector<FlightEvidence>()>, 2> checks{
      [&] { return inertial_rows(recording, segments); },
      [&] { return air_data_evidence(recording, reconstruction, options.airspeed_is_true, segments); }};
  std::array<std::vector<FlightEvidence>, 2> found;
  numerics::parallel_for(checks.size(), threads, [&](std::size_t i) { found[i] = checks[i](); });

  const auto add = [&](std::vector<FlightEvidence> more) {
    for (FlightEvidence& row : more) rows.push_back(std::move(row));
  };
  add(std::move(found[0]));
  add(delay_rows(delays));
  add(vane_delay_rows(delays));
  add(together_rows(delays));
  add(std::move(found[1]));
  add(missing_sensor_evidence(recording, reconstruction, segments));
  add(range_rows(recording, segments));
  if (std::optional<FlightEvidence> length = length_row(reconstruction, segments)) rows.push_back(std::move(*length));
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
