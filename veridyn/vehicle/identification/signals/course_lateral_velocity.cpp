#include "veridyn/vehicle/identification/signals/course_lateral_velocity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::vehicle {
namespace {

/// A car that goes straight accelerates less sideways [m/s^2].
constexpr double kStraight_mps2 = 0.3;
/// Stretches into which straight driving is cut to see the offset wander, and how many samples each needs.
constexpr std::size_t kStretches = 10, kLeastSamples = 20;
/// Where course and heading differ by less than this in turns, one is made of the other [rad].
constexpr double kSame = 1e-3;
/// How late a course may be, and what of it sideslip cannot be [s]; at these speeds [m/s].
constexpr double kLatest_s = 0.6, kLate_s = 0.1;
constexpr double kFast_mps = 8.0;
constexpr double kReversing = 30.0 * kDegree;
/// How well the place of an antenna is known [m].
constexpr double kPlaceSigma_m = 0.05;

/// Over how many stamps a receiver holds a value: the median of the runs of equal ones.
std::size_t held_for(const std::vector<double>& values) {
  std::vector<double> lengths;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (k > 0 && values[k] == values[k - 1])
      lengths.back() += 1.0;
    else
      lengths.push_back(1.0);
  }
  return lengths.empty() ? 1 : static_cast<std::size_t>(numerics::median(lengths));
}

/// A channel of angles whose held values count once, unwrapped.
Channel unwrapped(const Channel& from) {
  Channel out = from;
  std::vector<double> stamps;
  out.value.clear();
  const std::size_t held = held_for(from.value);
  std::size_t run = 0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    run = k > 0 && from.value[k] == from.value[k - 1] ? run + 1 : 0;
    if (run % held != 0) continue;
    out.value.push_back(from.value[k]);
    stamps.push_back(from.times()[k]);
  }
  out.time = make_time_base(std::move(stamps));
  numerics::unwrap_angles(out.value);
  return out;
}

double wrapped(double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); }

/// The offset between course and heading, and the standard deviation by which it wanders.
struct Offset {
  double value = 0.0;
  double range = 0.0;
  double wander = 0.0;
};

/// Median of differences about the first, which may go round.
double median_angle(std::vector<double> angles) {
  const double about = angles.front();
  for (double& a : angles) a = wrapped(a - about);
  return about + numerics::median(angles);
}

std::optional<Offset> offset_of(const std::vector<double>& difference, const CourseProblem& p) {
  std::vector<double> straight;
  for (std::size_t k = 0; k < difference.size(); ++k)
    if (std::isfinite(difference[k]) && std::abs(p.speed[k] * p.yaw_rate[k]) < kStraight_mps2)
      straight.push_back(difference[k]);
  if (straight.size() < kLeastSamples) return std::nullopt;
  Offset out{.value = median_angle(straight)};
  const std::size_t stretches = std::min(kStretches, straight.size() / kLeastSamples);
  std::vector<double> medians;
  for (std::size_t i = 0; i < stretches; ++i) {
    const auto begin = straight.begin() + static_cast<std::ptrdiff_t>(i * straight.size() / stretches);
    const auto end = straight.begin() + static_cast<std::ptrdiff_t>((i + 1) * straight.size() / stretches);
    medians.push_back(wrapped(median_angle({begin, end}) - out.value));
  }
  const auto [low, high] = std::ranges::minmax(medians);
  out.range = high - low;
  out.wander = numerics::rms(medians);
  return out;
}

/// The shift of the course [samples] at which it follows the heading best.
std::size_t samples_late(const std::vector<double>& chi, const std::vector<double>& psi, const CourseProblem& p) {
  const auto latest = static_cast<std::size_t>(kLatest_s / p.grid.step);
  std::size_t best = 0;
  double least = kInfinity;
  for (std::size_t late = 0; late <= latest; ++late) {
    double sum = 0.0, squares = 0.0, count = 0.0, first = kNaN;
    for (std::size_t k = 0; k + latest < chi.size(); ++k) {
      const double d = chi[k + late] - psi[k];
      if (!(p.speed[k] >= kFast_mps) || !std::isfinite(d)) continue;
      if (std::isnan(first)) first = d;
      const double about = wrapped(d - first);
      sum += about;
      squares += about * about;
      count += 1.0;
    }
    const double variance = (squares - sum * sum / count) / count;
    if (count > 0.0 && variance < least) {
      least = variance;
      best = late;
    }
  }
  return static_cast<double>(best) * p.grid.step >= kLate_s ? best : 0;
}

/// Course less heading, NaN where the vehicle is too slow.
std::vector<double> difference_of(const std::vector<double>& chi, const std::vector<double>& psi, std::size_t late,
                                  const CourseProblem& p) {
  std::vector<double> out(p.grid.count, kNaN);
  for (std::size_t k = 0; k + late < out.size(); ++k)
    if (p.speed[k] >= kSlowestCourse_mps && std::isfinite(p.yaw_rate[k])) out[k] = chi[k + late] - psi[k];
  return out;
}

/// Root mean square of what course and heading differ by where the vehicle turns.
double in_turns(const std::vector<double>& difference, double offset, const CourseProblem& p) {
  double sum = 0.0, count = 0.0;
  for (std::size_t k = 0; k < difference.size(); ++k) {
    if (!std::isfinite(difference[k]) || std::abs(p.speed[k] * p.yaw_rate[k]) < kStraight_mps2) continue;
    const double d = wrapped(difference[k] - offset);
    sum += d * d;
    count += 1.0;
  }
  return std::sqrt(sum / std::max(1.0, count));
}

}  // namespace

CourseLateralVelocity course_lateral_velocity(const CourseProblem& p) {
  const auto unused = [](const std::string& why) {
    return CourseLateralVelocity{{}, 0.0, "course and heading are not used for the lateral velocity: " + why};
  };
  const Channel course = unwrapped(p.course), yaw = unwrapped(p.yaw);
  if (course.size() < 2 || yaw.size() < 2) return unused("one of them never changes");
  const std::vector<double> chi = recording::on_grid(course, p.grid), psi = recording::on_grid(yaw, p.grid);
  const std::size_t late = samples_late(chi, psi, p);
  const std::vector<double> difference = difference_of(chi, psi, late, p);
  const std::optional<Offset> offset = offset_of(difference, p);
  if (!offset)
    return unused(
        fmt::format("the vehicle hardly goes straight faster than {:g} m/s, which shows the offset between "
                    "both",
                    kSlowestCourse_mps));
  if (offset->range > kWanderingHeading)
    return unused(
        fmt::format("going straight their difference wanders by {:.1f} deg: the heading "
                    "is a compass's or drifts",
                    offset->range / kDegree));
  if (in_turns(difference, offset->value, p) < kSame) return unused("one of them is made of the other");
  CourseLateralVelocity out{.signal = {}, .shift_s = static_cast<double>(late) * p.grid.step};
  out.signal.value.assign(difference.size(), kNaN);
  const double angle_variance = std::pow(recording::noise_floor(course), 2.0) +
                                std::pow(recording::noise_floor(yaw), 2.0) + std::pow(offset->wander, 2.0);
  double variance = 0.0, count = 0.0;
  for (std::size_t k = 0; k < difference.size(); ++k) {
    const double beta = wrapped(difference[k] - offset->value);
    if (!(std::abs(beta) < kReversing)) continue;
    const double u = p.speed[k], r = p.yaw_rate[k], t = std::tan(beta);
    out.signal.value[k] = u * t - p.position * r;
    variance += std::pow(u * (1.0 + t * t), 2.0) * angle_variance + std::pow(t * p.speed_sigma, 2.0) +
                std::pow(p.position * p.yaw_rate_sigma, 2.0) + std::pow(kPlaceSigma_m * r, 2.0);
    count += 1.0;
  }
  if (count == 0.0) return unused("they differ by more than 30 deg throughout");
  out.signal.sigma = std::sqrt(variance / count);
  out.signal.rate_Hz = std::min(course.rate_Hz(), yaw.rate_Hz());
  out.signal.origin = "speed tan(course - yaw)";
  if (p.position != 0.0) out.signal.origin += fmt::format(", moved by {:g} m", -p.position);
  out.note = fmt::format(
      "lateral velocity is {}: {:.2f} m/s of error a sample; their offset of {:.1f} deg was taken off{}; not used "
      "below "
      "{:g} m/s",
      out.signal.origin, out.signal.sigma, wrapped(offset->value) / kDegree,
      late > 0 ? fmt::format(", and {:.2f} s by which the course is late", out.shift_s) : "", kSlowestCourse_mps);
  return out;
}

}  // namespace veridyn::vehicle
