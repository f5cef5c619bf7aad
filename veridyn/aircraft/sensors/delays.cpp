#include "veridyn/aircraft/sensors/delays.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "veridyn/aircraft/model/atmosphere.hpp"
#include "veridyn/aircraft/model/still_air_rate.hpp"
#include "veridyn/aircraft/sensors/vane_kinematics.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/numerics/rotation.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::aircraft {
namespace {

using recording::BandLimited;
using recording::DelayGroup;
using Series = BandLimited::Series;

/// Below this airspeed the flow angles have no rate [m/s].
constexpr double kSlowest_mps = 3.0;

/// A receiver read by NMEA sentences on a serial line is 0.2 to 0.5 s late: it is searched up to here.
constexpr double kLatestGps_s = 1.0;

/// In the order in which they are aligned: later ones are compared with earlier ones.
const std::vector<DelayGroup>& groups() {
  static const std::vector<DelayGroup> all{{"attitude", {"roll", "pitch", "yaw"}},
                                           {"gps", {"vel_north", "vel_east", "vel_down"}},
                                           {"airspeed", {"airspeed", "dynamic_pressure"}},
                                           {"alpha", {"alpha"}},
                                           {"beta", {"beta"}},
                                           {"elevator", {"elevator"}},
                                           {"aileron", {"aileron"}},
                                           {"rudder", {"rudder"}}};
  return all;
}

/// What a surface moves: the rate whose derivative answers it.
struct SurfaceAxis {
  std::string_view surface;
  const char* rate;
};
constexpr std::array<SurfaceAxis, 3> kSurfaceAxes{
    {{"elevator", "gyro_y"}, {"aileron", "gyro_x"}, {"rudder", "gyro_z"}}};

const SurfaceAxis* surface_axis(std::string_view name) {
  const auto found = std::find_if(kSurfaceAxes.begin(), kSurfaceAxes.end(),
                                  [&](const SurfaceAxis& axis) { return axis.surface == name; });
  return found == kSurfaceAxes.end() ? nullptr : &*found;
}

/// Of two comparisons the one that determines the delay; of two that do the one with the smaller error, with what the
/// other says where they contradict each other.
std::optional<DelayReport> better_of(std::optional<DelayReport> a, std::optional<DelayReport> b) {
  if (!a || !b) return a ? std::move(a) : std::move(b);
  const bool both = a->determined() && b->determined();
  const bool first = a->determined() != b->determined() ? a->determined() : a->sigma_s > 0.0 && a->sigma_s < b->sigma_s;
  std::optional<DelayReport>&chosen = first ? a : b, &other = first ? b : a;
  if (both && std::abs(a->delay_s - b->delay_s) > estimation::kBeyondChance * std::hypot(a->sigma_s, b->sigma_s)) {
    chosen->contradicted_by = {other->reference, other->delay_s, other->sigma_s};
  }
  return std::move(chosen);
}

/// View of a recording that is being aligned, group by group, and of how.
class Alignment {
 public:
  Alignment(Recording& recording, const DelayAlignment& options, const BandLimited& band, Progress& progress)
      : recording_(recording), options_(options), band_(band), progress_(progress) {}

  /// Finds side by side what most groups are compared with.
  void prepare(int threads) {
    std::vector<std::function<void()>> jobs;
    const auto plan = [&](auto& found, const char* name, const auto& find) {
      if (!recording_.has(name)) return;
      auto& kept_there = found[name];
      jobs.emplace_back([&kept_there, &channel = at(name), find] { kept_there = find(channel); });
    };
    for (const char* name : {"gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z", "airspeed", "alpha", "beta",
                             "elevator", "aileron", "rudder"})
      plan(smoothed_, name, [this](const Channel& channel) { return band_.smooth(channel); });
    for (const char* name : {"roll", "pitch", "yaw"})
      plan(smoothed_angles_, name, [this](const Channel& channel) { return band_.smooth_angle(channel); });
    for (const char* name : {"gyro_x", "gyro_y", "gyro_z", "accel_y", "accel_z", "alpha", "beta"})
      plan(noise_, name, [this](const Channel& channel) { return band_.noise_variance(channel); });
    numerics::parallel_for(jobs.size(), threads, [&](std::size_t i) { jobs[i](); });
  }

  /// One group; nothing where the recording lacks what it is compared with.
  std::optional<DelayReport> align(const DelayGroup& group) {
    if (group.name == "attitude") return attitude(group);
    if (group.name == "gps") return gps(group);
    if (surface_axis(group.name) != nullptr) return deflection(group);
    if (group.name == "airspeed") return airspeed(group);
    return vane(group);
  }

  /// Vanes and surfaces again, once all are on the clock of the motion: as long as one was not, its effect went to the
  /// others at the wrong time.
  void align_again(const DelayGroup& group, DelayReport& report) {
    const bool surface = surface_axis(group.name) != nullptr;
    if (!report.together.empty() || (surface && moving_together(group.name).size() > 1)) return;
    // Of a surface the position was moved later.
    if (report.applied()) take_off(group.channels, surface ? report.delay_s : -report.delay_s);
    if (const std::optional<DelayReport> again = surface ? deflection(group) : vane(group)) report = *again;
  }

 private:
  bool has(std::initializer_list<const char*> names) const {
    return std::all_of(names.begin(), names.end(), [&](const char* name) { return recording_.has(name); });
  }
  const Channel& at(std::string_view name) const { return recording_.at(name); }
  /// Found once, as most groups are compared with the same channels.
  const Series& smooth(std::string_view name) const {
    return kept(smoothed_, name, [this](const Channel& channel) { return band_.smooth(channel); });
  }
  const Series& smooth_angle(std::string_view name) const {
    return kept(smoothed_angles_, name, [this](const Channel& channel) { return band_.smooth_angle(channel); });
  }
  double noise_variance(std::string_view name) const {
    return kept(noise_, name, [this](const Channel& channel) { return band_.noise_variance(channel); });
  }
  template <typename Kept, typename Find>
  const Kept& kept(std::map<std::string, Kept, std::less<>>& found, std::string_view name, const Find& find) const {
    auto it = found.find(name);
    if (it == found.end()) it = found.emplace(std::string(name), find(at(name))).first;
    return it->second;
  }

  void take_off(const std::vector<std::string>& channels, double delay_s) {
    recording::take_off_delay(recording_, channels, delay_s);
    for (const std::string& channel : channels) {
      smoothed_.erase(channel);
      smoothed_angles_.erase(channel);
    }
  }

  /// [m/s]; of the dynamic pressure where there is no airspeed, constant without either, NaN where the aircraft does
  /// not fly.
  Series airspeed() const {
    Series Va(band_.size(), kSlowest_mps + 1.0);
    if (recording_.has("airspeed")) {
      Va = smooth("airspeed");
      if (!options_.airspeed_is_true)
        for (double& v : Va) v *= std::sqrt(kSeaLevelDensity / options_.air_density);
    } else if (recording_.has("dynamic_pressure")) {
      Va = smooth("dynamic_pressure");
      for (double& v : Va) v = std::sqrt(2.0 * std::max(v, 0.0) / options_.air_density);
    }
    for (double& v : Va)
      if (!(v > kSlowest_mps)) v = kNaN;
    return Va;
  }

  /// @param farther_s  where the best delay is at the end of the search it goes on up to here; 0: it does not
  DelayReport compare(const DelayGroup& group, const char* reference, const std::vector<recording::DelayPair>& pairs,
                      double farther_s = 0.0) {
    DelayReport report = recording::shared_delay(group.name, reference, pairs, band_.rate_Hz(), options_);
    if (report.finding == recording::DelayFinding::kAtEnd && farther_s > options_.max_delay_s) {
      recording::DelayOptions farther = options_;
      farther.max_delay_s = farther_s;
      report = recording::shared_delay(group.name, reference, pairs, band_.rate_Hz(), farther);
    }
    if (report.applied()) take_off(group.channels, report.delay_s);
    return report;
  }

  std::optional<DelayReport> attitude(const DelayGroup& group) {
    if (!has({"roll", "pitch", "yaw"})) return std::nullopt;
    const Series &phi = smooth_angle("roll"), &theta = smooth_angle("pitch");
    const Series &p = smooth("gyro_x"), &q = smooth("gyro_y"), &r = smooth("gyro_z");
    Series roll_rate(band_.size()), pitch_rate(band_.size());
    for (std::size_t k = 0; k < band_.size(); ++k) {
      const auto rates = numerics::euler_rates(phi[k], theta[k], numerics::Vector3<double>(p[k], q[k], r[k]));
      roll_rate[k] = rates(0);
      pitch_rate[k] = rates(1);
    }
    return compare(group, "gyro",
                   {{std::move(roll_rate), band_.angle_derivative(at("roll"))},
                    {std::move(pitch_rate), band_.angle_derivative(at("pitch"))}});
  }

  std::optional<DelayReport> gps(const DelayGroup& group) {
    if (!has({"vel_north", "vel_east", "roll", "pitch", "yaw", "accel_x", "accel_y", "accel_z"})) return std::nullopt;
    const char* const reference = "accelerometer and attitude";
    const double fixes = at("vel_north").rate_Hz();
    if (!(fixes >= recording::kSlowestDelayed_Hz))
      return DelayReport{group.name, reference, 0.0, 0.0, 0.0, recording::DelayFinding::kSlow};
    const Series &phi = smooth_angle("roll"), &theta = smooth_angle("pitch"), &psi = smooth_angle("yaw");
    const Series &ax = smooth("accel_x"), &ay = smooth("accel_y"), &az = smooth("accel_z");
    Series north(band_.size()), east(band_.size());
    for (std::size_t k = 0; k < band_.size(); ++k) {
      const numerics::Vector3<double> acceleration = numerics::R_body_from_ned(phi[k], theta[k], psi[k]).transpose() *
                                                     numerics::Vector3<double>(ax[k], ay[k], az[k]);
      north[k] = acceleration(0);
      east[k] = acceleration(1);
    }
    // GPS is slow: both sides through one more low-pass at a rate that five fixes a second can follow.
    const auto [low, slope] = band_.kernels(std::min(options_.band_Hz, 0.2 * fixes));
    return compare(group, reference,
                   {{numerics::filter(north, low), numerics::filter(band_.raw(at("vel_north")), slope)},
                    {numerics::filter(east, low), numerics::filter(band_.raw(at("vel_east")), slope)}},
                   kLatestGps_s);
  }

  /// Derivative of the airspeed that specific force and attitude imply in still air.
  Series implied_airspeed_derivative() const {
    const Series &phi = smooth_angle("roll"), &theta = smooth_angle("pitch");
    const Series &ax = smooth("accel_x"), &ay = smooth("accel_y"), &az = smooth("accel_z");
    const Series alpha = flow_angle("alpha"), beta = flow_angle("beta");
    Series derivative(band_.size());
    for (std::size_t k = 0; k < band_.size(); ++k)
      derivative[k] = still_air_rate({.specific_force = {ax[k], ay[k], az[k]},
                                      .phi = phi[k],
                                      .theta = theta[k],
                                      .Va = kSlowest_mps,
                                      .alpha = alpha[k],
                                      .beta = beta[k]})
                          .Va;
    return derivative;
  }

  /// As recorded, zero without the vane.
  Series flow_angle(const char* name) const { return recording_.has(name) ? smooth(name) : Series(band_.size(), 0.0); }

  /// The same as recorded, be it as dynamic pressure.
  Series airspeed_derivative() const {
    if (recording_.has("airspeed")) return band_.derivative(at("airspeed"));
    Series derivative = band_.derivative(at("dynamic_pressure"));
    const Series Va = airspeed();
    for (std::size_t k = 0; k < derivative.size(); ++k) derivative[k] /= options_.air_density * Va[k];
    return derivative;
  }

  std::optional<DelayReport> airspeed(const DelayGroup& group) {
    const bool speed = recording_.has("airspeed") || recording_.has("dynamic_pressure");
    if (!speed || !has({"roll", "pitch", "accel_x", "accel_y", "accel_z"})) return std::nullopt;
    return compare(group, "accelerometer and attitude", {{implied_airspeed_derivative(), airspeed_derivative()}});
  }

  /// View of an alignment that collects the others of an effect's equation, all functions of the same moment.
  class Equation {
   public:
    Equation(const Alignment& alignment, Series airspeed) : from_(alignment), Va_(std::move(airspeed)) {
      double flown = 0.0;
      for (const double V : Va_) {
        if (!std::isfinite(V)) continue;
        mean_[0] += 1.0;
        mean_[1] += 1.0 / V / V;
        mean_[2] += 1.0 / V / V / V / V;
        flown += 1.0;
      }
      for (double& mean : mean_) mean /= std::max(1.0, flown);
    }
    /// x over a power 0 to 2 of the airspeed.
    [[nodiscard]] Series over_speed(Series x, std::size_t power) const {
      for (std::size_t k = 0; k < x.size(); ++k)
        for (std::size_t i = 0; i < power; ++i) x[k] /= Va_[k];
      return x;
    }
    /// The channel in the same way, with its noise.
    [[nodiscard]] recording::Explanatory measured(const char* channel, std::size_t power) const {
      return {over_speed(from_.smooth(channel), power), mean_[power] * from_.noise_variance(channel)};
    }
    void add(const char* channel, std::size_t power) {
      if (from_.recording_.has(channel)) others_.push_back(measured(channel, power));
    }
    void add_exact(Series x, std::size_t power) { others_.push_back({over_speed(std::move(x), power), 0.0}); }
    void add_position(const char* channel) {
      if (from_.recording_.has(channel)) add_exact(from_.smooth(channel), 0);
    }
    [[nodiscard]] const std::vector<recording::Explanatory>& others() const { return others_; }

   private:
    const Alignment& from_;
    Series Va_;
    std::array<double, 3> mean_{};  ///< of 1/Va^2 to the power
    std::vector<recording::Explanatory> others_;
  };

  /// The delay of a vane at which the lift, or the side force, explains it best: air that moves shows in the vane and
  /// in the force at once, while the motion of the aircraft follows a gust by its response.
  std::optional<DelayReport> vane_by_force(const DelayGroup& group) const {
    const bool lift = group.name == "alpha";
    const char* const force = lift ? "accel_z" : "accel_y";
    if (!recording_.has(group.name) || !recording_.has(force)) return std::nullopt;
    Equation equation(*this, airspeed());
    equation.add_exact(Series(band_.size(), 1.0), 2);  // bias of the accelerometer
    if (lift) {
      equation.add("gyro_y", 1);
      equation.add_position("elevator");
    } else {
      for (const char* rate : {"gyro_x", "gyro_z"}) equation.add(rate, 1);
      for (const char* surface : {"aileron", "rudder"}) equation.add_position(surface);
    }
    // The vane is late against all of them.
    DelayReport report = recording::common_effect_delay(group.name, lift ? "lift (accel_z)" : "side force (accel_y)",
                                                        {{.effect = smooth(group.name),
                                                          .causes = {equation.measured(force, 2)},
                                                          .others = {},
                                                          .late_others = equation.others()}},
                                                        band_.step(), options_, progress_, "force");
    // A gust also turns the air about the aircraft, at a rate that goes with the change of its angle: what that does to
    // the force seems an earlier angle, by c/(2 V) CL_q/CL_alpha or b/(2 V) CY_r/CY_beta (5 and 50 ms for UnATRaP).
    constexpr double kTurningLift_s = 0.005, kTurningSideForce_s = 0.025;
    if (report.determined()) report.sigma_s = std::hypot(report.sigma_s, lift ? kTurningLift_s : kTurningSideForce_s);
    return report;
  }

  /// What a vane shows in still air follows from the motion, whatever the aerodynamics. Gusts are left out: the
  /// aircraft answers them, and the answer is late.
  std::optional<DelayReport> vane_by_motion(const DelayGroup& group) const {
    /// An airspeed without calibration; with a wrong one angle and path answer a manoeuvre at another time.
    constexpr double kAirspeedDoubt = 0.03;
    const bool speed = recording_.has("airspeed") || recording_.has("dynamic_pressure");
    if (!speed || !has({"roll", "pitch", "accel_x", "accel_y", "accel_z"}) || !recording_.has(group.name))
      return std::nullopt;
    const VaneKinematics motion{.rate_Hz = band_.rate_Hz(),
                                .p = smooth("gyro_x"),
                                .q = smooth("gyro_y"),
                                .r = smooth("gyro_z"),
                                .ax = smooth("accel_x"),
                                .ay = smooth("accel_y"),
                                .az = smooth("accel_z"),
                                .phi = smooth_angle("roll"),
                                .theta = smooth_angle("pitch"),
                                .Va = airspeed(),
                                .alpha = flow_angle("alpha"),
                                .beta = flow_angle("beta"),
                                .position = options_.vane_position};
    const auto angle = [&](double airspeed_factor) {
      StillAirAngles angles = still_air_angles(motion, airspeed_factor);
      return without_drift(group.name == "alpha" ? angles.alpha : angles.beta, motion.rate_Hz);
    };
    return recording::shared_delay(group.name, "gyro, accelerometer and attitude",
                                   {{.expected = angle(1.0),
                                     .observed = without_drift(smooth(group.name), motion.rate_Hz),
                                     .noise_variance = band_.noise_variance(at(group.name)),
                                     .doubted = angle(1.0 + kAirspeedDoubt)}},
                                   band_.rate_Hz(), options_);
  }

  /// By what has the smaller error: the force, where air moves, or the motion, where it does not.
  std::optional<DelayReport> vane(const DelayGroup& group) {
    std::optional<DelayReport> report = better_of(vane_by_force(group), vane_by_motion(group));
    if (report && report->applied()) take_off(group.channels, report->delay_s);
    return report;
  }

  /// What the angular acceleration over the square of the airspeed about a surface's axis is explained by: flow angles,
  /// normalised rates, products of the rates that couple through the inertia, and the other surface of the axis. What
  /// is left out moves with the aircraft, and so with the pilot who holds it, and biases the delay.
  Equation moment_equation(const SurfaceAxis& axis, const std::vector<std::string>& causes) const {
    const Series &p = smooth("gyro_x"), &q = smooth("gyro_y"), &r = smooth("gyro_z");
    const auto products = [&](auto value) {
      Series series(band_.size());
      for (std::size_t k = 0; k < series.size(); ++k) series[k] = value(k);
      return series;
    };
    Equation equation(*this, airspeed());
    if (axis.surface == "elevator") {
      equation.add("alpha", 0);
      equation.add("gyro_y", 1);
      equation.add_exact(products([&](std::size_t k) { return p[k] * r[k]; }), 2);
      equation.add_exact(products([&](std::size_t k) { return p[k] * p[k] - r[k] * r[k]; }), 2);
      return equation;
    }
    equation.add("beta", 0);
    equation.add("gyro_x", 1);
    equation.add("gyro_z", 1);
    equation.add_exact(products([&](std::size_t k) { return q[k] * r[k]; }), 2);
    equation.add_exact(products([&](std::size_t k) { return p[k] * q[k]; }), 2);
    for (const char* other : {"aileron", "rudder"})
      if (std::ranges::find(causes, other) == causes.end()) equation.add_position(other);
    return equation;
  }

  /// The delay of a deflection at which the moment about its axis is explained best; one for all that move together.
  std::optional<DelayReport> deflection(const DelayGroup& group) {
    if (!recording_.has(group.name)) return std::nullopt;
    if (const auto found = shared_.find(group.name); found != shared_.end()) return found->second;
    const std::vector<std::string> together = moving_together(group.name);
    std::vector<recording::Explanatory> causes;
    for (const std::string& surface : together) causes.push_back({smooth(surface)});
    std::vector<recording::DelayedEffect> effects;
    std::vector<std::string> rates;
    for (const std::string& surface : together) {
      const SurfaceAxis& axis = *surface_axis(surface);
      const Equation equation = moment_equation(axis, together);
      effects.push_back({equation.over_speed(band_.derivative(at(axis.rate)), 2), causes, equation.others(), {}});
      rates.emplace_back(axis.rate);
    }
    DelayReport report =
        recording::common_effect_delay(group.name, fmt::format("angular acceleration ({})", fmt::join(rates, ", ")),
                                       effects, band_.step(), options_, progress_, "surface");
    if (together.size() > 1) {
      report.together = together;
      for (const std::string& surface : together) {
        shared_[surface] = report;
        shared_[surface].group = surface;
      }
    }
    // What is late here is the effect: the position is moved later, onto the clock of the motion.
    if (report.applied()) take_off(together, -report.delay_s);
    return report;
  }

  /// The surface and those whose delay is searched too and that move with it, in the order of `groups`.
  std::vector<std::string> moving_together(const std::string& surface) const {
    std::vector<std::string> together;
    const Series& position = smooth(surface);
    for (const SurfaceAxis& other : kSurfaceAxes) {
      const bool same = other.surface == surface;
      if (!same && (!recording_.has(other.surface) || options_.given_for(other.surface))) continue;
      if (same || std::abs(recording::correlation_of(position, smooth(other.surface))) > recording::kMoveTogether)
        together.emplace_back(other.surface);
    }
    return together;
  }

  Recording& recording_;
  const DelayAlignment& options_;
  const BandLimited& band_;
  Progress& progress_;
  // Of channels as they are aligned so far.
  mutable std::map<std::string, Series, std::less<>> smoothed_, smoothed_angles_;
  mutable std::map<std::string, double, std::less<>> noise_;
  std::map<std::string, DelayReport> shared_;  ///< of surfaces that were found together with one before
};

}  // namespace

const KeyTable<DelayAlignment>& DelayAlignment::keys() {
  static const auto table = KeyTable<DelayAlignment>("delays", "How sensors are brought onto one clock.")
                                .with(recording::DelayOptions::keys(groups()));
  return table;
}

AlignedRecording align_delays(MappedRecording mapped, const DelayAlignment& options, Progress& progress) {
  AlignedRecording aligned{std::move(mapped), {}};
  Recording& recording = aligned.mapped.recording;
  const bool clock = recording.has("gyro_x") && recording.has("gyro_y") && recording.has("gyro_z");
  const std::optional<BandLimited> band =
      clock ? BandLimited::around(recording.at("gyro_x"), options.band_Hz) : std::nullopt;
  std::optional<Alignment> alignment;
  if (band && options.automatic) {
    alignment.emplace(recording, options, *band, progress);
    if (progress.threads() != 1) alignment->prepare(progress.threads());
  }
  double done = 0.0;
  for (const DelayGroup& group : groups()) {
    if (!progress.update(done / static_cast<double>(groups().size()))) break;
    done += 1.0;
    std::optional<DelayReport> report = recording::take_off_given(recording, group, options);
    if (!report && alignment && !options.given_for(group.name)) report = alignment->align(group);
    if (report) aligned.delays.push_back(std::move(*report));
  }
  const auto by_effect = [&](const DelayReport& report) {
    return (report.group == "alpha" || report.group == "beta" || surface_axis(report.group) != nullptr) &&
           !options.given_for(report.group);
  };
  const bool moved = std::ranges::any_of(
      aligned.delays, [&](const DelayReport& report) { return report.applied() && by_effect(report); });
  if (!alignment || !moved) return aligned;
  for (DelayReport& report : aligned.delays)
    if (by_effect(report))
      alignment->align_again(*std::ranges::find(groups(), report.group, &DelayGroup::name), report);
  return aligned;
}

AlignedRecording align_delays(MappedRecording mapped, const DelayAlignment& options) {
  Progress silent;
  return align_delays(std::move(mapped), options, silent);
}

}  // namespace veridyn::aircraft
