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
