// veridyn demo: the whole way on a built-in aircraft and a simulated flight; needs no file.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/veridyn/results.hpp"
#include "veridyn/aircraft/flight_study.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/progress.hpp"

namespace veridyn::app {
namespace {

constexpr const char* kDemoStudy =
    R"(# The study of `veridyn demo`: a built-in aircraft flown in turbulence with the reference sensors, then identified from
# what they recorded. The truth is known, so the report shows it beside every estimate.
title = "demo"
seed = 1

[subject]
builtin = "unatrap"

[flight]
duration = 300
airspeed = 20
wind = [4, -2, 0]
turbulence = "low_moderate"

[reconstruct]
sensors = "reference"
turbulence = "low_moderate"
)";

int demo(const CommonOptions& options) {
  const std::filesystem::path folder = std::filesystem::path(options.out) / "aircraft";
  make_folder(folder);
  write_file(folder / "study.toml", kDemoStudy);
  const Study study = load_study((folder / "study.toml").string(), options);
  TerminalProgress progress(options.quiet);
  aircraft::FlightStudy flight = aircraft::read_flight_study(study, progress);
  const aircraft::FlightAnalysis analysis = aircraft::identify_flight(flight, progress);
  if (analysis.interrupted) {
    fmt::print(stderr, "veridyn: interrupted, nothing was written\n");
    return kFailed;
  }
  progress.stage("writing the results");
  write_identification(folder, flight, analysis,
                       {"demo", study.name(), study.to_toml(), flight.seed, {folder / "study.toml"}}, options);
  tell_identification(analysis, folder, options);
  print_summary(summary_of(analysis, folder), options);
  return kDone;
}

}  // namespace

void add_demo(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<CommonOptions>();
  CLI::App* verb =
      program.add_subcommand("demo", "a complete run on a built-in aircraft and a simulated flight; needs no input");
  add_common(*verb, *options, "out/demo", "veridyn demo --seed 3");
  verb->callback([options, &exit_code] { exit_code = demo(*options); });
}

}  // namespace veridyn::app
