#include "veridyn/recording/delays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/delay.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/recording/grid_signals.hpp"

namespace veridyn::recording {
namespace {

/// A shorter recording shows too little of any delay [s].
constexpr double kShortest_s = 10.0;
/// Rows that the search for an effect's delay looks at: five minutes at 100 Hz are plenty.
constexpr std::size_t kMostRows = 30000;
/// Share of the effect that must be explained, and how much of that by the cause: never less than what is left.
constexpr double kLeastExplained = 0.3;
constexpr double kLeastByCause = 0.05;

/// Of the rows that the search looks at.
long stride_of(const std::vector<double>& z) {
  return std::max<long>(1, static_cast<long>(z.size()) / static_cast<long>(kMostRows));
}

numerics::LowPassDesign design(double rate_Hz, double band_Hz) {
  return {.rate_Hz = rate_Hz, .pass_Hz = band_Hz, .stop_Hz = 1.5 * band_Hz};
}

/// What a constant, `others` and the cause `lag` samples before leave of an effect.
struct Explained {
  double share = 0.0;       ///< of the effect's variance
  double with_noise = 0.0;  ///< the same by what is recorded, noise and all: less
  double rows = 0.0;        ///< that were used
};

Explained explained_by(const std::vector<double>& z, const Explanatory& cause, const std::vector<Explanatory>& others,
                       long lag) {
  const auto n = static_cast<long>(z.size());
  const long stride = stride_of(z);
  const auto columns = static_cast<Eigen::Index>(others.size() + 1 + (cause.value.empty() ? 0 : 1));
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(columns, columns);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(columns);
  Eigen::VectorXd row(columns);
  double squares = 0.0;
  double sum = 0.0;
  double count = 0.0;
  for (long k = 0; k < n; k += stride) {
    row(0) = 1.0;
    for (std::size_t j = 0; j < others.size(); ++j)
      row(static_cast<Eigen::Index>(j) + 1) = others[j].value[static_cast<std::size_t>(k)];
    if (!cause.value.empty()) {
      if (k - lag < 0 || k - lag >= n) continue;
      row(columns - 1) = cause.value[static_cast<std::size_t>(k - lag)];
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
  if (!(count > 100.0) || !(total > 0.0)) return {};
  const auto share = [&] {
    return 1.0 - (squares - right.dot(numerics::shortest_least_squares(normal, right))) / total;
  };
  const double with_noise = share();
  const auto take_off_noise = [&](Eigen::Index j, double variance) {
    // At least half of it is signal, or the noise is not what it was taken for.
    normal(j, j) = std::max(normal(j, j) - count * variance, 0.5 * normal(j, j));
  };
  for (std::size_t j = 0; j < others.size(); ++j)
    take_off_noise(static_cast<Eigen::Index>(j) + 1, others[j].noise_variance);
  if (!cause.value.empty()) take_off_noise(columns - 1, cause.noise_variance);
  return {share(), with_noise, count};
}

}  // namespace

void DelayOptions::read_keys(const StudyTable& table, const std::vector<DelayGroup>& groups) {
  automatic = table.flag_or("automatic", automatic);
  max_delay_s = table.positive_or("max", "s", max_delay_s);
  min_delay_s = table.number_or("min", "s", min_delay_s);
  band_Hz = table.positive_or("band", "Hz", band_Hz);
  for (const DelayGroup& group : groups) {
    if (table.has(group.name)) given.emplace_back(group.name, table.number(group.name, "s"));
  }
}

std::optional<double> DelayOptions::given_for(std::string_view group) const {
  for (const auto& [name, delay_s] : given) {
    if (name == group) return delay_s;
  }
  return std::nullopt;
}

std::optional<BandLimited> BandLimited::around(const Channel& reference, double band_Hz) {
  const double rate = grid_rate(reference);
  const TimeSpan whole = reference.span();
  if (!(rate >= 4.0 * band_Hz) || whole.duration() < kShortest_s) return std::nullopt;
  const double middle = 0.5 * (whole.begin + whole.end);
  const double half = 0.5 * std::min(whole.duration(), kLongestDelaySearch_s);
  return BandLimited(numerics::UniformGrid::covering(middle - half, middle + half, 1.0 / rate), band_Hz);
}

BandLimited::BandLimited(const numerics::UniformGrid& grid, double band_Hz) : grid_(grid) {
  const auto [smooth, differentiate] = kernels(band_Hz);
  smooth_ = smooth;
  differentiate_ = differentiate;
}

std::pair<numerics::FirKernel, numerics::FirKernel> BandLimited::kernels(double band_Hz) const {
  const numerics::LowPassDesign band = design(grid_.rate_Hz(), band_Hz);
  return {numerics::low_pass(band), numerics::low_pass_differentiator(band)};
}

BandLimited::Series BandLimited::raw(const Channel& channel) const { return on_grid(channel, grid_); }

double BandLimited::noise_variance(const Channel& channel) const {
  const double sd = noise_floor(channel);
  // A channel slower than the grid was interpolated: more of its noise lies in the band.
  return sd * sd * smooth_.noise_gain() * std::max(1.0, rate_Hz() / channel.rate_Hz());
}

BandLimited::Series BandLimited::smooth_angle(const Channel& channel) const {
  return numerics::filter(angle_on_grid(channel, grid_), smooth_);
}

BandLimited::Series BandLimited::angle_derivative(const Channel& channel) const {
  return numerics::filter(angle_on_grid(channel, grid_), differentiate_);
}

DelayReport shared_delay(std::string group, std::string reference, const std::vector<DelayPair>& pairs, double rate_Hz,
                         const DelayOptions& options) {
  // Laid end to end, with a hole between them that is longer than any shift.
  std::vector<double> expected, observed;
  const auto hole = static_cast<std::size_t>(2.0 * options.max_delay_s * rate_Hz) + 1;
  for (const DelayPair& pair : pairs) {
    expected.insert(expected.end(), pair.expected.begin(), pair.expected.end());
    observed.insert(observed.end(), pair.observed.begin(), pair.observed.end());
    expected.insert(expected.end(), hole, kNaN);
    observed.insert(observed.end(), hole, kNaN);
  }
  const numerics::DelayEstimate found =
      numerics::estimate_delay(expected, observed, rate_Hz, {.max_delay_s = options.max_delay_s});
  DelayReport report{
      std::move(group), std::move(reference), found.delay_s, found.sigma_s, found.correlation, false, ""};
  if (found.correlation < 0.0) {
    report.text = "opposite sign: is the channel's sign right?";
  } else if (!found.determined) {
    report.text = fmt::format("not determined: {}", found.reason);
  } else if (std::abs(found.delay_s) < std::max(options.min_delay_s, 3.0 * found.sigma_s)) {
    report.text = "too small to matter";
  } else {
    report.applied = true;
    report.text = "applied";
  }
  return report;
}

DelayReport effect_delay(std::string cause_name, std::string effect_name, const std::vector<double>& effect,
                         const Explanatory& cause, const std::vector<Explanatory>& others, double step_s,
                         const DelayOptions& options, const Progress& progress, std::string_view kind) {
  DelayReport report{std::move(cause_name), std::move(effect_name), 0.0, 0.0, 0.0, false, ""};
  const auto longest = static_cast<long>(options.max_delay_s / step_s);
  const long first = -longest / 3;
  std::vector<Explained> explained;
  for (long lag = first; lag <= longest; ++lag) {
    if (progress.interrupted()) {
      report.text = "not determined: interrupted";
      return report;
    }
    explained.push_back(explained_by(effect, cause, others, lag));
  }
  const auto best = std::ranges::max_element(explained, {}, &Explained::share) - explained.begin();
  const auto at = static_cast<std::size_t>(best);
  const double top = explained[at].share;
  report.correlation = std::sqrt(std::clamp(top, 0.0, 1.0));
  const double without = explained_by(effect, {}, others, 0).share;
  const bool by_cause = top - without > std::max(kLeastByCause, 1.0 - top);
  if (best == 0 && top > kLeastExplained && by_cause) {
    report.delay_s = static_cast<double>(first) * step_s;
    report.text = fmt::format("negative, as far as was searched: a {} cannot follow its effect, left alone", kind);
    return report;
  }
  if (best == 0 || at + 1 == explained.size() || !(top > kLeastExplained) || !by_cause) {
    report.text =
        by_cause ? "not determined: no clear optimum" : fmt::format("not determined: the {} explains too little", kind);
    return report;
  }
  const double left = explained[at - 1].share;
  const double right = explained[at + 1].share;
  const double curvature = left - 2.0 * top + right;
  const double part = curvature < 0.0 ? 0.5 * (left - right) / curvature : 0.0;
  report.delay_s = (static_cast<double>(first + best) + part) * step_s;
  // Of least squares: twice the residual variance of an independent row over the second derivative of their sum, where
  // two rows a period of the band's edge are independent.
  const double independent = std::min(
      explained[at].rows, explained[at].rows * 2.0 * options.band_Hz * step_s * static_cast<double>(stride_of(effect)));
  // A cause that jumps between two samples, as a servo without lag does, is known to half a sample.
  constexpr double kOfASample = 0.5;
  report.sigma_s = step_s * std::hypot(kOfASample, std::sqrt((1.0 - explained[at].with_noise) * 2.0 /
                                                             (std::max(-curvature, 1e-300) * independent)));
  const double least = std::max(options.min_delay_s, 3.0 * report.sigma_s);
  if (report.delay_s < -least) {
    report.text = fmt::format("negative: a {} cannot follow its effect, left alone", kind);
  } else if (report.delay_s < least) {
    report.text = "too small to matter";
  } else {
    report.applied = true;
    report.text = "applied";
  }
  return report;
}

bool take_off_delay(Recording& recording, const std::vector<std::string>& channels, double delay_s) {
  bool any = false;
  for (const std::string& name : channels) {
    const Channel* channel = recording.find(name);
    if (channel == nullptr) continue;
    any = true;
    Channel moved = *channel;
    std::vector<double> stamps(moved.times().begin(), moved.times().end());
    for (double& t : stamps) t -= delay_s;
    moved.time = make_time_base(std::move(stamps));
    recording.set(std::move(moved));
  }
  return any;
}

std::optional<DelayReport> take_off_given(Recording& recording, const DelayGroup& group, const DelayOptions& options) {
  const std::optional<double> delay = options.given_for(group.name);
  if (!delay || !take_off_delay(recording, group.channels, *delay)) return std::nullopt;
  return DelayReport{group.name, "study", *delay, 0.0, 0.0, true, "given in the study"};
}

}  // namespace veridyn::recording
