// veridyn reconstruct STUDY: airspeed, flow angles and wind only.
#include <fmt/format.h>

#include "apps/veridyn/results/aircraft_results.hpp"
#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/domains.hpp"

namespace veridyn::app {
namespace {

Summary summary_of(const aircraft::Reconstruction& reconstruction, const std::filesystem::path& folder) {
  Summary summary;
  summary["folder"] = folder.string();
  if (reconstruction.contradiction) summary["contradiction"] = reconstruction.contradiction->statement;
  for (const aircraft::QuantityReport& q : reconstruction.quantities) {
    summary["quantities"][q.quantity] = Summary::object(
        {{"sigma", q.sigma}, {"unit", q.unit}, {"observability", aircraft::to_string(q.observability)}});
  }
  for (const aircraft::SensorErrorReport& e : reconstruction.sensor_errors) {
    summary["sensor_errors"][e.name] = Summary::object({{"value", e.value},
                                                        {"sigma", e.sigma},
                                                        {"prior_sigma", e.prior_sigma},
                                                        {"unit", e.unit},
                                                        {"information", e.information},
                                                        {"observability", aircraft::to_string(e.observability)}});
  }
  return summary;
}

void print_reconstruction(const aircraft::Reconstruction& reconstruction, const CommonOptions& options) {
  for (const aircraft::QuantityReport& q : reconstruction.quantities)
    print_line(options, fmt::format("  {:<16} {}", q.quantity, q.statement));
  for (const aircraft::SensorErrorReport& e : reconstruction.sensor_errors)
    print_line(options, fmt::format("  {:<16} {}", e.name, e.statement));
  if (reconstruction.guard) print_line(options, "guard: " + reconstruction.guard->statement);
  for (const aircraft::FilterError& e : reconstruction.comparison) {
    const auto text = [&](double v) {
      return fmt::format("{:.3g}{}", aircraft::display_value(v, e.unit), aircraft::display_unit(e.unit));
    };
    print_line(options, fmt::format("  {:<16} RMS error of filter / smoother: model-free {} / {}, model-based {} / {}",
                                    e.quantity, text(e.model_free.filter_rms), text(e.model_free.smoother_rms),
                                    text(e.model_based.filter_rms), text(e.model_based.smoother_rms)));
  }
  for (const std::string& warning : reconstruction.warnings) print_line(options, "warning: " + warning);
}

}  // namespace

int reconstruct_aircraft(const StudyRun& run) {
  OutputFolder folder(run.options().out);
  TerminalProgress progress = progress_of(run.options());
  const aircraft::FlightStudy flight = aircraft::read_study(run.study, progress);
  const aircraft::FlightAnalysis analysis = aircraft::reconstruct(flight, progress);
  if (analysis.interrupted) throw Interrupted();
  write_reconstruction(folder, flight, analysis);
  folder.publish(run.record(flight.seed, flight.inputs), run.options(),
                 summary_of(analysis.flights.front().reconstruction, folder.path()));
  print_reconstruction(analysis.flights.front().reconstruction, run.options());
  print_line(run.options(), fmt::format("report: {}", (folder.path() / "report.html").string()));
  // What could be reconstructed before the contradiction is in the files.
  return analysis.flights.front().reconstruction.contradiction ? kFailed : kDone;
}

Command reconstruct_command() {
  return {.name = "reconstruct",
          .summary = "state estimation only: airspeed, alpha, beta, wind, with 95 % bands",
          .arguments = {{.name = "STUDY", .help = "study file (TOML)", .required = true}},
          .default_out = "out/reconstruct",
          .example = "veridyn reconstruct study.toml --set reconstruct.turbulence=low_light",
          .run = [](const Arguments& arguments) { return run_on_study("reconstruct", arguments); }};
}

}  // namespace veridyn::app
