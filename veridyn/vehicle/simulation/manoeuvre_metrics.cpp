#include "veridyn/vehicle/simulation/manoeuvre_metrics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/deg_per_g.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/moments.hpp"
#include "veridyn/vehicle/simulation/steady_turn.hpp"

namespace veridyn::vehicle {
namespace {

constexpr double kNone = kNaN;
using Series = std::span<const double>;

/// Mean over the last fifth of the drive.
double final_mean(Series x) { return numerics::mean(x.last(std::max<std::size_t>(x.size() / 5, 1))); }

/// When x first rises through `level` (both times the sign of level), from sample `from` on; NaN when it does not.
double crossing(Series time, Series x, double level, std::size_t from = 0) {
  const double sign = level < 0.0 ? -1.0 : 1.0;
  for (std::size_t i = from + 1; i < x.size(); ++i) {
    const double before = sign * x[i - 1] - std::abs(level), after = sign * x[i] - std::abs(level);
    if (before < 0.0 && after >= 0.0) return time[i - 1] + (time[i] - time[i - 1]) * before / (before - after);
  }
  return kNone;
}

/// The largest of sign x between two samples, refined by a parabola.
struct Peak {
  double time = kNone, value = kNone;
};
Peak peak_of(Series time, Series x, double sign, std::size_t from, std::size_t to) {
  if (from >= to) return {};
  std::size_t at = from;
  for (std::size_t i = from; i < to; ++i) {
    if (sign * x[i] > sign * x[at]) at = i;
  }
  if (at == 0 || at + 1 >= x.size()) return {time[at], x[at]};
  const double left = x[at - 1] - x[at], right = x[at + 1] - x[at];
  const double curvature = left + right;
  if (!(sign * curvature < 0.0)) return {time[at], x[at]};
  const double shift = std::clamp(0.5 * (left - right) / curvature, -0.5, 0.5);
  return {time[at] + shift * 0.5 * (time[at + 1] - time[at - 1]),
          x[at] - 0.125 * (left - right) * (left - right) / curvature};
}

double at_time(Series time, Series x, double when) {
  if (!(when >= time.front() && when <= time.back())) return kNone;
  const auto after = std::lower_bound(time.begin(), time.end(), when);
  const auto i = static_cast<std::size_t>(after - time.begin());
  if (i == 0) return x[0];
  return x[i - 1] + (x[i] - x[i - 1]) * (when - time[i - 1]) / (time[i] - time[i - 1]);
}

double largest(Series x) {
  double most = 0.0;
  for (const double value : x) most = std::max(most, std::abs(value));
  return most;
}

std::vector<double> sideslip_of(const VehicleTrajectory& t) {
  std::vector<double> beta(t.size());
  for (std::size_t i = 0; i < t.size(); ++i) beta[i] = std::atan2(t.v[i], t.u[i]);
  return beta;
}

/// Metrics of one quantity's response to a step.
std::vector<Metric> step_metrics(const char* name, const char* unit, const VehicleTrajectory& t, Series x, double steer,
                                 double begin) {
  std::vector<Metric> list;
  const double steady = final_mean(x);
  const Peak peak = peak_of(t.time, x, steady < 0.0 ? -1.0 : 1.0, 0, x.size());
  list.push_back({fmt::format("{}_gain", name), steady / steer, unit, "ISO 7401", "steady value per steer"});
  list.push_back({fmt::format("{}_response_time", name), crossing(t.time, x, 0.9 * steady) - begin, "s", "ISO 7401",
                  "from half the steer to 90 % of the steady value"});
  // Without an overshoot the largest value is somewhere in the noise of the steady state.
  const double overshoot = peak.value / steady - 1.0;
  const bool peaks = overshoot > 1e-6;
  list.push_back({fmt::format("{}_peak_response_time", name), peaks ? peak.time - begin : kNone, "s", "ISO 7401",
                  "from half the steer to the first maximum"});
  list.push_back(
      {fmt::format("{}_overshoot", name), peaks ? overshoot : 0.0, "1", "ISO 7401", "over the steady value"});
  return list;
}

}  // namespace

std::vector<Metric> step_steer_metrics(const VehicleTrajectory& t) {
  std::vector<Metric> list;
  if (t.size() < 10) return list;
  const double steer = final_mean(t.steer);
  if (steer == 0.0) return list;
  const double begin = crossing(t.time, t.steer, 0.5 * steer);
  const auto add = [&](const char* name, const char* unit, Series x) {
    const std::vector<Metric> more = step_metrics(name, unit, t, x, steer, begin);
    list.insert(list.end(), more.begin(), more.end());
  };
  add("yaw_rate", "1/s", t.r);
  add("lateral_acceleration", "m/s^2/rad", t.lateral_acceleration);
  const std::vector<double> beta = sideslip_of(t);
  const double sideslip = final_mean(beta);
  list.push_back({"sideslip_gain", sideslip / steer, "1", "ISO 7401", "steady value per steer"});
  double peak_time = kNone;
  for (const Metric& metric : list) {
    if (metric.name == "yaw_rate_peak_response_time") peak_time = metric.value;
  }
  list.push_back({"tb_factor", peak_time * std::abs(sideslip), "s rad", "ISO 7401",
                  "peak response time of the yaw rate times the steady sideslip angle"});
  if (t.roll.size() == t.size()) add("roll", "1", t.roll);
  return list;
}

std::vector<Metric> sine_with_dwell_metrics(const VehicleTrajectory& t) {
  std::vector<Metric> list;
  const double most = largest(t.steer);
  if (t.size() < 10 || most == 0.0) return list;
  const auto steers = [&](std::size_t i) { return std::abs(t.steer[i]) > 1e-9 * most; };
  std::size_t first = 0, last = t.size() - 1;
  while (!steers(first)) ++first;
  while (!steers(last)) --last;
  // Straight until the sample before the first that steers.
  const double begin = t.time[first == 0 ? 0 : first - 1];
  const double end = t.time[std::min(last + 1, t.size() - 1)];
  const double second = t.steer[first] > 0.0 ? -1.0 : 1.0;  // sign of the second half
  std::size_t reversal = first;
  while (reversal <= last && second * t.steer[reversal] <= 0.0) ++reversal;
  // While the steer lasts: what a vehicle that spins does later is no answer to it.
  const Peak peak = peak_of(t.time, t.r, second, reversal, std::min(last + 2, t.size()));
  const double c = std::cos(t.yaw[0]), s = std::sin(t.yaw[0]);
  std::vector<double> side(t.size());
  for (std::size_t i = 0; i < t.size(); ++i) side[i] = c * (t.y[i] - t.y[0]) - s * (t.x[i] - t.x[0]);
  list.push_back({"lateral_displacement_1.07s", std::abs(at_time(t.time, side, begin + 1.07)), "m",
                  "FMVSS 126, ISO 19365",
                  "1.07 s after the beginning of steer; at least 1.83 m for cars up to 3500 kg"});
  list.push_back({"second_yaw_rate_peak", peak.value, "rad/s", "FMVSS 126, ISO 19365", ""});
  list.push_back({"yaw_rate_ratio_1.00s", at_time(t.time, t.r, end + 1.0) / peak.value, "1", "FMVSS 126, ISO 19365",
                  "1.00 s after the end of steer; at most 0.35"});
  list.push_back({"yaw_rate_ratio_1.75s", at_time(t.time, t.r, end + 1.75) / peak.value, "1", "FMVSS 126, ISO 19365",
                  "1.75 s after the end of steer; at most 0.20"});
  return list;
}

std::vector<Metric> steady_state_metrics(const VehicleTrajectory& t, double wheelbase, double begin, double low,
                                         double high) {
  const TurnSamples turn = steady_turn(t, wheelbase, begin);
  const std::string range = fmt::format("over {:g} to {:g} m/s^2", low, high);
  std::vector<Metric> list;
  const auto add = [&](const char* name, const std::vector<double>& shown, bool per_g) {
    const double slope = turn_gradient(turn.acceleration, shown, low, high).slope;
    list.push_back({name, slope, "rad s^2/m", "ISO 4138", range});
    if (per_g) list.push_back({std::string(name) + "_deg_per_g", deg_per_g(slope), "deg/g", "ISO 4138", range});
  };
  add("understeer_gradient", turn.extra_steer, true);
  add("sideslip_gradient", turn.sideslip, false);
  if (t.roll.size() == t.size()) add("roll_gradient", turn.roll, true);
  return list;
}

std::vector<Metric> lane_change_metrics(const VehicleTrajectory& t, const DoubleLaneChange& course,
                                        const BodyOutline& body) {
  const LaneCheck check = check_lanes(t, course, body);
  std::vector<Metric> list{{"within_lanes", check.within && check.finished ? 1.0 : 0.0, "1", course.standard,
                            !check.within    ? fmt::format("left lane {} at {:.2f} s", check.lane, check.time)
                            : check.finished ? "passed without touching a cone"
                                             : "the drive ended before the last lane did"},
                           {"lane_margin", check.margin, "m", course.standard,
                            fmt::format("smallest, in lane {} at {:.2f} s; negative outside", check.lane, check.time)}};
  const double entry = crossing(t.time, t.x, course.lanes[0].begin);
  list.push_back(
      {"entry_speed", std::isfinite(entry) ? at_time(t.time, t.u, entry) : kNone, "m/s", course.standard, ""});
  return list;
}

std::vector<Metric> slalom_metrics(const VehicleTrajectory& t, const Slalom& course, const BodyOutline& body) {
  const ConeCheck check = check_cones(t, course, body);
  const double begin = crossing(t.time, t.x, course.cone(0)),
               end = crossing(t.time, t.x, course.cone(course.cones - 1));
  double slowest = kInfinity;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (t.time[i] >= begin && !(t.time[i] > end)) slowest = std::min(slowest, t.u[i]);
  }
  return {{"cones_hit", static_cast<double>(check.hit), "1", "", fmt::format("of {} that were reached", check.passed)},
          {"cones_passed", static_cast<double>(check.passed), "1", "", fmt::format("of {}", course.cones)},
          {"cone_margin", check.passed > 0 ? check.margin : kNone, "m", "",
           fmt::format("smallest, at cone {}; negative: hit", check.nearest)},
          {"entry_speed", std::isfinite(begin) ? at_time(t.time, t.u, begin) : kNone, "m/s", "", "at the first cone"},
          {"lowest_speed", slowest < kInfinity ? slowest : kNone, "m/s", "", "between the first and the last cone"}};
}

std::vector<Metric> ramp_steer_metrics(const VehicleTrajectory& t, double wheelbase) {
  std::vector<Metric> list = steady_state_metrics(t, wheelbase);
  if (t.size() == 0) return list;
  const auto by_size = [](double one, double other) { return std::abs(one) < std::abs(other); };
  const auto most = std::ranges::max_element(t.lateral_acceleration, by_size) - t.lateral_acceleration.begin();
  list.push_back({"steer_at_peak", t.steer[most], "rad", "", "where the lateral acceleration is largest"});
  return list;
}

std::vector<Metric> braking_in_a_turn_metrics(const VehicleTrajectory& t, double brake_time) {
  if (t.size() < 10) return {};
  const auto at = [&](Series x, double when) { return at_time(t.time, x, when); };
  const std::vector<double> beta = sideslip_of(t);
  const double r0 = at(t.r, brake_time), u0 = at(t.u, brake_time), r1 = at(t.r, brake_time + 1.0);
  const double u1 = at(t.u, brake_time + 1.0);
  const char* source = "after ISO 7975";
  return {
      {"deceleration", at(t.u, brake_time + 0.5) - at(t.u, brake_time + 1.5), "m/s^2", source,
       "mean from 0.5 to 1.5 s after the pedal moves"},
      {"initial_lateral_acceleration", at(t.lateral_acceleration, brake_time), "m/s^2", source, "when the pedal moves"},
      {"yaw_rate_ratio_1.00s", r1 / r0, "1", source, "1 s after the pedal moves, over that before"},
      {"yaw_rate_of_circle_ratio_1.00s", r1 / (r0 * u1 / u0), "1", source,
       "over that of the speed left on the same circle: above 1 turns in"},
      {"sideslip_change_1.00s", at(beta, brake_time + 1.0) - at(beta, brake_time), "rad", source, ""}};
}

MeasuredFrequencyResponse measured_frequency_response(const VehicleTrajectory& t, double low_Hz, double high_Hz) {
  MeasuredFrequencyResponse out;
  if (t.size() < 64) throw InputError("frequency response", fmt::format("{} samples are too few", t.size()));
  const double duration = t.time.back() - t.time.front();
  const double rate = static_cast<double>(t.size() - 1) / duration;
  const double length = std::min(std::max(2.0 / low_Hz, 8.0), 0.25 * duration);
  const auto segment = static_cast<std::size_t>(length * rate);
  const auto respond = [&](Series x) {
    return numerics::spectral_response(t.steer, x, rate, segment, std::max(low_Hz, 1.0 / length), high_Hz);
  };
  out.yaw_rate = respond(t.r);
  out.lateral_acceleration = respond(t.lateral_acceleration);
  out.sideslip = respond(sideslip_of(t));
  if (t.roll.size() == t.size()) out.roll = respond(t.roll);
  return out;
}

std::vector<Metric> frequency_response_metrics(const MeasuredFrequencyResponse& response) {
  std::vector<Metric> list;
  const auto& r = response.yaw_rate;
  if (r.size() < 3) return list;
  const auto gain = [&](std::size_t i) { return std::abs(r[i].response); };
  double steady = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < r.size() && r[i].frequency_Hz <= 1.26 * r[0].frequency_Hz; ++i, ++count)
    steady += gain(i);
  steady /= static_cast<double>(count);
  double bandwidth = kNone, coherence = 1.0;
  std::size_t peak = 0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    coherence = std::min(coherence, r[i].coherence);
    if (gain(i) > gain(peak)) peak = i;
    const double limit = steady / std::numbers::sqrt2;
    if (i > 0 && std::isnan(bandwidth) && gain(i - 1) >= limit && gain(i) < limit) {
      const double share = (gain(i - 1) - limit) / (gain(i - 1) - gain(i));
      bandwidth = r[i - 1].frequency_Hz + share * (r[i].frequency_Hz - r[i - 1].frequency_Hz);
    }
  }
  const auto phase_at = [](const std::vector<numerics::ResponseEstimate>& x, double frequency) {
    const auto near =
        std::ranges::min_element(x, {}, [&](const auto& one) { return std::abs(one.frequency_Hz - frequency); });
    return near == x.end() || std::abs(near->frequency_Hz - frequency) > 0.2 ? kNone : std::arg(near->response);
  };
  const char* source = "ISO 7401";
  list.push_back({"yaw_rate_gain", steady, "1/s", source, "at the lowest frequencies"});
  list.push_back({"yaw_rate_bandwidth", bandwidth, "Hz", source, "gain down by 3 dB"});
  list.push_back({"yaw_rate_peak_frequency", r[peak].frequency_Hz, "Hz", source, "of the largest gain"});
  list.push_back({"yaw_rate_peak_ratio", gain(peak) / steady, "1", source, "largest over steady gain"});
  list.push_back({"yaw_rate_phase_1Hz", phase_at(r, 1.0), "rad", source, ""});
  list.push_back({"lateral_acceleration_phase_1Hz", phase_at(response.lateral_acceleration, 1.0), "rad", source, ""});
  list.push_back({"smallest_coherence", coherence, "1", source, "of yaw rate and steer over the band"});
  return list;
}

std::vector<Metric> peak_metrics(const VehicleTrajectory& t, double gravity) {
  std::vector<Metric> list;
  if (t.size() == 0) return list;
  const double lateral = largest(t.lateral_acceleration);
  list.push_back(
      {"peak_lateral_acceleration", lateral, "m/s^2", "", fmt::format("{:.3f} of gravity", lateral / gravity)});
  list.push_back({"peak_yaw_rate", largest(t.r), "rad/s", "", ""});
  list.push_back({"peak_sideslip", largest(sideslip_of(t)), "rad", "", "at the centre of gravity"});
  if (t.roll.size() == t.size()) list.push_back({"peak_roll", largest(t.roll), "rad", "", ""});
  if (t.Fz[0].size() == t.size()) {
    double transfer = 0.0, least = kInfinity;
    std::size_t lightest = 0;
    for (std::size_t i = 0; i < t.size(); ++i) {
      const double left = t.Fz[kFrontLeft][i] + t.Fz[kRearLeft][i], right = t.Fz[kFrontRight][i] + t.Fz[kRearRight][i];
      if (left + right > 0.0) transfer = std::max(transfer, std::abs(left - right) / (left + right));
      for (std::size_t wheel = 0; wheel < kWheels; ++wheel) {
        const double share = t.Fz[wheel][i] / t.Fz[wheel][0];
        if (t.Fz[wheel][0] > 0.0 && share < least) {
          least = share;
          lightest = wheel;
        }
      }
    }
    list.push_back(
        {"peak_load_transfer_ratio", transfer, "1", "", "|left - right|/(left + right); at 1 a side has lifted"});
    list.push_back({"smallest_wheel_load", least, "1", "",
                    fmt::format("over its value at the start, wheel {}", kWheelNames[lightest])});
  }
  return list;
}

std::vector<Metric> manoeuvre_metrics(const VehicleTrajectory& t, const Manoeuvre& manoeuvre,
                                      const VehicleParameters<double>& parameters, double gravity) {
  std::vector<Metric> list;
  switch (manoeuvre.kind) {
    case ManoeuvreKind::kStepSteer:
      if (t.end == DriveEnd::kCompleted) list = step_steer_metrics(t);
      break;
    case ManoeuvreKind::kSineWithDwell:
      list = sine_with_dwell_metrics(t);
      break;
    case ManoeuvreKind::kSweep:
    case ManoeuvreKind::kRandomSteer:
      if (t.end == DriveEnd::kCompleted && t.size() >= 64) {
        // No higher than the samples allow, and nothing from a drive too short for the band.
        const double duration = t.time.back() - t.time.front();
        const double high = std::min(manoeuvre.end_frequency, 0.5 * static_cast<double>(t.size() - 1) / duration);
        const double low = std::max(manoeuvre.frequency, 8.0 / duration);
        if (low < high) list = frequency_response_metrics(measured_frequency_response(t, low, high));
      }
      break;
    case ManoeuvreKind::kSteadyStateCircle:
      list = steady_state_metrics(t, parameters.wheelbase(), steady_turn_begin(manoeuvre));
      break;
    case ManoeuvreKind::kDoubleLaneChange:
    case ManoeuvreKind::kObstacleAvoidance:
      if (manoeuvre.course) list = lane_change_metrics(t, *manoeuvre.course, manoeuvre.body);
      break;
    case ManoeuvreKind::kSlalom:
      if (manoeuvre.slalom) list = slalom_metrics(t, *manoeuvre.slalom, manoeuvre.body);
      break;
    case ManoeuvreKind::kRampSteer:
      list = ramp_steer_metrics(t, parameters.wheelbase());
      break;
    case ManoeuvreKind::kBrakingInATurn:
      list = braking_in_a_turn_metrics(t, manoeuvre.brake_time);
      break;
    case ManoeuvreKind::kReference:
    case ManoeuvreKind::kSine:
    case ManoeuvreKind::kContinuousSine:
    case ManoeuvreKind::kFishhook:
    case ManoeuvreKind::kFollowPath:
    case ManoeuvreKind::kSignal:
      break;
  }
  const std::vector<Metric> peaks = peak_metrics(t, gravity);
  list.insert(list.end(), peaks.begin(), peaks.end());
  if (std::ranges::any_of(t.road, [](const std::vector<double>& height) { return largest(height) > 0.0; })) {
    const std::vector<Metric> ride = ride_metrics(t);
    list.insert(list.end(), ride.begin(), ride.end());
  }
  return list;
}

}  // namespace veridyn::vehicle
