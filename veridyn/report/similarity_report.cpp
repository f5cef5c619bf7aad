#include "veridyn/report/similarity_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/report/document/number_format.hpp"
#include "veridyn/report/figures/vehicle_figures.hpp"
#include "veridyn/report/parts/remarks.hpp"
#include "veridyn/report/vehicle_report.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::vehicle;

std::string percent(double value) {
  if (!std::isfinite(value)) return "only one has it";
  return std::abs(value) < 1e-9 ? "0 %" : fmt::format("{:+.3g} %", value);
}

Row group_row(const GroupComparison& g, double tolerance, bool separate = false) {
  const bool off = !(std::abs(g.mismatch_percent) <= tolerance);
  const Status status = off ? (separate ? Status::kCaution : Status::kBad) : Status::kGood;
  return {.cells = {text_cell(g.parameter), text_cell(g.formula), number_cell(g.prototype), number_cell(g.model),
                    status_cell(status, percent(g.mismatch_percent)), text_cell(off ? g.affects : "")},
          .status = off ? status : Status::kNone};
}

Table group_table(const SimilarityReport& r, const std::string& title) {
  Table table{
      .title = title,
      .caption = fmt::format("{} quantities, rank of their dimensions {}: {} groups. A mismatch above {:g} % is "
                             "marked with what suffers from it.",
                             r.parameters, r.rank, r.parameters - r.rank, r.tolerance_percent)};
  table.columns = {{.name = "quantity", .align = Align::kLeft},  {.name = "group", .align = Align::kLeft},
                   {.name = "prototype", .digits = 5},           {.name = "model", .digits = 5},
                   {.name = "mismatch", .align = Align::kRight}, {.name = "what suffers", .align = Align::kLeft}};
  for (const GroupComparison& g : r.groups) table.rows.push_back(group_row(g, r.tolerance_percent));
  return table;
}

Table gravity_table(const SimilarityReport& r) {
  Table table{.title = "Gravity, separately",
              .caption =
                  "No model of other size keeps this group at equal times unless gravity could be changed. A Froude "
                  "twin (speed by the square root of the length ratio) keeps it, at the cost of the time axis."};
  table.columns = {{.name = "quantity", .align = Align::kLeft},  {.name = "group", .align = Align::kLeft},
                   {.name = "prototype", .digits = 4},           {.name = "model", .digits = 4},
                   {.name = "mismatch", .align = Align::kRight}, {.name = "what suffers", .align = Align::kLeft}};
  table.rows.push_back(group_row(r.gravity, r.tolerance_percent, true));
  return table;
}

Table behaviour_table(const SimilarityReport& r) {
  Table table{.title = "What it does to the response",
              .caption = "Numbers of the behaviour, the model's brought to the prototype's size."};
  table.columns = {{.name = "behaviour", .align = Align::kLeft},
                   {.name = "prototype"},
                   {.name = "model"},
                   {.name = "unit", .align = Align::kLeft},
                   {.name = "change", .align = Align::kRight}};
  for (const BehaviourComparison& b : r.behaviour) {
    const ReadableNumber p = readable(b.prototype, b.unit, b.name), m = readable(b.model, b.unit, b.name);
    table.rows.push_back({.cells = {text_cell(b.name), number_cell(p.value), number_cell(m.value), text_cell(p.unit),
                                    text_cell(percent(b.change_percent))}});
  }
  return table;
}

Table scaled_table(const ScaleStudy& study, const ScaleAnalysis& a) {
  Table table{.title = "Scaled parameters"};
  table.columns = {{.name = "name", .align = Align::kLeft},
                   {.name = "prototype", .digits = 6},
                   {.name = "factor", .digits = 6},
                   {.name = "exactly similar", .digits = 6}};
  if (study.given) table.columns.push_back({.name = study.given->name, .digits = 6});
  table.columns.push_back({.name = "unit", .align = Align::kLeft});
  const auto row = [&](const std::string& name, double prototype, double twin, double given, const std::string& unit) {
    Row r{.cells = {text_cell(name), number_cell(prototype), number_cell(twin / prototype), number_cell(twin)}};
    if (study.given) r.cells.push_back(number_cell(given));
    r.cells.push_back(text_cell(unit == "1" ? "" : unit));
    table.rows.push_back(std::move(r));
  };
  for (std::size_t i = 0; i < kVehicleFields.size(); ++i) {
    const double prototype = field_of(study.prototype.parameters, i);
    if (prototype == 0.0 || !std::isfinite(prototype)) continue;
    row(kVehicleFields[i].name, prototype, field_of(a.scaled.model.parameters, i),
        field_of(study.given_subject.parameters, i), kVehicleFields[i].unit);
  }
  row("speed", study.prototype.speed, a.scaled.model.speed, study.given_subject.speed, "m/s");
  const ScaleFactors& f = a.scaled.factors;
  table.caption = fmt::format(
      "Factors model over prototype: length {:.6g}, mass {:.6g}, speed {:.6g}; so time {:.6g}, force {:.6g}, "
      "acceleration {:.6g}. For a driver who should feel the full-size car, motion acceleration is multiplied by "
      "{:.6g} "
      "after gravity has been taken off; gravity by 1, rates by {:.6g}.",
      f.length, f.mass, f.speed, f.time(), f.force(), f.acceleration(), 1.0 / f.acceleration(), f.time());
  return table;
}

Table difference_table(const ScaleAnalysis& a) {
  Table table{
      .title = "Largest differences over the drive",
      .caption =
          "After bringing each to the prototype's size, as shares of the prototype's largest value; of a drive that "
          "ended early until then."};
  table.columns = {{.name = "quantity", .align = Align::kLeft}};
  for (const ScaledRun& run : a.runs)
    table.columns.push_back({.name = "difference", .unit = "%", .digits = 3, .group = run.name});
  for (std::size_t i = 0; i < a.runs.front().differences.size(); ++i) {
    Row row{.cells = {text_cell(a.runs.front().differences[i].quantity)}};
    for (const ScaledRun& run : a.runs) {
      const double share = i < run.differences.size() && run.differences[i].range > 0.0
                               ? 100.0 * run.differences[i].largest / run.differences[i].range
                               : std::nan("");
      row.cells.push_back(number_cell(share));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

Section group_section(const ScaleAnalysis& analysis) {
  const SimilarityReport& r = analysis.judged();
  Section section{.title = "Pi groups"};
  section.blocks.emplace_back(group_table(r, analysis.given_report ? "Groups of the given model" : "Groups"));
  section.blocks.emplace_back(gravity_table(r));
  if (!r.gravity_changes.empty()) section.blocks.emplace_back(List{r.gravity_changes, Tone::kNote});
  if (!r.behaviour.empty()) section.blocks.emplace_back(behaviour_table(r));
  return section;
}

Section difference_section(const ScaleAnalysis& analysis) {
  Section section{.title = "Differences"};
  if (const std::vector<std::string> early = analysis.ended_early(); !early.empty()) {
    section.blocks.emplace_back(List{early, Tone::kWarning});  // differences are those until then
  }
  section.blocks.emplace_back(difference_table(analysis));
  return section;
}

std::vector<Section> overlay_sections(const ScaleStudy& study, const ScaleAnalysis& analysis) {
  // The model of most interest, and on top of it the prototype.
  const ScaledRun& model = analysis.runs.back();
  const std::vector<ShownDrive> drives{
      {.name = model.name, .trajectory = &model.rescaled},
      {.name = "prototype", .trajectory = &analysis.prototype, .role = Role::kReference}};
  const double gravity = study.simulation.four_wheel.gravity;
  // Static loads do not scale unless gravity does: what the drive adds to them does.
  std::vector<PerWheel<double>> loads(drives.size());
  for (std::size_t i = 0; i < drives.size(); ++i) {
    for (std::size_t w = 0; w < kWheels; ++w) {
      const std::vector<double>& Fz = drives[i].trajectory->Fz[w];
      loads[i][w] = Fz.empty() ? 0.0 : Fz.front();
    }
  }
  std::vector<Section> sections;
  sections.push_back({.title = "Path", .blocks = {path_figure(drives), g_g_figure(drives, gravity)}, .folded = true});
  sections.push_back({.title = "Motion", .blocks = {motion_figure(drives)}, .folded = true});
  sections.push_back({.title = "Tyres", .blocks = {tyre_figure(drives)}, .folded = true});
  TimeSeries ride = ride_figure(drives, loads);
  if (!ride.panels.empty())
    sections.push_back({.title = "Body and wheels", .blocks = {std::move(ride)}, .folded = true});
  return sections;
}

Document similarity_report(const ScaleStudy& study, const ScaleAnalysis& analysis, const std::string& program) {
  const SimilarityReport& r = analysis.judged();
  Document document = started_document(study.simulation.title, study.simulation.vehicle.description, program);
  const bool similar = r.similar_without_gravity();
  document.verdict.level = r.similar() ? Level::kGood : similar ? Level::kCaution : Level::kBad;
  document.verdict.word = r.similar() ? "Similar" : similar ? "Similar but for gravity" : "Not similar";
  document.verdict.headline = r.message();
  for (const std::string& line : analysis.ended_early()) document.verdict.lines.push_back(line + ".");
  for (const std::string& line : r.gravity_changes) {
    if (document.verdict.lines.size() < 3) document.verdict.lines.push_back(line);
  }
  document.facts = {{"Prototype", study.simulation.vehicle.name},
                    {"Model", study.given ? study.given->name : "exactly similar"},
                    {"Length ratio", fmt::format("{:.6g}", r.factors.length)},
                    {"Mass ratio", fmt::format("{:.6g}", r.factors.mass)},
                    {"Speed ratio", fmt::format("{:.6g}", r.factors.speed)},
                    {"Time, force", fmt::format("{:.6g}, {:.6g}", r.factors.time(), r.factors.force())},
                    {"Manoeuvre", std::string(to_string(study.simulation.manoeuvre.kind))},
                    {"Drive model", std::string(to_string(study.simulation.model))}};
  document.sections.push_back(group_section(analysis));
  Section numbers{.title = "Scaled vehicle", .blocks = {scaled_table(study, analysis)}, .folded = true};
  if (!analysis.scaled.chosen.empty()) numbers.blocks.emplace_back(List{analysis.scaled.chosen, Tone::kNote});
  document.sections.push_back(std::move(numbers));
  if (!analysis.runs.empty() && analysis.prototype.size() > 1) {
    document.sections.push_back(difference_section(analysis));
    for (Section& section : overlay_sections(study, analysis)) document.sections.push_back(std::move(section));
  }
  return document;
}

}  // namespace veridyn::report
