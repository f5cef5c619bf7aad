#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/numerics/resample.hpp"

namespace veridyn::recording {

/// How every domain chooses excited stretches of a recording. Study table `[segments]`; every key is optional.
struct SegmentOptions {
  double window_s = 4.0;
  double merge_s = 3.0;
  double min_duration_s = 3.0;
  double holdout = 1.0 / 3.0;
  double block_s = 10.0;
  double guard_s = 0.5;

  [[nodiscard]] static const KeyTable<SegmentOptions>& keys();
};

/// Excited stretches of a recording and how they are used.
struct Segments {
  std::vector<TimeSpan> excited;
  std::vector<TimeSpan> identification;  ///< blocks used to identify
  std::vector<TimeSpan> holdout;         ///< blocks that identification never uses
  bool given = false;                    ///< by the user
  std::string text;                      ///< one sentence for the report
};

/// Sum of the durations [s].
[[nodiscard]] double total_s(std::span<const TimeSpan> spans);

/// `key = [10, 60, 80, 95]`: begin and end of each [s]; none when the key is missing.
/// @throws InputError for an odd number of values, a span without length, spans that overlap or are not in order.
[[nodiscard]] std::vector<TimeSpan> read_spans(const StudyTable& table, std::string_view key);
/// Such a key of a table of keys, for stretches that are given instead of searched.
[[nodiscard]] StudyKey spans_key(std::string name, std::string says);

/// Maximal stretches of samples for which `holds(k)`; one sample alone is a stretch without length.
template <typename Predicate>
[[nodiscard]] std::vector<TimeSpan> stretches(const numerics::UniformGrid& grid, std::size_t count, Predicate holds) {
  std::vector<TimeSpan> found;
  bool open = false;
  for (std::size_t k = 0; k < count; ++k) {
    const bool now = holds(k);
    if (now && !open) found.push_back({grid.at(k), grid.at(k)});
    if (now) found.back().end = grid.at(k);
    open = now;
  }
  return found;
}

/// Spans in order, those with at most `gap_s` between them joined.
[[nodiscard]] std::vector<TimeSpan> merged(std::span<const TimeSpan> spans, double gap_s);

/// Removes spans shorter than `least_s` by more than a nanosecond, and those without length.
void drop_shorter(std::vector<TimeSpan>& spans, double least_s);

/// The parts of `a` within `b`.
[[nodiscard]] std::vector<TimeSpan> within(std::span<const TimeSpan> a, std::span<const TimeSpan> b);

/// Root mean square of x about its mean over a window of `half` samples to either side; NaN where no more than half of
/// the window is there.
[[nodiscard]] std::vector<double> activity(std::span<const double> x, std::size_t half);

/// Mean of x^2 over a window of `half` samples to either side, at the ends over what there is of it. x must be finite.
[[nodiscard]] std::vector<double> mean_square(std::span<const double> x, std::size_t half);

/// The value that the share `share` of the finite x does not exceed, of the samples `inside`; 0 where there are none.
[[nodiscard]] double quantile_inside(std::span<const double> x, const std::vector<bool>& inside, double share);

/// From which activity on a stretch counts as excited: from `usual` on, and in a recording that is gentle throughout
/// from less, down to `least`.
struct LeastActivity {
  double usual = 0.0, least = 0.0;

  /// Half of what the most active twentieth of the samples `inside` exceeds, but twice what the calmest fifth does not
  /// (noise alone excites nothing), between `least` and `usual`.
  [[nodiscard]] double of(std::span<const double> activity, const std::vector<bool>& inside) const;
};

/// A span cut into equal blocks, as many as make their length nearest to `block_s`; at least one.
[[nodiscard]] std::vector<TimeSpan> blocks(const TimeSpan& span, double block_s);

/// What becomes of neighbouring blocks of the same use.
enum class Neighbours {
  kJoined,
  kSeparate  ///< each gets an initial state, which keeps simulations short
};

/// Blocks by their use.
struct AssignedBlocks {
  std::vector<TimeSpan> identification, holdout;
};

/// How much a span has of an input that must be identified from: the integral of its square, say.
using InputShare = std::function<double(const TimeSpan&)>;

/// Assigns every excited stretch in blocks to identification and hold-out, in turn, so that both see the recording's
/// beginning and end and every manoeuvre that is repeated. The share of the hold-out, counted over the whole recording,
/// is kept as closely as whole blocks allow; the first block is for identification, and so is one without which less
/// than half of one of `inputs` would be left to identify from. Where blocks of different use meet,
/// both are shortened by the guard; what is left shorter than `least_s` is dropped.
[[nodiscard]] AssignedBlocks assign_blocks(std::span<const TimeSpan> excited, const SegmentOptions& options,
                                           Neighbours neighbours, double least_s,
                                           std::span<const InputShare> inputs = {});

}  // namespace veridyn::recording
