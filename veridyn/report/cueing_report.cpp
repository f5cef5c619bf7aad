#include "veridyn/report/cueing_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace veridyn::report {
namespace {

using namespace veridyn::cueing;

/// Numbers of turns are shown in degrees.
double shown(Cue cue, double value) { return cue < Cue::kRoll ? value : value / kDegree; }
const char* shown_unit(Cue cue) { return cue < Cue::kRoll ? "m/s^2" : "deg/s"; }
double shown(PlatformAxis axis, double value) { return turns(axis) ? value / kDegree : 1000.0 * value; }
const char* shown_unit(PlatformAxis axis) { return turns(axis) ? "deg" : "mm"; }

std::string with_interval(const Measured& m, double scale = 1.0) {
  if (!std::isfinite(m.value)) return "-";
  if (!std::isfinite(m.low)) return fmt::format("{:.3f}", scale * m.value);
  return fmt::format("{:.3f} ({:.3f} to {:.3f})", scale * m.value, scale * m.low, scale * m.high);
}

bool is_moved(const CueingResult& result, Cue cue) {
  const FeltMotion& felt = result.algorithms.front().felt;
  const std::vector<double>& v = felt.felt[cue].vehicle;
  return std::any_of(v.begin(), v.end(), [&](double x) { return std::abs(x) > felt.threshold[cue]; });
}

Table score_table(const CueingResult& result, Cue cue) {
  const FeltMotion& felt = result.algorithms.front().felt;
  Table t{.title = fmt::format("{}", name_of(cue)),
          .caption =
              fmt::format("What is felt on the platform against what was felt in the vehicle, threshold {:.2g} {}. In "
                          "brackets 95 % intervals over blocks of 10 s.",
                          shown(cue, felt.threshold[cue]), shown_unit(cue))};
  t.columns = {{.name = "algorithm", .align = Align::kLeft},
               {.name = "Pearson correlation", .align = Align::kLeft},
               {.name = "lag", .unit = "s", .align = Align::kLeft},
               {.name = "correlation at the lag", .align = Align::kLeft},
               {.name = "RMS error", .unit = shown_unit(cue), .align = Align::kLeft},
               {.name = "time above threshold", .align = Align::kLeft},
               {.name = "Pearson, not felt but physical", .align = Align::kLeft}};
  const double scale = cue < Cue::kRoll ? 1.0 : 1.0 / kDegree;
  for (const AlgorithmResult& a : result.algorithms) {
    const CueScore& s = a.score.cues[cue];
    t.rows.push_back(
        {.cells = {text_cell(a.run.algorithm), text_cell(with_interval(s.pearson)), text_cell(with_interval(s.lag)),
                   text_cell(with_interval(s.at_lag)), text_cell(with_interval(s.rmse, scale)),
                   text_cell(with_interval(s.above)), text_cell(with_interval(s.physical_pearson))}});
  }
  return t;
}

/// Perceived errors of both pairs of axes beside the least that is possible.
Table perceived_table(const CueingResult& result) {
  Table t{.title = "Perceived error",
          .caption =
              "Of force and turn together, in thresholds. Least: with the whole drive known beforehand, within "
              "range, rates and accelerations of the platform; no algorithm can be better."};
  t.columns = {{.name = "algorithm", .align = Align::kLeft},
               {.name = "surge and pitch", .align = Align::kLeft},
               {.name = "over the least"},
               {.name = "sway and roll", .align = Align::kLeft},
               {.name = "over the least"}};
  const auto over = [&](double error, std::size_t pair) {
    return number_cell(result.least[pair] ? error / result.least[pair]->error : NAN, 3);
  };
  for (const AlgorithmResult& a : result.algorithms) {
    const std::array<Measured, 2>& e = a.score.pairs;
    t.rows.push_back({.cells = {text_cell(a.run.algorithm), text_cell(with_interval(e[1])), over(e[1].value, 1),
                                text_cell(with_interval(e[0])), over(e[0].value, 0)}});
  }
  if (const auto& [sway, surge] = result.least; surge && sway) {
    t.rows.push_back(
        {.cells = {text_cell("a platform that stands"), text_cell(fmt::format("{:.3f}", surge->still)),
                   over(surge->still, 1), text_cell(fmt::format("{:.3f}", sway->still)), over(sway->still, 0)}});
    t.rows.push_back(
        {.cells = {text_cell("least"), text_cell(fmt::format("{:.3f}", surge->error)), over(surge->error, 1),
                   text_cell(fmt::format("{:.3f}", sway->error)), over(sway->error, 0)}});
  }
  return t;
}

/// Pairs of algorithms that differ beyond their intervals, in words.
List differences(const CueingResult& result) {
  List list;
  for (std::size_t i = 0; i < result.algorithms.size(); ++i) {
    for (std::size_t j = i + 1; j < result.algorithms.size(); ++j) {
      const CueingScore &a = result.algorithms[i].score, &b = result.algorithms[j].score;
      for (const Cue cue : {Cue::kSurge, Cue::kSway}) {
        if (!is_moved(result, cue)) continue;
        const Measured d = difference(a, b, cue, CueFigure::kPearson);
        if (!std::isfinite(d.low)) continue;
        if (d.low <= 0.0 && d.high >= 0.0) {
          list.items.push_back(fmt::format("{}: {} and {} do not differ beyond their intervals ({:+.3f} to {:+.3f})",
                                           name_of(cue), a.algorithm, b.algorithm, d.low, d.high));
        } else {
          list.items.push_back(fmt::format(
              "{}: {} correlates better than {} by {:.3f} ({:.3f} to {:.3f})", name_of(cue),
              d.low > 0.0 ? a.algorithm : b.algorithm, d.low > 0.0 ? b.algorithm : a.algorithm, std::abs(d.value),
              std::min(std::abs(d.low), std::abs(d.high)), std::max(std::abs(d.low), std::abs(d.high))));
        }
      }
    }
  }
  return list;
}

Table workspace_table(const CueingStudy& study, const CueingResult& result) {
  Table t{.title = "What the platform used",
          .caption =
              "Share of the range on the side that was used most; share of time that the guard held the axis back; "
              "largest share of the rate."};
  t.columns = {{.name = "algorithm", .align = Align::kLeft},
               {.name = "axis", .align = Align::kLeft},
               {.name = "lowest"},
               {.name = "highest"},
               {.name = "unit", .align = Align::kLeft},
               {.name = "range", .unit = "%", .digits = 3},
               {.name = "held back", .unit = "%", .digits = 3},
               {.name = "rate", .unit = "%", .digits = 3},
               {.name = "RMS jerk", .digits = 3}};
  for (const AlgorithmResult& a : result.algorithms) {
    for (std::size_t i = 0; i < kPlatformAxes; ++i) {
      if (!study.platform.limits.axes[i].moves()) continue;
      const auto axis = static_cast<PlatformAxis>(i);
      const AxisScore& s = a.score.axes[i];
      t.rows.push_back(
          {.cells = {text_cell(a.run.algorithm), text_cell(std::string(name_of(axis))),
                     number_cell(shown(axis, s.lowest)), number_cell(shown(axis, s.highest)),
                     text_cell(shown_unit(axis)), number_cell(100.0 * s.used), number_cell(100.0 * s.limited),
                     number_cell(100.0 * s.rate), number_cell(shown(axis, s.rms_jerk))}});
    }
  }
  return t;
}

Table false_cue_table(const CueingResult& result) {
  Table t{.title = "False cues",
          .caption =
              "Stretches of a tenth of a second and more. Wrong sign: felt the other way, above threshold. Too strong: "
              "more than twice. Missing: not felt, where more than twice the threshold was felt in the vehicle. The "
              "largest ones of each algorithm."};
  t.columns = {{.name = "algorithm", .align = Align::kLeft}, {.name = "from", .unit = "s", .digits = 5},
               {.name = "lasts", .unit = "s", .digits = 3},  {.name = "cue", .align = Align::kLeft},
               {.name = "kind", .align = Align::kLeft},      {.name = "off by, over threshold", .digits = 3}};
  constexpr std::size_t kMost = 12;
  for (const AlgorithmResult& a : result.algorithms) {
    std::vector<FalseCue> all = a.score.false_cues;
    const auto over = [&](const FalseCue& f) { return f.size / a.felt.threshold[f.cue]; };
    std::sort(all.begin(), all.end(), [&](const FalseCue& x, const FalseCue& y) { return over(x) > over(y); });
    for (std::size_t i = 0; i < std::min(kMost, all.size()); ++i) {
      const FalseCue& f = all[i];
      t.rows.push_back({.cells = {text_cell(a.run.algorithm), number_cell(f.begin), number_cell(f.end - f.begin),
                                  text_cell(std::string(name_of(f.cue))), text_cell(std::string(name_of(f.kind))),
                                  number_cell(over(f))}});
    }
  }
  return t;
}

Table false_cue_counts(const CueingResult& result) {
  Table t{.title = "Number of false cues, and their time"};
  t.columns = {{.name = "algorithm", .align = Align::kLeft},
               {.name = "wrong sign"},
               {.name = "too strong"},
               {.name = "missing"},
               {.name = "all together", .unit = "s", .digits = 4}};
  for (const AlgorithmResult& a : result.algorithms) {
    std::array<double, 3> count{};
    double time = 0.0;
    for (const FalseCue& f : a.score.false_cues) {
      count[static_cast<std::size_t>(f.kind)] += 1.0;
      time += f.end - f.begin;
    }
    t.rows.push_back({.cells = {text_cell(a.run.algorithm), number_cell(count[0], 0), number_cell(count[1], 0),
                                number_cell(count[2], 0), number_cell(time)}});
  }
  return t;
}

TimeSeries felt_histories(const CueingResult& result) {
  TimeSeries figure{.title = "What is felt",
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
  TimeSeries figure{.title = "What the platform does",
                    .caption = "Where it is after legs and actuators. Dashed: its limits."};
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
    for (const double limit : {limits.lowest, limits.highest}) {
      if (most > 0.5)
        panel.lines.push_back({.name = "limit",
                               .y = std::vector<double>(figure.samples.size(), shown(which, limit)),
                               .role = Role::kReference});
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

void add_responses(const CueingStudy& study, const CueingResult& result, Document& document) {
  Section section{.title = "Gain and phase"};
  for (std::size_t i = 0; i < kCues; ++i) {
    const auto cue = static_cast<Cue>(i);
    XYPlot gain{.title = fmt::format("{}: gain", name_of(cue)), .x = {"log10 frequency", "rad/s"}, .y = {"gain", ""}},
        phase{
            .title = fmt::format("{}: phase", name_of(cue)), .x = {"log10 frequency", "rad/s"}, .y = {"phase", "deg"}};
    for (const AlgorithmResult& a : result.algorithms) {
      const auto found = a.response.find(cue);
      if (found == a.response.end()) continue;
      XYSeries g{.name = a.run.algorithm, .style = Style::kLine}, p{.name = a.run.algorithm, .style = Style::kLine};
      for (const ResponsePoint& r : found->second) {
        g.x.push_back(std::log10(r.frequency));
        g.y.push_back(r.gain);
        p.x.push_back(std::log10(r.frequency));
        p.y.push_back(r.phase / kDegree);
      }
      gain.series.push_back(std::move(g));
      phase.series.push_back(std::move(p));
    }
    if (gain.series.empty()) continue;
    const auto mask = study.response->mask.find(cue);
    if (mask != study.response->mask.end()) {
      const auto add = [&](XYPlot& plot, double MaskPoint::*limit, double unit) {
        XYSeries s{.name = "mask", .role = Role::kReference, .style = Style::kLine};
        for (const MaskPoint& m : mask->second) {
          if (!std::isfinite(m.*limit)) continue;
          s.x.push_back(std::log10(m.frequency));
          s.y.push_back(m.*limit / unit);
        }
        if (!s.x.empty()) plot.series.push_back(std::move(s));
      };
      add(gain, &MaskPoint::least_gain, 1.0);
      add(gain, &MaskPoint::most_gain, 1.0);
      add(phase, &MaskPoint::least_phase, kDegree);
      add(phase, &MaskPoint::most_phase, kDegree);
      for (const AlgorithmResult& a : result.algorithms) {
        const auto out = a.outside_mask.find(cue);
        if (out == a.outside_mask.end() || out->second.empty()) continue;
        std::vector<std::string> at;
        for (const ResponsePoint& r : out->second) at.push_back(fmt::format("{:g}", r.frequency));
        section.blocks.emplace_back(Paragraph{
            fmt::format("{}, {}: outside the mask at {} rad/s.", name_of(cue), a.run.algorithm, fmt::join(at, ", ")),
            Tone::kWarning});
      }
    }
    section.blocks.emplace_back(std::move(gain));
    section.blocks.emplace_back(std::move(phase));
  }
  document.sections.push_back(std::move(section));
}

void add_tuning(const CueingResult& result, Document& document) {
  Section section{.title = "Tuned"};
  for (const AlgorithmResult& a : result.algorithms) {
    if (!a.tuning) continue;
    Table t{.title = fmt::format("{}: cost {:.4f} before, {:.4f} after {} drives", a.run.algorithm,
                                 a.tuning->cost_before, a.tuning->cost_after, a.tuning->evaluations)};
    t.columns = {{.name = "knob", .align = Align::kLeft},
                 {.name = "before", .align = Align::kLeft},
                 {.name = "after", .align = Align::kLeft},
                 {.name = "unit", .align = Align::kLeft}};
    for (const TunedKnob& k : a.tuning->knobs)
      t.rows.push_back({.cells = {text_cell(k.name), text_cell(fmt::format("{:.4g}", fmt::join(k.before, ", "))),
                                  text_cell(fmt::format("{:.4g}", fmt::join(k.after, ", "))), text_cell(k.unit)}});
    section.blocks.emplace_back(std::move(t));
  }
  document.sections.push_back(std::move(section));
}

Verdict cueing_verdict(const CueingResult& result) {
  const auto best = [&](Cue cue) {
    const auto value = [&](const AlgorithmResult& a) {
      const double p = a.score.cues[cue].pearson.value;
      return std::isfinite(p) ? p : -2.0;
    };
    return std::max_element(result.algorithms.begin(), result.algorithms.end(),
                            [&](const AlgorithmResult& a, const AlgorithmResult& b) { return value(a) < value(b); })
        ->score.cues[cue]
        .pearson.value;
  };
  Verdict v{.level = Level::kCaution, .word = "Scored"};
  std::vector<std::string> parts;
  for (const Cue cue : {Cue::kSurge, Cue::kSway}) {
    if (is_moved(result, cue) && std::isfinite(best(cue)))
      parts.push_back(fmt::format("{} felt with a correlation of {:.2f}", name_of(cue), best(cue)));
  }
  v.headline =
      parts.empty() ? "The drive holds no force that is felt." : fmt::format("At best {}.", fmt::join(parts, ", "));
  return v;
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
  Section score{.title = "Score"};
  for (std::size_t i = 0; i < kCues; ++i) {
    if (is_moved(result, static_cast<Cue>(i))) score.blocks.emplace_back(score_table(result, static_cast<Cue>(i)));
  }
  score.blocks.emplace_back(perceived_table(result));
  if (List list = differences(result); !list.items.empty()) score.blocks.emplace_back(std::move(list));
  d.sections.push_back(std::move(score));
  d.sections.push_back({.title = "Felt", .blocks = {felt_histories(result)}});
  d.sections.push_back(
      {.title = "Platform", .blocks = {platform_histories(study, result), workspace_table(study, result)}});
  d.sections.push_back({.title = "False cues", .blocks = {false_cue_counts(result), false_cue_table(result)}});
  if (study.response) add_responses(study, result, d);
  if (study.tune) add_tuning(result, d);
  Section numbers{.title = "Numbers of the algorithms", .folded = true};
  for (const AlgorithmResult& a : result.algorithms) {
    numbers.blocks.emplace_back(Paragraph{a.run.algorithm});
    numbers.blocks.emplace_back(List{.items = a.knobs});
  }
  d.sections.push_back(std::move(numbers));
  return d;
}

}  // namespace veridyn::report
