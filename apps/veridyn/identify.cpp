// veridyn identify STUDY: from recording to parameters, validation and report.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/veridyn/drive.hpp"
#include "apps/veridyn/ground.hpp"
#include "apps/veridyn/results.hpp"
#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/muscle/muscle_study.hpp"
#include "veridyn/vehicle/model/vehicle.hpp"

namespace veridyn::app {
namespace {

struct Options {
  std::string study;
  CommonOptions common;
};

int identify(const Options& options) {
  const Study study = load_study(options.study, options.common);
  if (is_ground_study(study)) return identify_ground(study, options.study, options.common);
  if (vehicle::is_vehicle_study(study.root())) return identify_vehicle(study, options.study, options.common);
  if (muscle::is_muscle_study(study.root())) {
    throw InputError(study.root().place("subject"),
                     "is a musculoskeletal model, whose parameters this version does not estimate yet; `veridyn "
                     "simulate` runs the study, [subject.parameters] sets parameters by hand");
  }
  TerminalProgress progress(options.common.quiet);
  aircraft::FlightStudy flight = aircraft::read_study(study, progress);
  const aircraft::FlightAnalysis analysis = aircraft::identify(flight, progress);
  if (analysis.interrupted) {
    fmt::print(stderr, "veridyn: interrupted, nothing was written\n");
    return kFailed;
  }
  const std::filesystem::path folder = options.common.out;
  RunRecord run{"identify", study.name(), study.to_toml(), flight.seed, flight.inputs};
  run.inputs.emplace_back(options.study);
  progress.stage("writing the results");
  write_identification(folder, flight, analysis, run, options.common);
  tell_identification(analysis, folder, options.common);
  print_summary(summary_of(analysis, folder), options.common);
  return kDone;
}

}  // namespace

void add_identify(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = program.add_subcommand("identify", "from recording to parameters, validation and report");
  verb->add_option(
          "STUDY", options->study,
          "study file (TOML) of an aircraft's flight, a vehicle's drive, a swing test or a calibration; `veridyn init` "
          "writes one to start from. Studies of muscles (`model` in [subject]) are for `veridyn simulate`: estimating "
          "muscle "
          "parameters is not there yet")
      ->required();
  add_common(*verb, options->common, "out/identify",
             "veridyn identify study.toml --out out/flight7 --set data.from=120");
  verb->callback([options, &exit_code] { exit_code = identify(*options); });
}

}  // namespace veridyn::app
