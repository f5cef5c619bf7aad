#include "veridyn/recording/delays.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/numerics/delay.hpp"
#include "veridyn/recording/grid_signals.hpp"

namespace veridyn::recording {
namespace {

/// A shorter recording shows too little of any delay [s].
constexpr double kShortest_s = 10.0;

numerics::LowPassDesign design(double rate_Hz, double band_Hz) {
  return {.rate_Hz = rate_Hz, .pass_Hz = band_Hz, .stop_Hz = 1.5 * band_Hz};
}

/// How far disturbances that are answered may shift a delay [s], see `shared_delay`.
double bias_by_answers(const std::vector<DelayPair>& pairs, const numerics::DelayEstimate& found) {
  /// How well a noise floor is known.
  constexpr double kNoiseDoubt = 0.1;
  /// An answer that is larger than the disturbance, as of a badly damped Dutch roll.
  constexpr double kAmplified = 2.0;
  double noise = 0.0, power = 0.0;
  bool answered = false;
  for (const DelayPair& pair : pairs) {
    answered = answered || pair.noise_variance.has_value();
    for (const double v : pair.observed) {
      if (!std::isfinite(v)) continue;
      power += v * v;
      noise += pair.noise_variance.value_or(0.0);
    }
  }
  const double c2 = found.correlation * found.correlation;
  if (!answered || !(c2 > 0.0) || !(power > 0.0) || !(found.bandwidth_rad_s > 0.0)) return 0.0;
  const double share = std::max(1.0 - c2 - noise / power, kNoiseDoubt * noise / power);
  return kAmplified * share / (c2 * found.bandwidth_rad_s);
}

}  // namespace

DelayFinding finding_of_small(double least_s, const DelayOptions& options) {
  return least_s > kDelayMatters_s && least_s > options.min_delay_s ? DelayFinding::kWide : DelayFinding::kSmall;
}

namespace {

std::string says_of_finding(const DelayReport& report) {
  switch (report.finding) {
    case DelayFinding::kApplied:
      return "applied";
    case DelayFinding::kGiven:
      return "given in the study";
    case DelayFinding::kSmall:
      return "too small to matter";
    case DelayFinding::kBeforeCause:
      return fmt::format("negative: a {} cannot follow its effect, left alone", report.kind);
    case DelayFinding::kOppositeSign:
      return "opposite sign: is the channel's sign right?";
    case DelayFinding::kWide:
      return fmt::format("not determined: {:.3f} +- {:.3f} s", report.delay_s, report.sigma_s);
    case DelayFinding::kInDoubt:
      return fmt::format("not determined: {:.3f} +- {:.3f} s fits best, but the {} explains less than what is left",
                         report.delay_s, report.sigma_s, report.kind);
    case DelayFinding::kLittleExplained:
      return fmt::format("not determined: the {} explains too little", report.kind);
    case DelayFinding::kNoneAsGood:
      return "not determined: no delay fits as well";
    case DelayFinding::kNoOptimum:
      return "not determined: no clear optimum";
    case DelayFinding::kNoPeak:
    case DelayFinding::kAtEnd:
      return fmt::format("not determined: {}", report.why);
    case DelayFinding::kSlow:
      return fmt::format("not determined: fewer than {:g} samples a second", kSlowestDelayed_Hz);
    case DelayFinding::kInterrupted:
      return "not determined: interrupted";
  }
  return {};
}

}  // namespace

std::string says(const DelayReport& report) {
  std::string text = says_of_finding(report);
  if (report.contradicted_by)
    text += fmt::format("; by {} it would be {:.3f} +- {:.3f} s", report.contradicted_by->reference,
                        report.contradicted_by->delay_s, report.contradicted_by->sigma_s);
  if (!report.together.empty())
    text += fmt::format("; one delay for {}, which move together", fmt::join(report.together, " and "));
  return text;
}

KeyTable<DelayOptions> DelayOptions::keys(const std::vector<DelayGroup>& groups) {
  using O = DelayOptions;
  KeyTable<O> table("delays", "How sensors are brought onto one clock.");
  table.flag("automatic", &O::automatic, "delays are estimated and removed; `false`: only those that the study gives")
      .number("max", &O::max_delay_s, "s", kPositive, "searched up to here")
      .number("min", &O::min_delay_s, "s", kAnyNumber, "smaller ones are left alone")
      .number("band", &O::band_Hz, "Hz", kPositive, "signals are compared below this frequency");
  for (const DelayGroup& group : groups)
    table.other(
        {group.name, "s", "", "estimated", fmt::format("of {}", fmt::join(group.channels, ", ")), true},
        [](const StudyTable& t, const std::string& key, O& o) { o.given.emplace_back(key, t.number(key, "s")); });
  return table;
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
  std::vector<double> expected, doubted, observed;
  bool in_doubt = false;
  const auto hole = static_cast<std::size_t>(2.0 * options.max_delay_s * rate_Hz) + 1;
  const auto append = [&](std::vector<double>& to, const std::vector<double>& x) {
    to.insert(to.end(), x.begin(), x.end());
    to.insert(to.end(), hole, kNaN);
  };
  for (const DelayPair& pair : pairs) {
    append(expected, pair.expected);
    append(observed, pair.observed);
    append(doubted, pair.doubted.empty() ? pair.expected : pair.doubted);
    in_doubt = in_doubt || !pair.doubted.empty();
  }
  const auto search = [&](const std::vector<double>& reference_signal) {
    return numerics::estimate_delay(reference_signal, observed, rate_Hz, {.max_delay_s = options.max_delay_s});
  };
  const numerics::DelayEstimate found = search(expected);
  const double doubt = in_doubt ? search(doubted).delay_s - found.delay_s : 0.0;
  const double sigma = std::hypot(found.sigma_s, doubt, bias_by_answers(pairs, found));
  DelayReport report{std::move(group), std::move(reference), found.delay_s, sigma, found.correlation};
  const double least = std::max(options.min_delay_s, estimation::kBeyondChance * sigma);
  // What correlates little has no sign either: of a vane that shows gusts the aircraft's answer is the opposite.
  if (!found.determined) {
    report.finding = found.at_end ? DelayFinding::kAtEnd : DelayFinding::kNoPeak;
    report.why = found.reason;
  } else if (found.correlation < 0.0) {
    report.finding = DelayFinding::kOppositeSign;
  } else if (std::abs(found.delay_s) < least) {
    report.finding = finding_of_small(least, options);
  } else {
    report.finding = DelayFinding::kApplied;
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
  return DelayReport{group.name, "study", *delay, 0.0, 0.0, DelayFinding::kGiven};
}

}  // namespace veridyn::recording
