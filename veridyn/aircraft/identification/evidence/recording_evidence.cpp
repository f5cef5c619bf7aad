#include "veridyn/aircraft/identification/evidence/recording_evidence.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>

#include "veridyn/aircraft/identification/evidence/air_data_evidence.hpp"
#include "veridyn/aircraft/identification/evidence/contradicted_flight.hpp"
#include "veridyn/aircraft/identification/evidence/missing_sensor_evidence.hpp"
#include "veridyn/aircraft/reconstruction/corrected_flow.hpp"
#include "veridyn/aircraft/sensors/accelerometer_at_centre.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/numerics/threads/parallel.hpp"
#include "veridyn/recording/inertial_consistency.hpp"
#include "veridyn/recording/sample_evidence.hpp"
#include "veridyn/recording/stamp_evidence.hpp"
#include "veridyn/recording/time_order.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Cause;
using estimation::Check;
using estimation::Evidence;
using estimation::Groups;
using estimation::info_of;
using estimation::Outcome;
using estimation::row_of;

/// The surfaces, and what rests on each.
struct ControlSurface {
  const char* name;
  Groups affects;
};
constexpr std::array<ControlSurface, 3> kControlSurfaces{
    {{"elevator", kByAlpha}, {"aileron", kByBeta}, {"rudder", kByBeta}}};

const ControlSurface* surface_of(std::string_view group) {
  const auto found = std::ranges::find(kControlSurfaces, group, &ControlSurface::name);
  return found == kControlSurfaces.end() ? nullptr : &*found;
}

/// The coefficients that rest on a channel: a vane and a surface are of one axis, all else of both.
Groups affected_by(std::string_view channel) {
  if (const ControlSurface* surface = surface_of(channel)) return surface->affects;
  return channel == "alpha" ? kByAlpha : channel == "beta" ? kByBeta : Groups::all();
}

Evidence with_affects(Evidence row) {
  row.affects = affected_by(row.about);
  return row;
}

/// What the alignment of the clocks found that no sensor can be: early, or of opposite sign.
std::vector<Evidence> delay_rows(std::span<const DelayReport> delays) {
  /// See the table: beyond it the sign of a control derivative depends on the delay.
  constexpr double kControlFailed_s = 0.1;
  const auto order_of = [](const DelayReport& report) -> recording::TimeOrder {
    if (surface_of(report.group) == nullptr) return {};
    return {.failed_s = kControlFailed_s, .is_control = true};
  };
  std::vector<Evidence> rows;
  const auto attitude = std::ranges::find(delays, "attitude", &DelayReport::group);
  const bool gyro_is_late = attitude != delays.end() && recording::is_early(*attitude, order_of(*attitude));
  if (gyro_is_late) {
    rows.push_back(row_of(Check::kGyroDelay, "gyro", -attitude->delay_s, attitude->sigma_s));
    rows.back().cause = Cause::kDelay;
  }
  for (const DelayReport& report : delays) {
    const recording::TimeOrder order = order_of(report);
    if (recording::is_opposite(report))
      rows.push_back(with_affects(recording::opposite_row(report)));
    else if (recording::is_early(report, order) && !gyro_is_late)
      rows.push_back(with_affects(recording::early_row(report, order)));
    else if (order.is_control && recording::is_doubtful(report, order))
      rows.push_back(with_affects(recording::doubtful_row(report, order)));
  }
  return rows;
}

/// A vane whose delay by its force and by the motion contradict each other: one of what they are computed from is
/// wrong.
Evidence contradicted_vane_row(const DelayReport& report) {
  const recording::OtherDelay& other = *report.contradicted_by;
  Evidence row = row_of(Check::kVaneDelayContradicted, report.group, Outcome::kCare);
  row.value = other.delay_s - report.delay_s;
  row.sigma = std::hypot(report.sigma_s, other.sigma_s);
  row.limit = std::copysign(estimation::kBeyondChance * row.sigma, row.value);
  row.cause = Cause::kDelay;
  return with_affects(std::move(row)
                          .with("delay", report.delay_s)
                          .with("delay_sigma", report.sigma_s)
                          .with("reference", report.reference)
                          .with("other", other.delay_s)
                          .with("other_sigma", other.sigma_s)
                          .with("other_reference", other.reference));
}

/// Vanes whose delay a recording does not show: in gusts of the size of its manoeuvres, or with few of these, the
/// motion does not tell, and where lift follows alpha, pitch rate and elevator alike, the force does not.
std::vector<Evidence> vane_delay_rows(std::span<const DelayReport> delays) {
  std::vector<Evidence> rows;
  for (const DelayReport& report : delays) {
    if (report.group != "alpha" && report.group != "beta") continue;
    if (report.contradicted_by) rows.push_back(contradicted_vane_row(report));
    if (report.determined() && !(estimation::kBeyondChance * report.sigma_s > recording::kDelayMatters_s)) continue;
    Evidence row = row_of(Check::kVaneDelay, report.group, Outcome::kNotVerified);
    row.value = report.sigma_s;
    row.limit = recording::kDelayMatters_s / estimation::kBeyondChance;
    row.cause = report.applied() ? Cause::kDelay : report.sigma_s > 0.0 ? Cause::kNoise : Cause::kExcitation;
    rows.push_back(with_affects(std::move(row).with("delay", report.delay_s)));
  }
  return rows;
}

/// Deflections whose single delays a recording does not show.
std::vector<Evidence> together_rows(std::span<const DelayReport> delays) {
  std::vector<Evidence> rows;
  for (const DelayReport& report : delays) {
    if (report.together.empty() || report.group != report.together.front()) continue;
    Evidence row =
        row_of(Check::kMoveTogether, fmt::format("{}", fmt::join(report.together, " and ")), Outcome::kNotVerified);
    row.value = report.delay_s;
    row.sigma = report.sigma_s;
    row.cause = Cause::kCollinear;
    row.affects = affected_by(report.group);
    if (std::ranges::any_of(report.together, [](const std::string& name) { return affected_by(name).contains(0); }) &&
        !row.affects.contains(0))
      row.affects = Groups::all();
    rows.push_back(std::move(row));
  }
  return rows;
}

/// No surface moves so far.
std::vector<Evidence> range_rows(const Recording& recording, const Segments& segments) {
  std::vector<Evidence> rows;
  for (const ControlSurface& surface : kControlSurfaces) {
    const Channel* channel = recording.find(surface.name);
    if (channel == nullptr) continue;
    double largest = 0.0;
    for (std::size_t i = 0; i < channel->size(); ++i) {
      const double t = channel->times()[i];
      if (std::ranges::any_of(segments.airborne, [&](const TimeSpan& span) { return span.contains(t); }))
        largest = std::fmax(largest, std::abs(channel->value[i]));
    }
    Evidence row = row_of(Check::kSurfaceRange, surface.name, largest / kDegree);
    if (row.passed()) continue;
    row.cause = Cause::kUnit;
    row.affects = surface.affects;
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<Evidence> sample_rows(const Recording& recording, const Segments& segments, int threads) {
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
                                                                {"elevator", "elevator", recording::Rest::kControl},
                                                                {"aileron", "aileron", recording::Rest::kControl},
                                                                {"rudder", "rudder", recording::Rest::kControl}};
  std::vector<Evidence> rows = recording::sample_evidence(recording, kChannels, segments.airborne, threads);
  std::ranges::move(recording::stamp_evidence(recording, kChannels, segments.airborne), std::back_inserter(rows));
  for (Evidence& row : rows) row.affects = affected_by(row.about);
  return rows;
}

/// A sensor whose samples the reconstruction had to refuse, or that is noisier than assumed. With both vanes and an
/// airspeed nothing rests on the heading.
Evidence innovation_row(const SensorReport& sensor, bool needs_heading) {
  const estimation::InnovationSummary& s = sensor.innovations;
  const double count = static_cast<double>(std::max<std::size_t>(1, s.count));
  Evidence row =
      row_of(Check::kReconstructionAgreement, sensor.channel, static_cast<double>(s.rejected + s.recovered) / count);
  row.affects = sensor.channel == "yaw" && !needs_heading ? kByNothing : affected_by(sensor.channel);
  return row;
}

/// Mean gusts of the reconstruction: what a recording that contradicts itself is pushed into.
std::optional<Evidence> gust_row(const Reconstruction& reconstruction, const Segments& segments) {
  const std::array<double, 3> sigma{reconstruction.turbulence.sigma_u, reconstruction.turbulence.sigma_v,
                                    reconstruction.turbulence.sigma_w};
  const std::array<double, 3> length{reconstruction.turbulence.Lu, reconstruction.turbulence.Lv,
                                     reconstruction.turbulence.Lw};
  static constexpr std::array<const char*, 3> kNames{"gust_x", "gust_y", "gust_z"};
  std::optional<Evidence> worst;
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
    Evidence row = row_of(Check::kMeanGust, kNames[i], mean, sigma_of_mean);
    if (!worst || row.outcome > worst->outcome ||
        (row.outcome == worst->outcome && std::abs(mean) > std::abs(worst->value)))
      worst = std::move(row);
  }
  return worst;
}

/// The slowest oscillation of an aircraft, the phugoid, has a period of about pi sqrt(2) V/g (Lanchester 1908): what is
/// shorter shows neither it nor trends that are as slow.
std::optional<Evidence> length_row(const Reconstruction& reconstruction, const Segments& segments) {
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
  Evidence row = row_of(Check::kFlightLength, "", estimation::passed_or(longest >= period, Outcome::kCare));
  row.value = longest;
  row.limit = period;
  if (!row.passed()) row.cause = Cause::kLength;
  return row;
}

/// What accelerometers are off by, after what velocity and attitude say of their zeros.
std::vector<SensorError> accelerometer_errors(const std::optional<recording::SensorMatrix>& found,
                                              const KnownSensors& known) {
  using enum SensorErrorKind;
  std::vector<SensorError> errors;
  Eigen::Index axis = 0;
  for (const SensorErrorKind kind : {kZeroX, kZeroY, kZeroZ}) {
    const SensorError prior = prior_of(BudgetSensor::kAccelerometer, kind, known);
    // A wrong zero of roll or pitch shows as much along y or x.
    const double attitude = kind == kZeroZ ? 0.0 : kGravity * kAttitudeZero;
    errors.push_back(found ? updated(prior, found->bias(axis), std::hypot(found->bias_sigma(axis), attitude)) : prior);
    ++axis;
  }
  return errors;
}

/// What no channel of a flight can show: the aircraft answers a deflection the same whatever it is called.
Evidence deflection_row(const Recording& recording) {
  std::vector<std::string> surfaces;
  for (const ControlSurface& surface : kControlSurfaces)
    if (recording.has(surface.name)) surfaces.emplace_back(surface.name);
  return row_of(Check::kDeflections, "controls", Outcome::kNotVerified)
      .with("surfaces", surfaces.empty() ? "deflections" : fmt::format("{}", fmt::join(surfaces, ", ")));
}

}  // namespace

CheckedFlight recording_evidence(const Recording& recording, const Reconstruction& reconstruction,
                                 const ReconstructOptions& options, const Segments& segments,
                                 std::span<const DelayReport> delays, int threads, const KnownSensors& known,
                                 const std::array<double, 3>& imu_position) {
  // What takes time, side by side.
  std::vector<Evidence> samples = sample_rows(recording, segments, threads);
  recording::InertialConsistency inertial;
  CheckedFlight air_data;
  const Recording motion = with_accelerometer_at_centre(recording, imu_position);
  const std::array<std::function<void()>, 2> checks{
      [&] { inertial = recording::inertial_consistency(motion, segments.airborne); },
      [&] {
        const FlowSensors vanes = flow_sensors(options, reconstruction.smoothed);
        const auto check = [&](const Recording& of) {
          return air_data_evidence(of, reconstruction, options.airspeed_is_true, segments, known);
        };
        air_data =
            vanes.exact()
                ? check(motion)
                : check(with_corrected_flow({.recording = motion}, vanes, reconstruction.smoothed).mapped.recording);
      }};
  numerics::parallel_for(checks.size(), threads, [&](std::size_t i) { checks[i](); });

  CheckedFlight found;
  const auto add = [&](std::vector<Evidence> more) { found.add({.rows = std::move(more), .errors = {}}); };
  add(std::move(samples));
  found.add(
      {.rows = recording::inertial_evidence(inertial), .errors = accelerometer_errors(inertial.accelerometer, known)});
  add(delay_rows(delays));
  add(vane_delay_rows(delays));
  add(together_rows(delays));
  found.add(std::move(air_data));
  found.add(missing_sensor_evidence(recording, reconstruction, segments));
  add(range_rows(recording, segments));
  if (std::optional<Evidence> length = length_row(reconstruction, segments)) found.add(std::move(*length));
  found.add(deflection_row(recording));
  found.add(row_of(Check::kBody, "body", Outcome::kNotVerified));
  // First of all rows, as the reason that there is no more.
  if (reconstruction.contradiction)
    found.rows.insert(found.rows.begin(),
                      contradiction_row(*reconstruction.contradiction, options.gate.dead_reckoning_s, found.rows));
  const bool needs_heading = !(recording.has("alpha") && recording.has("beta") &&
                               (recording.has("airspeed") || recording.has("dynamic_pressure")));
  for (const SensorReport& sensor : reconstruction.sensors)
    if (sensor.innovations.count > 0) found.add(innovation_row(sensor, needs_heading));
  if (std::optional<Evidence> gust = gust_row(reconstruction, segments)) found.add(std::move(*gust));
  return found;
}

}  // namespace veridyn::aircraft
