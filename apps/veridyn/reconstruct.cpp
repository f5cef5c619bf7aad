// veridyn reconstruct STUDY: airspeed, flow angles and wind only.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/veridyn/results.hpp"
#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/core/progress.hpp"

namespace veridyn::app {
namespace {

struct Options {
  std::string study;
  CommonOptions common;
};

int reconstruct(const Options& options) {
  const Study study = load_study(options.study, options.common);
  TerminalProgress progress(options.common.quiet);
  aircraft::FlightStudy flight = aircraft::read_study(study, progress);
  const aircraft::FlightAnalysis analysis = aircraft::reconstruct(flight, progress);
  if (analysis.interrupted) {
    fmt::print(stderr, "veridyn: interrupted, nothing was written\n");
    return kFailed;
  }
  const std::filesystem::path folder = options.common.out;
  RunRecord run{"reconstruct", study.name(), study.to_toml(), flight.seed, flight.inputs};
  run.inputs.emplace_back(options.study);
  write_reconstruction(folder, flight, analysis, run, options.common);
  nlohmann::ordered_json summary;
  summary["folder"] = folder.string();
  for (const aircraft::QuantityReport& q : analysis.reconstruction.quantities) {
    tell(options.common, fmt::format("  {:<16} {}", q.quantity, q.statement));
    summary["quantities"][q.quantity] = {
        {"sigma", q.sigma}, {"unit", q.unit}, {"observability", aircraft::to_string(q.observability)}};
  }
  for (const aircraft::SensorErrorReport& e : analysis.reconstruction.sensor_errors) {
    tell(options.common, fmt::format("  {:<16} {}", e.name, e.statement));
    summary["sensor_errors"][e.name] = {{"value", e.value},
                                        {"sigma", e.sigma},
                                        {"prior_sigma", e.prior_sigma},
                                        {"unit", e.unit},
                                        {"information", e.information},
                                        {"observability", aircraft::to_string(e.observability)}};
  }
  if (analysis.reconstruction.guard) tell(options.common, "guard: " + analysis.reconstruction.guard->statement);
  for (const aircraft::FilterError& e : analysis.reconstruction.comparison) {
    const auto text = [&](double v) {
      return fmt::format("{:.3g}{}", aircraft::shown(v, e.unit), aircraft::shown_unit(e.unit));
    };
    tell(options.common, fmt::format("  {:<16} RMS error of filter / smoother: model-free {} / {}, model-based {} / {}",
                                     e.quantity, text(e.model_free.filter_rms), text(e.model_free.smoother_rms),
                                     text(e.model_based.filter_rms), text(e.model_based.smoother_rms)));
  }
  for (const std::string& warning : analysis.reconstruction.warnings) tell(options.common, "warning: " + warning);
  tell(options.common, fmt::format("report: {}", (folder / "report.html").string()));
  print_summary(summary, options.common);
  return kDone;
}

}  // namespace

void add_reconstruct(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb =
      program.add_subcommand("reconstruct", "state estimation only: airspeed, alpha, beta, wind, with 95 % bands");
  verb->add_option("STUDY", options->study, "study file (TOML)")->required();
  add_common(*verb, options->common, "out/reconstruct",
             "veridyn reconstruct study.toml --set reconstruct.turbulence=low_light");
  verb->callback([options, &exit_code] { exit_code = reconstruct(*options); });
}

}  // namespace veridyn::app
