#include "veridyn/report/parts/cueing_tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/core/index.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/report/document/number_format.hpp"
#include "veridyn/report/figures/cueing_figures.hpp"

namespace veridyn::report {

using namespace veridyn::cueing;

namespace {

std::string with_interval(const Measured& m, double scale = 1.0, int decimals = 2) {
  if (!std::isfinite(m.value)) return "-";
  const auto text = [&](double v) { return format_decimals(scale * v, decimals); };
  if (!std::isfinite(m.low)) return text(m.value);
  // Spaces that do not break keep the interval on one line, the value's or the next.
  return fmt::format("{} ({}\u00a0to\u00a0{})", text(m.value), text(m.low), text(m.high));
}

double three_digits(double value) {
  if (value == 0.0 || !std::isfinite(value)) return value;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 2.0);
  return unit * std::round(value / unit);
}

}  // namespace

double correlation(const AlgorithmResult& a, Cue cue) {
  const double p = a.score.cues[cue].pearson.value;
  return std::isfinite(p) ? p : -2.0;
}

const AlgorithmResult& best_of(const CueingResult& result, Cue cue) {
  return *std::max_element(
      result.algorithms.begin(), result.algorithms.end(),
      [&](const AlgorithmResult& a, const AlgorithmResult& b) { return correlation(a, cue) < correlation(b, cue); });
}

Table score_table(const CueingResult& result, Cue cue) {
  const FeltMotion& felt = result.algorithms.front().felt;
  Table t{.title = capitalised(std::string(name_of(cue)))};
  t.columns = {
      {.name = "algorithm", .align = Align::kLeft},
      {.name = "correlation", .align = Align::kLeft},
      {.name = "lag", .unit = "s", .align = Align::kLeft},
      {.name = "at the lag", .align = Align::kLeft},
      {.name = "RMS error", .unit = shown_unit(cue), .align = Align::kLeft},
      {.name = fmt::format("off > {:.2g}", shown(cue, felt.threshold[cue])), .unit = "%", .align = Align::kLeft},
      {.name = "physical", .align = Align::kLeft}};
  const double scale = cue < Cue::kRoll ? 1.0 : 1.0 / kDegree;
  for (const AlgorithmResult& a : result.algorithms) {
    const CueScore& s = a.score.cues[cue];
    t.rows.push_back(
        {.cells = {text_cell(a.run.algorithm), text_cell(with_interval(s.pearson)), text_cell(with_interval(s.lag)),
                   text_cell(with_interval(s.at_lag)), text_cell(with_interval(s.rmse, scale)),
                   text_cell(with_interval(s.above, 100.0, 0)), text_cell(with_interval(s.physical_pearson))}});
  }
  return t;
}

Table perceived_table(const CueingResult& result) {
  Table t{.title = "Perceived error",
          .caption =
              "Of force and turn together, in thresholds. Least: with the whole drive known beforehand, within "
              "range, rates and accelerations of the platform; no algorithm can be better."};
  t.columns = {{.name = "algorithm", .align = Align::kLeft},
               {.name = "error", .align = Align::kLeft, .group = "surge and pitch"},
               {.name = "over the least", .group = "surge and pitch"},
               {.name = "error", .align = Align::kLeft, .group = "sway and roll"},
               {.name = "over the least", .group = "sway and roll"}};
  const auto over = [&](double error, std::size_t pair) {
    return number_cell(result.least[pair] ? error / result.least[pair]->error : kNaN, 2);
  };
  for (const AlgorithmResult& a : result.algorithms) {
    const std::array<Measured, 2>& e = a.score.pairs;
    t.rows.push_back({.cells = {text_cell(a.run.algorithm), text_cell(with_interval(e[1])), over(e[1].value, 1),
                                text_cell(with_interval(e[0])), over(e[0].value, 0)}});
  }
  if (const auto& [sway, surge] = result.least; surge && sway) {
    t.rows.push_back(
        {.cells = {text_cell("a platform that stands"), text_cell(format_decimals(surge->still, 2)),
                   over(surge->still, 1), text_cell(format_decimals(sway->still, 2)), over(sway->still, 0)}});
    t.rows.push_back({.cells = {text_cell("least"), text_cell(format_decimals(surge->error, 2)), over(surge->error, 1),
                                text_cell(format_decimals(sway->error, 2)), over(sway->error, 0)}});
  }
  return t;
}

List differences(const CueingResult& result) {
  List list;
  for (const Cue cue : {Cue::kSurge, Cue::kSway}) {
    if (!is_moved(result, cue)) continue;
    const AlgorithmResult& best = best_of(result, cue);
    std::vector<std::string> worse, alike;
    for (const AlgorithmResult& other : result.algorithms) {
      if (&other == &best) continue;
      const Measured d = difference(best.score, other.score, cue, CueFigure::kPearson);
      if (!std::isfinite(d.low)) continue;
      if (d.low <= 0.0) {
        alike.push_back(other.run.algorithm);
      } else {
        worse.push_back(fmt::format("{} by {:.2f} ({:.2f} to {:.2f})", other.run.algorithm, d.value, d.low, d.high));
      }
    }
    std::vector<std::string> parts;
    if (!worse.empty()) parts.push_back(fmt::format("better than {}", fmt::join(worse, ", ")));
    if (!alike.empty())
      parts.push_back(fmt::format("no different beyond the intervals from {}", fmt::join(alike, ", ")));
    if (!parts.empty())
      list.items.push_back(fmt::format("{}: {} correlates best; {}.", capitalised(std::string(name_of(cue))),
                                       best.run.algorithm, fmt::join(parts, "; ")));
  }
  return list;
}

Table against_first(const CueingResult& result) {
  const AlgorithmResult& first = result.algorithms.front();
  Table t{.title = fmt::format("Against {}", first.run.algorithm),
          .caption =
              "Correlation: more is better. Lag: less is better. An algorithm differs where the interval, over "
              "the same blocks of both, leaves out 0."};
  t.columns = {{.name = "algorithm", .align = Align::kLeft}};
  std::vector<Cue> cues;
  for (const Cue cue : {Cue::kSurge, Cue::kSway, Cue::kHeave}) {
    if (!is_moved(result, cue)) continue;
    cues.push_back(cue);
    const std::string group(name_of(cue));
    t.columns.push_back({.name = "correlation", .align = Align::kLeft, .group = group});
    t.columns.push_back({.name = "lag", .unit = "s", .align = Align::kLeft, .group = group});
  }
  for (const AlgorithmResult& a : result.algorithms) {
    if (&a == &first) continue;
    std::vector<Cell> cells = {text_cell(a.run.algorithm)};
    for (const Cue cue : cues) {
      for (const CueFigure figure : {CueFigure::kPearson, CueFigure::kLag})
        cells.push_back(text_cell(with_interval(difference(a.score, first.score, cue, figure))));
    }
    t.rows.push_back({.cells = std::move(cells)});
  }
  return t;
}

Table workspace_table(const CueingStudy& study, const CueingResult& result) {
  Table t{.title = "What the platform used",
          .caption =
              "Range: share of it on the side that was used most. Held back: share of time in which the guard kept "
              "the axis from the command of the algorithm. Rate: the largest, over what is allowed. Jerk in the "
              "axis's unit over s^3."};
  t.columns = {{.name = "axis", .align = Align::kLeft}, {.name = "algorithm", .align = Align::kLeft},
               {.name = "lowest", .digits = 3},         {.name = "highest", .digits = 3},
               {.name = "range", .unit = "%"},          {.name = "held back", .unit = "%"},
               {.name = "rate", .unit = "%"},           {.name = "RMS jerk", .digits = 3}};
  const auto percent = [](double share) { return number_cell(100.0 * share, share < 0.0995 ? 1 : 0); };
  for (const PlatformAxis axis : study.platform.limits.moving_axes()) {
    const int decimals = turns(axis) ? 2 : 1;
    for (const AlgorithmResult& a : result.algorithms) {
      const AxisScore& s = a.score.axes[axis];
      t.rows.push_back({.cells = {text_cell(fmt::format("{}\u00a0[{}]", name_of(axis), shown_unit(axis))),
                                  text_cell(a.run.algorithm), number_cell(shown(axis, s.lowest), decimals),
                                  number_cell(shown(axis, s.highest), decimals), percent(s.used), percent(s.limited),
                                  percent(s.rate), number_cell(three_digits(shown(axis, s.rms_jerk)))}});
    }
  }
  return t;
}

Table false_cue_table(const CueingResult& result) {
  // About as many rows as a screen has, however many algorithms there are.
  const std::size_t most = std::max<std::size_t>(3, 30 / result.algorithms.size());
  Table t{.title = "The largest false cues",
          .caption = fmt::format("At most {} of each algorithm; all are in false_cues.csv.", most)};
  t.columns = {{.name = "algorithm", .align = Align::kLeft},
               {.name = "from", .unit = "s"},
               {.name = "lasts", .unit = "s"},
               {.name = "cue", .align = Align::kLeft},
               {.name = "kind", .align = Align::kLeft},
               {.name = "off by, over threshold"}};
  for (const AlgorithmResult& a : result.algorithms) {
    std::vector<FalseCue> all = a.score.false_cues;
    const auto over = [&](const FalseCue& f) { return f.size / a.felt.threshold[f.cue]; };
    std::sort(all.begin(), all.end(), [&](const FalseCue& x, const FalseCue& y) { return over(x) > over(y); });
    for (std::size_t i = 0; i < std::min(most, all.size()); ++i) {
      const FalseCue& f = all[i];
      t.rows.push_back({.cells = {text_cell(a.run.algorithm), number_cell(f.begin, 2), number_cell(f.end - f.begin, 2),
                                  text_cell(std::string(name_of(f.cue))), text_cell(std::string(name_of(f.kind))),
                                  number_cell(over(f), 1)}});
    }
  }
  return t;
}

Table false_cue_counts(const CueingResult& result) {
  Table t{.title = "Number of false cues, and their time",
          .caption =
              "Stretches of a tenth of a second and more, of all cues together. Wrong sign: felt the other way, above "
              "threshold. Too strong: more than twice. Missing: not felt, where more than twice the threshold was "
              "felt in the vehicle. Turns felt at rest: share of the time in which the driver felt neither force nor "
              "turn, and the platform, on its way back to neutral, turned above threshold."};
  t.columns = {{.name = "algorithm", .align = Align::kLeft},
               {.name = "wrong sign"},
               {.name = "too strong"},
               {.name = "missing"},
               {.name = "all together", .unit = "s"},
               {.name = "turns felt at rest", .unit = "%"}};
  for (const AlgorithmResult& a : result.algorithms) {
    std::array<double, 3> count{};
    double time = 0.0;
    for (const FalseCue& f : a.score.false_cues) {
      count[static_cast<std::size_t>(f.kind)] += 1.0;
      time += f.end - f.begin;
    }
    t.rows.push_back(
        {.cells = {text_cell(a.run.algorithm), number_cell(count[0], 0), number_cell(count[1], 0),
                   number_cell(count[2], 0), number_cell(time, 1), number_cell(100.0 * a.score.felt_return, 1)}});
  }
  return t;
}

Section tuning_section(const CueingResult& result) {
  Table costs{.title = "What tuning gained",
              .caption = "Cost of a drive: 1 is that of a platform that stands still. Drives: how many were tried."};
  costs.columns = {{.name = "algorithm", .align = Align::kLeft},
                   {.name = "cost before"},
                   {.name = "cost after"},
                   {.name = "drives"}};
  Table knobs{.title = "Knobs that were turned"};
  knobs.columns = {{.name = "algorithm", .align = Align::kLeft},
                   {.name = "knob", .align = Align::kLeft},
                   {.name = "before", .align = Align::kLeft},
                   {.name = "after", .align = Align::kLeft},
                   {.name = "unit", .align = Align::kLeft}};
  for (const AlgorithmResult& a : result.algorithms) {
    if (!a.tuning) continue;
    costs.rows.push_back(
        {.cells = {text_cell(a.run.algorithm), number_cell(a.tuning->cost_before, 3),
                   number_cell(a.tuning->cost_after, 3), number_cell(static_cast<double>(a.tuning->evaluations), 0)}});
    for (const TunedKnob& k : a.tuning->knobs)
      knobs.rows.push_back({.cells = {text_cell(a.run.algorithm), text_cell(k.name),
                                      text_cell(fmt::format("{:.4g}", fmt::join(k.before, ", "))),
                                      text_cell(fmt::format("{:.4g}", fmt::join(k.after, ", "))),
                                      text_cell(k.unit == "1" ? "" : k.unit)}});
  }
  Section section{.title = "Tuned knobs", .blocks = {std::move(costs)}};
  if (knobs.rows.empty()) {
    section.blocks.emplace_back(Paragraph{"No knob was turned: none of the drives that were tried was better."});
  } else {
    section.blocks.emplace_back(std::move(knobs));
  }
  return section;
}

}  // namespace veridyn::report
