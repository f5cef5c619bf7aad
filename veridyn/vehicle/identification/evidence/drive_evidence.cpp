#include "veridyn/vehicle/identification/evidence/drive_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "veridyn/core/constants.hpp"
#include "veridyn/recording/sample_evidence.hpp"
#include "veridyn/recording/signal_gain.hpp"
#include "veridyn/recording/stamp_evidence.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::Cause;
using estimation::Check;
using estimation::Evidence;
using estimation::Outcome;
using estimation::Purpose;
using estimation::row_of;

std::vector<Evidence> drive_sample_rows(const Recording& recording, const DriveSegments& segments) {
  static const std::vector<recording::SampledChannel> kChannels{{"yaw_rate", "yaw_rate"},
                                                                {"gyro_z", "yaw_rate"},
                                                                {"accel_x", "accel_x"},
                                                                {"accel_y", "accel_y"},
                                                                {"accel_z", "accel_z"},
                                                                {"lateral_velocity", "lateral_velocity"},
                                                                {"sideslip", "sideslip"},
                                                                {"yaw", "yaw"},
                                                                {"course", "course"},
                                                                {"speed", "speed", recording::Rest::kLongOnly},
                                                                {"wheel_speed_rl", "speed", recording::Rest::kLongOnly},
                                                                {"wheel_speed_rr", "speed", recording::Rest::kLongOnly},
                                                                {"steer", "steer", recording::Rest::kNone},
                                                                {"steering_wheel", "steer", recording::Rest::kNone}};
  std::vector<Evidence> rows = recording::sample_evidence(recording, kChannels, segments.usable);
  std::ranges::move(recording::stamp_evidence(recording, kChannels, segments.usable), std::back_inserter(rows));
  return rows;
}

/// A vehicle whose wheels stand still comes to a steady turn; one that turns on does not stand still.
std::optional<Evidence> frozen_steering(const DriveSignals& signals, std::span<const TimeSpan> spans) {
  const double longest_s = estimation::info_of(Check::kFrozenSteering).tolerance.high;
  constexpr double kSettles_s = 1.0;
  /// Of the yaw rate's scatter over the drive, and of a drive that turns at all [rad/s].
  constexpr double kLimit = 0.3, kTurns = 0.01;
  const std::vector<double>& steer = signals[DriveSignal::kSteer].value;
  if (steer.empty()) return std::nullopt;
  const std::vector<double> r =
      recording::low_passed(signals[DriveSignal::kYawRate].value, signals.grid, 0.1 * signals.grid.rate_Hz());
  const auto scatter = [&](std::size_t first, std::size_t last) {
    double sum = 0.0, squares = 0.0, n = 0.0;
    for (std::size_t k = first; k < last; ++k)
      if (std::isfinite(r[k])) sum += r[k], squares += r[k] * r[k], n += 1.0;
    return n < 2.0 ? 0.0 : std::sqrt(std::max(0.0, squares / n - sum * sum / (n * n)));
  };
  const double all = scatter(0, r.size());
  if (all < kTurns) return std::nullopt;
  double moving = 0.0, total = 0.0, at = 0.0;
  for (const TimeSpan& span : spans) {
    const auto [first, last] = signals.indices(span);
    for (std::size_t k = first; k < last;) {
      std::size_t end = k + 1;
      while (end < last && steer[end] == steer[k]) ++end;
      const double length = static_cast<double>(end - k) * signals.grid.step;
      total += length;
      const auto settled = k + static_cast<std::size_t>(kSettles_s / signals.grid.step);
      if (length > longest_s && scatter(settled, end) > kLimit * all) {
        if (moving == 0.0) at = signals.grid.at(k);
        moving += length;
      }
      k = end;
    }
  }
  if (moving == 0.0) return std::nullopt;
  Evidence row = row_of(Check::kFrozenSteering, "steer", moving > 0.02 * total ? Outcome::kFailed : Outcome::kCare);
  row.cause = Cause::kFrozen;
  row.value = moving;
  row.limit = longest_s;
  return std::move(row).with("begin", at);
}

Evidence with_late(Evidence row, const char* which, double late_s, const char* other) {
  if (!row.passed()) row.cause = Cause::kDelay;
  return std::move(row).with("late", late_s).with("which", std::string(which)).with("other", std::string(other));
}
/// Of a row that compared the two: which is late, and by how much; or the other is early.
Evidence of_steering(Evidence row) {
  row.about = "steer, yaw_rate";
  const double late_s = row.value;
  return late_s < 0.0 ? with_late(std::move(row), "steer", -late_s, "yaw_rate")
                      : with_late(std::move(row), "yaw_rate", late_s, "steer");
}

Evidence row_by_signals(const recording::DelayReport& report, bool misled) {
  const bool determined = report.correlation > 0.0 && report.determined();
  const Outcome outcome = determined ? estimation::outcome_of(report.delay_s, report.sigma_s,
                                                              estimation::info_of(Check::kSteeringOrder).tolerance)
                                     : Outcome::kPassed;
  // Signals alone tell a delay to no better than what tyres and a lean make.
  if (outcome != Outcome::kPassed && !misled)
    return of_steering(row_of(Check::kSteeringOrder, "", report.delay_s, report.sigma_s));
  Evidence row = row_of(Check::kSteeringOrder, "steer, yaw_rate", Outcome::kNotVerified);
  row.cause = !determined ? Cause::kExcitation : outcome != Outcome::kPassed ? Cause::kMissingTerm : Cause::kNone;
  row.value = determined ? report.delay_s : kNaN;
  row.sigma = report.sigma_s;
  row.limit = estimation::info_of(Check::kSteeringOrder).tolerance.high;
  return row;
}

}  // namespace

Evidence steering_row(const recording::DelayReport& by_signals, const KnownByModel& known) {
  if (!known.delay || !std::isfinite(known.delay->sigma_s))
    return row_by_signals(by_signals, known.changed || known.roll_gradient.value_or(0.0) != 0.0);
  return of_steering(row_of(Check::kSteeringDelay, "", known.delay->value_s, known.delay->sigma_s));
}

bool contradicts_itself(const DriveFindings& findings) {
  return std::ranges::any_of(recording_rows(findings), [](const Evidence& row) {
    return row.outcome == Outcome::kFailed && row.bears_on.contains(Purpose::kParameters);
  });
}

bool is_in_doubt(const DriveFindings& findings, const KnownByModel& known) {
  const auto doubts = [](const Evidence& row) {
    return row.outcome >= Outcome::kCare && row.bears_on.contains(Purpose::kParameters);
  };
  return std::ranges::any_of(findings.rows, doubts) ||
         std::ranges::any_of(consistency_rows(findings.consistency, known.roll_gradient, findings.gravity), doubts);
}

std::vector<Evidence> recording_rows(const DriveFindings& findings, const KnownByModel& known) {
  std::vector<Evidence> rows = findings.rows;
  for (Evidence& row : consistency_rows(findings.consistency, known.roll_gradient, findings.gravity))
    rows.push_back(std::move(row));
  if (findings.steering_delay) rows.push_back(steering_row(*findings.steering_delay, known));
  const VehicleParameters<double>& p = findings.vehicle;
  rows.push_back(row_of(Check::kGivenMass, "mass", Outcome::kNotVerified).with("mass", p.mass));
  rows.push_back(
      row_of(Check::kGivenCentreOfGravity, "centre of gravity", Outcome::kNotVerified).with("a", p.a).with("b", p.b));
  return rows;
}

recording::DelayReport steering_delay(const DriveSignals& signals, std::span<const TimeSpan> spans,
                                      const Progress& progress) {
  const double band_Hz = std::min(3.0, 0.15 * signals.grid.rate_Hz());
  const auto smooth = [&](const std::vector<double>& values) {
    return recording::low_passed(values, signals.grid, band_Hz);
  };
  const std::vector<double>& u = signals[DriveSignal::kSpeed].value;
  const std::vector<double>& r = signals[DriveSignal::kYawRate].value;
  std::vector<double> curvature(r.size()), turning(r.size());
  for (std::size_t k = 0; k < r.size(); ++k) {
    curvature[k] = r[k] / u[k];
    turning[k] = r[k] * u[k];
  }
  const recording::GridSignal& accel = signals[DriveSignal::kAccelY];
  std::vector<double> effect = recording::low_passed_derivative(r, signals.grid, band_Hz);
  std::vector<bool> inside(effect.size(), false);
  for (const TimeSpan& span : spans) {
    const auto [first, last] = signals.indices(span);
    std::fill(inside.begin() + first, inside.begin() + last, true);
  }
  for (std::size_t k = 0; k < effect.size(); ++k)
    if (!inside[k]) effect[k] = kNaN;
  recording::DelayOptions options;
  options.max_delay_s = 0.6;
  options.band_Hz = band_Hz;
  return recording::effect_delay("steer", "yaw_rate", effect, {smooth(signals[DriveSignal::kSteer].value)},
                                 {{smooth(curvature)}, {smooth(accel.available() ? accel.value : turning)}},
                                 signals.grid.step, options, progress, "steering");
}

DriveFindings drive_findings(const recording::MappedRecording& mapped, const DriveSignals& signals,
                             const DriveSegments& segments, const VehicleParameters<double>& vehicle,
                             const DriveSignalOptions& options, const Progress& progress) {
  DriveFindings out{.rows = drive_sample_rows(mapped.recording, segments),
                    .consistency = drive_consistency(mapped, signals, segments.usable, vehicle.wheelbase()),
                    .vehicle = vehicle,
                    .gravity = options.gravity};
  if (auto row = frozen_steering(signals, segments.usable)) out.rows.push_back(std::move(*row));
  if (signals[DriveSignal::kSteer].available()) out.steering_delay = steering_delay(signals, segments.usable, progress);
  return out;
}

}  // namespace veridyn::vehicle
