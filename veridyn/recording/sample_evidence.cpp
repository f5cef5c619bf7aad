#include "veridyn/recording/sample_evidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/numerics/resample.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::recording {
namespace {

using estimation::Cause;
using estimation::Check;
using estimation::Evidence;
using estimation::info_of;
using estimation::Outcome;
using estimation::row_of;

constexpr std::size_t kFewestSamples = 100;
/// A sensor that is moved does not show the same value for so long [s]; a control may.
constexpr double kRestsFor_s = 2.0;
constexpr double kControlRestsFor_s = 30.0;
/// Samples that a held value has at least, and the share of all samples that are held equally long.
constexpr std::size_t kHeld = 3;
constexpr double kShareAlike = 0.8;

/// A spike stands out of both its neighbours by so many times what samples around it do.
constexpr double kSpike = 12.0;
/// Less of the channel's range than this does no harm.
constexpr double kSpikeOfRange = 0.05;
constexpr std::size_t kFewestSpikes = 3;

/// Samples in a row with one value.
struct Run {
  double value, begin, end;
  std::size_t samples;
};

std::vector<Run> runs_of(const Channel& channel, std::span<const TimeSpan> spans) {
  std::vector<Run> runs;
  const std::span<const double> times = channel.times();
  for (const TimeSpan& span : spans) {
    bool fresh = true;
    for (auto i = static_cast<std::size_t>(std::ranges::lower_bound(times, span.begin) - times.begin());
         i < channel.size() && times[i] <= span.end; ++i) {
      const double v = channel.value[i];
      if (!std::isfinite(v)) continue;
      if (fresh || v != runs.back().value)
        runs.push_back({v, times[i], times[i], 1});
      else
        runs.back().end = times[i], ++runs.back().samples;
      fresh = false;
    }
  }
  return runs;
}

/// Length in samples of the runs that a sample typically lies in, rests left out.
std::size_t typical_length(const std::vector<Run>& runs) {
  std::vector<std::size_t> lengths;
  std::size_t samples = 0;
  for (const Run& run : runs) {
    if (run.end - run.begin > kRestsFor_s) continue;
    lengths.push_back(run.samples);
    samples += run.samples;
  }
  std::ranges::sort(lengths);
  std::size_t below = 0;
  for (const std::size_t length : lengths) {
    below += length;
    if (2 * below >= samples) return length;
  }
  return 1;
}

/// View of a channel and of what its kind is, with its runs.
struct Sampled {
  const SampledChannel* which = nullptr;
  const Channel* channel = nullptr;
  double rate_Hz = 0.0;
  std::vector<Run> runs;
  std::size_t samples = 0;
  std::size_t typical = 1;  ///< length of a run, in samples
};

/// Whether most other sensors change in a stretch: an aircraft in smooth air may really stand still.
bool others_move(const std::vector<Sampled>& all, const Sampled& still, double begin, double end) {
  constexpr double kOfItsRange = 0.1;
  std::size_t moving = 0, resting = 0;
  for (const Sampled& other : all) {
    if (&other == &still || other.which->may_rest()) continue;
    const auto first = std::ranges::lower_bound(other.runs, begin, {}, &Run::begin);
    const auto last = std::ranges::lower_bound(other.runs, end, {}, &Run::begin);
    const auto [low, high] = std::ranges::minmax(other.runs, {}, &Run::value);
    bool moves = false;
    if (last - first > 1) {
      const auto [least, most] = std::ranges::minmax(std::span(first, last), {}, &Run::value);
      moves = most.value - least.value > kOfItsRange * (high.value - low.value);
    }
    (moves ? moving : resting) += 1;
  }
  return moving > resting;
}

std::optional<Evidence> stands_still(const Sampled& channel, const std::vector<Sampled>& all) {
  const SampledChannel& which = *channel.which;
  if (which.rest == Rest::kNone) return std::nullopt;
  const Run& longest = *std::ranges::max_element(channel.runs, {}, &Run::samples);
  const double limit = which.may_rest() ? kControlRestsFor_s : kRestsFor_s;
  if (!(longest.end - longest.begin > limit) || longest.samples < 10 * channel.typical) return std::nullopt;
  if (which.may_rest() && channel.typical >= kHeld) return std::nullopt;
  // Exactly zero is what a simulated or decoupled motion may be.
  if (longest.value == 0.0) return std::nullopt;
  if (!others_move(all, channel, longest.begin, longest.end)) return std::nullopt;
  // A speed that is the same all the time is a simulation's.
  const bool allowed = which.rest == Rest::kControl || (which.may_rest() && channel.runs.size() == 1);
  Evidence row = row_of(Check::kFrozenSamples, which.about, allowed ? Outcome::kNotVerified : Outcome::kFailed);
  row.cause = allowed ? Cause::kExcitation : Cause::kFrozen;
  row.value = longest.end - longest.begin;
  row.limit = limit;
  return std::move(row).with("channel", which.channel).with("begin", longest.begin).with("end", longest.end);
}

std::optional<Evidence> is_held(const Sampled& channel) {
  constexpr std::size_t kFewestRuns = 10;
  const auto& [which, recorded, rate_Hz, runs, samples, typical] = channel;
  if (typical < kHeld || runs.size() < kFewestRuns) return std::nullopt;
  std::size_t alike = 0;
  for (const Run& run : runs)
    if (run.samples + 1 >= typical && run.samples <= typical + 1) alike += run.samples;
  if (!(static_cast<double>(alike) > kShareAlike * static_cast<double>(samples))) return std::nullopt;
  const double measured_Hz = rate_Hz / static_cast<double>(typical);
  Evidence row = row_of(Check::kHeldSamples, which->about, static_cast<double>(typical));
  row.cause = Cause::kHeld;
  return std::move(row).with("channel", which->channel).with("rate_Hz", measured_Hz);
}

std::optional<Evidence> is_clipped(const Sampled& channel) {
  const auto& [which, recorded, rate_Hz, runs, samples, typical] = channel;
  if (which->may_rest() || typical >= kHeld) return std::nullopt;
  const auto [low, high] = std::ranges::minmax(runs, {}, &Run::value);
  double share = 0.0, end = kNaN;
  for (const double value : {low.value, high.value}) {
    std::size_t there = 0;
    for (const Run& run : runs)
      if (run.value == value && run.samples >= kHeld) there += run.samples;
    const double of_all = static_cast<double>(there) / static_cast<double>(samples);
    if (of_all > share) {
      share = of_all;
      end = value;
    }
  }
  Evidence row = row_of(Check::kClippedSamples, which->about, share);
  if (row.passed()) return std::nullopt;
  row.cause = Cause::kSaturation;
  return std::move(row).with("channel", which->channel).with("end_of_range", end);
}

/// Between any two of every `stride`-th value; infinite when there is only one.
double smallest_step_of(const std::vector<Run>& runs, std::size_t stride) {
  std::vector<double> values;
  for (std::size_t i = 0; i < runs.size(); i += stride) values.push_back(runs[i].value);
  std::ranges::sort(values);
  double step = kInfinity;
  for (std::size_t i = 1; i < values.size(); ++i)
    if (values[i] > values[i - 1]) step = std::min(step, values[i] - values[i - 1]);
  return step;
}

/// Between any two values; infinite when there is only one. Where a few thousand of them come as close as `enough`,
/// that of these: hours of noise need not be sorted to know that they are not coarse.
double smallest_step(const std::vector<Run>& runs, double enough) {
  constexpr std::size_t kRunsTaken = 4096;
  if (runs.size() > 2 * kRunsTaken) {
    const double step = smallest_step_of(runs, runs.size() / kRunsTaken);
    if (step <= enough) return step;
  }
  return smallest_step_of(runs, 1);
}

std::optional<Evidence> is_coarse(const Sampled& channel) {
  const std::vector<Run>& runs = channel.runs;
  if (channel.which->may_rest()) return std::nullopt;
  double sum = 0.0, squares = 0.0;
  for (const Run& run : runs) {
    sum += run.value;
    squares += run.value * run.value;
  }
  const auto n = static_cast<double>(runs.size());
  const double deviation = std::sqrt(std::max(0.0, squares / n - sum * sum / (n * n)));
  const double step = smallest_step(runs, deviation / info_of(Check::kCoarseSamples).tolerance.low);
  if (!std::isfinite(step)) return std::nullopt;
  Evidence row = row_of(Check::kCoarseSamples, channel.which->about, deviation / step);
  if (row.passed()) return std::nullopt;
  row.cause = Cause::kResolution;
  return std::move(row).with("channel", channel.which->channel).with("step", step).with("deviation", deviation);
}

/// Indices of samples that stand alone: by more than `least` from the middle between their neighbours, which are near
/// each other, and by many times what samples there and everywhere are.
std::vector<std::size_t> spikes_in(std::span<const double> x, double least) {
  constexpr std::ptrdiff_t kAround = 50;
  std::vector<double> deviation(x.size(), 0.0);
  for (std::size_t i = 1; i + 1 < x.size(); ++i) {
    const double d = std::abs(x[i] - 0.5 * (x[i - 1] + x[i + 1]));
    deviation[i] = std::isfinite(d) ? d : 0.0;
  }
  const double limit = std::max(least, kSpike * numerics::median(deviation));
  std::vector<std::size_t> found;
  for (std::size_t i = 1; i + 1 < x.size(); ++i) {
    if (!(deviation[i] > limit) || std::abs(x[i + 1] - x[i - 1]) > 0.5 * deviation[i]) continue;
    // Vibration comes and goes: what samples do before or after counts too.
    const auto here = deviation.begin() + i;
    const auto before = std::min<std::ptrdiff_t>(kAround, here - deviation.begin());
    const auto after = std::min<std::ptrdiff_t>(kAround, deviation.end() - here);
    const double nearby = std::max(numerics::median({here - before, here}), numerics::median({here, here + after}));
    if (deviation[i] > kSpike * nearby) found.push_back(i);
  }
  return found;
}

std::optional<Evidence> has_spikes(const Sampled& sampled, std::span<const TimeSpan> spans) {
  if (sampled.typical >= kHeld) return std::nullopt;
  const auto [low, high] = std::ranges::minmax(sampled.runs, {}, &Run::value);
  const double of_range = kSpikeOfRange * (high.value - low.value);
  const double least = std::max(of_range, 3.0 * smallest_step(sampled.runs, of_range / 3.0));
  const std::span<const double> times = sampled.channel->times();
  std::vector<double> at;
  for (const TimeSpan& span : spans) {
    const auto first = std::ranges::lower_bound(times, span.begin) - times.begin();
    const auto last = std::ranges::upper_bound(times, span.end) - times.begin();
    if (last <= first) continue;
    const double* const value = sampled.channel->value.data();
    std::vector<double> x(value + first, value + last);
    // A heading that passes +-180 deg does not jump.
    if (sampled.channel->unit.si_name() == "rad") numerics::unwrap_angles(x);
    for (const std::size_t i : spikes_in(x, least)) at.push_back(times[first + i]);
  }
  const double share = static_cast<double>(at.size()) / static_cast<double>(sampled.samples);
  Evidence row = row_of(Check::kSpikes, sampled.which->about, share);
  if (at.size() < kFewestSpikes || row.passed()) return std::nullopt;
  row.cause = Cause::kSpikes;
  return std::move(row)
      .with("channel", sampled.which->channel)
      .with("samples", static_cast<double>(at.size()))
      .with("first", at.front());
}

}  // namespace

std::vector<Evidence> sample_evidence(const Recording& recording, std::span<const SampledChannel> channels,
                                      std::span<const TimeSpan> spans, int threads) {
  std::vector<Sampled> found(channels.size());
  numerics::parallel_for(channels.size(), threads, [&](std::size_t i) {
    const Channel* channel = recording.find(channels[i].channel);
    if (channel == nullptr) return;
    Sampled& sampled = found[i];
    sampled = {
        .which = &channels[i], .channel = channel, .rate_Hz = channel->rate_Hz(), .runs = runs_of(*channel, spans)};
    for (const Run& run : sampled.runs) sampled.samples += run.samples;
    if (sampled.samples >= kFewestSamples) sampled.typical = typical_length(sampled.runs);
  });
  std::erase_if(found, [](const Sampled& sampled) { return sampled.samples < kFewestSamples; });
  const std::vector<Sampled>& all = found;
  std::vector<std::array<std::optional<Evidence>, 5>> flaws(all.size());
  numerics::parallel_for(all.size(), threads, [&](std::size_t i) {
    const Sampled& sampled = all[i];
    flaws[i] = {stands_still(sampled, all), is_held(sampled), is_clipped(sampled), is_coarse(sampled),
                has_spikes(sampled, spans)};
  });
  std::vector<Evidence> rows;
  for (std::array<std::optional<Evidence>, 5>& of_channel : flaws)
    for (std::optional<Evidence>& flaw : of_channel)
      if (flaw) rows.push_back(std::move(*flaw));
  if (rows.empty() && !all.empty()) {
    Evidence row = row_of(Check::kSamples, "recording", Outcome::kPassed);
    row.value = 0.0;
    rows.push_back(std::move(row).with("channels", static_cast<double>(all.size())));
  }
  return rows;
}

}  // namespace veridyn::recording
