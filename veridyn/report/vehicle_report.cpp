#include "veridyn/report/vehicle_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/deg_per_g.hpp"
#include "veridyn/report/document/number_format.hpp"
#include "veridyn/report/figures/curves.hpp"
#include "veridyn/report/figures/vehicle_figures.hpp"
#include "veridyn/report/parts/remarks.hpp"
#include "veridyn/report/parts/steady_cornering_section.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::vehicle;

std::vector<Fact> facts(const SimulationStudy& study, const SimulationRun& run) {
  const VehicleParameters<double>& p = study.vehicle.parameters;
  std::vector<Fact> list{
      {"Vehicle", study.vehicle.name},
      {"Mass, wheelbase", fmt::format("{:g} kg, {:g} m", p.mass, p.wheelbase())},
      {"Tyres", study.vehicle.tyre_text},
      {"Model", std::string(to_string(study.model))},
      {"Manoeuvre", std::string(to_string(study.manoeuvre.kind))},
      {"Speed", fmt::format("{:.4g} m/s ({:.4g} km/h)", study.simulation.speed, 3.6 * study.simulation.speed)},
      {"Driven", fmt::format("{:.2f} s, {} samples", run.trajectory.end_time, run.trajectory.size())},
      {"Integration", fmt::format("Runge-Kutta, {:g} ms", 1e3 * study.simulation.step)}};
  if (study.four_wheel.convention == FourWheelConvention::kSource) list.push_back({"Convention", "of the source"});
  if (study.four_wheel.gravity != kGravity)
    list.push_back({"Gravity", fmt::format("{:g} m/s^2", study.four_wheel.gravity)});
  return list;
}

Verdict verdict(const SimulationStudy& study, const SimulationRun& run) {
  const VehicleTrajectory& t = run.trajectory;
  Verdict v;
  const bool clean = t.end == vehicle::DriveEnd::kCompleted && t.lift_offs.empty();
  v.level = clean ? Level::kGood : t.end == vehicle::DriveEnd::kDiverged ? Level::kBad : Level::kCaution;
  v.word = t.end == vehicle::DriveEnd::kCompleted ? "Driven" : "Ended early";
  std::string headline = t.message();
  headline[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(headline[0])));
  v.headline = headline + ".";
  if (!t.lateral_acceleration.empty()) {
    const auto [low, high] = std::minmax_element(t.lateral_acceleration.begin(), t.lateral_acceleration.end());
    v.lines.push_back(fmt::format("Largest lateral acceleration {:.2f} m/s^2 ({:.2f} g).", std::max(-*low, *high),
                                  std::max(-*low, *high) / kGravity));
  }
  const BicycleCharacteristics<double>& c = run.characteristics;
  const double K = c.understeer_gradient;
  const double per_g = deg_per_g(K);
  v.lines.push_back(
      std::isfinite(c.critical_speed)
          ? fmt::format("Oversteering: {:.3g} deg/g; unstable above {:.4g} m/s.", per_g, c.critical_speed)
      : std::isfinite(c.characteristic_speed)
          ? fmt::format("Understeering: {:.3g} deg/g; characteristic speed {:.4g} m/s.", per_g, c.characteristic_speed)
          : std::string("Neutral steering: neither a characteristic nor a critical speed."));
  if (run.cornering) {
    v.lines.push_back(
        fmt::format("With its suspension, in gentle turns: understeer gradient {:.3g} deg/g, roll "
                    "gradient {:.3g} deg/g.",
                    deg_per_g(run.cornering->understeer_gradient), deg_per_g(run.cornering->roll_gradient)));
  }
  if (!study.vehicle.assumed.empty())
    v.lines.push_back(
        fmt::format("{} numbers that this model does not need were assumed.", study.vehicle.assumed.size()));
  return v;
}

Table metric_table(std::span<const Metric> metrics) {
  Table table{.title = "Metrics",
              .caption = "As the named standard defines them; a dash where the drive does not show them."};
  // What stands in deg/g in a row of its own stays in SI.
  const auto also_per_g = [&](const Metric& m) {
    return std::ranges::any_of(metrics, [&](const Metric& other) { return other.name == m.name + "_deg_per_g"; });
  };
  table.columns = {{.name = "metric", .align = Align::kLeft},
                   {.name = "value"},
                   {.name = "unit", .align = Align::kLeft},
                   {.name = "source", .align = Align::kLeft},
                   {.name = "meaning", .align = Align::kLeft}};
  for (const Metric& m : metrics) {
    const ReadableNumber r = also_per_g(m) ? ReadableNumber{m.value, m.unit} : readable(m.value, m.unit, m.name);
    table.rows.push_back({.cells = {text_cell(m.name), number_cell(r.value), text_cell(r.unit), text_cell(m.source),
                                    text_cell(m.meaning)}});
  }
  return table;
}

Table characteristic_table(const BicycleCharacteristics<double>& c) {
  Table table{.title = "Handling of the linear bicycle at this speed"};
  table.columns = {
      {.name = "number", .align = Align::kLeft}, {.name = "value"}, {.name = "unit", .align = Align::kLeft}};
  const auto values = to_array(c);
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::string name = kBicycleCharacteristicFields[i].name;
    std::replace(name.begin(), name.end(), '_', ' ');
    const ReadableNumber r = readable(values[i], kBicycleCharacteristicFields[i].unit, name);
    table.rows.push_back({.cells = {text_cell(name), number_cell(r.value), text_cell(r.unit)}});
  }
  return table;
}

/// Eigenvalues; `name` says what a mode moves.
template <typename AnyMode>
Table mode_table(const std::string& title, const std::vector<AnyMode>& modes) {
  Table table{.title = title};
  constexpr bool kNamed = requires(const AnyMode& m) { m.name; };
  if constexpr (kNamed) {
    table.caption = "Named after what has most of the kinetic energy, its share alongside.";
    table.columns.push_back({.name = "mode", .align = Align::kLeft});
    table.columns.push_back({.name = "share", .unit = "%", .digits = 2});
  }
  const std::vector<Column> numbers{{.name = "real part", .unit = "1/s"},
                                    {.name = "imaginary part", .unit = "1/s"},
                                    {.name = "frequency", .unit = "Hz"},
                                    {.name = "damping ratio"},
                                    {.name = "", .align = Align::kLeft}};
  table.columns.insert(table.columns.end(), numbers.begin(), numbers.end());
  for (const AnyMode& m : modes) {
    Row row;
    if constexpr (kNamed) row.cells = {text_cell(m.name), number_cell(100.0 * m.share)};
    row.cells.push_back(number_cell(m.eigenvalue.real()));
    row.cells.push_back(number_cell(m.eigenvalue.imag()));
    row.cells.push_back(number_cell(m.frequency_Hz));
    row.cells.push_back(number_cell(m.damping_ratio));
    row.cells.push_back(status_cell(m.stable ? Status::kGood : Status::kBad, !m.stable      ? "grows"
                                                                             : m.oscillates ? "oscillates"
                                                                                            : "decays"));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

Table vehicle_table(const VehicleParameters<double>& parameters) {
  Table table{.title = "Numbers of the vehicle"};
  table.columns = {{.name = "name", .align = Align::kLeft},
                   {.name = "value", .digits = 6},
                   {.name = "unit", .align = Align::kLeft},
                   {.name = "meaning", .align = Align::kLeft}};
  for (std::size_t i = 0; i < kVehicleFields.size(); ++i) {
    const VehicleField& f = kVehicleFields[i];
    table.rows.push_back({.cells = {text_cell(f.name), number_cell(field_of(parameters, i)),
                                    text_cell(std::string(f.unit) == "1" ? "" : f.unit), text_cell(f.meaning)}});
  }
  return table;
}

std::vector<Block> frequency_response_figures(std::span<const NamedBicycle> bicycles) {
  struct Response {
    const char* name;
    const char* unit;
    std::complex<double> BicycleResponse::*value;
    double factor;
  };
  const std::array<Response, 3> quantities{
      {{"yaw rate", "deg/s per deg", &BicycleResponse::yaw_rate, 1.0},
       {"lateral acceleration", "m/s^2 per deg", &BicycleResponse::lateral_acceleration, kDegree},
       {"sideslip", "deg per deg", &BicycleResponse::sideslip, 1.0}}};
  std::vector<Block> blocks;
  for (const Response& q : quantities) {
    XYPlot gain{.title = fmt::format("Gain of {} to steer", q.name),
                .x = {"frequency", "Hz"},
                .y = {"gain", q.unit},
                .height = 220};
    XYPlot phase{.title = fmt::format("Phase of {} to steer", q.name),
                 .x = {"frequency", "Hz"},
                 .y = {"phase", "deg"},
                 .height = 220};
    for (const NamedBicycle& b : bicycles) {
      XYSeries g{.name = b.name, .role = b.role, .style = Style::kLine};
      XYSeries ph{.name = b.name, .role = b.role, .style = Style::kLine};
      double before = 0.0;
      for (const BicycleResponse& r : frequency_response(b.bicycle, 0.05, 5.0, 160)) {
        const std::complex<double> value = r.*q.value;
        double angle = std::arg(value) / kDegree;
        // Unwrapped: no jump of a whole turn between neighbours.
        if (!ph.y.empty()) angle += 360.0 * std::round((before - angle) / 360.0);
        before = angle;
        g.x.push_back(r.frequency_Hz);
        g.y.push_back(std::abs(value) * q.factor);
        ph.x.push_back(r.frequency_Hz);
        ph.y.push_back(angle);
      }
      gain.series.push_back(std::move(g));
      phase.series.push_back(std::move(ph));
    }
    blocks.emplace_back(std::move(gain));
    blocks.emplace_back(std::move(phase));
  }
  return blocks;
}

Document vehicle_report(const SimulationStudy& study, const SimulationRun& run, const std::string& program) {
  Document document = started_document(study.title, study.vehicle.description, program);
  document.verdict = verdict(study, run);
  document.facts = facts(study, run);
  const VehicleTrajectory& t = run.trajectory;
  const std::array drives{ShownDrive{.name = "drive", .trajectory = &t}};

  if (t.size() > 1) {
    Section path{.title = "Path and accelerations"};
    XYPlot seen = path_figure(drives);
    std::vector<XYSeries> cones = course_series(study.manoeuvre);
    if (!cones.empty()) {
      // To scale, a course is a line: metres aside over hundreds ahead.
      seen.equal_scale = false;
      seen.caption = "The path of the centre of gravity, seen from above; enlarged sideways, not to scale.";
    }
    for (XYSeries& one : cones) seen.series.push_back(std::move(one));
    path.blocks.emplace_back(std::move(seen));
    path.blocks.emplace_back(g_g_figure(drives, study.four_wheel.gravity));
    document.sections.push_back(std::move(path));
    document.sections.push_back({.title = "Time histories", .blocks = {motion_figure(drives)}});
    document.sections.push_back({.title = "Tyres", .blocks = {tyre_figure(drives)}, .folded = true});
    TimeSeries ride = ride_figure(drives);
    if (!ride.panels.empty())
      document.sections.push_back({.title = "Body and wheels", .blocks = {std::move(ride)}, .folded = true});
  }
  document.sections.push_back(steady_cornering_section(study, run));
  if (!run.metrics.empty()) document.sections.push_back({.title = "Metrics", .blocks = {metric_table(run.metrics)}});

  Section linear{.title = "Linear analysis", .folded = true};
  linear.blocks.emplace_back(characteristic_table(run.characteristics));
  linear.blocks.emplace_back(mode_table("Eigenvalues of the bicycle", run.modes));
  if (!run.vehicle_modes.empty())
    linear.blocks.emplace_back(mode_table("Modes of the four-wheel model", run.vehicle_modes));
  const std::array bicycles{NamedBicycle{"bicycle", run.linear}};
  for (Block& block : frequency_response_figures(bicycles)) linear.blocks.push_back(std::move(block));
  document.sections.push_back(std::move(linear));

  Section numbers{.title = "Vehicle", .folded = true};
  numbers.blocks.emplace_back(vehicle_table(study.vehicle.parameters));
  if (!study.vehicle.assumed.empty()) {
    numbers.blocks.emplace_back(Paragraph{"Not given, and not needed by this model; assumed:"});
    numbers.blocks.emplace_back(List{study.vehicle.assumed});
  }
  document.sections.push_back(std::move(numbers));
  add_warnings(document, study.vehicle.warnings);
  return document;
}

}  // namespace veridyn::report
