#include "veridyn/aircraft/sensors/delays.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "veridyn/numerics/delay.hpp"
#include "veridyn/numerics/filters.hpp"
#include "veridyn/numerics/resample.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::aircraft {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kGravity = 9.80665;
constexpr double kMaxRate_Hz = 100.0;
/// Samples of the longest stretch that the deflection search looks at: five minutes at 100 Hz are plenty.
constexpr std::size_t kMaxRows = 30000;

/// A delay is one number: the middle quarter of an hour of a longer flight determines it.
constexpr double kLongestSearch_s = 900.0;

using Series = std::vector<double>;

class Alignment {
 public:
  Alignment(MappedRecording& mapped, const DelayAlignment& options) : mapped_(mapped), options_(options) {}

  std::vector<DelayReport> run() {
    if (!has({"gyro_x", "gyro_y", "gyro_z"})) return finish_with_given();
    const Channel& gyro = mapped_.recording.at("gyro_x");
    const double rate = std::min(kMaxRate_Hz, std::round(gyro.rate_Hz()));
    if (!(rate >= 4.0 * options_.band_Hz) || gyro.span().duration() < 10.0) return finish_with_given();
    const TimeSpan whole = gyro.span();
    const double middle = 0.5 * (whole.begin + whole.end);
    const double half = 0.5 * std::min(whole.duration(), kLongestSearch_s);
    grid_ = numerics::UniformGrid::covering(middle - half, middle + half, 1.0 / rate);
    const numerics::LowPassDesign band{.rate_Hz = rate, .pass_Hz = options_.band_Hz, .stop_Hz = 1.5 * options_.band_Hz};
    smooth_ = numerics::low_pass(band);
    differentiate_ = numerics::low_pass_differentiator(band);
    attitude();
    gps();
    flow();
    deflections();
    return std::move(reports_);
  }

 private:
  bool has(std::initializer_list<const char*> names) const {
    return std::all_of(names.begin(), names.end(), [&](const char* name) { return mapped_.recording.has(name); });
  }

  Series raw(const char* name, bool angle = false) const {
    Channel channel = mapped_.recording.at(name);
    if (angle) numerics::unwrap_angles(channel.value);
    numerics::ResampleOptions options;
    options.gap_limit_s = std::max(0.5, channel.rate_Hz() > 0.0 ? 3.0 / channel.rate_Hz() : 0.0);
    return numerics::resample(channel.times(), channel.value, grid_, options);
  }
  Series smooth(const char* name, bool angle = false) const { return numerics::filter(raw(name, angle), smooth_); }
  Series derivative(const char* name, bool angle = false) const {
    return numerics::filter(raw(name, angle), differentiate_);
  }

  const double* given(const std::string& group) const {
    const auto found =
        std::find_if(options_.given.begin(), options_.given.end(), [&](const auto& g) { return g.first == group; });
    return found == options_.given.end() ? nullptr : &found->second;
  }

  void shift(const std::vector<std::string>& channels, double delay_s) {
    for (const std::string& name : channels) {
      const Channel* channel = mapped_.recording.find(name);
      if (channel == nullptr) continue;
      Channel moved = *channel;
      std::vector<double> stamps(moved.times().begin(), moved.times().end());
      for (double& t : stamps) t -= delay_s;
      moved.time = make_time_base(std::move(stamps));
      mapped_.recording.set(std::move(moved));
    }
  }

  /// True when the study settles this group.
  bool settled(const std::string& group, const std::vector<std::string>& channels) {
    if (const double* delay = given(group)) {
      const bool there =
          std::any_of(channels.begin(), channels.end(), [&](const auto& c) { return mapped_.recording.has(c); });
      if (there) {
        shift(channels, *delay);
        reports_.push_back({group, "study", *delay, 0.0, 0.0, true, "given in the study"});
      }
      return true;
    }
    return !options_.automatic;
  }

  std::vector<DelayReport> finish_with_given() {
    for (const auto& [group, channels] : groups()) static_cast<void>(settled(group, channels));
    return std::move(reports_);
  }

  static const std::vector<std::pair<std::string, std::vector<std::string>>>& groups() {
    static const std::vector<std::pair<std::string, std::vector<std::string>>> all{
        {"attitude", {"roll", "pitch", "yaw"}},
        {"gps", {"vel_north", "vel_east", "vel_down"}},
        {"airspeed", {"airspeed", "dynamic_pressure"}},
        {"alpha", {"alpha"}},
        {"beta", {"beta"}},
        {"elevator", {"elevator"}},
        {"aileron", {"aileron"}},
        {"rudder", {"rudder"}}};
    return all;
  }

  /// Several pairs that share one delay: laid end to end, a hole between them longer than any shift.
  void compare(const std::string& group, const std::vector<std::string>& channels, const std::string& reference_name,
               const std::vector<std::pair<Series, Series>>& pairs) {
    Series reference;
    Series delayed;
    const auto hole = static_cast<std::size_t>(2.0 * options_.max_delay_s * grid_.rate_Hz()) + 1;
    for (const auto& [expected, observed] : pairs) {
      reference.insert(reference.end(), expected.begin(), expected.end());
      delayed.insert(delayed.end(), observed.begin(), observed.end());
      reference.insert(reference.end(), hole, kNaN);
      delayed.insert(delayed.end(), hole, kNaN);
    }
    numerics::DelayOptions search;
    search.max_delay_s = options_.max_delay_s;
    const numerics::DelayEstimate found = numerics::estimate_delay(reference, delayed, grid_.rate_Hz(), search);
    DelayReport report{group, reference_name, found.delay_s, found.sigma_s, found.correlation, false, ""};
    const bool opposite = found.correlation < 0.0;
    if (!found.determined || opposite) {
      report.text =
          opposite ? "opposite sign: is the channel's sign right?" : fmt::format("not determined: {}", found.reason);
    } else if (std::abs(found.delay_s) < std::max(options_.min_delay_s, 3.0 * found.sigma_s)) {
      report.text = "too small to matter";
    } else {
      report.applied = true;
      report.text = "applied";
      shift(channels, found.delay_s);
    }
    reports_.push_back(std::move(report));
  }

  void attitude() {
    const std::vector<std::string> channels{"roll", "pitch", "yaw"};
    if (!has({"roll", "pitch", "yaw"}) || settled("attitude", channels)) return;
    const Series phi = smooth("roll", true), theta = smooth("pitch", true);
    const Series p = smooth("gyro_x"), q = smooth("gyro_y"), r = smooth("gyro_z");
    Series roll_rate(grid_.count), pitch_rate(grid_.count);
    for (std::size_t k = 0; k < grid_.count; ++k) {
      const auto rates = numerics::euler_rates(phi[k], theta[k], numerics::Vector3<double>(p[k], q[k], r[k]));
      roll_rate[k] = rates(0);
      pitch_rate[k] = rates(1);
    }
    compare("attitude", channels, "gyro",
            {{std::move(roll_rate), derivative("roll", true)}, {std::move(pitch_rate), derivative("pitch", true)}});
  }

  void gps() {
    const std::vector<std::string> channels{"vel_north", "vel_east", "vel_down"};
    if (!has({"vel_north", "vel_east", "roll", "pitch", "yaw", "accel_x", "accel_y", "accel_z"}) ||
        settled("gps", channels))
      return;
    const Series phi = smooth("roll", true), theta = smooth("pitch", true), psi = smooth("yaw", true);
    const Series ax = smooth("accel_x"), ay = smooth("accel_y"), az = smooth("accel_z");
    Series north(grid_.count), east(grid_.count);
    for (std::size_t k = 0; k < grid_.count; ++k) {
      const numerics::Vector3<double> acceleration = numerics::R_body_from_ned(phi[k], theta[k], psi[k]).transpose() *
                                                     numerics::Vector3<double>(ax[k], ay[k], az[k]);
      north[k] = acceleration(0);
      east[k] = acceleration(1);
    }
    // GPS is slow: both sides through one more low-pass at a rate that five fixes a second can follow.
    const double fixes = mapped_.recording.at("vel_north").rate_Hz();
    const double band = std::min(options_.band_Hz, 0.2 * fixes);
    const numerics::LowPassDesign design{.rate_Hz = grid_.rate_Hz(), .pass_Hz = band, .stop_Hz = 1.5 * band};
    const numerics::FirKernel low = numerics::low_pass(design);
    const numerics::FirKernel slope = numerics::low_pass_differentiator(design);
    compare("gps", channels, "accelerometer and attitude",
            {{numerics::filter(north, low), numerics::filter(raw("vel_north"), slope)},
             {numerics::filter(east, low), numerics::filter(raw("vel_east"), slope)}});
  }

  void flow() {
    if (!has({"airspeed", "roll", "pitch", "accel_x", "accel_y", "accel_z"})) return finish_flow_given();
    const Series Va = smooth("airspeed");
    const Series phi = smooth("roll", true), theta = smooth("pitch", true);
    const Series p = smooth("gyro_x"), q = smooth("gyro_y"), r = smooth("gyro_z");
    const Series ax = smooth("accel_x"), ay = smooth("accel_y"), az = smooth("accel_z");
    const Series alpha = has({"alpha"}) ? smooth("alpha") : Series(grid_.count, 0.0);
    const Series beta = has({"beta"}) ? smooth("beta") : Series(grid_.count, 0.0);
    Series dVa(grid_.count), dalpha(grid_.count), dbeta(grid_.count);
    for (std::size_t k = 0; k < grid_.count; ++k) {
      const double ca = std::cos(alpha[k]), sa = std::sin(alpha[k]), cb = std::cos(beta[k]), sb = std::sin(beta[k]);
      // Acceleration relative to still air in body axes, rotated into wind axes.
      const double x = ax[k] - kGravity * std::sin(theta[k]);
      const double y = ay[k] + kGravity * std::cos(theta[k]) * std::sin(phi[k]);
      const double z = az[k] + kGravity * std::cos(theta[k]) * std::cos(phi[k]);
      const double V = Va[k] > 3.0 ? Va[k] : kNaN;
      dVa[k] = x * ca * cb + y * sb + z * sa * cb;
      dalpha[k] = q[k] - std::tan(beta[k]) * (p[k] * ca + r[k] * sa) + (z * ca - x * sa) / (V * cb);
      dbeta[k] = p[k] * sa - r[k] * ca + (y * cb - x * ca * sb - z * sa * sb) / V;
    }
    if (!settled("airspeed", {"airspeed", "dynamic_pressure"})) {
      compare("airspeed", {"airspeed", "dynamic_pressure"}, "accelerometer and attitude",
              {{dVa, derivative("airspeed")}});
    }
    if (has({"alpha"}) && !settled("alpha", {"alpha"})) {
      compare("alpha", {"alpha"}, "gyro and accelerometer", {{dalpha, derivative("alpha")}});
    }
    if (has({"beta"}) && !settled("beta", {"beta"})) {
      compare("beta", {"beta"}, "gyro and accelerometer", {{dbeta, derivative("beta")}});
    }
  }

  void finish_flow_given() {
    for (const char* group : {"airspeed", "alpha", "beta"}) {
      for (const auto& [name, channels] : groups()) {
        if (name == group) static_cast<void>(settled(group, channels));
      }
    }
  }

  /// The delay of a deflection at which the angular acceleration is explained best.
  void deflections() {
    deflection("elevator", "gyro_y", {"alpha", "gyro_y", "airspeed"});
    deflection("aileron", "gyro_x", {"beta", "gyro_x", "gyro_z"});
    deflection("rudder", "gyro_z", {"beta", "gyro_x", "gyro_z"});
  }

  void deflection(const std::string& name, const char* rate, const std::vector<const char*>& motion) {
    if (!mapped_.recording.has(name) || settled(name, {name})) return;
    const Series acceleration = derivative(rate);
    const Series surface = smooth(name.c_str());
    std::vector<Series> regressors;
    for (const char* channel : motion) {
      if (mapped_.recording.has(channel)) regressors.push_back(smooth(channel));
    }
    const double step = grid_.step;
    const auto longest = static_cast<long>(options_.max_delay_s / step);
    std::vector<double> explained;
    for (long lag = -longest / 3; lag <= longest; ++lag)
      explained.push_back(share_explained(acceleration, surface, regressors, lag));
    const auto best = std::max_element(explained.begin(), explained.end()) - explained.begin();
    const long first = -longest / 3;
    DelayReport report{name, fmt::format("angular acceleration ({})", rate), 0.0, 0.0, 0.0, false, ""};
    const auto at = static_cast<std::size_t>(best);
    const double top = explained[at];
    report.correlation = std::sqrt(std::max(0.0, top));
    const double without = share_explained(acceleration, {}, regressors, 0);
    if (best == 0 || at + 1 == explained.size() || !(top > 0.3) || !(top - without > 0.05)) {
      report.text =
          top - without > 0.05 ? "not determined: no clear optimum" : "not determined: the surface explains too little";
      reports_.push_back(std::move(report));
      return;
    }
    const double left = explained[at - 1];
    const double right = explained[at + 1];
    const double curvature = left - 2.0 * top + right;
    const double part = curvature < 0.0 ? 0.5 * (left - right) / curvature : 0.0;
    report.delay_s = (static_cast<double>(first + best) + part) * step;
    if (report.delay_s < options_.min_delay_s) {
      report.text = report.delay_s < -options_.min_delay_s ? "negative: a surface cannot follow its effect, left alone"
                                                           : "too small to matter";
    } else {
      report.applied = true;
      report.text = "applied";
      // What is late here is the effect: the position is moved later, onto the clock of the motion.
      shift({name}, -report.delay_s);
    }
    reports_.push_back(std::move(report));
  }

  static double share_explained(const Series& z, const Series& surface, const std::vector<Series>& regressors,
                                long lag) {
    const auto n = static_cast<long>(z.size());
    const long stride = std::max<long>(1, n / static_cast<long>(kMaxRows));
    const auto columns = static_cast<Eigen::Index>(regressors.size() + 1 + (surface.empty() ? 0 : 1));
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(columns, columns);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(columns);
    Eigen::VectorXd row(columns);
    double squares = 0.0;
    double sum = 0.0;
    double count = 0.0;
    for (long k = 0; k < n; k += stride) {
      row(0) = 1.0;
      for (std::size_t j = 0; j < regressors.size(); ++j)
        row(static_cast<Eigen::Index>(j) + 1) = regressors[j][static_cast<std::size_t>(k)];
      if (!surface.empty()) {
        if (k - lag < 0 || k - lag >= n) continue;
        row(columns - 1) = surface[static_cast<std::size_t>(k - lag)];
      }
      const double value = z[static_cast<std::size_t>(k)];
      if (!row.allFinite() || !std::isfinite(value)) continue;
      normal += row * row.transpose();
      right += value * row;
      squares += value * value;
      sum += value;
      count += 1.0;
    }
    const double total = squares - sum * sum / std::max(1.0, count);
    if (!(count > 100.0) || !(total > 0.0)) return 0.0;
    const Eigen::VectorXd theta = normal.completeOrthogonalDecomposition().solve(right);
    return 1.0 - (squares - right.dot(theta)) / total;
  }

  MappedRecording& mapped_;
  const DelayAlignment& options_;
  numerics::UniformGrid grid_;
  numerics::FirKernel smooth_;
  numerics::FirKernel differentiate_;
  std::vector<DelayReport> reports_;
};

}  // namespace

DelayAlignment DelayAlignment::read(const StudyTable& table) {
  DelayAlignment options;
  options.automatic = table.flag_or("automatic", options.automatic);
  options.max_delay_s = table.positive_or("max", "s", options.max_delay_s);
  options.min_delay_s = table.number_or("min", "s", options.min_delay_s);
  options.band_Hz = table.positive_or("band", "Hz", options.band_Hz);
  for (const char* group : {"attitude", "gps", "airspeed", "alpha", "beta", "elevator", "aileron", "rudder"}) {
    if (table.has(group)) options.given.emplace_back(group, table.number(group, "s"));
  }
  return options;
}

std::vector<DelayReport> align_delays(MappedRecording& mapped, const DelayAlignment& options) {
  return Alignment(mapped, options).run();
}

}  // namespace veridyn::aircraft
