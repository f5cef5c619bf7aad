#include "veridyn/vehicle/identification/drive_segments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "veridyn/core/error.hpp"

namespace veridyn::vehicle {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

std::vector<TimeSpan> read_spans(const StudyTable& table, std::string_view key) {
  std::vector<TimeSpan> spans;
  const std::vector<double> t = table.numbers(key, "s");
  if (t.size() % 2 != 0) table.fail(key, fmt::format("has {} numbers; must be pairs of begin and end", t.size()));
  for (std::size_t i = 0; i < t.size(); i += 2) {
    if (!(t[i] < t[i + 1])) table.fail(key, fmt::format("begins at {:g} s and ends at {:g} s", t[i], t[i + 1]));
    spans.push_back({t[i], t[i + 1]});
  }
  return spans;
}

/// Maximal stretches of true.
std::vector<TimeSpan> stretches(const std::vector<bool>& holds, const numerics::UniformGrid& grid) {
  std::vector<TimeSpan> spans;
  for (std::size_t k = 0; k < holds.size(); ++k) {
    if (!holds[k]) continue;
    std::size_t end = k;
    while (end + 1 < holds.size() && holds[end + 1]) ++end;
    if (end > k) spans.push_back({grid.at(k), grid.at(end)});
    k = end;
  }
  return spans;
}

void drop_short(std::vector<TimeSpan>& spans, double least) {
  std::erase_if(spans, [&](const TimeSpan& s) { return s.duration() < least - 1e-9; });
}

/// The parts of `a` within `b`.
std::vector<TimeSpan> within(const std::vector<TimeSpan>& a, const std::vector<TimeSpan>& b) {
  std::vector<TimeSpan> out;
  for (const TimeSpan& x : a) {
    for (const TimeSpan& y : b) {
      const TimeSpan both{std::max(x.begin, y.begin), std::min(x.end, y.end)};
      if (both.begin < both.end) out.push_back(both);
    }
  }
  return out;
}

/// Blocks dealt so that the share of the hold-out is kept as closely as whole blocks allow.
void deal(const std::vector<TimeSpan>& excited, const DriveSegmentOptions& o, DriveSegments& out) {
  double total = 0.0, held = 0.0;
  for (const TimeSpan& span : excited) {
    const auto blocks = static_cast<std::size_t>(std::max(1.0, std::round(span.duration() / o.block_s)));
    const double length = span.duration() / static_cast<double>(blocks);
    TimeSpan open{span.begin, span.begin};
    bool open_held = false;
    const auto close = [&](double end, bool meets) {
      TimeSpan block{open.begin, meets ? end - o.guard_s : end};
      if (block.duration() >= o.min_duration_s - 1e-9) (open_held ? out.holdout : out.identification).push_back(block);
    };
    for (std::size_t i = 0; i < blocks; ++i) {
      // The first block is for identification: without one there is nothing to hold against the hold-out.
      const bool holds = total > 0.0 && held + length <= o.holdout * (total + length) + 0.5 * length - 1e-9 &&
                         o.holdout > 0.0 && held < o.holdout * (total + length);
      const double begin = span.begin + static_cast<double>(i) * length;
      if (i == 0) {
        open_held = holds;
      } else if (holds != open_held) {
        close(begin, true);
        open.begin = begin + o.guard_s;
        open_held = holds;
      } else {
        // Blocks of the same use stay apart: each gets its own initial state, which keeps simulations short.
        close(begin, false);
        open.begin = begin;
      }
      total += length;
      if (holds) held += length;
    }
    close(span.end, false);
  }
}

}  // namespace

DriveSegmentOptions DriveSegmentOptions::read(const StudyTable& table) {
  DriveSegmentOptions o;
  o.min_speed_mps = table.positive_or("min_speed", "m/s", o.min_speed_mps);
  o.max_steer_rad = table.positive_or("max_steer", "rad", o.max_steer_rad);
  if (!(o.max_steer_rad < 90.0 * kDegree))
    table.fail("max_steer", fmt::format("= {:g} deg must be less than 90 deg", o.max_steer_rad / kDegree));
  o.min_lateral_mps2 = table.positive_or("min_lateral_acceleration", "m/s^2", o.min_lateral_mps2);
  o.window_s = table.positive_or("window", "s", o.window_s);
  o.merge_s = table.positive_or("merge", "s", o.merge_s);
  o.min_duration_s = table.positive_or("min_duration", "s", o.min_duration_s);
  o.holdout = table.number_or("holdout", "1", o.holdout);
  if (!(o.holdout >= 0.0 && o.holdout <= 0.8))
    table.fail("holdout", fmt::format("= {:g} must be from 0 to 0.8", o.holdout));
  o.block_s = table.positive_or("block", "s", o.block_s);
  if (!(o.block_s >= o.min_duration_s))
    table.fail("block",
               fmt::format("= {:g} s must not be shorter than min_duration = {:g} s", o.block_s, o.min_duration_s));
  o.guard_s = table.number_or("guard", "s", o.guard_s);
  if (!(o.guard_s >= 0.0)) table.fail("guard", fmt::format("= {:g} s must be >= 0", o.guard_s));
  if (table.has("identification")) o.identification_spans = read_spans(table, "identification");
  if (table.has("holdout_spans")) o.holdout_spans = read_spans(table, "holdout_spans");
  return o;
}

double DriveSegments::seconds(const std::vector<TimeSpan>& spans) const {
  double sum = 0.0;
  for (const TimeSpan& span : spans) sum += span.duration();
  return sum;
}

DriveSegments find_drive_segments(const DriveSignals& signals, const DriveSegmentOptions& o,
                                  std::span<const TimeSpan> holdout_runs) {
  const std::vector<double>& u = signals[DriveSignal::kSpeed].value;
  const std::vector<double>& r = signals[DriveSignal::kYawRate].value;
  const std::vector<double>& steer = signals[DriveSignal::kSteer].value;
  const GridSignal& accel = signals[DriveSignal::kAccelY];
  const std::size_t n = signals.size();
  double highest = 0.0, widest = 0.0;
  std::vector<bool> usable(n);
  std::size_t fast = 0, beyond = 0, missing = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double delta = steer.empty() ? 0.0 : steer[k];
    highest = std::fmax(highest, u[k]);
    widest = std::fmax(widest, std::abs(delta));
    const bool there = std::isfinite(u[k]) && std::isfinite(r[k]) && std::isfinite(delta) &&
                       (!accel.available() || std::isfinite(accel.value[k]));
    if (!there) ++missing;
    if (u[k] >= o.min_speed_mps) {
      ++fast;
      if (std::abs(delta) > o.max_steer_rad) ++beyond;
    }
    usable[k] = there && u[k] >= o.min_speed_mps && std::abs(delta) <= o.max_steer_rad;
  }
  DriveSegments out;
  out.usable = stretches(usable, signals.grid);
  drop_short(out.usable, o.min_duration_s);
  if (out.usable.empty()) {
    if (fast == 0) {
      throw InputError(
          signals.source,
          fmt::format("the vehicle never drives: its speed stays below {:.2f} m/s, slip angles need {:g} m/s "
                      "(key segments.min_speed)",
                      std::ceil(100.0 * highest) / 100.0, o.min_speed_mps));
    }
    if (beyond == fast || (beyond > 0 && missing == 0)) {
      throw InputError(
          signals.source,
          fmt::format("steer reaches {:.0f} deg and is beyond {:.0f} deg for {:.0f} % of the drive: is it the "
                      "hand wheel's angle, or in degrees? (keys data.map.steer, segments.max_steer)",
                      widest / kDegree, o.max_steer_rad / kDegree,
                      100.0 * static_cast<double>(beyond) / static_cast<double>(fast)));
    }
    throw InputError(
        signals.source,
        fmt::format("no stretch of {:g} s has all of steer, speed, yaw_rate{}: {:.0f} % of the samples lack "
                    "one of them",
                    o.min_duration_s, accel.available() ? " and accel_y" : "",
                    100.0 * static_cast<double>(missing) / static_cast<double>(n)));
  }

  // Lateral motion: rms of r u over a window.
  std::vector<double> sum(n + 1, 0.0);
  for (std::size_t k = 0; k < n; ++k) {
    const double a = usable[k] ? u[k] * r[k] : 0.0;
    sum[k + 1] = sum[k] + a * a;
  }
  const auto half = static_cast<std::size_t>(std::max(1.0, 0.5 * o.window_s / signals.grid.step));
  std::vector<bool> excited(n);
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t from = k > half ? k - half : 0, to = std::min(n, k + half + 1);
    const double power = (sum[to] - sum[from]) / static_cast<double>(to - from);
    excited[k] = usable[k] && power >= o.min_lateral_mps2 * o.min_lateral_mps2;
  }
  std::vector<TimeSpan> found = stretches(excited, signals.grid);
  std::vector<TimeSpan> merged;
  for (const TimeSpan& span : found) {
    const bool near = !merged.empty() && span.begin - merged.back().end <= o.merge_s;
    if (near)
      merged.back().end = span.end;
    else
      merged.push_back(span);
  }
  out.excited = within(merged, out.usable);
  drop_short(out.excited, o.min_duration_s);

  const TimeSpan whole{signals.grid.begin, signals.grid.at(n - 1)};
  const auto given = [&](const std::vector<TimeSpan>& spans, const char* key) {
    for (const TimeSpan& span : spans) {
      if (span.end <= whole.begin || span.begin >= whole.end) {
        throw InputError(fmt::format("segments.{}", key),
                         fmt::format("{:g} to {:g} s lies outside the recording, {:.3f} to {:.3f} s", span.begin,
                                     span.end, whole.begin, whole.end));
      }
    }
    std::vector<TimeSpan> parts = within(spans, out.usable);
    drop_short(parts, o.min_duration_s);
    return parts;
  };
  const auto in_blocks = [&](const std::vector<TimeSpan>& spans) {
    std::vector<TimeSpan> blocks;
    for (const TimeSpan& span : spans) {
      const double count = std::max(1.0, std::round(span.duration() / o.block_s));
      for (double i = 0.0; i < count; i += 1.0)
        blocks.push_back({span.begin + i / count * span.duration(), span.begin + (i + 1.0) / count * span.duration()});
    }
    return blocks;
  };
  if (!o.identification_spans.empty() || !o.holdout_spans.empty()) {
    out.given = true;
    out.identification =
        in_blocks(o.identification_spans.empty() ? out.excited : given(o.identification_spans, "identification"));
    out.holdout = in_blocks(given(o.holdout_spans, "holdout_spans"));
  } else if (!holdout_runs.empty()) {
    const std::vector<TimeSpan> held(holdout_runs.begin(), holdout_runs.end());
    std::vector<TimeSpan> rest;
    double from = whole.begin;
    for (const TimeSpan& run : held) {
      if (run.begin > from) rest.push_back({from, run.begin});
      from = run.end;
    }
    if (from < whole.end) rest.push_back({from, whole.end});
    out.identification = in_blocks(within(out.excited, rest));
    out.holdout = in_blocks(within(out.excited, held));
    drop_short(out.identification, o.min_duration_s);
    drop_short(out.holdout, o.min_duration_s);
  } else {
    deal(out.excited, o, out);
  }
  out.text =
      out.excited.empty() && !out.given
          ? fmt::format("{:.0f} s are usable, but the lateral acceleration stays below {:g} m/s^2 (rms over {:g} s)",
                        out.seconds(out.usable), o.min_lateral_mps2, o.window_s)
          : fmt::format(
                "{:.0f} s usable, {:.0f} s of them with lateral motion; {:.0f} s to identify in {} segments, "
                "{:.0f} s to validate in {}",
                out.seconds(out.usable), out.seconds(out.excited), out.seconds(out.identification),
                out.identification.size(), out.seconds(out.holdout), out.holdout.size());
  return out;
}

}  // namespace veridyn::vehicle
