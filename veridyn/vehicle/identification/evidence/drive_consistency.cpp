#include "veridyn/vehicle/identification/evidence/drive_consistency.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "veridyn/core/constants.hpp"
#include "veridyn/recording/signal_gain.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::Check;
using estimation::kBeyondChance;
using estimation::Outcome;
using estimation::Tolerance;
using recording::SignalGain;
using GridSeries = std::vector<double>;

/// Signals are compared below this frequency, where a body follows its wheels [Hz].
constexpr double kBand_Hz = 0.5;
/// Rms of the motion below which a comparison shows noise: r u and u' [m/s^2], r [rad/s], L r/u as an angle [rad].
constexpr double kLeastAcceleration = 0.3, kLeastYawRate = 0.01, kLeastSteer = 0.002;
/// A reading so many times larger moves even where what it is compared with does not.
constexpr double kClearly = 5.0;
/// Lateral acceleration above which tyres bend the relation of steering and turning [m/s^2].
constexpr double kLinearTyres_mps2 = 4.0;
/// Relative variation of the speed from which its powers are different columns.
constexpr double kSpeedsDiffer = 0.05;
/// Understeer gradients that vehicles have [rad/(m/s^2)]: -1.7 to 11 deg/g.
constexpr double kLeastUndersteer = -0.003, kMostUndersteer = 0.02;
/// A scale is verified where its range is no wider than this to either side.
constexpr double kVerified = 0.1;
/// Square of the correlation below which two strong signals are not the same motion: with care, failed.
constexpr double kCommonCare = 0.6, kCommonFailed = 0.25;

using Powers = PerDriveSuspect<int>;
constexpr Powers powers(int steer, int speed, int yaw_rate, int accel_y, int accel_x) {
  return {steer, speed, yaw_rate, accel_y, accel_x};
}

GridSeries product(const GridSeries& a, const GridSeries& b) {
  GridSeries out(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) out[k] = a[k] * b[k];
  return out;
}

/// View of a drive while its relations are formed.
class Relations {
 public:
  Relations(const recording::MappedRecording& mapped, const DriveSignals& signals, std::span<const TimeSpan> spans,
            double wheelbase)
      : mapped_(mapped), s_(signals), spans_(spans), wheelbase_(wheelbase) {
    speed_ = s_[DriveSignal::kSpeed].value;
    yaw_rate_ = s_[DriveSignal::kYawRate].value;
    yaw_acceleration_ = derivative(yaw_rate_);
    double sum = 0.0, squares = 0.0, count = 0.0;
    for (const TimeSpan& span : spans_) {
      const auto [first, last] = s_.indices(span);
      for (std::size_t k = first; k < last; ++k) {
        if (!std::isfinite(speed_[k])) continue;
        sum += speed_[k];
        squares += speed_[k] * speed_[k];
        count += 1.0;
      }
    }
    typical_speed_ = sum / std::max(1.0, count);
    const double variance = squares / std::max(1.0, count) - typical_speed_ * typical_speed_;
    speed_varies_ = std::sqrt(std::max(0.0, variance)) > kSpeedsDiffer * std::abs(typical_speed_);
  }

  std::vector<DriveRelation> run() {
    compare_yaw_rate();
    compare_speed();
    compare_accel_y();
    compare_accel_x();
    compare_steer();
    return std::move(out_);
  }

 private:
  [[nodiscard]] GridSeries derivative(const GridSeries& values) const {
    return recording::low_passed_derivative(values, s_.grid, kBand_Hz);
  }
  [[nodiscard]] std::optional<SignalGain> gain(const recording::ComparedSignals& signals,
                                               std::span<const bool> used = {}) const {
    return recording::signal_gain(signals, s_.grid, spans_, kBand_Hz, used);
  }

  /// A relation of a gain that was found in a motion of at least `least` rms.
  void add(DriveSuspect sensor, Check check, std::string against, const std::optional<SignalGain>& found, double least,
           const Powers& power, std::optional<Tolerance> tolerance = std::nullopt) {
    if (!found) return;
    DriveRelation relation{.sensor = sensor, .check = check, .against = std::move(against), .power = power};
    relation.low = found->low - kBeyondChance * found->low_sigma;
    relation.high = found->high + kBeyondChance * found->high_sigma;
    relation.correlation = found->correlation;
    relation.strong = found->truth_rms > least || found->reading_rms > kClearly * least;
    relation.tolerance = tolerance.value_or(estimation::info_of(check).tolerance);
    relation.verified = relation.strong && relation.low > 1.0 - kVerified && relation.high < 1.0 + kVerified;
    out_.push_back(std::move(relation));
  }

  void compare_yaw_rate();
  void compare_speed();
  void compare_accel_y();
  void compare_accel_x();
  void compare_steer();
  /// Speed and course of the positions; empty where there are none.
  [[nodiscard]] std::pair<GridSeries, GridSeries> by_position() const;

  const recording::MappedRecording& mapped_;
  const DriveSignals& s_;
  std::span<const TimeSpan> spans_;
  double wheelbase_;
  double typical_speed_ = 0.0;
  bool speed_varies_ = false;
  GridSeries speed_, yaw_rate_, yaw_acceleration_;
  std::vector<DriveRelation> out_;
};

std::pair<GridSeries, GridSeries> Relations::by_position() const {
  if (!s_[DriveSignal::kX].available() || !s_[DriveSignal::kY].available()) return {};
  const GridSeries vx = derivative(s_[DriveSignal::kX].value), vy = derivative(s_[DriveSignal::kY].value);
  constexpr double kSlowest_mps = 0.5;
  GridSeries speed(vx.size(), kNaN), course(vx.size(), kNaN);
  double turns = 0.0, last = kNaN;
  for (std::size_t k = 0; k < vx.size(); ++k) {
    speed[k] = std::hypot(vx[k], vy[k]);
    if (!(speed[k] > kSlowest_mps)) continue;
    const double angle = std::atan2(vy[k], vx[k]);
    if (std::isfinite(last)) turns += 2.0 * kPi * std::round((last - turns - angle) / (2.0 * kPi));
    course[k] = last = angle + turns;
    turns = last - angle;
  }
  return {std::move(speed), std::move(course)};
}

void Relations::compare_yaw_rate() {
  GridSeries angle;
  std::string against = "the rate of the heading";
  const bool is_heading = s_[DriveSignal::kYaw].available();
  if (is_heading) {
    angle = s_[DriveSignal::kYaw].value;
  } else if (const Channel* course = mapped_.recording.find("course"); course != nullptr && course->size() > 1) {
    angle = recording::angle_on_grid(*course, s_.grid);
    against = "the rate of the course";
  } else {
    angle = by_position().second;
    against = "the rate of the positions' course";
  }
  if (angle.empty()) return;
  const GridSeries rate = derivative(angle);
  // A delay is in the derivative, and so is sideslip to first order. A course has it to second order too: at the band's
  // edge (2 pi f)^2 I_z/(2 C_r L), 6 % of a road car.
  Tolerance tolerance = estimation::info_of(Check::kYawRateScale).tolerance;
  if (!is_heading) tolerance.low = 0.9, tolerance.high = 1.1;
  add(DriveSuspect::kYawRate, Check::kYawRateScale, std::move(against),
      gain({.reading = yaw_rate_, .truth = rate, .others = {derivative(rate)}}), kLeastYawRate, powers(0, 0, 1, 0, 0),
      tolerance);
}

void Relations::compare_speed() {
  const GridSeries speed = by_position().first;
  if (speed.empty()) return;
  add(DriveSuspect::kSpeed, Check::kSpeedScale, "the speed of the positions",
      gain({.reading = speed_, .truth = speed, .with_bias = false}), 1.0, powers(0, 1, 0, 0, 0));
}

void Relations::compare_accel_y() {
  const recording::GridSignal& accel = s_[DriveSignal::kAccelY];
  if (!accel.available()) return;
  const GridSeries turning = product(yaw_rate_, speed_);
  // v' of the sideslip, which follows the yaw rate: first order in the frequency, then second.
  std::vector<GridSeries> others{yaw_acceleration_, derivative(yaw_acceleration_)};
  if (speed_varies_) others.push_back(product(yaw_acceleration_, product(speed_, speed_)));
  add(DriveSuspect::kAccelY, Check::kLateralAcceleration, "yaw_rate x speed",
      gain({.reading = accel.value, .truth = turning, .others = std::move(others)}), kLeastAcceleration,
      powers(0, -1, -1, 1, 0));
}

void Relations::compare_accel_x() {
  const recording::GridSignal& accel = s_[DriveSignal::kAccelX];
  if (!accel.available()) return;
  // Pitch under braking and grades are in the reading: within a quarter nothing can be said.
  add(DriveSuspect::kAccelX, Check::kLongitudinalAcceleration, "the derivative of speed",
      gain({.reading = accel.value, .truth = derivative(speed_), .others = {product(yaw_rate_, yaw_rate_)}}),
      kLeastAcceleration, powers(0, -1, 0, 0, 1));
}

void Relations::compare_steer() {
  const recording::GridSignal& steer = s_[DriveSignal::kSteer];
  if (!steer.available()) return;
  GridSeries turning = product(yaw_rate_, speed_);
  GridSeries kinematic(turning.size());
  // std::vector<bool> has no data to view.
  const auto used = std::make_unique<bool[]>(turning.size());  // NOLINT(modernize-avoid-c-arrays)
  for (std::size_t k = 0; k < turning.size(); ++k) {
    kinematic[k] = wheelbase_ * yaw_rate_[k] / speed_[k];
    used[k] = std::abs(turning[k]) < kLinearTyres_mps2;
  }
  const std::span<const bool> linear(used.get(), turning.size());
  const Powers power = powers(1, 1, -1, 0, 0);
  const auto whole = gain({.reading = steer.value, .truth = kinematic, .others = {yaw_acceleration_}}, linear);
  if (!whole) return;
  add(DriveSuspect::kSteer, Check::kSteeringScale, "wheelbase x yaw_rate / speed with understeer", whole, kLeastSteer,
      power);
  DriveRelation& relation = out_.back();
  // All understeer that vehicles have; what reads against the turning does so for any of it.
  const double curving = typical_speed_ * typical_speed_ / wheelbase_;
  const double most = 1.0 + kMostUndersteer * curving, least = std::max(0.2, 1.0 + kLeastUndersteer * curving);
  relation.low /= relation.low > 0.0 ? most : least;
  relation.high /= relation.high > 0.0 ? least : most;
  if (speed_varies_) {
    const auto separated = gain({.reading = steer.value,
                                 .truth = kinematic,
                                 .others = {turning, yaw_acceleration_, product(yaw_acceleration_, speed_)}},
                                linear);
    // Where the understeer takes nearly all of the motion, what is left is noise and the model's errors.
    if (separated && separated->truth_rms > kLeastSteer && separated->correlation > 0.0) {
      const double low = separated->low - kBeyondChance * separated->low_sigma;
      const double high = separated->high + kBeyondChance * separated->high_sigma;
      if (low < relation.high && high > relation.low) {
        relation.low = std::max(relation.low, low);
        relation.high = std::min(relation.high, high);
      }
    }
  }
  relation.verified = relation.strong && relation.low > 1.0 - kVerified && relation.high < 1.0 + kVerified;
}

/// Whether a sensor that reads `factor` times the truth would leave nothing off.
bool explains(std::span<const DriveRelation> relations, DriveSuspect sensor, double factor) {
  return std::ranges::all_of(relations, [&](const DriveRelation& relation) {
    const int power = relation.power[sensor];
    if (power == 0) return relation.outcome() == Outcome::kPassed;
    const double by = power > 0 ? 1.0 / factor : factor;
    const double a = relation.low * by, b = relation.high * by;
    return estimation::outcome_between(std::min(a, b), std::max(a, b), relation.tolerance) == Outcome::kPassed;
  });
}

}  // namespace

bool DriveRelation::unrelated() const { return strong && correlation * correlation < kCommonCare; }

Outcome DriveRelation::outcome() const {
  if (!strong) return Outcome::kPassed;
  const Outcome by_range = estimation::outcome_between(low, high, tolerance);
  const double common = correlation * correlation;
  const Outcome by_correlation = common < kCommonFailed ? Outcome::kFailed
                                 : common < kCommonCare ? Outcome::kCare
                                                        : Outcome::kPassed;
  return std::max(by_range, by_correlation);
}

std::vector<DriveRelation> drive_relations(const recording::MappedRecording& mapped, const DriveSignals& signals,
                                           std::span<const TimeSpan> spans, double wheelbase) {
  return Relations(mapped, signals, spans, wheelbase).run();
}

std::vector<DriveCulprit> culprits(std::span<const DriveRelation> relations) {
  std::vector<const DriveRelation*> off;
  for (const DriveRelation& relation : relations)
    if (relation.outcome() != Outcome::kPassed) off.push_back(&relation);
  if (off.empty()) return {};
  const bool unrelated = std::ranges::any_of(off, [](const DriveRelation* r) { return r->unrelated(); });
  const DriveRelation& sharpest = **std::ranges::min_element(
      off, {}, [](const DriveRelation* r) { return (r->high - r->low) / std::abs(r->middle()); });
  std::vector<DriveCulprit> found;
  for (const DriveSuspect sensor : enumerators<DriveSuspect, kDriveSuspects>()) {
    if (!std::ranges::all_of(off, [&](const DriveRelation* r) { return r->power[sensor] != 0; })) continue;
    // A verified relation clears its sensors.
    const bool cleared = std::ranges::any_of(relations, [&](const DriveRelation& r) {
      return r.verified && r.outcome() == Outcome::kPassed && r.power[sensor] != 0;
    });
    if (cleared) continue;
    const double doubt = 0.5 * (sharpest.high - sharpest.low) / std::abs(sharpest.middle());
    const double factor = sharpest.power[sensor] > 0 ? sharpest.middle() : 1.0 / sharpest.middle();
    if (unrelated)
      found.push_back({sensor, kNaN});
    else if (explains(relations, sensor, factor))
      found.push_back({sensor, factor, doubt});
  }
  return found;
}

}  // namespace veridyn::vehicle
