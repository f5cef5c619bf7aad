#include "veridyn/aircraft/reconstruction/reconstruct.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <span>

#include "veridyn/aircraft/reconstruction/reconstruct_columns.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_run.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_solve.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_streams.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::aircraft {
namespace {

using internal::FlightStreams;
using internal::kSensors;
using internal::monitors_with;
using internal::noise_of;
using internal::ResultColumns;
using internal::RunSetting;
using internal::Segment;
using internal::Solution;

// --- Turbulence -----------------------------------------------------------------------------------------------------

/// A stretch of at most `length` seconds in the fastest part of the longest segment: where the aircraft surely flies.
Segment typical_part(const FlightStreams& s, std::span<const Segment> segments, double length) {
  const Segment longest = *std::max_element(segments.begin(), segments.end(), [](const Segment& a, const Segment& b) {
    return a.end - a.begin < b.end - b.begin;
  });
  if (longest.end - longest.begin <= length) return longest;
  Segment best = longest;
  double fastest = -1.0;
  constexpr int kParts = 16;
  for (int i = 0; i < kParts; ++i) {
    const double begin = longest.begin + (longest.end - longest.begin - length) * i / (kParts - 1);
    const double north = internal::median_within(s.sensors[internal::kVelNorth], begin, length);
    const double east = internal::median_within(s.sensors[internal::kVelEast], begin, length);
    double speed = std::hypot(north, east);
    if (!s.sensors[internal::kPitot].t.empty()) {
      speed = internal::median_within(s.sensors[internal::kPitot], begin, length);
    }
    if (speed > fastest) {
      fastest = speed;
      best = {begin, begin + length};
    }
  }
  // A segment begins where attitude and velocity are known.
  for (const auto i : {internal::kRoll, internal::kPitch, internal::kYaw, internal::kVelNorth, internal::kVelEast,
                       internal::kVelDown}) {
    const auto& t = s.sensors[i].t;
    const auto it = std::lower_bound(t.begin(), t.end(), best.begin);
    if (it != t.end()) best.begin = std::max(best.begin, *it);
  }
  return best;
}

/// Log likelihood of the innovations over a stretch under a gust spectrum. What the gate refuses counts as an
/// innovation on the gate, so that a spectrum does not win by refusing.
double log_likelihood(const FlightStreams& s, const ReconstructOptions& o, const Segment& part,
                      const DrydenSettings& spectrum) {
  const std::vector<double> no_output;
  RunSetting setting{.streams = &s, .options = &o, .motion = {}, .output_t = &no_output};
  setting.motion.spectrum = spectrum;
  setting.motion.noise = noise_of(s, o);
  const auto run = internal::model_free_engine(false)->innovation_run(setting, part, monitors_with(o.gate));
  while (run->advance()) {
  }
  double sum = 0.0;
  for (const auto& monitor : run->monitors()) {
    const auto summary = monitor.summary();
    sum += summary.log_likelihood -
           0.5 * static_cast<double>(summary.rejected + summary.recovered) * o.gate.threshold * o.gate.threshold;
  }
  return sum;
}

/// A gust spectrum and why it was taken.
struct ChosenTurbulence {
  DrydenSettings spectrum;
  std::string origin;
};

ChosenTurbulence choose_turbulence(const FlightStreams& s, const ReconstructOptions& o,
                                   std::span<const Segment> segments) {
  if (o.turbulence) {
    ChosenTurbulence chosen{o.turbulence->spectrum, o.turbulence->name};
    for (double* sigma : {&chosen.spectrum.sigma_u, &chosen.spectrum.sigma_v, &chosen.spectrum.sigma_w})
      *sigma *= o.turbulence_scale;
    if (o.turbulence_scale != 1.0) chosen.origin += fmt::format(", intensities times {:g}", o.turbulence_scale);
    return chosen;
  }
  using namespace internal;
  if (s.sensors[kPitot].t.empty() && s.sensors[kAlpha].t.empty() && s.sensors[kBeta].t.empty()) {
    return {gust_spectrum("low_moderate"), "low_moderate, assumed: no sensor feels the air"};
  }
  const Segment part = typical_part(s, segments, 60.0);
  constexpr std::array<double, 7> kScales{0.25, 0.5, 0.7, 1.0, 1.4, 2.0, 3.0};
  ChosenTurbulence chosen;
  double best = -kInfinity;
  for (const char* setting : {"low_light", "medium_light"}) {
    for (const double scale : kScales) {
      const DrydenSettings spectrum = gust_spectrum(setting, scale);
      const double likelihood = log_likelihood(s, o, part, spectrum);
      if (likelihood > best) {
        best = likelihood;
        chosen = {spectrum, fmt::format("auto: {} times {:g}, by the innovations of {:.0f}..{:.0f} s", setting, scale,
                                        part.begin, part.end)};
      }
    }
  }
  return chosen;
}

// --- Report ---------------------------------------------------------------------------------------------------------

/// Gaps and slow samples of the inertial sensors.
std::vector<std::string> sampling_warnings(const FlightStreams& s, std::size_t segments, double max_gap) {
  std::vector<std::string> warnings;
  if (segments > 1) {
    warnings.push_back(
        fmt::format("gyro or accelerometer pause for more than {:g} s: estimated in {} parts, each "
                    "with its own start",
                    max_gap, segments));
  }
  if (s.gyro.interval > 0.05) {
    warnings.push_back(fmt::format("gyro at {:.1f} Hz: motion between its samples is not seen", 1.0 / s.gyro.interval));
  }
  return warnings;
}

std::vector<SensorReport> sensor_reports(const FlightStreams& s, const Solution& solution) {
  std::vector<SensorReport> reports;
  for (std::size_t i = 0; i < kSensors; ++i) {
    const internal::Stream& stream = s.sensors[i];
    if (stream.t.empty()) continue;
    reports.push_back({stream.channel, stream.unit, stream.sigma, stream.rate_Hz, solution.monitors[i].summary()});
  }
  return reports;
}

Recording innovation_recording(const FlightStreams& s, Solution& solution, const std::string& source) {
  Recording recording;
  recording.source = source;
  for (std::size_t i = 0; i < kSensors; ++i) {
    internal::InnovationHistory& history = solution.innovations[i];
    if (history.time.empty()) continue;
    const std::string& name = s.sensors[i].channel;
    const std::string& unit = s.sensors[i].unit;
    const TimeBase time = make_time_base(std::move(history.time));
    recording.add(make_channel(name, unit, time, std::move(history.innovation)));
    recording.add(make_channel("sigma_" + name, unit, time, std::move(history.sigma)));
    recording.add(make_channel("refused_" + name, "1", time, std::move(history.refused)));
  }
  return recording;
}

/// Sensors whose samples contradict the estimate.
std::vector<std::string> contradiction_warnings(std::span<const SensorReport> sensors) {
  std::vector<std::string> warnings;
  for (const SensorReport& sensor : sensors) {
    const estimation::InnovationSummary& summary = sensor.innovations;
    if (summary.count == 0) continue;
    const double refused = static_cast<double>(summary.rejected) / static_cast<double>(summary.count);
    if (refused > 0.01) {
      warnings.push_back(fmt::format("{}: {:.1f} % of the samples contradict the estimate and were dropped",
                                     sensor.channel, 100.0 * refused));
    }
    if (summary.recovered > 0) {
      warnings.push_back(
          fmt::format("{}: dropped for long and taken back, {} samples with inflated variance: the estimate or the "
                      "sensor was wrong for a while",
                      sensor.channel, summary.recovered));
    }
    if (summary.count > 100 && summary.nis > 2.0) {
      warnings.push_back(fmt::format(
          "{}: innovations {:.1f} times the expected size: its error is larger than the assumed {:.3g}{}",
          sensor.channel, std::sqrt(summary.nis), display_value(sensor.sigma, sensor.unit), display_unit(sensor.unit)));
    }
  }
  return warnings;
}

/// Sensors that are missing, and what cannot be known without them.
std::vector<std::string> missing_sensor_warnings(const FlightStreams& s) {
  std::vector<std::string> warnings;
  const bool pitot = s.has(internal::kPitot), vane_a = s.has(internal::kAlpha), vane_b = s.has(internal::kBeta);
  if (!s.has_ground_velocity()) {
    warnings.emplace_back(
        "no ground velocity: wind and motion over ground are not distinguishable; the velocity is the one through the "
        "mean air, and slow changes of the wind count as its accelerations");
  } else if (!s.has(internal::kYaw)) {
    warnings.emplace_back("no heading: it is found from accelerations over ground, slowly where there are few");
  }
  if (!s.has_tilt())
    warnings.emplace_back(
        "no roll and pitch: they are found from gyro, accelerometer and ground velocity, with the gyro's biases");
  if (!pitot) warnings.emplace_back("no pitot tube: the size of the airspeed is known only through the wind");
  if (!vane_a) {
    warnings.emplace_back("no alpha vane: gusts along z stay unknown, so alpha is known only as far as they are small");
  }
  if (!vane_b) {
    warnings.emplace_back("no beta vane: lateral gusts stay unknown, so beta is known only as far as they are small");
  }
  if (!pitot && !vane_a && !vane_b) {
    warnings.emplace_back(
        "neither pitot tube nor vanes: nothing in the recording feels the air; airspeed, alpha, "
        "beta and wind are assumptions, not estimates");
  }
  return warnings;
}

/// Where errors of vanes and pitot tube were estimated.
std::vector<std::string> air_data_error_warnings(const Solution& solution) {
  std::vector<std::string> warnings;
  if (!solution.air_data_errors_converged) {
    warnings.emplace_back(
        "the errors of vanes and pitot tube did not converge: their values are the best found, and the bands too "
        "narrow");
  }
  if (!solution.not_applied.empty()) {
    warnings.push_back(
        fmt::format("{}: not corrected, since headings, attitude, ground velocity and manoeuvres of this flight show "
                    "no such error beyond their own doubt; reconstruct.filter = \"model-based\" sees smaller ones",
                    fmt::join(solution.not_applied, ", ")));
  }
  return warnings;
}

std::vector<QuantityReport> quantity_reports(const ReconstructOptions& o, const DrydenSettings& g,
                                             const ResultColumns& columns, std::size_t count) {
  const auto first = [count](const std::vector<double>& v) { return std::span<const double>(v.data(), count); };
  const double speed = std::max(numerics::median(first(columns.value(0))), 1.0);
  const auto prior = [&](std::size_t c) -> double {
    const double vertical = std::hypot(o.initial_wind_down, g.sigma_w);
    switch (c) {
      case 0:
        return std::hypot(o.initial_wind, g.sigma_u);
      case 1:
        return std::min(vertical / speed, 1.0);
      case 2:
        return std::min(std::hypot(o.initial_wind, g.sigma_v) / speed, 1.0);
      case 6:
      case 7:
        return o.initial_wind;
      case 8:
        return o.initial_wind_down;
      default:
        return 0.0;
    }
  };
  std::vector<QuantityReport> reports;
  for (std::size_t c = 0; c < internal::kColumns.size(); ++c) {
    const double before = prior(c);
    if (before == 0.0 || !columns.has(c)) continue;
    QuantityReport q;
    q.quantity = internal::kColumns[c].name;
    q.unit = internal::kColumns[c].unit;
    q.prior_sigma = before;
    q.sigma = numerics::median(first(columns.sigma(c)));
    q.observability = observability_of(q.sigma, before);
    q.statement = fmt::format("{} is {}: sigma {:.3g}{} where {:.3g}{} was assumed beforehand", q.quantity,
                              to_string(q.observability), display_value(q.sigma, q.unit), display_unit(q.unit),
                              display_value(before, q.unit), display_unit(q.unit));
    reports.push_back(std::move(q));
  }
  return reports;
}

double error_prior(std::size_t column, const ModelError& model) {
  using namespace internal;
  if (column < kFirstImuBias + 3) return kGyroBiasPrior;
  if (column < kFirstImuScale) return kAccelBiasPrior;
  if (column < kFirstAirDataError) return kImuScalePrior;
  constexpr std::array<double, 5> kAir{kVaneBiasPrior, kVaneBiasPrior, kAlphaScalePrior, kPitotScalePrior,
                                       kPitotBiasPrior};
  if (column < kFirstCoefficientError) return kAir[column - kFirstAirDataError];
  return model.sigma(column - kFirstCoefficientError);
}

std::vector<SensorErrorReport> sensor_error_reports(const Solution& solution, const ModelError& model) {
  std::vector<SensorErrorEstimate> errors;
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < solution.error_columns.size(); ++i) {
    const std::size_t c = solution.error_columns[i];
    const double prior = error_prior(c, model);
    if (!(prior > 0.0)) continue;
    const auto part = [&](const std::vector<double>& v) { return std::span<const double>(v.data(), solution.count); };
    const bool air_data = c >= internal::kFirstAirDataError && c < internal::kFirstCoefficientError;
    errors.push_back({.name = internal::kColumns[c].name,
                      .unit = internal::kColumns[c].unit,
                      .value = air_data ? solution.air_error_found(c - internal::kFirstAirDataError)
                                        : numerics::median(part(solution.smoothed->value(c))),
                      .prior_sigma = prior,
                      .sigma = numerics::median(part(solution.smoothed->sigma(c)))});
    kept.push_back(static_cast<Eigen::Index>(i));
  }
  const auto n = signed_index(kept.size());
  Eigen::MatrixXd covariance(n, n);
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b) covariance(a, b) = solution.error_covariance(kept[a], kept[b]);
  }
  return judge_sensor_errors(errors, covariance);
}

GuardReport guard_report(const internal::GuardTrace& trace, const std::vector<double>& stamps, std::size_t count) {
  GuardReport report;
  report.reverts = trace.reverts;
  std::size_t used = 0;
  for (std::size_t k = 0; k < count; ++k) {
    if (trace.model_based[k]) {
      ++used;
      continue;
    }
    if (k > 0 && !trace.model_based[k - 1] && !report.model_free.empty()) {
      report.model_free.back().end = stamps[k];
    } else {
      report.model_free.push_back({stamps[k], stamps[k]});
    }
  }
  report.model_based_share = count > 0 ? static_cast<double>(used) / static_cast<double>(count) : 0.0;
  report.statement =
      report.reverts == 0
          ? std::string("the model-based filter was trusted throughout")
          : fmt::format(
                "the model-based filter was trusted {:.0f} % of the time; its innovations contradicted the "
                "model {} time{}, first at {:.1f} s",
                100.0 * report.model_based_share, report.reverts, report.reverts > 1 ? "s" : "",
                report.model_free.empty() ? 0.0 : report.model_free.front().begin);
  return report;
}

Solution solved(FilterKind kind, const internal::SolveTask& task, Progress& progress) {
  switch (kind) {
    case FilterKind::kGuarded:
      return internal::solve_guarded(task, progress);
    case FilterKind::kModelBased:
      return internal::solve_model_based(task, progress);
    case FilterKind::kModelFree:
    case FilterKind::kNone:
      break;
  }
  return internal::solve_model_free(task, progress);
}

/// What was solved for, as a recording; without channels where nothing was.
Recording recording_of(ResultColumns& columns, const TimeBase& time, std::size_t count, const std::string& source) {
  Recording recording;
  recording.source = source;
  recording.frame = Frame::kFrd;
  if (count > 0) columns.move_into(recording, time, count);
  return recording;
}

}  // namespace

std::string reconstruction_obstacle(const Recording& mapped, const ReconstructOptions& options) {
  const auto has = [&mapped](const char* name) {
    const Channel* channel = mapped.find(name);
    return channel != nullptr && std::ranges::any_of(channel->value, [](double v) { return std::isfinite(v); });
  };
  const auto all = [&has](std::initializer_list<const char*> names) { return std::ranges::all_of(names, has); };
  if (!all({"gyro_x", "gyro_y", "gyro_z"})) return "the recording has no gyro (gyro_x, gyro_y, gyro_z)";
  if (!all({"accel_x", "accel_y", "accel_z"})) return "the recording has no accelerometer (accel_x, accel_y, accel_z)";
  const bool ground = all({"vel_north", "vel_east"});
  if (!ground && !all({"roll", "pitch"}))
    return "the recording has neither attitude (roll, pitch) nor ground velocity (vel_north, vel_east)";
  if (!ground && !(options.use_pitot && (has("dynamic_pressure") || has("airspeed"))))
    return "the recording has neither ground velocity (vel_north, vel_east) nor airspeed (airspeed, dynamic_pressure)";
  return {};
}

Reconstruction reconstruct(const Recording& mapped, const ReconstructOptions& given, Progress& progress,
                           const Subject* subject) {
  if (mapped.frame == Frame::kFlu) {
    throw InputError(mapped.source, "is in the frame flu; reconstruction of an aircraft needs frd, convert it first");
  }
  if (const std::string obstacle = reconstruction_obstacle(mapped, given); !obstacle.empty())
    throw InputError(mapped.source, fmt::format("{}; it has: {}", obstacle, fmt::join(mapped.names(), ", ")));
  FlightStreams streams = internal::load_streams(mapped, given);
  ReconstructOptions options = given;
  // What an attitude would take off, the integral of the gyro keeps.
  if (!streams.has_tilt()) options.gyro_bias = true;
  std::optional<Subject> force_model;
  if (options.filter != FilterKind::kModelFree) {
    if (subject == nullptr) {
      throw InputError(mapped.source, "reconstruct.filter other than \"model-free\" needs a subject with derivatives");
    }
    internal::ModelStreams with_model = internal::load_model_streams(mapped, *subject, std::move(streams));
    streams = std::move(with_model.streams);
    force_model = std::move(with_model.force_model);
  }
  const std::vector<Segment> segments = internal::find_segments(streams, options.max_gap);
  if (segments.empty()) {
    throw InputError(
        mapped.source,
        fmt::format("holds no second of gyro, accelerometer, attitude and ground velocity, as far as it has these, "
                    "together without a gap longer than {:g} s",
                    options.max_gap));
  }
  internal::OutputStamps stamps = internal::output_stamps(streams, segments, options.rate_Hz);
  if (stamps.time.empty())
    throw InputError(mapped.source, "reconstruct.rate is too low: no result falls into the record");

  ChosenTurbulence turbulence = choose_turbulence(streams, options, segments);
  progress.stage(fmt::format("reconstructing {:.0f} s of flight", stamps.time.back() - stamps.time.front()));
  const internal::SolveTask task{.streams = &streams,
                                 .options = &options,
                                 .segments = segments,
                                 .stamps = &stamps.time,
                                 .first_stamp = stamps.first,
                                 .spectrum = turbulence.spectrum,
                                 .subject = force_model ? &*force_model : nullptr,
                                 .recording = &mapped};
  Solution solution = solved(options.filter, task, progress);

  Reconstruction out;
  const auto warn = [&](std::vector<std::string> texts) {
    std::move(texts.begin(), texts.end(), std::back_inserter(out.warnings));
  };
  out.filter = options.filter;
  out.sigma = streams.sigma;
  out.density_origin = streams.density_origin;
  out.turbulence = turbulence.spectrum;
  out.turbulence_origin = std::move(turbulence.origin);
  for (const Segment& segment : segments) out.segments.push_back({segment.begin, segment.end});
  out.contradiction = solution.contradiction;
  out.interrupted = !out.contradiction && solution.count < stamps.time.size();
  if (out.contradiction) warn({out.contradiction->statement});
  warn(streams.warnings);
  warn(sampling_warnings(streams, segments.size(), options.max_gap));
  out.sensors = sensor_reports(streams, solution);
  out.innovations = innovation_recording(streams, solution, mapped.source);
  for (const SensorReport& sensor : out.sensors) out.log_likelihood += sensor.innovations.log_likelihood;
  warn(contradiction_warnings(out.sensors));
  if (solution.count > 0)
    out.quantities = quantity_reports(options, out.turbulence, *solution.smoothed, solution.count);
  warn(missing_sensor_warnings(streams));
  if (options.estimates_air_data_errors()) warn(air_data_error_warnings(solution));
  if (solution.count > 0)
    out.sensor_errors =
        sensor_error_reports(solution, force_model ? internal::model_error_of(*force_model, options) : ModelError{});
  if (solution.guard) {
    out.guard = guard_report(*solution.guard, stamps.time, solution.count);
    if (out.guard->reverts > 0) out.warnings.push_back(out.guard->statement);
  }
  stamps.time.resize(solution.count);
  const TimeBase time = make_time_base(std::move(stamps.time));
  out.smoothed = recording_of(*solution.smoothed, time, solution.count, mapped.source);
  if (solution.filtered) out.filtered = recording_of(*solution.filtered, time, solution.count, mapped.source);
  if (solution.filtered && solution.guard)
    internal::add_guard_channels(*solution.guard, time, solution.count, out.filtered);
  return out;
}

}  // namespace veridyn::aircraft
