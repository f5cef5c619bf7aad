#include "veridyn/recording/drive_relations.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/recording/grid_signals.hpp"
#include "veridyn/recording/signal_gain.hpp"

namespace veridyn::recording {
namespace {

using estimation::Check;
using estimation::kBeyondChance;
using estimation::Tolerance;
using enum InertialChannel;
using GridSeries = std::vector<double>;

/// Rms of the motion below which a comparison shows noise: r u and u' [m/s^2], r [rad/s], rates of roll and pitch
/// [rad/s], speed [m/s], L r/u as an angle [rad].
constexpr double kLeastAcceleration = 0.2, kLeastYawRate = 0.01, kLeastTilting = 0.005, kLeastSpeed = 0.5,
                 kLeastSteer = 0.002;
/// Lateral acceleration up to which the forces of tyres grow with their slip [m/s^2].
constexpr double kLinearTyres_mps2 = 4.0;
/// Relative variation of the speed from which its powers are different columns.
constexpr double kSpeedsDiffer = 0.05;
/// Understeer gradients that vehicles have [rad/(m/s^2)]: -1.7 to 11 deg/g.
constexpr double kLeastUndersteer = -0.003, kMostUndersteer = 0.02;
/// And most of them, 4.5 deg/g: where the wheelbase is not known either.
constexpr double kUsualUndersteer = 0.008;
/// Share of the mean speed below which a vehicle stands or starts.
constexpr double kSlowShare = 0.3;
/// Wheelbases from a 1:10 model to a truck, and of what drives fast [m].
constexpr double kShortestWheelbase = 0.15, kShortestOfFast = 1.5, kLongestWheelbase = 8.0, kFast_mps = 10.0;
/// A scale is verified where its range is no wider than this to either side.
constexpr double kVerified = 0.1;
/// Between two sensors [s].
constexpr double kLongestLag_s = 1.0, kLagStep_s = 0.1;

GridSeries product(const GridSeries& a, const GridSeries& b) {
  GridSeries out(std::min(a.size(), b.size()));
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = a[k] * b[k];
  return out;
}

/// Two signals that are compared, and how.
struct Compared {
  InertialChannel channel;
  GridSeries truth;
  std::vector<GridSeries> others = {};
  double least = 0.0;  ///< rms of the truth from which it moves
  bool with_bias = true;
  std::span<const bool> used = {};
};

class Relations {
 public:
  Relations(const DriveMotion& motion, const ConsistencyOptions& options)
      : m_(motion), o_(options), spans_(options.spans) {
    if (spans_.empty()) spans_.push_back({m_.grid.begin, m_.grid.at(std::max<std::size_t>(1, m_.grid.count) - 1)});
    if (!m_.has(kSpeed)) return;
    double sum = 0.0, squares = 0.0, count = 0.0;
    for_each_sample([&](std::size_t k) {
      const double u = m_.signals[kSpeed][k];
      if (!std::isfinite(u)) return;
      sum += u;
      squares += u * u;
      count += 1.0;
    });
    typical_speed_ = sum / std::max(1.0, count);
    const double variance = squares / std::max(1.0, count) - typical_speed_ * typical_speed_;
    speed_varies_ = std::sqrt(std::max(0.0, variance)) > kSpeedsDiffer * std::abs(typical_speed_);
  }

  std::vector<ChannelRelation> run() {
    if (m_.grid.count < 2) return {};
    compare_yaw_rate();
    compare_tilting(kGyroX, kRoll, Check::kRollRateScale, "the rate of roll");
    compare_tilting(kGyroY, kPitch, Check::kPitchRateScale, "the rate of pitch");
    compare_speed();
    compare_accel_y();
    compare_accel_x();
    compare_steer();
    compare_gravity();
    return std::move(out_);
  }

 private:
  template <typename Do>
  void for_each_sample(Do&& act) const {
    for (const TimeSpan& span : spans_) {
      const auto [first, last] = grid_indices(m_.grid, span);
      for (std::size_t k = first; k < last; ++k) act(k);
    }
  }
  [[nodiscard]] GridSeries derivative(const GridSeries& values) const {
    return low_passed_derivative(values, m_.grid, o_.band_Hz);
  }
  [[nodiscard]] double lag_of(const GridSeries& reading, const GridSeries& truth) const;
  [[nodiscard]] std::optional<SignalGain> gain(const Compared& c, double lag_s) const;
  /// Nothing where the two cannot be compared.
  ChannelRelation* add(Check check, std::string against, const Compared& compared,
                       std::initializer_list<std::pair<InertialChannel, int>> power);

  void compare_yaw_rate();
  void compare_tilting(InertialChannel rate, InertialChannel angle, Check check, const char* against);
  void compare_speed();
  void compare_accel_y();
  void compare_accel_x();
  void compare_steer();
  void compare_gravity();
  /// Speed and course of the positions; empty where there are none.
  [[nodiscard]] std::pair<GridSeries, GridSeries> by_position() const;
  /// A wheelbase that is not known makes the ratio the wheelbase that the steering would need.
  [[nodiscard]] double wheelbase() const { return o_.wheelbase > 0.0 ? o_.wheelbase : 1.0; }

  const DriveMotion& m_;
  const ConsistencyOptions& o_;
  std::vector<TimeSpan> spans_;
  double typical_speed_ = 0.0;
  bool speed_varies_ = false;
  std::vector<ChannelRelation> out_;
};

/// At which the two correlate best; none where another one is hardly better.
double Relations::lag_of(const GridSeries& reading, const GridSeries& truth) const {
  const GridSeries y = low_passed(reading, m_.grid, o_.band_Hz), x = low_passed(truth, m_.grid, o_.band_Hz);
  const auto correlation = [&](std::ptrdiff_t lag) {
    double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, syy = 0.0, sxy = 0.0;
    // Of low-passed signals some samples a period are all that there is.
    constexpr std::size_t kStride = 10;
    std::size_t count = 0;
    for_each_sample([&](std::size_t k) {
      const std::ptrdiff_t i = signed_index(k) - lag;
      if (++count % kStride != 0 || i < 0 || i >= signed_index(x.size())) return;
      const double a = x[at(i)], b = y[k];
      if (!std::isfinite(a) || !std::isfinite(b)) return;
      n += 1.0, sx += a, sy += b, sxx += a * a, syy += b * b, sxy += a * b;
    });
    const double vx = sxx - sx * sx / std::max(1.0, n), vy = syy - sy * sy / std::max(1.0, n);
    return vx > 0.0 && vy > 0.0 ? std::abs(sxy - sx * sy / n) / std::sqrt(vx * vy) : 0.0;
  };
  constexpr double kBetter = 0.02;
  double best = correlation(0) + kBetter, found = 0.0;
  for (double lag_s = -kLongestLag_s; lag_s < kLongestLag_s + 1e-9; lag_s += kLagStep_s) {
    const double c = correlation(static_cast<std::ptrdiff_t>(std::lround(lag_s / m_.grid.step)));
    if (!(c > best)) continue;
    best = c;
    found = lag_s;
  }
  return found;
}

std::optional<SignalGain> Relations::gain(const Compared& c, double lag_s) const {
  GridSeries reading = m_.signals[c.channel];
  const auto shift = static_cast<std::ptrdiff_t>(std::lround(lag_s / m_.grid.step));
  if (shift != 0) {
    for (std::size_t k = 0; k < reading.size(); ++k) {
      const std::ptrdiff_t i = signed_index(k) + shift;
      reading[k] = i >= 0 && i < signed_index(reading.size()) ? m_.signals[c.channel][at(i)] : kNaN;
    }
  }
  return signal_gain({.reading = reading, .truth = c.truth, .others = c.others, .with_bias = c.with_bias}, m_.grid,
                     spans_, o_.band_Hz, c.used);
}

ChannelRelation* Relations::add(Check check, std::string against, const Compared& c,
                                std::initializer_list<std::pair<InertialChannel, int>> power) {
  const double lag_s = lag_of(m_.signals[c.channel], c.truth);
  const std::optional<SignalGain> found = gain(c, lag_s);
  if (!found) return nullptr;
  ChannelRelation relation{.check = check, .channel = c.channel, .against = std::move(against)};
  relation.low = found->low - kBeyondChance * found->low_sigma;
  relation.high = found->high + kBeyondChance * found->high_sigma;
  relation.correlation = found->correlation;
  relation.lag_s = lag_s;
  relation.seconds = static_cast<double>(found->rows) / (4.0 * o_.band_Hz);
  relation.truth_rms = found->truth_rms;
  relation.reading_rms = found->reading_rms;
  relation.least = c.least;
  relation.tolerance = estimation::info_of(check).tolerance;
  for (const auto& [channel, exponent] : power) relation.power[channel] = exponent;
  relation.verified = relation.moved() && relation.low > 1.0 - kVerified && relation.high < 1.0 + kVerified;
  out_.push_back(std::move(relation));
  return &out_.back();
}

std::pair<GridSeries, GridSeries> Relations::by_position() const {
  if (!m_.has(kPosX) || !m_.has(kPosY)) return {};
  const GridSeries vx = derivative(m_.signals[kPosX]), vy = derivative(m_.signals[kPosY]);
  constexpr double kSlowest_mps = 0.5;
  GridSeries speed(vx.size(), kNaN), course(vx.size(), kNaN);
  for (std::size_t k = 0; k < vx.size(); ++k) speed[k] = std::hypot(vx[k], vy[k]);
  // Where one run ends and another one begins the place jumps.
  GridSeries finite = speed;
  std::erase_if(finite, [](double v) { return !std::isfinite(v); });
  const double most = finite.empty() ? kNaN : 5.0 * numerics::median(finite);
  double turns = 0.0, last = kNaN;
  for (std::size_t k = 0; k < vx.size(); ++k) {
    if (!(speed[k] < most)) speed[k] = kNaN;
    if (!(speed[k] > kSlowest_mps)) continue;
    const double angle = std::atan2(vy[k], vx[k]);
    if (std::isfinite(last)) turns += 2.0 * kPi * std::round((last - turns - angle) / (2.0 * kPi));
    course[k] = last = angle + turns;
    turns = last - angle;
  }
  return {std::move(speed), std::move(course)};
}

void Relations::compare_yaw_rate() {
  if (!m_.has(kGyroZ)) return;
  GridSeries angle = m_.signals[kYaw];
  const bool is_heading = m_.has(kYaw) && !m_.course_for_yaw;
  const char* against = is_heading ? "the rate of the heading" : "the rate of the course";
  const bool by_place = angle.empty();
  if (by_place) {
    angle = by_position().second;
    against = "the rate of the positions' course";
  }
  if (angle.empty()) return;
  const GridSeries rate = derivative(angle);
  // A delay is in the derivative, and so is sideslip to first order. A course has it to second order too: at the band's
  // edge (2 pi f)^2 I_z/(2 C_r L), 6 % of a road car.
  ChannelRelation* relation =
      add(Check::kYawRateScale, against,
          {.channel = kGyroZ, .truth = rate, .others = {derivative(rate)}, .least = kLeastYawRate}, {{kGyroZ, 1}});
  if (relation == nullptr) return;
  constexpr double kSideslip = 0.1;
  if (!is_heading) relation->tolerance.low = 1.0 - kSideslip, relation->tolerance.high = 1.0 + kSideslip;
  if (!by_place) relation->power[kYaw] = -1;
}

void Relations::compare_tilting(InertialChannel rate, InertialChannel angle, Check check, const char* against) {
  if (!m_.has(rate) || !m_.has(angle)) return;
  const GridSeries change = derivative(m_.signals[angle]);
  add(check, against, {.channel = rate, .truth = change, .others = {derivative(change)}, .least = kLeastTilting},
      {{rate, 1}, {angle, -1}});
}

void Relations::compare_speed() {
  if (!m_.has(kSpeed)) return;
  const GridSeries speed = by_position().first;
  if (speed.empty()) return;
  add(Check::kSpeedScale, "the speed of the positions",
      {.channel = kSpeed, .truth = speed, .least = kLeastSpeed, .with_bias = false}, {{kSpeed, 1}});
}

void Relations::compare_accel_y() {
  if (!m_.has(kAccelY) || !m_.has(kGyroZ) || !m_.has(kSpeed)) return;
  const GridSeries& speed = m_.signals[kSpeed];
  const GridSeries yaw_acceleration = derivative(m_.signals[kGyroZ]);
  // v' of the sideslip, which follows the yaw rate: first order in the frequency, then second.
  std::vector<GridSeries> others{yaw_acceleration, derivative(yaw_acceleration)};
  if (speed_varies_) others.push_back(product(yaw_acceleration, product(speed, speed)));
  add(Check::kLateralAcceleration, "yaw rate times speed",
      {.channel = kAccelY,
       .truth = product(m_.signals[kGyroZ], speed),
       .others = std::move(others),
       .least = kLeastAcceleration},
      {{kAccelY, 1}, {kGyroZ, -1}, {kSpeed, -1}});
}

void Relations::compare_accel_x() {
  if (!m_.has(kAccelX) || !m_.has(kSpeed)) return;
  std::vector<GridSeries> others;
  if (m_.has(kGyroZ)) others.push_back(product(m_.signals[kGyroZ], m_.signals[kGyroZ]));
  add(Check::kLongitudinalAcceleration, "the change of speed",
      {.channel = kAccelX,
       .truth = derivative(m_.signals[kSpeed]),
       .others = std::move(others),
       .least = kLeastAcceleration},
      {{kAccelX, 1}, {kSpeed, -1}});
}

void Relations::compare_steer() {
  if (!m_.has(kSteer) || !m_.has(kGyroZ) || !m_.has(kSpeed)) return;
  const GridSeries &speed = m_.signals[kSpeed], &yaw_rate = m_.signals[kGyroZ];
  const GridSeries turning = product(yaw_rate, speed), yaw_acceleration = derivative(yaw_rate);
  GridSeries kinematic(turning.size());
  // std::vector<bool> has no data to view.
  const auto used = std::make_unique<bool[]>(turning.size());  // NOLINT(modernize-avoid-c-arrays)
  for (std::size_t k = 0; k < turning.size(); ++k) {
    // Near a standstill it is noise over nothing.
    const bool drives = std::abs(speed[k]) > kSlowShare * std::abs(typical_speed_);
    kinematic[k] = drives ? wheelbase() * yaw_rate[k] / speed[k] : kNaN;
    used[k] = std::abs(turning[k]) < kLinearTyres_mps2;
  }
  // Where hardly anything is left, yaw rate or speed is in another unit.
  constexpr double kFewest = 0.1;
  const bool few = static_cast<double>(std::count(used.get(), used.get() + turning.size(), true)) <
                   kFewest * static_cast<double>(turning.size());
  const std::span<const bool> linear =
      few ? std::span<const bool>() : std::span<const bool>(used.get(), turning.size());
  Compared compared{.channel = kSteer,
                    .truth = kinematic,
                    .others = {yaw_acceleration},
                    .least = kLeastSteer * wheelbase() / std::max(1.0, wheelbase()),
                    .used = linear};
  ChannelRelation* relation =
      add(Check::kSteeringScale, "turning with any understeer", compared, {{kSteer, 1}, {kSpeed, 1}, {kGyroZ, -1}});
  if (relation == nullptr) return;
  if (o_.wheelbase <= 0.0) {
    const double u2 = typical_speed_ * typical_speed_;
    const double shortest = typical_speed_ > kFast_mps ? kShortestOfFast : kShortestWheelbase;
    const double longest = kLongestWheelbase + kUsualUndersteer * u2;
    const double low = shortest * (m_.hand_wheel ? kLeastSteeringRatio : 1.0);
    const double high = longest * (m_.hand_wheel ? kMostSteeringRatio : 1.0);
    relation->tolerance = {.low = low, .high = high, .lowest = low, .highest = high};
    relation->verified = false;
    return;
  }
  // All understeer that vehicles have; what reads against the turning does so for any of it.
  const double curving = typical_speed_ * typical_speed_ / o_.wheelbase;
  const double most = 1.0 + kMostUndersteer * curving, least = std::max(0.2, 1.0 + kLeastUndersteer * curving);
  relation->low /= relation->low > 0.0 ? most : least;
  relation->high /= relation->high > 0.0 ? least : most;
  if (speed_varies_) {
    compared.others = {turning, yaw_acceleration, product(yaw_acceleration, speed)};
    const auto separated = gain(compared, relation->lag_s);
    // Where the understeer takes nearly all of the motion, what is left is noise and the model's errors.
    if (separated && separated->truth_rms > kLeastSteer && separated->correlation > 0.0) {
      const double low = separated->low - kBeyondChance * separated->low_sigma;
      const double high = separated->high + kBeyondChance * separated->high_sigma;
      if (low < relation->high && high > relation->low) {
        relation->low = std::max(relation->low, low);
        relation->high = std::min(relation->high, high);
      }
    }
  }
  relation->verified = relation->moved() && relation->low > 1.0 - kVerified && relation->high < 1.0 + kVerified;
}

void Relations::compare_gravity() {
  if (!m_.has(kAccelZ)) return;
  GridSeries values;
  for_each_sample([&](std::size_t k) {
    if (std::isfinite(m_.signals[kAccelZ][k])) values.push_back(m_.signals[kAccelZ][k]);
  });
  if (values.empty()) return;
  const double ratio = numerics::median(values) / kGravity;
  ChannelRelation relation{.check = Check::kGravity,
                           .channel = kAccelZ,
                           .against = "gravity",
                           .low = ratio,
                           .high = ratio,
                           .seconds = static_cast<double>(values.size()) * m_.grid.step,
                           .truth_rms = 1.0,
                           .tolerance = estimation::info_of(Check::kGravity).tolerance,
                           .may_be_none = true};
  relation.power[kAccelZ] = 1;
  relation.verified = relation.outcome() == estimation::Outcome::kPassed;
  out_.push_back(std::move(relation));
}

}  // namespace

std::vector<ChannelRelation> drive_relations(const DriveMotion& motion, const ConsistencyOptions& options) {
  return Relations(motion, options).run();
}

}  // namespace veridyn::recording
