#include "veridyn/report/muscle_task_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/moments.hpp"
#include "veridyn/report/document/number_format.hpp"
#include "veridyn/report/parts/analysis_sections.hpp"
#include "veridyn/report/parts/estimate_tables.hpp"
#include "veridyn/report/parts/posterior_section.hpp"
#include "veridyn/report/parts/profile_section.hpp"
#include "veridyn/report/parts/remarks.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::muscle;

/// Tasks in a figure; more would be slivers.
constexpr std::size_t kMostPanels = 12;
/// Tasks on the first screen.
constexpr std::size_t kLeadTasks = 4;

std::size_t count_tasks(const MuscleAnalysis& a, bool hold_out) {
  return static_cast<std::size_t>(
      std::count_if(a.tasks.begin(), a.tasks.end(), [&](const TaskOutcome& t) { return t.hold_out == hold_out; }));
}

std::vector<Fact> task_facts(const TaskStudy& study, const MuscleAnalysis& a) {
  std::vector<Fact> list{{"Model", study.subject.model_name},
                         {"Recording", study.person ? "a simulated person" : "measured motion"},
                         {"Estimated", a.estimate.verdict},
                         {"Held out", fmt::format("{} tasks", count_tasks(a, true))}};
  if (study.emg) {
    list.push_back(
        {"EMG", fmt::format("{} signals drive the muscles along the recorded angles", study.emg->signals.size())});
    for (std::size_t j = 0; j < a.outputs.size() && j < at(a.moment_noise.size()); ++j)
      list.push_back(
          {fmt::format("Noise of {}", a.outputs[j].name),
           fmt::format("{:.3g} {}{}", a.moment_noise(j), a.outputs[j].unit,
                       study.outputs[j].noise_sd > 0.0 ? " (stated)" : " (found together with the EMG's error)")});
    if (!a.emg_share.empty())
      list.push_back({"Error of the EMG",
                      fmt::format("{:.0f} % of the residual's variance", 100.0 * numerics::mean(a.emg_share))});
  }
  if (!a.result.searches.empty()) list.push_back({"Method", a.estimate.method});
  return list;
}

Section muscle_parameters(const TaskStudy& study, const MuscleAnalysis& a) {
  Section section{.title = "Parameters", .id = "parameters"};
  const bool truth = !a.truth.empty();
  Table table{.title = "Parameters",
              .caption =
                  "95 % intervals, priors included. Learned: the share of the prior's variance that the tasks removed. "
                  "Identified from three quarters on, weak from a quarter on; what is less is the prior's, and not "
                  "excited: the tasks hardly move with the parameter, or as much with others.",
              .columns = {{.name = "parameter", .align = Align::kLeft},
                          {.name = ""},
                          {.name = "standard"},
                          {.name = "value"},
                          {.name = "sigma"},
                          {.name = "from", .group = "95 %"},
                          {.name = "to", .group = "95 %"},
                          {.name = "unit", .align = Align::kLeft},
                          {.name = "learned", .unit = "%", .digits = 3}}};
  if (truth) table.columns.insert(table.columns.begin() + 4, {.name = "truth"});
  for (std::size_t i = 0; i < a.estimate.parameters.size(); ++i) {
    const estimation::Parameter& p = a.estimate.parameters[i];
    const auto unknown = std::find_if(study.unknowns.begin(), study.unknowns.end(),
                                      [&](const MuscleUnknown& u) { return u.name == p.name; });
    const double start = unknown != study.unknowns.end() ? unknown->start : kNaN;
    Row row{.cells = {text_cell(p.name), status_cell(status_of(p.status)), measured_cell(start, p.sigma)}};
    for (Cell& cell : interval_cells(p.value, p.sigma, p.low95, p.high95)) row.cells.push_back(std::move(cell));
    if (truth) row.cells.insert(row.cells.begin() + 4, measured_cell(a.true_value(p.name), p.sigma));
    row.cells.push_back(text_cell(p.unit == "1" ? "" : p.unit));
    row.cells.push_back(number_cell(i < at(a.result.learned.size()) ? 100.0 * a.result.learned(i) : kNaN));
    row.status = status_of(p.status);
    table.rows.push_back(std::move(row));
  }
  section.blocks.emplace_back(std::move(table));
  return section;
}

/// Which electrode is whose.
Section emg_section(const TaskStudy& study) {
  Section section{.title = "Which EMG drives which muscle", .id = "emg", .folded = true};
  if (!study.emg) return section;
  Table table{.title = "EMG",
              .caption = "Muscles of one signal share its error. A muscle at rest stays at its least activation.",
              .columns = {{.name = "signal", .align = Align::kLeft}, {.name = "muscles", .align = Align::kLeft}}};
  const auto add = [&](const std::string& name, int signal) {
    std::vector<std::string> muscles;
    for (std::size_t m = 0; m < study.emg->signal_of.size(); ++m)
      if (study.emg->signal_of[m] == signal) muscles.push_back(study.subject.system->model().muscles[m].name());
    if (!muscles.empty())
      table.rows.push_back({.cells = {text_cell(name), text_cell(fmt::format("{}", fmt::join(muscles, ", ")))}});
  };
  for (std::size_t s = 0; s < study.emg->signals.size(); ++s) add(study.emg->signals[s], static_cast<int>(s));
  add("at rest", -1);
  section.blocks.emplace_back(std::move(table));
  return section;
}

Section directions_section(const MuscleAnalysis& a) {
  Section section{.title = "What only combinations are known of", .id = "directions"};
  if (a.result.null_directions.empty()) return section;
  section.blocks.emplace_back(Paragraph{
      "Along these combinations the tasks say less than the priors: raising what stands before \"against\" and "
      "lowering what stands after it, in proportion to the priors' widths, leaves the motion nearly as it is. "
      "The least known first."});
  section.blocks.emplace_back(List{.items = a.result.null_directions});
  return section;
}

/// What to perform next: the best candidates.
Section advice_section(const MuscleAnalysis& a) {
  Section section{.title = "Which task next", .id = "next-task"};
  if (!a.advice.withheld.empty())
    section.blocks.emplace_back(Paragraph{"No task is advised: " + a.advice.withheld + "."});
  if (a.advice.tasks.empty()) return section;
  constexpr std::size_t kShown = 3;
  section.blocks.emplace_back(Paragraph{fmt::format(
      "The widest interval is that of {}: 95 % within +-{:.2g} % of the standard model's value. Predicted from the "
      "exact sensitivities of "
      "{} tasks that were not performed, at the estimate and with the controls with which the standard model follows "
      "them: what the widest interval would be with one of them added.",
      a.advice.now.parameter, 100.0 * a.advice.now.share, a.advice.tasks.size())});
  if (a.advice.of_prior)
    section.blocks.emplace_back(Paragraph{
        "No parameter is identified, and no single task would make one so: these widths are nearly the "
        "priors', sensitivities change within them, and what a task brings may be far from what is predicted."});
  else if (!a.advice.left_to_prior.empty())
    section.blocks.emplace_back(
        Paragraph{fmt::format("Only parameters count that are identified, or would be with one of these tasks. Left to "
                              "their priors, whichever "
                              "task is added: {}.",
                              fmt::join(a.advice.left_to_prior, ", "))});
  Table table{.title = "Which task next",
              .columns = {{.name = "task", .align = Align::kLeft},
                          {.name = "now", .unit = "%", .digits = 3, .group = "widest interval, +-"},
                          {.name = "then", .unit = "%", .digits = 3, .group = "widest interval, +-"},
                          {.name = "then that of", .align = Align::kLeft}}};
  for (std::size_t i = 0; i < std::min(kShown, a.advice.tasks.size()); ++i) {
    const AdvisedTask& task = a.advice.tasks[i];
    table.rows.push_back({.cells = {text_cell(task.name), number_cell(100.0 * a.advice.now.share),
                                    number_cell(100.0 * task.then.share), text_cell(task.then.parameter)}});
  }
  section.blocks.emplace_back(std::move(table));
  if (!a.advice.left_out.empty())
    section.blocks.emplace_back(
        Paragraph{fmt::format("Not to be advised: {}.", fmt::join(a.advice.left_out, "; ")), Tone::kNote});
  return section;
}

Cell share_cell(double value) { return std::isfinite(value) ? number_cell(100.0 * value) : text_cell("-"); }

Table task_table(const MuscleAnalysis& a) {
  const bool angle = !a.outputs.empty() && a.outputs.front().unit == "rad";
  const double unit = angle ? 1.0 / kDegree : 1.0;
  const std::string name = a.outputs.empty() ? "" : angle ? "deg" : a.outputs.front().unit;
  Table table{.title = "Tasks",
              .caption =
                  "Before: with the standard model's parameters; after: with the estimate. RMSE of the motion, NRMSE "
                  "as its share of the target's range. A dash: the simulation cannot finish, or the target moves "
                  "less than a degree.",
              .columns = {{.name = "task", .align = Align::kLeft},
                          {.name = "", .align = Align::kLeft},
                          {.name = "before", .unit = "%", .digits = 3, .group = "NRMSE"},
                          {.name = "after", .unit = "%", .digits = 3, .group = "NRMSE"},
                          {.name = "before", .unit = name, .digits = 3, .group = "RMSE"},
                          {.name = "after", .unit = name, .digits = 3, .group = "RMSE"},
                          {.name = "reserves", .unit = "%", .digits = 2}}};
  for (const TaskOutcome& t : a.tasks) {
    table.rows.push_back(
        {.cells = {text_cell(t.name), text_cell(t.hold_out ? "unseen" : "trained"), share_cell(t.before.nrmse),
                   share_cell(t.after.nrmse), number_cell(unit * t.before.rmse), number_cell(unit * t.after.rmse),
                   number_cell(100.0 * t.reserve_share)},
         .status = std::isfinite(t.after.rmse) ? Status::kNone : Status::kBad});
  }
  return table;
}

std::vector<double> output_column(const estimation::RowMatrix& values, std::size_t output, double unit) {
  std::vector<double> column;
  for (Eigen::Index k = 0; k < values.rows(); ++k) column.push_back(unit * values(k, output));
  return column;
}

/// Measured, with the standard model's parameters, and with the estimate.
Panel task_panel(const MuscleAnalysis& a, const TaskOutcome& t, std::size_t output, std::string label) {
  const ReadableNumber unit = readable(1.0, a.outputs[output].unit);
  const auto line = [&](const char* name, const estimation::RowMatrix& values, Role role) {
    return Line{.name = name, .y = output_column(values, output, unit.value), .x = t.time, .role = role};
  };
  Panel panel{.label = std::move(label), .unit = unit.unit, .height = 130};
  panel.lines.push_back(line("measured", t.measured, Role::kMeasured));
  if (t.standard.size() > 0) panel.lines.push_back(line("standard model", t.standard, Role::kReference));
  if (t.estimated.size() > 0) panel.lines.push_back(line("estimate", t.estimated, Role::kEstimate));
  return panel;
}

TimeSeries task_figure(const MuscleAnalysis& a, bool hold_out) {
  TimeSeries figure{.title = hold_out ? "Unseen tasks" : "Tasks that the estimate is from",
                    .caption = "Measured, with the standard model's parameters (dashed), with the estimate.",
                    .axis = hold_out ? "unseen" : "trained"};
  for (const TaskOutcome& t : a.tasks) {
    if (t.hold_out != hold_out) continue;
    if (t.time.size() > figure.samples.size()) figure.samples = t.time;
    for (std::size_t j = 0; j < a.outputs.size() && figure.panels.size() < kMostPanels; ++j)
      figure.panels.push_back(task_panel(a, t, j, fmt::format("{}: {}", t.name, a.outputs[j].name)));
  }
  return figure;
}

/// The first screen: unseen tasks, or where there is none those that the estimate is from; of many those that are
/// predicted worst. A figure each.
std::vector<TimeSeries> task_lead(const MuscleAnalysis& a) {
  const bool hold_out = count_tasks(a, true) > 0;
  std::vector<const TaskOutcome*> tasks;
  for (const TaskOutcome& t : a.tasks)
    if (t.hold_out == hold_out) tasks.push_back(&t);
  if (tasks.size() > kLeadTasks) {
    // What cannot be simulated is the worst.
    std::ranges::stable_sort(tasks, std::greater(), [](const TaskOutcome* t) {
      return std::isfinite(t->after.nrmse) ? t->after.nrmse : std::numeric_limits<double>::infinity();
    });
    tasks.resize(kLeadTasks);
  }
  std::vector<TimeSeries> figures;
  for (const TaskOutcome* t : tasks) {
    TimeSeries figure{.title = fmt::format("{} ({})", t->name, hold_out ? "unseen" : "trained"),
                      .samples = t->time,
                      .axis = "lead/" + t->name};
    for (std::size_t j = 0; j < a.outputs.size() && figure.panels.size() < 3; ++j)
      figure.panels.push_back(task_panel(a, *t, j, a.outputs[j].name));
    if (!figure.panels.empty()) figures.push_back(std::move(figure));
  }
  return figures;
}

Section cost_section(const MuscleAnalysis& a) {
  Section section{.title = "Searches and their cost", .id = "searches", .folded = true};
  if (a.result.searches.empty()) return section;
  const estimation::SimulationCount& n = a.result.simulations;
  section.blocks.emplace_back(Paragraph{
      fmt::format("Controls of the tasks took {:.2g} s, the estimate {:.2g} s: {} simulations of a task, {} with "
                  "derivatives. {}",
                  a.preparing_s, a.result.seconds, n.values, n.with_derivatives, a.result.best.message)});
  Table table{.title = "Searches",
              .caption = "The first begins at the standard model, the others at the best points of a Sobol sequence.",
              .columns = {{.name = "search"},
                          {.name = "residual where it began", .unit = "sigma", .digits = 3},
                          {.name = "steps"},
                          {.name = "-log posterior", .digits = 6},
                          {.name = "ends", .align = Align::kLeft},
                          {.name = "message", .align = Align::kLeft}}};
  for (std::size_t i = 0; i < a.result.searches.size(); ++i) {
    const TaskSearch& s = a.result.searches[i];
    const char* where = !std::isfinite(s.cost) ? ""
                        : i == a.result.chosen ? "best"
                        : s.agrees             ? "at the best"
                                               : "elsewhere";
    table.rows.push_back(
        {.cells = {number_cell(static_cast<double>(i + 1), 0), number_cell(s.rms_start), number_cell(s.steps, 0),
                   number_cell(s.cost), text_cell(where), text_cell(s.message)}});
  }
  section.blocks.emplace_back(std::move(table));
  return section;
}

}  // namespace

Document muscle_task_report(const TaskStudy& study, const MuscleAnalysis& a, const std::string& program,
                            bool validation_only) {
  Document document = started_document(
      study.subject.title, validation_only ? "An estimate validated on unseen tasks" : "A person's muscles from tasks",
      program);
  document.verdict = verdict_of(a.estimate);
  for (TimeSeries& figure : task_lead(a)) document.lead.emplace_back(std::move(figure));
  document.facts = task_facts(study, a);
  const auto add = [&](Section section) {
    if (!section.blocks.empty()) document.sections.push_back(std::move(section));
  };
  add(muscle_parameters(study, a));
  add(directions_section(a));
  add(profile_section(a.profiles, a.estimate.parameters));
  add(posterior_section(a.posterior, a.estimate.parameters));
  add(advice_section(a));
  Section tasks{.title = "Tasks before and after", .id = "tasks"};
  tasks.blocks.emplace_back(task_table(a));
  for (const bool hold_out : {true, false}) {
    TimeSeries figure = task_figure(a, hold_out);
    // Fewer are all on the first screen.
    const bool shown = count_tasks(a, true) <= kLeadTasks && a.outputs.size() <= 3 && hold_out;
    if (!figure.panels.empty() && !shown) tasks.blocks.emplace_back(std::move(figure));
  }
  if (!a.predictions.empty()) tasks.blocks.emplace_back(prediction_table(a.predictions, "Prediction of unseen tasks"));
  add(std::move(tasks));
  add(evidence_section(a.estimate));
  add(emg_section(study));
  add(cost_section(a));
  add_warnings(document, a.estimate.warnings);
  std::vector<std::string> notes = study.notes;
  for (const std::string& note : study.subject.system->notes()) notes.push_back(note);
  add_notes(document, notes);
  return document;
}

}  // namespace veridyn::report
