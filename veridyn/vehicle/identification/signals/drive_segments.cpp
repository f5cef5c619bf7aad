#include "veridyn/vehicle/identification/signals/drive_segments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::vehicle {
namespace {

using recording::drop_shorter;
using recording::within;

/// What of a drive can be used, and why the rest cannot.
struct Usable {
  std::vector<bool> sample;
  double highest_mps = 0.0, widest_rad = 0.0;
  std::size_t fast = 0, beyond = 0, missing = 0;  // samples: fast enough, of these steered too far; a signal missing
};

Usable usable_samples(const DriveSignals& signals, const DriveSegmentOptions& o) {
  const std::vector<double>& u = signals[DriveSignal::kSpeed].value;
  const std::vector<double>& r = signals[DriveSignal::kYawRate].value;
  const std::vector<double>& steer = signals[DriveSignal::kSteer].value;
  const GridSignal& accel = signals[DriveSignal::kAccelY];
  Usable found;
  found.sample.resize(signals.size());
  for (std::size_t k = 0; k < signals.size(); ++k) {
    const double delta = steer.empty() ? 0.0 : steer[k];
    found.highest_mps = std::fmax(found.highest_mps, u[k]);
    found.widest_rad = std::fmax(found.widest_rad, std::abs(delta));
    const bool there = std::isfinite(u[k]) && std::isfinite(r[k]) && std::isfinite(delta) &&
                       (!accel.available() || std::isfinite(accel.value[k]));
    if (!there) ++found.missing;
    if (u[k] >= o.min_speed_mps) {
      ++found.fast;
      if (std::abs(delta) > o.max_steer_rad) ++found.beyond;
    }
    found.sample[k] = there && u[k] >= o.min_speed_mps && std::abs(delta) <= o.max_steer_rad;
  }
  return found;
}

[[noreturn]] void refuse(const DriveSignals& signals, const DriveSegmentOptions& o, const Usable& found) {
  if (found.fast == 0) {
    throw InputError(
        signals.source,
        fmt::format("the vehicle never drives: its speed stays below {:.2f} m/s, slip angles need {:g} m/s "
                    "(key segments.min_speed)",
                    std::ceil(100.0 * found.highest_mps) / 100.0, o.min_speed_mps));
  }
  if (found.beyond == found.fast || (found.beyond > 0 && found.missing == 0)) {
    throw InputError(
        signals.source,
        fmt::format("steer reaches {:.0f} deg and is beyond {:.0f} deg for {:.0f} % of the drive: is it the "
                    "hand wheel's angle, or in degrees? (keys data.map.steer, segments.max_steer)",
                    found.widest_rad / kDegree, o.max_steer_rad / kDegree,
                    100.0 * static_cast<double>(found.beyond) / static_cast<double>(found.fast)));
  }
  throw InputError(
      signals.source,
      fmt::format("no stretch of {:g} s has all of steer, speed, yaw_rate{}: {:.0f} % of the samples lack one of them",
                  o.min_duration_s, signals[DriveSignal::kAccelY].available() ? " and accel_y" : "",
                  100.0 * static_cast<double>(found.missing) / static_cast<double>(signals.size())));
}

/// Where there is lateral motion: rms of r u over a window.
std::vector<TimeSpan> excited_spans(const DriveSignals& signals, const DriveSegmentOptions& o,
                                    const std::vector<bool>& usable, double& least_mps2) {
  const std::vector<double>& u = signals[DriveSignal::kSpeed].value;
  const std::vector<double>& r = signals[DriveSignal::kYawRate].value;
  std::vector<double> lateral(signals.size());
  for (std::size_t k = 0; k < lateral.size(); ++k) lateral[k] = usable[k] ? u[k] * r[k] : 0.0;
  const auto half = static_cast<std::size_t>(std::max(1.0, 0.5 * o.window_s / signals.grid.step));
  const std::vector<double> power = recording::mean_square(lateral, half);
  std::vector<double> activity(power.size());
  std::ranges::transform(power, activity.begin(), [](double p) { return std::sqrt(p); });
  constexpr recording::LeastActivity kLeastActivity{.usual = 0.3, .least = 0.05};
  least_mps2 = o.min_lateral_mps2.value_or(kLeastActivity.of(activity, usable));
  std::vector<TimeSpan> found = recording::stretches(
      signals.grid, signals.size(), [&](std::size_t k) { return usable[k] && activity[k] >= least_mps2; });
  drop_shorter(found, 0.0);
  return recording::merged(found, o.merge_s);
}

std::vector<TimeSpan> in_blocks(const std::vector<TimeSpan>& spans, double block_s) {
  std::vector<TimeSpan> all;
  for (const TimeSpan& span : spans) {
    const std::vector<TimeSpan> some = recording::blocks(span, block_s);
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

/// The usable parts of spans that the study gives.
std::vector<TimeSpan> given_spans(const std::vector<TimeSpan>& spans, const char* key, const TimeSpan& whole,
                                  const std::vector<TimeSpan>& usable, double least_s) {
  for (const TimeSpan& span : spans) {
    if (span.end <= whole.begin || span.begin >= whole.end) {
      throw InputError(fmt::format("segments.{}", key),
                       fmt::format("{:g} to {:g} s lies outside the recording, {:.3f} to {:.3f} s", span.begin,
                                   span.end, whole.begin, whole.end));
    }
  }
  std::vector<TimeSpan> parts = within(spans, usable);
  drop_shorter(parts, least_s);
  return parts;
}

/// Whole runs to identification and hold-out.
recording::AssignedBlocks assign_runs(const std::vector<TimeSpan>& excited, const DriveSegmentOptions& o,
                                      const TimeSpan& whole, std::span<const TimeSpan> held) {
  recording::AssignedBlocks out;
  std::vector<TimeSpan> rest;
  double from = whole.begin;
  for (const TimeSpan& run : held) {
    if (run.begin > from) rest.push_back({from, run.begin});
    from = run.end;
  }
  if (from < whole.end) rest.push_back({from, whole.end});
  out.identification = in_blocks(within(excited, rest), o.block_s);
  out.holdout = in_blocks(within(excited, held), o.block_s);
  drop_shorter(out.identification, o.min_duration_s);
  drop_shorter(out.holdout, o.min_duration_s);
  return out;
}

std::string account(const DriveSegments& s, const DriveSegmentOptions& o) {
  using recording::total_s;
  if (s.excited.empty() && !s.given) {
    return fmt::format(
        "{:.0f} s are usable, but the lateral acceleration stays below {:.2g} m/s^2 (rms over {:g} s; key "
        "segments.min_lateral_acceleration)",
        total_s(s.usable), s.least_lateral_mps2, o.window_s);
  }
  return fmt::format(
      "{:.0f} s usable, {:.0f} s of them with lateral motion; {:.0f} s to identify in {} segments, {:.0f} s to "
      "validate in {}",
      total_s(s.usable), total_s(s.excited), total_s(s.identification), s.identification.size(), total_s(s.holdout),
      s.holdout.size());
}

}  // namespace

DriveSegmentOptions::DriveSegmentOptions() { window_s = 2.0; }

const KeyTable<DriveSegmentOptions>& DriveSegmentOptions::keys() {
  using O = DriveSegmentOptions;
  const auto spans = [](auto field) {
    return [field](const StudyTable& table, const std::string& key, O& o) {
      o.*field = recording::read_spans(table, key);
    };
  };
  static const auto table =
      KeyTable<O>("segments", "Which stretches of a drive are used, and what for.")
          .with(recording::SegmentOptions::keys())
          .number("min_speed", &O::min_speed_mps, "m/s", kPositive, "slip angles mean nothing below it")
          .number("max_steer", &O::max_steer_rad, "rad", between(0.0, kPi / 2), "beyond it the drive is not used")
          .number("min_lateral_acceleration", &O::min_lateral_mps2, "m/s^2", kPositive,
                  "rms of yaw rate times speed over `window` from which a stretch counts as excited")
          .otherwise("0.3, or where a drive is gentler half of what its liveliest twentieth exceeds, down to 0.05")
          .other(recording::spans_key("identification", "stretches to identify from"), spans(&O::identification_spans))
          .other(recording::spans_key("holdout_spans", "stretches to validate on"), spans(&O::holdout_spans))
          .check([](const StudyTable& t, O& o) {
            if (!(o.block_s >= o.min_duration_s))
              t.fail("block", fmt::format("= {:g} s must not be shorter than min_duration = {:g} s", o.block_s,
                                          o.min_duration_s));
          });
  return table;
}

DriveSegments find_drive_segments(const DriveSignals& signals, const DriveSegmentOptions& o,
                                  std::span<const TimeSpan> holdout_runs) {
  const Usable found = usable_samples(signals, o);
  DriveSegments out;
  out.usable = recording::stretches(signals.grid, signals.size(), [&](std::size_t k) { return found.sample[k]; });
  drop_shorter(out.usable, o.min_duration_s);
  if (out.usable.empty()) refuse(signals, o, found);
  out.excited = within(excited_spans(signals, o, found.sample, out.least_lateral_mps2), out.usable);
  drop_shorter(out.excited, o.min_duration_s);

  const TimeSpan whole{signals.grid.begin, signals.grid.at(signals.size() - 1)};
  if (!o.identification_spans.empty() || !o.holdout_spans.empty()) {
    const auto given = [&](const std::vector<TimeSpan>& spans, const char* key) {
      return given_spans(spans, key, whole, out.usable, o.min_duration_s);
    };
    out.given = true;
    out.identification = in_blocks(
        o.identification_spans.empty() ? out.excited : given(o.identification_spans, "identification"), o.block_s);
    out.holdout = in_blocks(given(o.holdout_spans, "holdout_spans"), o.block_s);
  } else {
    recording::AssignedBlocks blocks =
        holdout_runs.empty()
            ? recording::assign_blocks(out.excited, o, recording::Neighbours::kSeparate, o.min_duration_s)
            : assign_runs(out.excited, o, whole, holdout_runs);
    out.identification = std::move(blocks.identification);
    out.holdout = std::move(blocks.holdout);
  }
  out.text = account(out, o);
  return out;
}

}  // namespace veridyn::vehicle
