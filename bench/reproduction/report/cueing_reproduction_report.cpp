#include "bench/reproduction/report/cueing_reproduction_report.hpp"

#include <fmt/format.h>

namespace veridyn::report {

ReproducedRow reproduced_row(const cueing::CueingReproduction& r) {
  ReproducedRow row{.title = r.title, .finding = r.finding, .ours = r.how};
  Table table{.title = "Figures",
              .caption =
                  "Printed: in the source. Derived: from what is printed there. Computed: by an independent "
                  "calculation.",
              .columns = {{.name = "quantity", .align = Align::kLeft},
                          {.name = "origin", .align = Align::kLeft},
                          {.name = "published", .digits = 5},
                          {.name = "ours", .digits = 5},
                          {.name = "within", .digits = 3},
                          {.name = "unit", .align = Align::kLeft},
                          {.name = ""}}};
  for (const cueing::ReproducedFigure& f : r.figures) {
    table.rows.push_back(
        {.cells = {text_cell(f.quantity), text_cell(f.origin), number_cell(f.published), number_cell(f.ours),
                   number_cell(f.within), text_cell(f.unit), status_cell(f.passed() ? Status::kGood : Status::kBad)}});
    row.checks.push_back({f.passed(), fmt::format("{}: {} {:g} {}, ours {:.6g}, within {:g}", f.quantity, f.origin,
                                                  f.published, f.unit, f.ours, f.within)});
  }
  row.blocks.emplace_back(std::move(table));
  if (r.curves.empty()) return row;
  TimeSeries series{.title = "Over time", .axis = r.title};
  series.samples = r.time;
  // Each on a scale of its own: what is left with the camera is a hundredth of what is there without.
  for (const cueing::ReproducedCurve& c : r.curves)
    series.panels.push_back({.label = c.name, .unit = c.unit, .lines = {{.name = c.name, .y = c.values}}});
  row.blocks.emplace_back(std::move(series));
  return row;
}

}  // namespace veridyn::report
