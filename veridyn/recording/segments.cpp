#include "veridyn/recording/segments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/rank.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::recording {
namespace {

constexpr double kRounding_s = 1e-9;
/// Blocks whose ends are nearer than this meet.
constexpr double kMeet_s = 1e-6;

/// Cuts the guard from both sides where a span meets one of another use.
void guard(std::vector<TimeSpan>& spans, const std::vector<TimeSpan>& others, double guard_s) {
  for (TimeSpan& span : spans) {
    for (const TimeSpan& other : others) {
      if (std::abs(other.end - span.begin) < kMeet_s) span.begin += guard_s;
      if (std::abs(other.begin - span.end) < kMeet_s) span.end -= guard_s;
    }
  }
}

}  // namespace

const KeyTable<SegmentOptions>& SegmentOptions::keys() {
  using O = SegmentOptions;
  static const auto table =
      KeyTable<O>("segments", "Which stretches of a recording are used, and what for.")
          .number("window", &O::window_s, "s", kPositive, "excitation is measured over this long")
          .number("merge", &O::merge_s, "s", kNotNegative, "excited stretches closer than this are one")
          .number("min_duration", &O::min_duration_s, "s", kPositive, "shorter stretches are dropped")
          .number("holdout", &O::holdout, "1", from_to(0.0, 0.8),
                  "share of the excited time that identification never sees")
          .number("block", &O::block_s, "s", kPositive,
                  "stretches are assigned to identification and hold-out in blocks of this length")
          .number("guard", &O::guard_s, "s", kNotNegative, "cut from both sides where blocks of different use meet");
  return table;
}

StudyKey spans_key(std::string name, std::string says) {
  return {std::move(name), "s", "`[10, 60, 80, 95]`: begin and end of each", "searched", std::move(says), true};
}

double total_s(std::span<const TimeSpan> spans) {
  double total = 0.0;
  for (const TimeSpan& span : spans) total += span.duration();
  return total;
}

std::vector<TimeSpan> read_spans(const StudyTable& table, std::string_view key) {
  std::vector<TimeSpan> spans;
  if (!table.has(key)) return spans;
  const std::vector<double> t = table.numbers(key, "s");
  if (t.empty() || t.size() % 2 != 0)
    table.fail(key, fmt::format("has {} numbers; must be pairs of begin and end: [10, 60, 80, 120]", t.size()));
  for (std::size_t i = 0; i < t.size(); i += 2) {
    if (!(t[i] < t[i + 1])) table.fail(key, fmt::format("segment {:g} s to {:g} s has no length", t[i], t[i + 1]));
    if (!spans.empty() && t[i] < spans.back().end)
      table.fail(key, fmt::format("holds {:g} to {:g} s and {:g} to {:g} s, which overlap or are not in order",
                                  spans.back().begin, spans.back().end, t[i], t[i + 1]));
    spans.push_back({t[i], t[i + 1]});
  }
  return spans;
}

std::vector<TimeSpan> merged(std::span<const TimeSpan> spans, double gap_s) {
  std::vector<TimeSpan> result;
  for (const TimeSpan& span : spans) {
    if (!result.empty() && span.begin - result.back().end <= gap_s) {
      result.back().end = span.end;
    } else {
      result.push_back(span);
    }
  }
  return result;
}

void drop_shorter(std::vector<TimeSpan>& spans, double least_s) {
  std::erase_if(spans,
                [&](const TimeSpan& s) { return !(s.duration() > 0.0) || s.duration() < least_s - kRounding_s; });
}

std::vector<TimeSpan> within(std::span<const TimeSpan> a, std::span<const TimeSpan> b) {
  std::vector<TimeSpan> out;
  for (const TimeSpan& x : a) {
    for (const TimeSpan& y : b) {
      const TimeSpan both{std::max(x.begin, y.begin), std::min(x.end, y.end)};
      if (both.begin < both.end) out.push_back(both);
    }
  }
  return out;
}

std::vector<double> activity(std::span<const double> x, std::size_t half) {
  std::vector<double> result(x.size(), kNaN);
  const auto first = std::find_if(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
  if (first == x.end()) return result;
  // Running sums, about a global offset so that they do not cancel.
  const double offset = *first;
  double sum = 0.0;
  double squares = 0.0;
  std::size_t count = 0;
  const auto change = [&](std::size_t i, double sign) {
    if (!std::isfinite(x[i])) return;
    const double v = x[i] - offset;
    sum += sign * v;
    squares += sign * v * v;
    count = sign > 0 ? count + 1 : count - 1;
  };
  for (std::size_t i = 0; i < std::min(half, x.size()); ++i) change(i, 1.0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (i + half < x.size()) change(i + half, 1.0);
    if (i > half) change(i - half - 1, -1.0);
    if (count <= half) continue;
    const double mean = sum / static_cast<double>(count);
    result[i] = std::sqrt(std::max(0.0, squares / static_cast<double>(count) - mean * mean));
  }
  return result;
}

std::vector<double> mean_square(std::span<const double> x, std::size_t half) {
  std::vector<double> sum(x.size() + 1, 0.0);
  for (std::size_t k = 0; k < x.size(); ++k) sum[k + 1] = sum[k] + x[k] * x[k];
  std::vector<double> result(x.size());
  for (std::size_t k = 0; k < x.size(); ++k) {
    const std::size_t from = k > half ? k - half : 0, to = std::min(x.size(), k + half + 1);
    result[k] = (sum[to] - sum[from]) / static_cast<double>(to - from);
  }
  return result;
}

double quantile_inside(std::span<const double> x, const std::vector<bool>& inside, double share) {
  std::vector<double> values;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (inside[i] && std::isfinite(x[i])) values.push_back(x[i]);
  }
  if (values.empty()) return 0.0;
  return value_of_rank(values, static_cast<std::size_t>(share * static_cast<double>(values.size() - 1)));
}

double LeastActivity::of(std::span<const double> activity, const std::vector<bool>& inside) const {
  const double lively = quantile_inside(activity, inside, 0.95), calm = quantile_inside(activity, inside, 0.2);
  return std::clamp(std::max(0.5 * lively, 2.0 * calm), least, usual);
}

std::vector<TimeSpan> blocks(const TimeSpan& span, double block_s) {
  const auto count = static_cast<std::size_t>(std::max(1.0, std::round(span.duration() / block_s)));
  const double length = span.duration() / static_cast<double>(count);
  std::vector<TimeSpan> result;
  for (std::size_t i = 0; i < count; ++i) {
    const double end = i + 1 < count ? span.begin + static_cast<double>(i + 1) * length : span.end;
    result.push_back({span.begin + static_cast<double>(i) * length, end});
  }
  return result;
}

namespace {

/// What of each input the hold-out has so far, of all that there is.
class HeldInputs {
 public:
  HeldInputs(std::span<const InputShare> inputs, std::span<const TimeSpan> excited)
      : inputs_(inputs), total_(inputs.size(), 0.0), held_(inputs.size(), 0.0) {
    for (std::size_t i = 0; i < inputs.size(); ++i)
      for (const TimeSpan& span : excited) total_[i] += inputs[i](span);
  }

  /// Whether half of each input is left without the block too, which is then held.
  bool hold(const TimeSpan& block) {
    constexpr double kMost = 0.5;
    std::vector<double> held = held_;
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
      held[i] += inputs_[i](block);
      if (held[i] > kMost * total_[i]) return false;
    }
    held_ = std::move(held);
    return true;
  }

 private:
  std::span<const InputShare> inputs_;
  std::vector<double> total_, held_;
};

}  // namespace

AssignedBlocks assign_blocks(std::span<const TimeSpan> excited, const SegmentOptions& options, Neighbours neighbours,
                             double least_s, std::span<const InputShare> inputs) {
  AssignedBlocks out;
  HeldInputs of_holdout(inputs, excited);
  double total = 0.0, held = 0.0;
  for (const TimeSpan& span : excited) {
    bool before_held = false;
    bool first = true;
    for (const TimeSpan& block : blocks(span, options.block_s)) {
      const double length = block.duration();
      // Without a block of identification there is nothing to hold against the hold-out.
      const bool hold = options.holdout > 0.0 && total > 0.0 &&
                        held + 0.5 * length <= options.holdout * (total + length) - kRounding_s &&
                        of_holdout.hold(block);
      std::vector<TimeSpan>& list = hold ? out.holdout : out.identification;
      if (neighbours == Neighbours::kJoined && !first && hold == before_held) {
        list.back().end = block.end;
      } else {
        list.push_back(block);
      }
      total += length;
      if (hold) held += length;
      before_held = hold;
      first = false;
    }
  }
  const std::vector<TimeSpan> identification = out.identification;
  guard(out.identification, out.holdout, options.guard_s);
  guard(out.holdout, identification, options.guard_s);
  drop_shorter(out.identification, least_s);
  drop_shorter(out.holdout, least_s);
  return out;
}

}  // namespace veridyn::recording
