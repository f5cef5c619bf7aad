#include "veridyn/aircraft/identification/segments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace veridyn::aircraft {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegree = std::numbers::pi / 180.0;

/// Stretches of samples for which `inside` holds.
template <typename Predicate>
std::vector<TimeSpan> stretches(const SegmentSignals& signals, std::size_t count, Predicate inside) {
  std::vector<TimeSpan> found;
  bool open = false;
  for (std::size_t i = 0; i <= count; ++i) {
    const bool now = i < count && inside(i);
    const double t = signals.begin + signals.step * static_cast<double>(i);
    if (now && !open) found.push_back({t, t});
    if (now) found.back().end = t;
    open = now;
  }
  return found;
}

std::vector<TimeSpan> merged(const std::vector<TimeSpan>& spans, double gap_s) {
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

void drop_shorter(std::vector<TimeSpan>& spans, double duration_s) {
  std::erase_if(spans, [&](const TimeSpan& span) { return span.duration() < duration_s; });
}

/// RMS about the mean over a centred window, NaN where less than half of the window is there. Running sums, about a
/// global offset so that they do not cancel.
std::vector<double> activity(std::span<const double> x, std::size_t half) {
  std::vector<double> result(x.size(), kNaN);
  const auto first = std::find_if(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
  if (first == x.end()) return result;
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

/// The larger of two, of which either may be missing.
std::vector<double> larger(std::vector<double> a, const std::vector<double>& b) {
  if (a.empty()) return b;
  for (std::size_t i = 0; i < b.size(); ++i) a[i] = std::fmax(a[i], b[i]);
  return a;
}

double quantile_inside(const std::vector<double>& x, const std::vector<bool>& inside, double share) {
  std::vector<double> values;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (inside[i] && std::isfinite(x[i])) values.push_back(x[i]);
  }
  if (values.empty()) return 0.0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Deals every excited stretch in blocks: of any three neighbouring blocks (at the default share) the last is held out,
/// counted over the whole flight, so that both parts see the flight's beginning and end and every manoeuvre that is
/// repeated.
void deal(AxisSegments& axis, const SegmentOptions& options) {
  double held = 0.0;
  double dealt = 0.0;
  for (const TimeSpan& span : axis.excited) {
    const auto blocks = static_cast<std::size_t>(std::max(1.0, std::round(span.duration() / options.block_s)));
    const double length = span.duration() / static_cast<double>(blocks);
    for (std::size_t k = 0; k < blocks; ++k) {
      TimeSpan block{span.begin + length * static_cast<double>(k), span.begin + length * static_cast<double>(k + 1)};
      dealt += length;
      const bool hold = options.holdout > 0.0 && held + 0.5 * length <= options.holdout * dealt;
      if (hold) held += length;
      std::vector<TimeSpan>& list = hold ? axis.holdout : axis.identification;
      if (!list.empty() && k > 0 && list.back().end >= block.begin - 1e-9) {
        list.back().end = block.end;
      } else {
        list.push_back(block);
      }
    }
  }
  const auto borders = [&](std::vector<TimeSpan>& list, const std::vector<TimeSpan>& others) {
    for (TimeSpan& span : list) {
      for (const TimeSpan& other : others) {
        if (std::abs(other.end - span.begin) < 1e-6) span.begin += options.guard_s;
        if (std::abs(other.begin - span.end) < 1e-6) span.end -= options.guard_s;
      }
    }
  };
  const std::vector<TimeSpan> identification = axis.identification;
  borders(axis.identification, axis.holdout);
  borders(axis.holdout, identification);
  drop_shorter(axis.identification, 1.0);
  drop_shorter(axis.holdout, 1.0);
}

std::vector<TimeSpan> read_spans(const StudyTable& table, const char* key) {
  std::vector<TimeSpan> spans;
  if (!table.has(key)) return spans;
  const std::vector<double> flat = table.numbers(key, "s");
  if (flat.empty() || flat.size() % 2 != 0) table.fail(key, "must be pairs of begin and end: [10, 60, 80, 120]");
  for (std::size_t i = 0; i < flat.size(); i += 2) {
    if (!(flat[i] < flat[i + 1])) {
      table.fail(key, fmt::format("segment {} s to {} s has no length", flat[i], flat[i + 1]));
    }
    if (!spans.empty() && flat[i] < spans.back().end) table.fail(key, "segments overlap or are not in order");
    spans.push_back({flat[i], flat[i + 1]});
  }
  return spans;
}

}  // namespace

const char* to_string(Axis axis) { return axis == Axis::kLongitudinal ? "longitudinal" : "lateral"; }

double AxisSegments::excited_s() const {
  double total = 0.0;
  for (const TimeSpan& span : excited) total += span.duration();
  return total;
}

SegmentOptions SegmentOptions::read(const StudyTable& table) {
  SegmentOptions options;
  options.min_airspeed_mps = table.number_or("min_airspeed", "m/s", options.min_airspeed_mps);
  options.window_s = table.positive_or("window", "s", options.window_s);
  options.min_input_rad = table.positive_or("min_input", "rad", options.min_input_rad);
  options.ambient_factor = table.number_or("ambient_factor", "1", options.ambient_factor);
  options.min_rate_radps = table.positive_or("min_rate", "rad/s", options.min_rate_radps);
  options.merge_s = table.number_or("merge", "s", options.merge_s);
  options.min_duration_s = table.positive_or("min_duration", "s", options.min_duration_s);
  options.holdout = table.number_or("holdout", "1", options.holdout);
  if (!(options.holdout >= 0.0 && options.holdout <= 0.8)) {
    table.fail("holdout", fmt::format("= {} must be a share between 0 and 0.8", options.holdout));
  }
  options.block_s = table.positive_or("block", "s", options.block_s);
  options.guard_s = table.number_or("guard", "s", options.guard_s);
  options.longitudinal = read_spans(table, "longitudinal");
  options.lateral = read_spans(table, "lateral");
  return options;
}

Segments find_segments(const SegmentSignals& signals, const SegmentOptions& options) {
  Segments result;
  const std::size_t count = signals.airspeed.size();
  result.airborne = merged(
      stretches(signals, count, [&](std::size_t i) { return signals.airspeed[i] > options.min_airspeed_mps; }), 2.0);
  drop_shorter(result.airborne, 5.0);
  std::vector<bool> flying(count, false);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = signals.begin + signals.step * static_cast<double>(i);
    flying[i] =
        std::any_of(result.airborne.begin(), result.airborne.end(), [&](const TimeSpan& s) { return s.contains(t); });
  }
  double airborne_s = 0.0;
  for (const TimeSpan& span : result.airborne) airborne_s += span.duration();

  const auto half = static_cast<std::size_t>(0.5 * options.window_s / signals.step);
  const auto search = [&](Axis axis, const std::vector<TimeSpan>& given, const std::vector<double>& input,
                          const std::vector<double>& rate) {
    AxisSegments found;
    found.axis = axis;
    found.given = !given.empty();
    if (found.given) {
      found.excited = given;
      found.text =
          fmt::format("{} segments: {} given in the study, {:.0f} s", to_string(axis), given.size(), found.excited_s());
    } else if (input.empty()) {
      found.text = fmt::format("{} segments: none, the log has no surface deflection", to_string(axis));
    } else {
      found.ambient_input_rad = quantile_inside(input, flying, 0.2);
      found.input_threshold_rad = std::max(options.min_input_rad, options.ambient_factor * found.ambient_input_rad);
      found.excited = merged(stretches(signals, count,
                                       [&](std::size_t i) {
                                         return flying[i] && input[i] > found.input_threshold_rad &&
                                                rate[i] > options.min_rate_radps;
                                       }),
                             options.merge_s);
      drop_shorter(found.excited, options.min_duration_s);
      found.text = fmt::format(
          "{} segments: {} found, {:.0f} s of {:.0f} s in the air, where {} activity over {:.0f} s exceeds {:.2f} deg "
          "(calmest "
          "fifth of the flight: {:.2f} deg) and the body rate answers with more than {:.1f} deg/s",
          to_string(axis), found.excited.size(), found.excited_s(), airborne_s,
          axis == Axis::kLongitudinal ? "elevator" : "aileron or rudder", options.window_s,
          found.input_threshold_rad / kDegree, found.ambient_input_rad / kDegree, options.min_rate_radps / kDegree);
    }
    deal(found, options);
    return found;
  };
  const auto of = [&](std::span<const double> x) { return x.empty() ? std::vector<double>{} : activity(x, half); };
  result.longitudinal = search(Axis::kLongitudinal, options.longitudinal, of(signals.elevator), of(signals.q));
  result.lateral = search(Axis::kLateral, options.lateral, larger(of(signals.aileron), of(signals.rudder)),
                          larger(of(signals.p), of(signals.r)));
  return result;
}

}  // namespace veridyn::aircraft
