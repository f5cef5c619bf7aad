#include "veridyn/report/sensitivity_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/sensitivity/sensitivity_tables.hpp"
#include "veridyn/report/parts/index_blocks.hpp"
#include "veridyn/report/parts/remarks.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::muscle;

bool in_set(const std::optional<TaskSet>& set, std::size_t task) {
  return set && std::binary_search(set->tasks.begin(), set->tasks.end(), task);
}

std::string muscle_names(const std::vector<std::size_t>& which, const MuscleSensitivity& s) {
  std::string text;
  for (const std::size_t m : which) text += (text.empty() ? "" : ", ") + s.muscles[m];
  return text;
}

Verdict sensitivity_verdict(const MuscleSensitivity& s) {
  Verdict v;
  const std::size_t all = s.muscles.size();
  if (!s.cover.chosen) {
    v.level = Level::kBad;
    v.headline = "No task can be chosen.";
    return v;
  }
  const TaskSet& chosen = *s.cover.chosen;
  v.level = chosen.excited == all && !s.bands_allowed ? Level::kGood : Level::kCaution;
  v.word = v.level == Level::kGood ? "Every muscle" : chosen.excited == all ? "With care" : "Not every muscle";
  v.headline = fmt::format("Tasks {} excite {} of {} muscles.", task_list(s, chosen), chosen.excited, all);
  v.lines.push_back(fmt::format("{} is excited least: {:.0f} % of the greatest NRMSE that a task has of it.",
                                s.muscles[chosen.weakest_muscle], 100.0 * chosen.weakest));
  if (s.cover.runner_up)
    v.lines.push_back(fmt::format("Runner-up: tasks {}, {} muscles, the weakest {:.0f} %.",
                                  task_list(s, *s.cover.runner_up), s.cover.runner_up->excited,
                                  100.0 * s.cover.runner_up->weakest));
  v.lines.emplace_back(
      "NRMSE says how far a motion goes with a muscle's parameters, not whether they can be distinguished from each "
      "other: the estimate says that.");
  return v;
}

Matrix heat_map(const SensitivityStudy& study, const MuscleSensitivity& s) {
  Matrix map{.title = "Mean NRMSE [%]",
             .caption = fmt::format(
                 "How far a task's motion goes from the standard model's, under the same controls, when F0, L0 and LS "
                 "of one muscle are within {:g} % of the model's: mean over {} points of a Sobol sequence.",
                 100.0 * study.options.sampling.range, s.sampling.samples),
             .column_names = s.muscles,
             .low = 0.0,
             .high = 1e-9,
             .decimals = 1};
  for (std::size_t t = 0; t < s.tasks.size(); ++t) {
    map.row_names.push_back((in_set(s.cover.chosen, t) ? "chosen: " : "") + s.tasks[t].name);
    std::vector<double> row;
    for (std::size_t m = 0; m < s.muscles.size(); ++m) {
      row.push_back(100.0 * s.sampling.mean(m, t));
      if (std::isfinite(row.back())) map.high = std::max(map.high, row.back());
    }
    map.values.push_back(std::move(row));
  }
  return map;
}

Table choice_table(const SensitivityStudy& study, const MuscleSensitivity& s) {
  Table table{.title = "Choice",
              .caption = fmt::format(
                  "Of all sets of so many tasks the one that excites most muscles ({:g} % of the greatest NRMSE); of "
                  "these the one whose weakest muscle is excited most, then the greatest mean.{}",
                  100.0 * study.options.cover.share,
                  s.cover.exhaustive ? "" : " There are too many to compare all: found by exchanging tasks."),
              .columns = {{.name = "Set"},
                          {.name = "Tasks"},
                          {.name = "muscles excited"},
                          {.name = "weakest muscle"},
                          {.name = "its share", .unit = "%", .digits = 3},
                          {.name = "mean share", .unit = "%", .digits = 3}},
              .sortable = false};
  const auto row = [&](const char* name, const TaskSet& set) {
    table.rows.push_back(
        {.cells = {text_cell(name), text_cell(task_list(s, set)), number_cell(static_cast<double>(set.excited), 0),
                   text_cell(s.muscles[set.weakest_muscle]), number_cell(100.0 * set.weakest),
                   number_cell(100.0 * set.mean)}});
  };
  if (s.cover.chosen) row("chosen", *s.cover.chosen);
  if (s.cover.runner_up) row("runner-up", *s.cover.runner_up);
  return table;
}

Table task_table(std::span<const PreparedTask> tasks, const MuscleSensitivity& s) {
  Table table{.title = "Tasks",
              .caption =
                  "Excites: at least the share above of the greatest NRMSE of the muscle. Tracking: the standard "
                  "model's largest distance from the desired motion. Reserves: their largest moment as a share "
                  "of the muscles' largest.",
              .columns = {{.name = "Task"},
                          {.name = ""},
                          {.name = "Excites"},
                          {.name = "Tracking", .unit = "deg", .digits = 2},
                          {.name = "Reserves", .unit = "%", .digits = 2},
                          {.name = "Failed"},
                          {.name = "Why not"}}};
  for (std::size_t t = 0; t < s.tasks.size(); ++t) {
    const TaskFinding& f = s.tasks[t];
    std::string why = f.obstacle;
    for (const std::string& band : f.wrap_bands) why += (why.empty() ? "" : "; ") + band;
    const bool chosen = in_set(s.cover.chosen, t);
    table.rows.push_back(
        {.cells = {text_cell(f.name),
                   chosen ? status_cell(Status::kGood, "chosen")
                          : text_cell(in_set(s.cover.runner_up, t) ? "runner-up" : ""),
                   text_cell(muscle_names(s.cover.excites[t], s)), number_cell(tasks[t].tracking_error / kDegree),
                   number_cell(100.0 * tasks[t].reserve_share), number_cell(static_cast<double>(f.failed), 0),
                   text_cell(why)},
         .status = !f.obstacle.empty() ? Status::kBad
                   : !why.empty()      ? Status::kCaution
                                       : Status::kNone});
  }
  return table;
}

Section index_section(const SensitivityStudy& study, const MuscleSensitivity& s) {
  Section section{.title = "Indices of the chosen tasks", .id = "indices"};
  const bool shares = std::ranges::any_of(s.indices.results, [](const auto& r) { return !r.variance.inputs.empty(); });
  section.blocks.emplace_back(index_explanation(shares));
  for (const ResultIndices& r : s.indices.results) {
    const IndexedResult result{
        .indices = r, .inputs = s.indices.inputs, .quantity = "the NRMSE", .unit = "%", .factor = 100.0};
    if (!r.variance.inputs.empty())
      section.blocks.emplace_back(index_plot(result, study.options.indices.variance.level));
    if (!r.morris.empty()) section.blocks.emplace_back(morris_table(result));
  }
  return section;
}

}  // namespace

Document sensitivity_report(const SensitivityStudy& study, std::span<const PreparedTask> tasks,
                            const MuscleSensitivity& result, const std::string& program) {
  Document document = started_document(
      study.title, fmt::format("Musculoskeletal model {}: sensitivity", study.subject.model_name), program);
  document.verdict = sensitivity_verdict(result);
  document.facts = {{"Model", study.subject.model_name},
                    {"Muscles", fmt::format("{}", result.muscles.size())},
                    {"Tasks", fmt::format("{}", result.tasks.size())},
                    {"Samples", fmt::format("{} a muscle", result.sampling.samples)},
                    {"Simulations", fmt::format("{}", result.sampling.simulations + result.indices.simulations)},
                    {"Seed", fmt::format("{}", study.seed)}};
  add_warnings(document, result.warnings);
  Section map{.title = "Which muscle moves which task", .id = "map"};
  map.blocks.emplace_back(choice_table(study, result));
  map.blocks.emplace_back(heat_map(study, result));
  document.sections.push_back(std::move(map));
  if (!result.indices.results.empty()) document.sections.push_back(index_section(study, result));
  Section list{.title = "Tasks", .id = "tasks"};
  list.blocks.emplace_back(task_table(tasks, result));
  document.sections.push_back(std::move(list));
  std::vector<std::string> notes = study.notes;
  for (const std::string& note : study.subject.system->notes()) notes.push_back(note);
  notes.push_back(
      fmt::format("Sampling: {} simulations in {:.1f} s, {:.1f} s of processor time. Indices: {} in {:.1f} "
                  "s, {:.1f} s.",
                  result.sampling.simulations, result.sampling.seconds, result.sampling.processor_seconds,
                  result.indices.simulations, result.indices.seconds, result.indices.processor_seconds));
  add_notes(document, notes);
  return document;
}

}  // namespace veridyn::report
