#include "veridyn/vehicle/identification/evidence/drive_evidence.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/recording/sample_evidence.hpp"
#include "veridyn/recording/sensor_matrix.hpp"
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

std::string_view name_of(DriveSuspect sensor) { return kDriveSuspectNames[sensor]; }

std::string names_of(const std::vector<DriveCulprit>& suspects, std::string_view separator) {
  std::vector<std::string_view> names;
  for (const DriveCulprit& culprit : suspects) names.push_back(name_of(culprit.sensor));
  return fmt::format("{}", fmt::join(names, separator));
}

/// The unit that explains a sensor's factor; empty: none does.
std::string unit_of(const DriveCulprit& culprit) {
  const double size = std::abs(culprit.factor);
  // What the sideslip's approximation leaves of a gain.
  constexpr double kModelError = 0.03;
  // Ratios of steering gears from rack to hand wheel.
  const bool hand_wheel = culprit.sensor == DriveSuspect::kSteer && size > 8.0 && size < 30.0;
  return hand_wheel ? "the hand wheel's angle taken for the road wheels'"
                    : recording::mistaken_unit(size, culprit.doubt + kModelError);
}

/// A body that leans outward shows part of gravity as lateral acceleration.
bool may_lean(const DriveRelation& r, bool gravity_removed) {
  constexpr double kMostByLean = 1.25;
  return r.sensor == DriveSuspect::kAccelY && !gravity_removed && r.low > 1.0 && r.middle() < kMostByLean;
}

/// Whether the lean that the model knows is what accel_y reads too much.
bool is_explained(const DriveRelation& r, std::optional<double> roll_gradient, double gravity) {
  // What the sideslip's approximation leaves of the ratio.
  constexpr double kModelError = 0.05;
  return r.sensor == DriveSuspect::kAccelY && roll_gradient && r.outcome() == Outcome::kCare &&
         std::abs(r.middle() - 1.0 - gravity * *roll_gradient) < kModelError;
}

Cause cause_of(const DriveRelation& r, const std::vector<DriveCulprit>& suspects, bool gravity_removed) {
  if (may_lean(r, gravity_removed)) return Cause::kGravity;
  if (r.unrelated()) return Cause::kAxis;
  if (suspects.size() != 1) return Cause::kNone;
  const DriveCulprit& culprit = suspects.front();
  if (!std::isfinite(culprit.factor)) return Cause::kAxis;
  if (!unit_of(culprit).empty()) return Cause::kUnit;
  return culprit.factor < 0.0 ? Cause::kSign : Cause::kScale;
}

Evidence relation_row(const DriveRelation& r, const std::vector<DriveCulprit>& suspects, bool gravity_removed,
                      double gravity, std::optional<double> roll_gradient) {
  const bool leans = is_explained(r, roll_gradient, gravity);
  Outcome outcome = leans ? Outcome::kPassed : r.outcome();
  if (!leans && outcome == Outcome::kPassed && !r.verified) outcome = Outcome::kNotVerified;
  Evidence row = row_of(r.check, std::string(name_of(r.sensor)), outcome);
  row.value = r.middle();
  row.sigma = (r.high - r.low) / (2.0 * estimation::kBeyondChance);
  const bool failed = outcome == Outcome::kFailed, high = r.middle() > 1.0;
  row.limit = failed ? (high ? r.tolerance.highest : r.tolerance.lowest) : (high ? r.tolerance.high : r.tolerance.low);
  if (leans) {
    row.cause = Cause::kGravity;
  } else if (!row.passed()) {
    row.cause = cause_of(r, suspects, gravity_removed);
  } else if (!r.strong) {
    row.cause = Cause::kExcitation;
  }
  row.with("sensor", std::string(name_of(r.sensor))).with("against", r.against).with("low", r.low).with("high", r.high);
  row.with("correlation", r.correlation);
  if (row.cause == Cause::kGravity) {
    const double gradient = leans ? *roll_gradient : (r.middle() - 1.0) / gravity;
    row.with("gradient", gradient).with("lean", gradient * gravity);
  }
  if (row.passed()) return row;
  if (!suspects.empty()) row.about = names_of(suspects, ", ");
  row.with("suspects", suspects.empty() ? std::string("one of the sensors") : names_of(suspects, " or "));
  if (suspects.size() == 1) row.with("factor", suspects.front().factor).with("units", unit_of(suspects.front()));
  return row;
}

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

/// Mean of the vertical specific force over g: unit, sign and frame of the accelerometer.
std::optional<Evidence> gravity_row(const Recording& recording, double gravity) {
  const Channel* accel = recording.find("accel_z");
  if (accel == nullptr || accel->size() < 2) return std::nullopt;
  std::vector<double> values;
  std::ranges::copy_if(accel->value, std::back_inserter(values), [](double v) { return std::isfinite(v); });
  if (values.empty()) return std::nullopt;
  const double ratio = numerics::median(values) / gravity;
  Evidence row = row_of(Check::kGravity, "accel_z", ratio);
  if (row.passed()) return row;
  const std::string unit = recording::mistaken_unit(std::abs(ratio));
  row.cause = ratio < 0.0 ? Cause::kSign : unit.empty() ? Cause::kScale : Cause::kUnit;
  return std::move(row).with("units", unit);
}

/// A vehicle whose wheels stand still comes to a steady turn; one that turns on does not stand still.
std::optional<Evidence> frozen_steering(const DriveSignals& signals, std::span<const TimeSpan> spans) {
  const double longest_s = estimation::info_of(Check::kFrozenSteering).tolerance.high;
  constexpr double kSettles_s = 1.0;
  /// Of the yaw rate's scatter over the drive.
  constexpr double kLimit = 0.3;
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
  double moving = 0.0, total = 0.0, at = 0.0;
  for (const TimeSpan& span : spans) {
    const auto [first, last] = signals.indices(span);
    const double all = scatter(0, r.size());
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

/// Of a row that found one of the two late: which, and by how much.
Evidence with_late(Evidence row) {
  row.about = row.value < 0.0 ? "steer" : "yaw_rate";
  if (!row.passed()) row.cause = Cause::kDelay;
  return std::move(row).with("late", std::abs(row.value));
}

Evidence row_by_signals(const recording::DelayReport& report, bool misled) {
  const bool determined = report.correlation > 0.0 && report.determined();
  const Outcome outcome = determined ? estimation::outcome_of(report.delay_s, report.sigma_s,
                                                              estimation::info_of(Check::kSteeringOrder).tolerance)
                                     : Outcome::kPassed;
  // Signals alone tell a delay to no better than what tyres and a lean make.
  if (outcome != Outcome::kPassed && !misled)
    return with_late(row_of(Check::kSteeringOrder, "", report.delay_s, report.sigma_s));
  Evidence row = row_of(Check::kSteeringOrder, "steer, yaw_rate", Outcome::kNotVerified);
  row.cause = !determined ? Cause::kExcitation : outcome != Outcome::kPassed ? Cause::kMissingTerm : Cause::kNone;
  row.value = determined ? report.delay_s : kNaN;
  row.sigma = report.sigma_s;
  row.limit = estimation::info_of(Check::kSteeringOrder).tolerance.high;
  return row;
}

}  // namespace

std::vector<Evidence> relation_rows(std::span<const DriveRelation> relations, bool gravity_removed, double gravity,
                                    std::optional<double> roll_gradient) {
  const std::vector<DriveCulprit> suspects = culprits(relations);
  std::vector<Evidence> rows;
  for (const DriveRelation& relation : relations)
    rows.push_back(relation_row(relation, suspects, gravity_removed, gravity, roll_gradient));
  return rows;
}

Evidence steering_row(const recording::DelayReport& by_signals, const KnownByModel& known) {
  if (!known.steer_delay || !std::isfinite(known.steer_delay->sigma))
    return row_by_signals(by_signals, known.changed || known.roll_gradient.value_or(0.0) != 0.0);
  return with_late(row_of(Check::kSteeringDelay, "", known.steer_delay->value, known.steer_delay->sigma));
}

bool contradicts_itself(const DriveFindings& findings) {
  return std::ranges::any_of(recording_rows(findings), [](const Evidence& row) {
    return row.outcome == Outcome::kFailed && row.bears_on.contains(Purpose::kParameters);
  });
}

std::vector<Evidence> recording_rows(const DriveFindings& findings, const KnownByModel& known) {
  std::vector<Evidence> rows = findings.rows;
  for (Evidence& row :
       relation_rows(findings.relations, findings.gravity_removed, findings.gravity, known.roll_gradient))
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
                    .relations = drive_relations(mapped, signals, segments.usable, vehicle.wheelbase()),
                    .vehicle = vehicle,
                    .gravity_removed = signals.gravity_removed,
                    .gravity = options.gravity};
  if (auto row = gravity_row(mapped.recording, options.gravity)) out.rows.push_back(std::move(*row));
  if (auto row = frozen_steering(signals, segments.usable)) out.rows.push_back(std::move(*row));
  if (signals[DriveSignal::kSteer].available()) out.steering_delay = steering_delay(signals, segments.usable, progress);
  return out;
}

}  // namespace veridyn::vehicle
