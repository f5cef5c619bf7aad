#include "bench/reproduction/report/muscle_reproduction_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

namespace veridyn::report {
namespace {

using namespace veridyn::muscle;

Table case_table(const MuscleReproduction& r) {
  Table table{.title = "Cases",
              .caption =
                  "Medians over the hidden persons, the largest in brackets. Parameter error: root mean square of "
                  "(estimate - truth)/truth over all unknowns, also over those that the tasks leave open. "
                  "Simulations are of one task, with or without derivatives.",
              .columns = {{.name = "case", .align = Align::kLeft},
                          {.name = "tasks", .align = Align::kLeft},
                          {.name = "load", .unit = "kg", .digits = 2},
                          {.name = "hidden within", .unit = "%", .digits = 2},
                          {.name = "route", .align = Align::kLeft},
                          {.name = "parameter error", .unit = "%", .align = Align::kRight},
                          {.name = "trained NRMSE", .align = Align::kRight},
                          {.name = "unseen NRMSE", .align = Align::kRight},
                          {.name = "identified", .align = Align::kRight},
                          {.name = "their error", .unit = "%", .align = Align::kRight},
                          {.name = "inside 95 %", .align = Align::kRight},
                          {.name = "at a bound", .align = Align::kRight},
                          {.name = "simulations", .align = Align::kRight},
                          {.name = "time", .unit = "s", .align = Align::kRight}}};
  for (const ComparedOutcome& c : r.cases) {
    const auto both = [&](ComparedQuantity q, double factor) {
      return text_cell(fmt::format("{:.2g} ({:.2g})", factor * c.median(q), factor * c.largest(q)));
    };
    int identified = 0, covered = 0, bound = 0, unknowns = 0;
    for (const ComparedPerson& p : c.persons) {
      identified += p.identified;
      covered += p.covered;
      bound += p.at_bound;
      unknowns += static_cast<int>(r.study.unknowns.size());
    }
    table.rows.push_back(
        {.cells = {text_cell(c.setting.name), text_cell(fmt::format("{}", fmt::join(c.setting.tasks, ", "))),
                   number_cell(c.setting.load), number_cell(100.0 * c.setting.spread),
                   text_cell(c.setting.published ? "published" : "gradient"),
                   both(ComparedQuantity::kParameterError, 100.0), both(ComparedQuantity::kTrained, 1.0),
                   both(ComparedQuantity::kUnseen, 1.0), text_cell(fmt::format("{} of {}", identified, unknowns)),
                   both(ComparedQuantity::kIdentifiedError, 100.0),
                   text_cell(fmt::format("{} of {}", covered, identified)), text_cell(fmt::format("{}", bound)),
                   text_cell(fmt::format("{:.0f} ({:.0f})", c.median(ComparedQuantity::kSimulations),
                                         c.largest(ComparedQuantity::kSimulations))),
                   both(ComparedQuantity::kSeconds, 1.0)}});
  }
  return table;
}

XYPlot person_plot(const MuscleReproduction& r) {
  XYPlot plot{.title = "Every person",
              .caption = "Lower left is better. Logarithms to base 10: -3 is a thousandth.",
              .x = {.label = "log parameter error"},
              .y = {.label = "log unseen NRMSE"}};
  for (const ComparedOutcome& c : r.cases) {
    XYSeries series{.name = c.setting.name};
    for (const ComparedPerson& p : c.persons) {
      if (!(p.parameter_error > 0.0 && p.unseen > 0.0)) continue;
      series.x.push_back(std::log10(p.parameter_error));
      series.y.push_back(std::log10(p.unseen));
    }
    if (!series.x.empty()) plot.series.push_back(std::move(series));
  }
  return plot;
}

}  // namespace

ReproducedRow reproduced_row(const MuscleReproduction& r) {
  ReproducedRow row{.title = r.title, .finding = r.finding, .checks = r.checks};
  row.ours = fmt::format("{}; {} unknowns, {} hidden person{}, noise of {:.2g} deg. {}", r.study.subject.model_name,
                         r.study.unknowns.size(), r.cases.empty() ? 0 : r.cases.front().persons.size(),
                         !r.cases.empty() && r.cases.front().persons.size() == 1 ? "" : "s",
                         r.study.person->noise / kDegree, r.conditions);
  row.blocks.emplace_back(case_table(r));
  XYPlot plot = person_plot(r);
  if (!plot.series.empty()) row.blocks.emplace_back(std::move(plot));
  return row;
}

}  // namespace veridyn::report
