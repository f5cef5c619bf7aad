#include "veridyn/report/cueing_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/text.hpp"
#include "veridyn/report/document/number_format.hpp"
#include "veridyn/report/figures/platform_figure.hpp"
#include "veridyn/report/figures/response_figures.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::cueing;

/// Numbers of turns are shown in degrees.
double shown(Cue cue, double value) { return cue < Cue::kRoll ? value : value / kDegree; }
const char* shown_unit(Cue cue) { return cue < Cue::kRoll ? "m/s^2" : "deg/s"; }
double shown(PlatformAxis axis, double value) { return turns(axis) ? value / kDegree : 1000.0 * value; }
const char* shown_unit(PlatformAxis axis) { return turns(axis) ? "deg" : "mm"; }

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

bool is_moved(const CueingResult& result, Cue cue) {
  const FeltMotion& felt = result.algorithms.front().felt;
  const std::vector<double>& v = felt.felt[cue].vehicle;
  return std::any_of(v.begin(), v.end(), [&](double x) { return std::abs(x) > felt.threshold[cue]; });
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

/// The correlation of a cue, and where there is none: below all others.
double correlation(const AlgorithmResult& a, Cue cue) {
  const double p = a.score.cues[cue].pearson.value;
  return std::isfinite(p) ? p : -2.0;
}

const AlgorithmResult& best_of(const CueingResult& result, Cue cue) {
  return *std::max_element(
      result.algorithms.begin(), result.algorithms.end(),
      [&](const AlgorithmResult& a, const AlgorithmResult& b) { return correlation(a, cue) < correlation(b, cue); });
}

/// Correlations of all cues and algorithms at a glance.
IntervalPlot correlation_figure(const CueingResult& result) {
  IntervalPlot plot{
      .title = "Correlation of what is felt with what was felt in the vehicle",
      .caption =
          "1: as in the vehicle. 0: nothing to do with it. Below 0: rather the other way. With 95 % intervals over "
          "blocks of 10 s, where the drive has four blocks or more.",
      .shared_scale = true};
  for (const AlgorithmResult& a : result.algorithms) plot.methods.push_back(a.run.algorithm);
  for (std::size_t i = 0; i < kCues; ++i) {
    const auto cue = static_cast<Cue>(i);
    if (!is_moved(result, cue)) continue;
    IntervalRow row{.name = std::string(name_of(cue))};
    for (const AlgorithmResult& a : result.algorithms) {
      const Measured& m = a.score.cues[cue].pearson;
      row.estimates.push_back({.value = m.value, .low = m.low, .high = m.high});
    }
    plot.rows.push_back(std::move(row));
  }
  return plot;
}

/// Perceived errors of both pairs of axes beside the least that is possible.
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

/// The best algorithm of a cue against each other one, in words.
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

/// Each algorithm against the first one, in the cues of forces.
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
              "the axis from what the algorithm wanted. Rate: the largest, over what is allowed. Jerk in the "
              "axis's unit over s^3."};
  t.columns = {{.name = "axis", .align = Align::kLeft}, {.name = "algorithm", .align = Align::kLeft},
               {.name = "lowest", .digits = 3},         {.name = "highest", .digits = 3},
               {.name = "range", .unit = "%"},          {.name = "held back", .unit = "%"},
               {.name = "rate", .unit = "%"},           {.name = "RMS jerk", .digits = 3}};
  const auto percent = [](double share) { return number_cell(100.0 * share, share < 0.0995 ? 1 : 0); };
  for (std::size_t i = 0; i < kPlatformAxes; ++i) {
    if (!study.platform.limits.axes[i].moves()) continue;
    const auto axis = static_cast<PlatformAxis>(i);
    const int decimals = turns(axis) ? 2 : 1;
    for (const AlgorithmResult& a : result.algorithms) {
      const AxisScore& s = a.score.axes[i];
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
              "turn, and the platform, on its way home, turned above threshold."};
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

TimeSeries felt_histories(const CueingResult& result) {
  TimeSeries figure{.title = "Felt force and rate",
                    .caption = "Grey: in the vehicle. Coloured: on the platform, after canals and otoliths."};
  figure.samples = result.algorithms.front().felt.time;
  for (std::size_t i = 0; i < kCues; ++i) {
    const auto cue = static_cast<Cue>(i);
    if (!is_moved(result, cue)) continue;
    const auto in_unit = [&](std::vector<double> values) {
      for (double& v : values) v = shown(cue, v);
      return values;
    };
    Panel panel{.label = std::string(name_of(cue)), .unit = shown_unit(cue)};
    panel.lines.push_back(
        {.name = "vehicle", .y = in_unit(result.algorithms.front().felt.felt[cue].vehicle), .role = Role::kMeasured});
    for (const AlgorithmResult& a : result.algorithms)
      panel.lines.push_back({.name = a.run.algorithm, .y = in_unit(a.felt.felt[cue].platform)});
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

TimeSeries platform_histories(const CueingStudy& study, const CueingResult& result) {
  TimeSeries figure{.title = "Position over time",
                    .caption = "Where it is after legs and actuators. Dashed: limits, where more than half is used."};
  figure.samples = result.algorithms.front().felt.time;
  for (std::size_t i = 0; i < kPlatformAxes; ++i) {
    const AxisLimits& limits = study.platform.limits.axes[i];
    if (!limits.moves()) continue;
    const auto which = static_cast<PlatformAxis>(i);
    Panel panel{.label = std::string(name_of(which)), .unit = shown_unit(which)};
    double most = 0.0;
    for (const AlgorithmResult& a : result.algorithms) {
      Line line{.name = a.run.algorithm};
      for (const CueingStep& s : a.run.steps) line.y.push_back(shown(which, axis(s.reached, which).position));
      most = std::max(most, a.score.axes[i].used);
      panel.lines.push_back(std::move(line));
    }
    if (most > 0.5) {
      for (const auto& [name, limit] :
           {std::pair("upper limit", limits.highest), std::pair("lower limit", limits.lowest)})
        panel.lines.push_back({.name = name,
                               .y = std::vector<double>(figure.samples.size(), shown(which, limit)),
                               .role = Role::kReference});
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

void add_tuning(const CueingResult& result, Document& document) {
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
  document.sections.push_back(std::move(section));
}

Verdict cueing_verdict(const CueingResult& result) {
  Verdict v{.level = Level::kCaution, .word = "Scored"};
  std::vector<std::string> named, bare;
  const AlgorithmResult* only = nullptr;
  bool same = true;
  for (const Cue cue : {Cue::kSurge, Cue::kSway}) {
    const AlgorithmResult& best = best_of(result, cue);
    if (!is_moved(result, cue) || correlation(best, cue) < -1.0) continue;
    same = same && (only == nullptr || only == &best);
    only = &best;
    const std::string value = format_decimals(correlation(best, cue), 2);
    named.push_back(fmt::format("{} in {} (correlation {})", best.run.algorithm, name_of(cue), value));
    bare.push_back(fmt::format("{} in {}", value, name_of(cue)));
  }
  if (only == nullptr) {
    v.headline = "The drive holds no force that is felt.";
  } else if (!same) {
    v.headline = fmt::format("Most like the drive: {}.", fmt::join(named, ", "));
  } else {
    v.headline =
        fmt::format("{}{}: correlation {}.", result.algorithms.size() > 1 ? "Most like the drive is " : "With ",
                    only->run.algorithm, fmt::join(bare, ", "));
  }
  return v;
}

Section score_tables(const CueingResult& result) {
  Section section{.title = "Cue by cue"};
  section.blocks.emplace_back(Paragraph{
      "What is felt on the platform against what was felt in the vehicle. Correlation: Pearson's, at the same time. "
      "Lag: by how much the platform is late where they are most alike, with the correlation there. Off: share of time "
      "in which they differ by more than the threshold. Physical: the correlation of force or rate itself. In brackets "
      "95 % intervals over blocks of 10 s.",
      Tone::kPlain});
  for (std::size_t i = 0; i < kCues; ++i) {
    if (is_moved(result, static_cast<Cue>(i))) section.blocks.emplace_back(score_table(result, static_cast<Cue>(i)));
  }
  if (Table t = against_first(result); !t.rows.empty() && t.columns.size() > 1)
    section.blocks.emplace_back(std::move(t));
  return section;
}

Section false_cue_section(const CueingResult& result) {
  Section section{.title = "False cues", .blocks = {false_cue_counts(result)}};
  if (Table largest = false_cue_table(result); !largest.rows.empty()) section.blocks.emplace_back(std::move(largest));
  return section;
}

/// "onset = 0.8, 1, 1 rad/s" as knob and value.
Section knob_section(const CueingResult& result) {
  Table t{};
  t.columns = {{.name = "algorithm", .align = Align::kLeft},
               {.name = "knob", .align = Align::kLeft},
               {.name = "value", .align = Align::kLeft}};
  for (const AlgorithmResult& a : result.algorithms) {
    for (const std::string& knob : a.knobs) {
      const std::size_t at = knob.find(" = ");
      std::string value = at == std::string::npos ? "" : knob.substr(at + 3);
      if (value.ends_with(" 1")) value.resize(value.size() - 2);  // the unit of a plain number
      t.rows.push_back(
          {.cells = {text_cell(a.run.algorithm), text_cell(knob.substr(0, at)), text_cell(std::move(value))}});
    }
  }
  return {.title = "Numbers of the algorithms", .blocks = {std::move(t)}, .folded = true};
}

/// What each knob of an algorithm does.
TimeSeries knob_figure(const AlgorithmResult& a) {
  TimeSeries figure{
      .title = fmt::format("Knobs of {}", a.run.algorithm),
      .caption = "The cue that each changes most. Braking at 2 s, a bend to the left at 11 s, a bump at 22 s."};
  figure.samples = a.effects.front().time;
  for (const KnobEffect& e : a.effects) {
    if (e.difference <= 0.0) continue;
    const auto in_unit = [&](std::vector<double> values) {
      for (double& v : values) v = shown(e.cue, v);
      return values;
    };
    Panel panel{.label = fmt::format("{}: {}", e.knob.name, name_of(e.cue)), .unit = shown_unit(e.cue)};
    panel.lines.push_back({.name = "vehicle", .y = in_unit(e.vehicle), .role = Role::kMeasured});
    constexpr std::array kNamesOfFactors = {"half", "as set", "twice"};
    for (std::size_t f = 0; f < e.factors.size(); ++f) {
      if (f != 1 && e.factors[f] == 1.0) continue;
      panel.lines.push_back({.name = kNamesOfFactors[f], .y = in_unit(e.platform[f])});
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

Section knob_effect_section(const AlgorithmResult& a) {
  Table t{.caption =
              "Difference: RMS of what is felt with the knob at half and at twice, over the threshold, in the cue "
              "that changes most."};
  t.columns = {{.name = "knob", .align = Align::kLeft},
               {.name = "turned up", .align = Align::kLeft},
               {.name = "changes", .align = Align::kLeft},
               {.name = "difference"}};
  for (const KnobEffect& e : a.effects) {
    t.rows.push_back({.cells = {text_cell(e.knob.name), text_cell(e.knob.feel),
                                text_cell(e.difference > 0.0 ? std::string(name_of(e.cue)) : "nothing here"),
                                number_cell(e.difference, 2)}});
  }
  Section section{.title = capitalised(a.run.algorithm), .blocks = {std::move(t)}};
  if (TimeSeries figure = knob_figure(a); !figure.panels.empty()) section.blocks.emplace_back(std::move(figure));
  return section;
}

}  // namespace

Document cueing_report(const CueingStudy& study, const CueingResult& result, const std::string& program) {
  Document d{.title = study.title.empty() ? "Motion cueing" : study.title,
             .subtitle = fmt::format("{} on platform {}", study.drive, study.platform.name),
             .generator = "Made with " + program};
  d.verdict = cueing_verdict(result);
  d.verdict.lines = study.notes;
  const CueingScore& first = result.algorithms.front().score;
  d.verdict.lines.insert(d.verdict.lines.end(), first.notes.begin(), first.notes.end());
  d.verdict.lines.insert(d.verdict.lines.end(), result.notes.begin(), result.notes.end());
  std::vector<std::string> names;
  for (const AlgorithmResult& a : result.algorithms) names.push_back(a.run.algorithm);
  d.facts = {{"Drive", study.drive},
             {"Lasts", fmt::format("{:.1f} s", first.duration)},
             {"Platform", study.platform.name},
             {"Algorithms", fmt::format("{}", fmt::join(names, ", "))},
             {"Perception", study.perception}};
  if (IntervalPlot glance = correlation_figure(result); !glance.rows.empty()) {
    Section score{.title = "Score", .blocks = {std::move(glance)}};
    if (List list = differences(result); !list.items.empty()) score.blocks.emplace_back(std::move(list));
    score.blocks.emplace_back(perceived_table(result));
    d.sections.push_back(std::move(score));
  }
  d.sections.push_back({.title = "What the platform does",
                        .blocks = {platform_figure(study.platform, result), platform_histories(study, result),
                                   workspace_table(study, result)}});
  if (TimeSeries felt = felt_histories(result); !felt.panels.empty()) {
    d.sections.push_back({.title = "What is felt", .blocks = {std::move(felt)}});
    d.sections.push_back(score_tables(result));
  }
  d.sections.push_back(false_cue_section(result));
  if (study.response) d.sections.push_back(response_section(*study.response, result));
  if (study.tune) add_tuning(result, d);
  d.sections.push_back(knob_section(result));
  return d;
}

Document knob_report(const CueingStudy& study, const CueingResult& result, const std::string& program) {
  Document d{.title = "What each knob does",
             .subtitle = fmt::format("a drive of 30 s on platform {}: braking, a bend, a bump", study.platform.name),
             .generator = "Made with " + program};
  d.verdict.level = Level::kGood;
  d.verdict.word = "Knobs";
  for (const AlgorithmResult& a : result.algorithms) {
    d.sections.push_back(knob_effect_section(a));
    const auto [least, most] = std::minmax_element(
        a.effects.begin(), a.effects.end(),
        [](const KnobEffect& one, const KnobEffect& other) { return one.difference < other.difference; });
    const std::string line = fmt::format("With {}, {} changes what is felt most, {} least.", a.run.algorithm,
                                         most->knob.name, least->knob.name);
    if (d.verdict.headline.empty())
      d.verdict.headline = line;
    else
      d.verdict.lines.push_back(line);
  }
  return d;
}

}  // namespace veridyn::report
