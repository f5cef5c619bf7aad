// veridyn validate STUDY --estimate FILE: an estimate against other data.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/veridyn/drive.hpp"
#include "apps/veridyn/results.hpp"
#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/io/results/estimate_json.hpp"
#include "veridyn/vehicle/model/vehicle.hpp"

namespace veridyn::app {
namespace {

struct Options {
  std::string study;
  std::string estimate;
  CommonOptions common;
};

int validate(const Options& options) {
  const Study study = load_study(options.study, options.common);
  if (vehicle::is_vehicle_study(study.root()))
    return validate_vehicle(study, options.study, options.estimate, options.common);
  const estimation::Estimate estimate = io::read_estimate(options.estimate);
  TerminalProgress progress(options.common.quiet);
  aircraft::FlightStudy flight = aircraft::read_study(study, progress);
  aircraft::FlightAnalysis analysis = aircraft::validate(flight, estimate, progress);
  if (analysis.interrupted) {
    fmt::print(stderr, "veridyn: interrupted, nothing was written\n");
    return kFailed;
  }
  const std::filesystem::path folder = options.common.out;
  RunRecord run{"validate", study.name(), study.to_toml(), flight.seed, flight.inputs};
  run.inputs.emplace_back(options.study);
  run.inputs.emplace_back(options.estimate);
  write_identification(folder, flight, analysis, run, options.common);
  tell_identification(analysis, folder, options.common);
  print_summary(summary_of(analysis, folder), options.common);
  return kDone;
}

}  // namespace

void add_validate(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = program.add_subcommand("validate", "an estimate tried on a flight or drive that it has not seen");
  verb->add_option("STUDY", options->study, "study file of the other flight or drive")->required();
  verb->add_option("--estimate", options->estimate, "estimate.json of an identification")
      ->required()
      ->type_name("FILE");
  add_common(*verb, options->common, "out/validate",
             "veridyn validate flight8.toml --estimate out/flight7/estimate.json");
  verb->callback([options, &exit_code] { exit_code = validate(*options); });
}

}  // namespace veridyn::app
