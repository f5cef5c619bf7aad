#include "veridyn/report/tracking_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/report/figures/curves.hpp"
#include "veridyn/report/figures/track_panels.hpp"
#include "veridyn/report/parts/analysis_sections.hpp"
#include "veridyn/report/parts/estimate_tables.hpp"
#include "veridyn/report/parts/remarks.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::aircraft;

/// The true value of a parameter at each moment, where the flight was simulated; empty otherwise.
std::vector<double> true_values(const FlightStudy& study, Coefficient c, const Term& term,
                                const std::vector<double>& time) {
  if (!study.true_subject) return {};
  std::vector<double> values;
  for (const double t : time) {
    const AeroModel* model = &study.true_subject->model;
    for (const aircraft::ModelChange& change : study.true_changes) {
      if (t >= change.time) model = &change.model;
    }
    const CoefficientModel* coefficient = model->find(c);
    values.push_back(coefficient != nullptr ? coefficient->value_of(term.expression).value_or(kNaN) : kNaN);
  }
  return values;
}

std::vector<Span> poorly_excited(const TrackHistory& h, std::size_t parameters) {
  std::vector<bool> poor;
  for (const int excited : h.excited) poor.push_back(excited < static_cast<int>(parameters));
  return spans_where(h.time, poor, "not all excited", SpanTone::kMuted);
}

TimeSeries figure_of(const FlightStudy& study, const TrackedCoefficient& c) {
  const TrackHistory& h = c.tracker->history();
  TimeSeries figure;
  figure.title = fmt::format("{} over time", name_of(c.model.coefficient));
  figure.caption =
      "Bands are 95 %; values beyond four times the last one are not drawn. Grey: some combination of parameters stays "
      "below the threshold and is held.";
  figure.samples = h.time;
  for (std::size_t i = 0; i < c.model.size(); ++i) {
    Panel panel{.label = c.tracker->names()[i], .unit = c.model.terms[i].parameter_unit(), .height = 110};
    std::vector<double> truth = true_values(study, c.model.coefficient, c.model.terms[i], h.time);
    // Wild values before there are data, and while no linear model holds, would hide everything else.
    double largest = std::max(std::abs(h.value[i].back()), 1e-3);
    for (const double v : truth) largest = std::max(largest, std::abs(v));
    panel.lines.push_back(followed_line(h.value[i], h.sigma[i], largest));
    if (!truth.empty()) panel.lines.push_back({.name = "truth", .y = std::move(truth), .role = Role::kReference});
    figure.panels.push_back(std::move(panel));
  }
  if (!h.singular_value.empty()) figure.panels.push_back(singular_value_panel(h));
  figure.panels.push_back({.label = "lambda", .unit = "1", .lines = {{.name = "lambda", .y = h.lambda}}, .height = 90});
  figure.panels.push_back({.label = "innovation / sigma",
                           .unit = "1",
                           .lines = {{.name = "rms", .y = h.innovation, .role = Role::kMeasured}},
                           .height = 90});
  figure.panels.push_back(
      {.label = "suspicion (1: alarm)", .unit = "1", .lines = {{.name = "suspicion", .y = h.suspicion}}, .height = 90});
  figure.spans = poorly_excited(h, c.model.size());
  for (const estimation::Change& change : c.tracker->changes()) {
    figure.spans.push_back(
        {.from = change.began_s, .to = change.detected_s, .label = "change", .tone = SpanTone::kBad});
  }
  return figure;
}

Table parameter_table(const FlightStudy& study, const FlightTracker& tracker, const estimation::Estimate& estimate) {
  Table table{.title = "Parameters as they stand at the end",
              .columns = parameter_columns(study.true_subject.has_value())};
  for (const TrackedCoefficient& c : tracker.coefficients()) {
    if (!c.tracker) continue;
    for (std::size_t i = 0; i < c.model.size(); ++i) {
      const estimation::Parameter* p = estimate.find(c.tracker->names()[i]);
      Row row = parameter_row(*p, 1.0, p->unit);
      if (study.true_subject) {
        const auto truth =
            true_values(study, c.model.coefficient, c.model.terms[i], {c.tracker->history().time.back()});
        row.cells.push_back(number_cell(truth.at(0)));
      }
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

Table change_table(const FlightTracker& tracker) {
  Table table{.title = "Changes found", .columns = change_columns("coefficient", "what")};
  for (const FlightChange& c : tracker.changes())
    table.rows.push_back(change_row(std::string(name_of(c.coefficient)), c.change));
  return table;
}

Table model_table(const FilterHistory& filter) {
  Table table{.title = "Models that the filter was given",
              .caption = "A coefficient without a source is not known: without CL the model-free filter is alone.",
              .columns = {{.name = "From", .unit = "s", .digits = 4},
                          {.name = "CL"},
                          {.name = "CD"},
                          {.name = "CY"},
                          {.name = "sigma CL", .digits = 2},
                          {.name = "sigma CD", .digits = 2},
                          {.name = "sigma CY", .digits = 2},
                          {.name = "Why"}}};
  for (const FilterModel& m : filter.models()) {
    Row row;
    row.cells.push_back(std::isfinite(m.from_s) ? number_cell(m.from_s) : text_cell("the start"));
    for (const ModelSource source : m.source)
      row.cells.push_back(text_cell(source == ModelSource::kNone ? "" : std::string(to_string(source))));
    for (std::size_t i = 0; i < m.source.size(); ++i)
      row.cells.push_back(number_cell(m.source[i] == ModelSource::kNone ? kNaN : m.error.initial[i]));
    row.cells.push_back(text_cell(m.reason));
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table filter_error_table(const std::vector<TrackedFilterError>& errors) {
  Table table{.title = "Errors against the truth",
              .caption = "Root mean square over the flight, without its first 10 s.",
              .columns = {{.name = "Quantity"},
                          {.name = "Unit"},
                          {.name = "Model-free", .digits = 3},
                          {.name = "Guarded", .digits = 3}}};
  for (const TrackedFilterError& e : errors) {
    const std::string unit = display_unit(e.unit);
    table.rows.push_back(
        {.cells = {text_cell(e.quantity), text_cell(unit.substr(unit.empty() ? 0 : 1)),
                   number_cell(display_value(e.model_free, e.unit)), number_cell(display_value(e.guarded, e.unit))}});
  }
  return table;
}

/// Angle of attack by both filters, and how far the model's innovations were from their limit; at 10 Hz.
TimeSeries filter_figure(const FlightStudy& study, const FilterHistory& filter) {
  const Recording all = filter.recording();
  const std::size_t step = std::max<std::size_t>(1, static_cast<std::size_t>(all.at("alpha").rate_Hz() / 10.0));
  const auto thin = [&](const char* name, double factor) {
    std::vector<double> values;
    const std::vector<double>& from = all.at(name).value;
    for (std::size_t k = 0; k < from.size(); k += step) values.push_back(factor * from[k]);
    return values;
  };
  TimeSeries figure;
  figure.title = "The guarded filter over time";
  figure.caption = "Grey: the model-free filter is in use, because there is no model or its innovations contradict it.";
  for (std::size_t k = 0; k < filter.time().size(); k += step) figure.samples.push_back(filter.time()[k]);
  Panel alpha{.label = "alpha", .unit = "deg"};
  alpha.lines.push_back({.name = "guarded", .y = thin("alpha", 1.0 / kDegree)});
  alpha.lines.push_back({.name = "model-free", .y = thin("alpha_model_free", 1.0 / kDegree), .role = Role::kMeasured});
  if (const Channel* truth = study.truth ? study.truth->find("alpha") : nullptr)
    alpha.lines.push_back({.name = "truth",
                           .y = scaled(truth->value, 1.0 / kDegree),
                           .x = {truth->times().begin(), truth->times().end()},
                           .role = Role::kReference});
  figure.panels.push_back(std::move(alpha));
  figure.panels.push_back({.label = "innovations / limit",
                           .unit = "1",
                           .lines = {{.name = "ratio", .y = thin("guard_ratio", 1.0), .role = Role::kMeasured}},
                           .height = 90});
  std::vector<bool> alone;
  for (const double used : thin("model_based", 1.0)) alone.push_back(used == 0.0);
  figure.spans = spans_where(figure.samples, alone, "model-free", SpanTone::kMuted);
  return figure;
}

Section filter_section(const FlightStudy& study, const FilterHistory& filter) {
  Section section{.title = "Guarded filter", .id = "filter"};
  section.blocks.push_back(Paragraph{.text = filter.statement()});
  section.blocks.push_back(model_table(filter));
  section.blocks.push_back(filter_figure(study, filter));
  if (study.truth) section.blocks.push_back(filter_error_table(filter.errors(*study.truth)));
  return section;
}

}  // namespace

Document tracking_report(const FlightStudy& study, const TrackedFlight& flight, const std::string& program) {
  const FlightTracker& tracker = flight.tracker();
  const estimation::Estimate estimate = flight.estimate();
  const TrackOptions& options = tracker.options();
  Document document = started_document(study.subject.name, "followed on line", program);
  const std::size_t changes = tracker.changes().size();
  document.verdict = verdict_of(estimate);
  if (changes > 0 && document.verdict.level == Level::kGood) document.verdict.level = Level::kCaution;
  document.verdict.word = changes == 0 ? "No change" : "The aircraft changed";
  const std::string change_text =
      changes == 0
          ? "No coefficient changed during the flight."
          : fmt::format("{} found, the first at {:.1f} s in {}.",
                        changes == 1 ? std::string("One change was") : fmt::format("{} changes were", changes),
                        tracker.changes().front().change.detected_s, name_of(tracker.changes().front().coefficient));
  const std::vector<std::string> found = {
      change_text, estimate.verdict,
      options.detect_changes ? fmt::format("Stated rate of false alarms: one per {:.1f} hours of unchanged flight for "
                                           "each coefficient.",
                                           options.detection.false_alarm_interval_s / 3600.0)
                             : std::string("Changes were not looked for.")};
  document.verdict.lines.insert(document.verdict.lines.begin(), found.begin(), found.end());
  const double rate = tracker.row_rate_Hz() > 0.0 ? tracker.row_rate_Hz() : 1.0;
  const estimation::ForgettingOptions forgetting = options.forgetting_at(rate);
  document.facts = {{"Recording", study.mapped.recording.source},
                    {"Method", fmt::format("{}, {} forgetting", estimation::to_string(options.method),
                                           forgetting.variable ? "variable" : "constant")},
                    {"Rows", fmt::format("{} at {:.1f} Hz", tracker.rows(), rate)},
                    {"Air data", std::string(to_string(flight.air_data()))},
                    {"Memory", fmt::format("lambda {:.6f}: a sample counts 5 % after {:.1f} s", forgetting.lambda,
                                           estimation::cut_off_time(forgetting.square_weight(), rate))}};
  if (forgetting.variable) {
    const estimation::FalseTriggerRate triggers = estimation::false_trigger_rate(forgetting, 4, rate, 1'000'000);
    document.facts.push_back({"False triggers of forgetting",
                              fmt::format("{}{:.2g} an hour on white noise with 4 parameters",
                                          triggers.bound ? "less than " : "", triggers.per_second * 3600.0)});
  }
  document.sections.push_back({.title = "Parameters", .blocks = {parameter_table(study, tracker, estimate)}});
  if (changes > 0) document.sections.push_back({.title = "Changes", .blocks = {change_table(tracker)}});
  if (!flight.filter().empty()) document.sections.push_back(filter_section(study, flight.filter()));
  for (const TrackedCoefficient& c : tracker.coefficients()) {
    // Where something changed, one looks first.
    Section section{.title = std::string(name_of(c.model.coefficient)),
                    .folded = !c.tracker || c.tracker->changes().empty()};
    if (!c.tracker) {
      section.blocks.push_back(
          Paragraph{.text = c.obstacle.empty() ? "Not long enough in the air." : c.obstacle, .tone = Tone::kWarning});
    } else {
      std::string text = fmt::format("Started from {}; {} rows taken, {} refused, forgetting triggered {} times.",
                                     c.start, c.tracker->regression().rows(), c.tracker->regression().refused(),
                                     c.tracker->regression().triggers());
      const std::string held = c.tracker->regression().unexcited_text();
      if (!held.empty()) text += fmt::format(" Held at the end, because not excited: {}.", held);
      section.blocks.push_back(Paragraph{.text = std::move(text)});
      section.blocks.push_back(figure_of(study, c));
    }
    document.sections.push_back(std::move(section));
  }
  document.sections.push_back(evidence_section(estimate));
  std::vector<std::string> warnings = estimate.warnings;
  warnings.insert(warnings.end(), flight.notes().begin(), flight.notes().end());
  warnings.insert(warnings.end(), study.mapped.notes.begin(), study.mapped.notes.end());
  add_notes(document, warnings);
  return document;
}

}  // namespace veridyn::report
