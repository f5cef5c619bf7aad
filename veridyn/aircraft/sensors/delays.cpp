#include "veridyn/aircraft/sensors/delays.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::aircraft {
namespace {

using recording::BandLimited;
using recording::DelayGroup;
using Series = BandLimited::Series;

/// Below this airspeed the flow angles have no rate [m/s].
constexpr double kSlowest_mps = 3.0;

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

/// How far the delay of a deflection is off beyond its scatter, since the rates' equation with noisy flow angles is no
/// exact model: root mean square of nine delays of 0 in simulated flights of three aircraft [s].
constexpr double kModelSigma_s = 0.016;

/// What a surface moves: the rate whose derivative answers it, and what else that depends on.
struct SurfaceAxis {
  std::string_view surface;
  const char* rate;
  std::array<const char*, 3> motion;
};
constexpr std::array<SurfaceAxis, 3> kSurfaceAxes{{{"elevator", "gyro_y", {"alpha", "gyro_y", "airspeed"}},
                                                   {"aileron", "gyro_x", {"beta", "gyro_x", "gyro_z"}},
                                                   {"rudder", "gyro_z", {"beta", "gyro_x", "gyro_z"}}}};

const SurfaceAxis* surface_axis(std::string_view name) {
  const auto found = std::find_if(kSurfaceAxes.begin(), kSurfaceAxes.end(),
                                  [&](const SurfaceAxis& axis) { return axis.surface == name; });
  return found == kSurfaceAxes.end() ? nullptr : &*found;
}

/// View of a recording that is being aligned, group by group, and of how.
class Alignment {
 public:
  Alignment(Recording& recording, const DelayAlignment& options, const BandLimited& band, Progress& progress)
      : recording_(recording), options_(options), band_(band), progress_(progress) {}

  /// One group; nothing where the recording lacks what it is compared with.
  std::optional<DelayReport> align(const DelayGroup& group) {
    if (group.name == "attitude") return attitude(group);
    if (group.name == "gps") return gps(group);
    if (surface_axis(group.name) != nullptr) return deflection(group);
    return flow(group);
  }

 private:
  bool has(std::initializer_list<const char*> names) const {
    return std::all_of(names.begin(), names.end(), [&](const char* name) { return recording_.has(name); });
  }
  const Channel& at(std::string_view name) const { return recording_.at(name); }
  Series smooth(const char* name) const { return band_.smooth(at(name)); }
  Series smooth_angle(const char* name) const { return band_.smooth_angle(at(name)); }

  DelayReport compare(const DelayGroup& group, const char* reference, const std::vector<recording::DelayPair>& pairs) {
    DelayReport report = recording::shared_delay(group.name, reference, pairs, band_.rate_Hz(), options_);
    if (report.applied) recording::take_off_delay(recording_, group.channels, report.delay_s);
    return report;
  }

  std::optional<DelayReport> attitude(const DelayGroup& group) {
    if (!has({"roll", "pitch", "yaw"})) return std::nullopt;
    const Series phi = smooth_angle("roll"), theta = smooth_angle("pitch");
    const Series p = smooth("gyro_x"), q = smooth("gyro_y"), r = smooth("gyro_z");
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
    if (!(fixes >= recording::kSlowestDelayed_Hz)) {
      return DelayReport{group.name,
                         reference,
                         0.0,
                         0.0,
                         0.0,
                         false,
                         fmt::format("not determined: {:.2g} samples a second are fewer than {:g}", fixes,
                                     recording::kSlowestDelayed_Hz)};
    }
    const Series phi = smooth_angle("roll"), theta = smooth_angle("pitch"), psi = smooth_angle("yaw");
    const Series ax = smooth("accel_x"), ay = smooth("accel_y"), az = smooth("accel_z");
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
                    {numerics::filter(east, low), numerics::filter(band_.raw(at("vel_east")), slope)}});
  }

  /// Derivatives of airspeed, alpha and beta that rates, specific force and attitude imply in still air.
  std::array<Series, 3> flow_derivatives() const {
    const Series Va = smooth("airspeed");
    const Series phi = smooth_angle("roll"), theta = smooth_angle("pitch");
    const Series p = smooth("gyro_x"), q = smooth("gyro_y"), r = smooth("gyro_z");
    const Series ax = smooth("accel_x"), ay = smooth("accel_y"), az = smooth("accel_z");
    const Series alpha = has({"alpha"}) ? smooth("alpha") : Series(band_.size(), 0.0);
    const Series beta = has({"beta"}) ? smooth("beta") : Series(band_.size(), 0.0);
    Series dVa(band_.size()), dalpha(band_.size()), dbeta(band_.size());
    for (std::size_t k = 0; k < band_.size(); ++k) {
      const double ca = std::cos(alpha[k]), sa = std::sin(alpha[k]), cb = std::cos(beta[k]), sb = std::sin(beta[k]);
      // Acceleration relative to still air in body axes, rotated into wind axes.
      const double x = ax[k] - kGravity * std::sin(theta[k]);
      const double y = ay[k] + kGravity * std::cos(theta[k]) * std::sin(phi[k]);
      const double z = az[k] + kGravity * std::cos(theta[k]) * std::cos(phi[k]);
      const double V = Va[k] > kSlowest_mps ? Va[k] : kNaN;
      dVa[k] = x * ca * cb + y * sb + z * sa * cb;
      dalpha[k] = q[k] - std::tan(beta[k]) * (p[k] * ca + r[k] * sa) + (z * ca - x * sa) / (V * cb);
      dbeta[k] = p[k] * sa - r[k] * ca + (y * cb - x * ca * sb - z * sa * sb) / V;
    }
    return {std::move(dVa), std::move(dalpha), std::move(dbeta)};
  }

  std::optional<DelayReport> flow(const DelayGroup& group) {
    if (!has({"airspeed", "roll", "pitch", "accel_x", "accel_y", "accel_z"}) || !recording_.has(group.name))
      return std::nullopt;
    // As the airspeed was before it was shifted: all three are compared with the same.
    if (!expected_) expected_ = flow_derivatives();
    const std::size_t which = group.name == "airspeed" ? 0 : group.name == "alpha" ? 1 : 2;
    return compare(group, which == 0 ? "accelerometer and attitude" : "gyro and accelerometer",
                   {{(*expected_)[which], band_.derivative(at(group.name))}});
  }

  /// The delay of a deflection at which the angular acceleration is explained best; one for all that move together.
  std::optional<DelayReport> deflection(const DelayGroup& group) {
    if (!recording_.has(group.name)) return std::nullopt;
    if (const auto found = shared_.find(group.name); found != shared_.end()) return found->second;
    const std::vector<std::string> together = moving_together(group.name);
    std::vector<Series> causes;
    for (const std::string& surface : together) causes.push_back(band_.smooth(at(surface)));
    std::vector<recording::DelayedEffect> effects;
    std::vector<std::string> rates;
    for (const std::string& surface : together) {
      const SurfaceAxis& axis = *surface_axis(surface);
      std::vector<Series> others;
      for (const char* channel : axis.motion)
        if (recording_.has(channel)) others.push_back(smooth(channel));
      effects.push_back({band_.derivative(at(axis.rate)), causes, std::move(others)});
      rates.emplace_back(axis.rate);
    }
    DelayReport report =
        recording::common_effect_delay(group.name, fmt::format("angular acceleration ({})", fmt::join(rates, ", ")),
                                       effects, band_.step(), options_, progress_, "surface");
    report.sigma_s = std::hypot(report.sigma_s, kModelSigma_s);
    if (together.size() > 1) {
      report.together = together;
      report.text += fmt::format("; one delay for {}, which move together", fmt::join(together, " and "));
      for (const std::string& surface : together) {
        shared_[surface] = report;
        shared_[surface].group = surface;
      }
    }
    // What is late here is the effect: the position is moved later, onto the clock of the motion.
    if (report.applied) recording::take_off_delay(recording_, together, -report.delay_s);
    return report;
  }

  /// The surface and those whose delay is searched too and that move with it, in the order of `groups`.
  std::vector<std::string> moving_together(const std::string& surface) const {
    std::vector<std::string> together;
    const Series position = band_.smooth(at(surface));
    for (const SurfaceAxis& other : kSurfaceAxes) {
      const bool same = other.surface == surface;
      if (!same && (!recording_.has(other.surface) || options_.given_for(other.surface))) continue;
      if (same ||
          std::abs(recording::correlation_of(position, band_.smooth(at(other.surface)))) > recording::kMoveTogether)
        together.emplace_back(other.surface);
    }
    return together;
  }

  Recording& recording_;
  const DelayAlignment& options_;
  const BandLimited& band_;
  Progress& progress_;
  std::optional<std::array<Series, 3>> expected_;
  std::map<std::string, DelayReport> shared_;  ///< of surfaces that were found together with one before
};

}  // namespace

DelayAlignment DelayAlignment::read(const StudyTable& table) {
  DelayAlignment options;
  options.read_keys(table, groups());
  return options;
}

AlignedRecording align_delays(MappedRecording mapped, const DelayAlignment& options, Progress& progress) {
  AlignedRecording aligned{std::move(mapped), {}};
  Recording& recording = aligned.mapped.recording;
  const bool clock = recording.has("gyro_x") && recording.has("gyro_y") && recording.has("gyro_z");
  const std::optional<BandLimited> band =
      clock ? BandLimited::around(recording.at("gyro_x"), options.band_Hz) : std::nullopt;
  std::optional<Alignment> alignment;
  if (band && options.automatic) alignment.emplace(recording, options, *band, progress);
  double done = 0.0;
  for (const DelayGroup& group : groups()) {
    if (!progress.update(done / static_cast<double>(groups().size()))) break;
    done += 1.0;
    std::optional<DelayReport> report = recording::take_off_given(recording, group, options);
    if (!report && alignment && !options.given_for(group.name)) report = alignment->align(group);
    if (report) aligned.delays.push_back(std::move(*report));
  }
  return aligned;
}

AlignedRecording align_delays(MappedRecording mapped, const DelayAlignment& options) {
  Progress silent;
  return align_delays(std::move(mapped), options, silent);
}

}  // namespace veridyn::aircraft
