#include "bench/reproduction/report/vehicle_reproduction_report.hpp"

#include <fmt/format.h>

#include "veridyn/report/similarity_report.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::vehicle;

Table number_table(std::span<const PublishedNumber> numbers) {
  Table table{.title = "Printed numbers",
              .columns = {{.name = "drive", .align = Align::kLeft},
                          {.name = "quantity", .align = Align::kLeft},
                          {.name = "at", .unit = "s"},
                          {.name = "published", .align = Align::kRight},
                          {.name = "ours", .digits = 8},
                          {.name = "unit", .align = Align::kLeft},
                          {.name = ""}}};
  for (const PublishedNumber& n : numbers) {
    table.rows.push_back(
        {.cells = {text_cell(n.run), text_cell(n.quantity), number_cell(n.time), text_cell(n.printed),
                   number_cell(n.ours), text_cell(n.unit), status_cell(n.passed() ? Status::kGood : Status::kBad)}});
  }
  return table;
}

}  // namespace

ReproducedRow reproduced_row(const VehicleReproduction& r) {
  ReproducedRow row{.title = r.title, .finding = r.finding, .checks = r.checks};
  const SimulationStudy& drive = r.study.simulation;
  row.ours =
      fmt::format("{} at {:g} m/s, {} model{}, {} manoeuvre, Runge-Kutta at {:g} ms.", drive.vehicle.name,
                  drive.simulation.speed, to_string(drive.model),
                  drive.four_wheel.convention == FourWheelConvention::kSource ? " in the source's convention" : "",
                  to_string(drive.manoeuvre.kind), 1e3 * drive.simulation.step);
  if (!r.numbers.empty()) row.blocks.emplace_back(number_table(r.numbers));
  for (Block& block : group_section(r.analysis).blocks) row.blocks.push_back(std::move(block));
  for (Block& block : difference_section(r.analysis).blocks) row.blocks.push_back(std::move(block));
  for (Section& section : overlay_sections(r.study, r.analysis))
    for (Block& block : section.blocks) row.blocks.push_back(std::move(block));
  // Rows zoom independently: their time axes differ.
  for (Block& block : row.blocks)
    if (auto* series = std::get_if<TimeSeries>(&block)) series->axis = r.title;
  return row;
}

}  // namespace veridyn::report
