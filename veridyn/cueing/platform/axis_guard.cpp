#include "veridyn/cueing/platform/axis_guard.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace veridyn::cueing {
namespace {

/// How fast a deviation from the command dies away: twice this rate, critically damped [1/s].
constexpr double kBandwidth = 40.0;
/// Pieces are no longer, so that the deviation is led back in several of them [s].
constexpr double kLongestPiece = 0.005;
/// Of the acceleration, what is spent on the way to a far position: the rest is for the jerk's way there and back.
constexpr double kOfAcceleration = 0.7;
/// Of the range, what is kept free at its ends for rounding.
constexpr double kOfRange = 1e-9;

double within(double value, double most) { return std::clamp(value, -most, most); }

/// After a piece of constant jerk.
AxisState after(const AxisState& s, double jerk, double t) {
  return {s.position + t * (s.rate + t * (s.acceleration / 2.0 + t * jerk / 6.0)),
          s.rate + t * (s.acceleration + t * jerk / 2.0), s.acceleration + t * jerk};
}

/// The fastest way to rest.
struct Stop {
  struct Piece {
    double jerk = 0.0, time = 0.0;
  };
  std::array<Piece, 3> pieces = {};
  double position = 0.0;  ///< of rest
};

Stop fastest_stop(const AxisState& s, const AxisLimits& limits) {
  const double J = limits.jerk;
  // The rate that stays if the acceleration ends as fast as it can.
  const double left = s.rate + s.acceleration * std::abs(s.acceleration) / (2.0 * J);
  const double sign = left < 0.0 ? -1.0 : 1.0;
  const double v = sign * s.rate, a = sign * s.acceleration;
  const double peak = std::min(std::sqrt(std::max(J * v + a * a / 2.0, 0.0)), limits.acceleration);
  const double hold = peak > 0.0 ? (v + a * a / (2.0 * J) - peak * peak / J) / peak : 0.0;
  Stop stop;
  stop.pieces = {{{-sign * J, std::max((a + peak) / J, 0.0)}, {0.0, std::max(hold, 0.0)}, {sign * J, peak / J}}};
  AxisState at = s;
  for (const Stop::Piece& p : stop.pieces) at = after(at, p.jerk, p.time);
  stop.position = at.position;
  return stop;
}

/// Times in (0, end) at which the rate of a piece of constant jerk is zero.
std::array<double, 2> turning_points(const AxisState& s, double jerk, double end) {
  std::array<double, 2> times = {0.0, 0.0};
  const auto keep = [&](double t, std::size_t i) { times[i] = t > 0.0 && t < end ? t : 0.0; };
  const double root = s.acceleration * s.acceleration - 2.0 * jerk * s.rate;
  if (!(root >= 0.0)) return times;
  const double q = -(s.acceleration + std::copysign(std::sqrt(root), s.acceleration));
  if (jerk != 0.0) keep(q / jerk, 0);
  if (q != 0.0) keep(2.0 * s.rate / q, 1);
  return times;
}

bool inside(double position, const AxisLimits& limits) {
  const double free = kOfRange * (limits.highest - limits.lowest);
  return position >= limits.lowest + free && position <= limits.highest - free;
}

bool slow_enough(double rate, const AxisLimits& limits) { return std::abs(rate) <= limits.rate * (1.0 - kOfRange); }

/// Whether a piece of constant jerk stays within position and rate.
bool stays_inside(const AxisState& s, double jerk, double time, const AxisLimits& limits) {
  const AxisState end = after(s, jerk, time);
  if (!inside(end.position, limits) || !slow_enough(end.rate, limits)) return false;
  for (const double t : turning_points(s, jerk, time)) {
    if (t > 0.0 && !inside(after(s, jerk, t).position, limits)) return false;
  }
  const double fastest = jerk != 0.0 ? -s.acceleration / jerk : -1.0;
  return !(fastest > 0.0 && fastest < time) || slow_enough(after(s, jerk, fastest).rate, limits);
}

/// Whether the axis can stop from here within its limits.
bool safe(const AxisState& s, const AxisLimits& limits) {
  if (!inside(s.position, limits) || !slow_enough(s.rate, limits) || std::abs(s.acceleration) > limits.acceleration)
    return false;
  AxisState at = s;
  for (const Stop::Piece& p : fastest_stop(s, limits).pieces) {
    if (!stays_inside(at, p.jerk, p.time, limits)) return false;
    at = after(at, p.jerk, p.time);
  }
  return true;
}

double nearest_inside(double position, const AxisLimits& limits) {
  const double free = 2.0 * kOfRange * (limits.highest - limits.lowest);
  return std::clamp(position, limits.lowest + free, limits.highest - free);
}

void check(const AxisLimits& limits) {
  PlatformLimits all;
  all[PlatformAxis::kHeave] = limits;
  all.validate();
}

}  // namespace

AxisGuard::AxisGuard(const AxisLimits& limits) : limits_((check(limits), limits)) { reset(0.0); }

AxisState AxisGuard::reset(double position) {
  take_new_limits();
  state_ = {nearest_inside(std::isfinite(position) ? position : 0.0, limits_), 0.0, 0.0};
  asked_ = desired_ = state_.position;
  wanted_rate_ = wanted_acceleration_ = last_step_ = 0.0;
  limited_ = false;
  return state_;
}

void AxisGuard::change_limits(const AxisLimits& limits) {
  check(limits);
  new_limits_ = limits;
}

bool AxisGuard::limited() const {
  constexpr double kNoticed = 1e-3;
  return limited_ && std::abs(state_.position - asked_) > kNoticed * (limits_.highest - limits_.lowest);
}

void AxisGuard::take_new_limits() {
  if (new_limits_) limits_ = *std::exchange(new_limits_, std::nullopt);
}

AxisState AxisGuard::step(double desired, double step) {
  if (new_limits_ && safe(state_, *new_limits_)) take_new_limits();
  const double asked = std::isfinite(desired) ? desired : asked_;
  desired = nearest_inside(std::isfinite(desired) ? desired : desired_, limits_);
  if (!(step > 0.0) || !std::isfinite(step)) step = 0.0;
  if (step == 0.0) return state_;
  asked_ = asked;
  if (step > kLongestStep || new_limits_) {
    if (step > kLongestStep) stop(step);
    desired_ = nearest_inside(fastest_stop(state_, limits_).position, new_limits_.value_or(limits_));
    wanted_rate_ = wanted_acceleration_ = 0.0;
    // In a gap nobody knows what was asked for.
    if (step > kLongestStep) asked_ = desired_;
    limited_ = true;
    if (step <= kLongestStep) follow(desired_, step, 0.0, 0.0);
    last_step_ = step;
    return state_;
  }
  const double before = desired_, mean_rate = (desired - before) / step;
  const double between = 0.5 * (step + last_step_);
  const double mean_acceleration = (mean_rate - wanted_rate_) / between;
  const double acceleration = within(mean_acceleration, limits_.acceleration);
  wanted_rate_ = mean_rate;
  wanted_acceleration_ = acceleration;
  last_step_ = step;
  const double pieces = std::ceil(step / kLongestPiece * (1.0 - 1e-9));
  const double final_rate = mean_rate + 0.5 * acceleration * step;
  limited_ = desired != asked || acceleration != mean_acceleration;
  for (double k = 1.0; k <= pieces; ++k) {
    const double left = step * (1.0 - k / pieces);
    follow(desired - left * (final_rate - 0.5 * acceleration * left), step / pieces, final_rate - acceleration * left,
           acceleration);
  }
  desired_ = desired;
  return state_;
}

AxisState AxisGuard::brake(double step) {
  if (!(step > 0.0) || !std::isfinite(step)) return state_;
  stop(step);
  asked_ = desired_ = nearest_inside(fastest_stop(state_, limits_).position, limits_);
  wanted_rate_ = wanted_acceleration_ = 0.0;
  last_step_ = step;
  limited_ = false;
  return state_;
}

AxisGuard::Following AxisGuard::desired_acceleration(double desired, double rate, double acceleration,
                                                     double step) const {
  const AxisLimits& most = new_limits_ ? *new_limits_ : limits_;
  const AxisState then = after(state_, 0.0, step);
  const double off = desired - then.position, distance = std::abs(off);
  // Near: a rate in proportion to the distance. Far: one from which the axis can brake on the way.
  constexpr double kNear = kBandwidth / 2.0;
  const double braking = kOfAcceleration * std::min(limits_.acceleration, most.acceleration);
  const double far_from = braking / (kNear * kNear);
  Following following;
  const auto limited = [&](double value, double limit) {
    following.limited = following.limited || std::abs(value) > limit;
    return within(value, limit);
  };
  const bool far = distance >= far_from;
  following.limited = far;
  const double towards = far ? std::copysign(std::sqrt(2.0 * braking * (distance - far_from / 2.0)), off) : kNear * off;
  const double fastest = 0.999 * std::min(limits_.rate, most.rate);
  const double missing = limited(rate + towards, fastest) - then.rate;
  // No more than the jerk takes back in time (half of a^2 / 2 J = missing), or the axis would swing for ever.
  const double taken_back = std::sqrt(std::abs(missing) * std::min(limits_.jerk, most.jerk));
  following.acceleration = limited(acceleration + limited(2.0 * kBandwidth * missing, taken_back),
                                   std::min(limits_.acceleration, most.acceleration));
  return following;
}

void AxisGuard::follow(double desired, double step, double rate, double acceleration) {
  const double most = new_limits_ ? std::min(limits_.jerk, new_limits_->jerk) : limits_.jerk;
  const Following following = desired_acceleration(desired, rate, acceleration, step);
  const double needed = (following.acceleration - state_.acceleration) / step;
  const double jerk = within(needed, most);
  limited_ = limited_ || following.limited || std::abs(needed) > most;
  if (const auto next = piece(jerk, step)) {
    state_ = *next;
    return;
  }
  limited_ = true;
  // As much of it as leaves a way to stop.
  const double braking = fastest_stop(state_, limits_).pieces[0].jerk;
  double allowed = 0.0, refused = 1.0;
  std::optional<AxisState> best = piece(braking, step);
  for (int k = 0; best && k < 20; ++k) {
    const double middle = 0.5 * (allowed + refused);
    if (const auto next = piece(braking + middle * (jerk - braking), step)) {
      best = next;
      allowed = middle;
    } else {
      refused = middle;
    }
  }
  if (best) {
    state_ = *best;
  } else {
    stop(step);
  }
}

std::optional<AxisState> AxisGuard::piece(double jerk, double step) const {
  AxisState next = after(state_, jerk, step);
  if (std::abs(next.acceleration) > limits_.acceleration || !stays_inside(state_, jerk, step, limits_) ||
      !safe(next, limits_))
    return std::nullopt;
  return next;
}

void AxisGuard::stop(double step) {
  const Stop way = fastest_stop(state_, limits_);
  for (const Stop::Piece& p : way.pieces) {
    const double time = std::min(step, p.time);
    state_ = after(state_, p.jerk, time);
    step -= time;
  }
  if (step > 0.0) state_ = {way.position, 0.0, 0.0};
}

}  // namespace veridyn::cueing
