#include "veridyn/report/cueing_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "veridyn/core/text.hpp"
#include "veridyn/report/document/number_format.hpp"
#include "veridyn/report/figures/cueing_figures.hpp"
#include "veridyn/report/figures/platform_figure.hpp"
#include "veridyn/report/figures/response_figures.hpp"
#include "veridyn/report/parts/cueing_tables.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::cueing;

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
  for (const Cue cue : kAllCues) {
    if (is_moved(result, cue)) section.blocks.emplace_back(score_table(result, cue));
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
  if (study.tune) d.sections.push_back(tuning_section(result));
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
