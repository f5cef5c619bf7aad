#include "veridyn/cueing/score/cueing_score.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::cueing {
namespace {

constexpr double kGrid = 0.02;          // [s]
constexpr double kShortestDrive = 5.0;  // [s]

/// A signal on lines between its stamps, at an even grid from the first one on.
std::vector<double> on_grid(const std::vector<double>& time, const std::vector<double>& values, std::size_t points) {
  std::vector<double> even(points);
  std::size_t i = 0;
  for (std::size_t k = 0; k < points; ++k) {
    const double t = time.front() + kGrid * static_cast<double>(k);
    while (i + 2 < time.size() && time[i + 1] <= t) ++i;
    const double part = std::clamp((t - time[i]) / (time[i + 1] - time[i]), 0.0, 1.0);
    even[k] = values[i] + part * (values[i + 1] - values[i]);
  }
  return even;
}

/// Every figure from the same draws.
CueScore measured(const BlockStatistics& felt, const BlockStatistics& physical, std::uint64_t seed) {
  const std::vector<Measured> m =
      bootstrapped(felt.blocks(), seed, 7, [&](std::span<const double> weights, std::span<double> out) {
        const BlockStatistics::Figures f = felt.figures(weights), p = physical.figures(weights);
        const std::array all = {f.rmse, f.pearson, f.lag, f.at_lag, f.above, p.pearson, p.lag};
        std::copy(all.begin(), all.end(), out.begin());
      });
  return {m[0], m[1], m[2], m[3], m[4], m[5], m[6]};
}

AxisScore axis_score(const CueingRun& run, PlatformAxis which, const AxisLimits& limits) {
  AxisScore s;
  double squares = 0.0;
  for (std::size_t k = 0; k < run.steps.size(); ++k) {
    const AxisState now = axis(run.steps[k].ordered, which);
    s.lowest = std::min(s.lowest, now.position);
    s.highest = std::max(s.highest, now.position);
    s.limited += run.steps[k].limited[static_cast<std::size_t>(which)] ? 1.0 : 0.0;
    s.rate = std::max(s.rate, std::abs(now.rate) / limits.rate);
    if (k == 0) continue;
    const double step = run.vehicle[k].time - run.vehicle[k - 1].time;
    const double jerk = (now.acceleration - axis(run.steps[k - 1].ordered, which).acceleration) / step;
    squares += jerk * jerk;
  }
  const auto samples = static_cast<double>(run.steps.size());
  s.limited /= samples;
  s.rms_jerk = std::sqrt(squares / samples);
  s.used = std::max(limits.highest > 0.0 ? s.highest / limits.highest : 0.0,
                    limits.lowest < 0.0 ? s.lowest / limits.lowest : 0.0);
  return s;
}

/// Share of the quiet time in which the platform's turning is felt.
double felt_return(const FeltMotion& felt) {
  double quiet = 0.0, turning = 0.0;
  for (std::size_t k = 0; k < felt.time.size(); ++k) {
    const auto beyond = [&](Cue cue, bool vehicle) {
      const CuePair& pair = felt.felt[cue];
      return std::abs(vehicle ? pair.vehicle[k] : pair.platform[k]) > felt.threshold[cue];
    };
    bool still = true, turns = false;
    for (const Cue cue : {Cue::kSurge, Cue::kSway, Cue::kRoll, Cue::kPitch}) still = still && !beyond(cue, true);
    for (const Cue cue : {Cue::kRoll, Cue::kPitch}) turns = turns || beyond(cue, false);
    quiet += still ? 1.0 : 0.0;
    turning += still && turns ? 1.0 : 0.0;
  }
  return quiet > 0.0 ? turning / quiet : 0.0;
}

}  // namespace

CueingScore score(const CueingRun& run, const FeltMotion& felt, const Platform& platform, std::uint64_t seed) {
  CueingScore s;
  s.algorithm = run.algorithm;
  s.seed = seed;
  s.duration = felt.time.empty() ? 0.0 : felt.time.back() - felt.time.front();
  if (!(s.duration >= kShortestDrive))
    throw InputError("drive", fmt::format("lasts {:.2g} s; a score needs {:g} s at least", s.duration, kShortestDrive));
  const auto points = static_cast<std::size_t>(s.duration / kGrid) + 1;
  for (const Cue cue : kAllCues) {
    const auto pair = [&](const CuePair& p) {
      return std::pair(on_grid(felt.time, p.vehicle, points), on_grid(felt.time, p.platform, points));
    };
    const auto [vehicle, platform_felt] = pair(felt.felt[cue]);
    const auto [force, rendered] = pair(felt.physical[cue]);
    s.felt_blocks[cue] = BlockStatistics(vehicle, platform_felt, kGrid, felt.threshold[cue]);
    s.physical_blocks[cue] = BlockStatistics(force, rendered, kGrid, felt.threshold[cue]);
    s.cues[cue] = measured(s.felt_blocks[cue], s.physical_blocks[cue], seed);
    const std::vector<FalseCue> found =
        false_cues(cue, vehicle, platform_felt, felt.threshold[cue], felt.time.front(), kGrid);
    s.false_cues.insert(s.false_cues.end(), found.begin(), found.end());
  }
  for (const std::size_t pair : {0U, 1U}) {
    const Cue force = pair == 0 ? Cue::kSway : Cue::kSurge, turn = pair == 0 ? Cue::kRoll : Cue::kPitch;
    s.pairs[pair] = bootstrapped(
        s.felt_blocks[force].blocks(), seed, 1, [&](std::span<const double> weights, std::span<double> out) {
          out[0] = std::hypot(s.felt_blocks[force].figures(weights).rmse / felt.threshold[force],
                              s.felt_blocks[turn].figures(weights).rmse / felt.threshold[turn]);
        })[0];
  }
  std::stable_sort(s.false_cues.begin(), s.false_cues.end(),
                   [](const FalseCue& a, const FalseCue& b) { return a.begin < b.begin; });
  for (const PlatformAxis axis : platform.limits.moving_axes())
    s.axes[axis] = axis_score(run, axis, platform.limits[axis]);
  if (platform.legs) {
    for (const CueingStep& step : run.steps)
      s.leg_speed = std::max(s.leg_speed, step.leg_speed / platform.legs->leg.rate);
  }
  s.felt_return = felt_return(felt);
  if (s.felt_blocks.front().blocks() < BlockStatistics::kFewestBlocks)
    s.notes.push_back(fmt::format("{:.0f} s are fewer than {} blocks of {:g} s: no intervals", s.duration,
                                  BlockStatistics::kFewestBlocks, BlockStatistics::kBlock));
  return s;
}

Measured difference(const CueingScore& a, const CueingScore& b, Cue cue, CueFigure figure) {
  using Figures = BlockStatistics::Figures;
  const bool physical = figure == CueFigure::kPhysicalPearson || figure == CueFigure::kPhysicalLag;
  const BlockStatistics &of_a = physical ? a.physical_blocks[cue] : a.felt_blocks[cue],
                        &of_b = physical ? b.physical_blocks[cue] : b.felt_blocks[cue];
  double Figures::*which = &Figures::rmse;
  if (figure == CueFigure::kPearson || figure == CueFigure::kPhysicalPearson) which = &Figures::pearson;
  if (figure == CueFigure::kLag || figure == CueFigure::kPhysicalLag) which = &Figures::lag;
  if (of_a.blocks() != of_b.blocks()) throw InputError("score", "is of another drive than the one it is compared with");
  return bootstrapped(of_a.blocks(), a.seed, 1, [&](std::span<const double> weights, std::span<double> out) {
    out[0] = of_a.figures(weights).*which - of_b.figures(weights).*which;
  })[0];
}

}  // namespace veridyn::cueing
