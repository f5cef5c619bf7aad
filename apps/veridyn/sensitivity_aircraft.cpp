// veridyn sensitivity STUDY of an aircraft: which of its parameters moves which manoeuvre and signal of a simulated
// flight.
#include <fmt/format.h>

#include <memory>

#include "apps/veridyn/results/response_results.hpp"
#include "apps/veridyn/results/study_tables.hpp"
#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/version.hpp"
#include "veridyn/aircraft/flight_sensitivity.hpp"

namespace veridyn::app {
namespace {

PreparedResponses prepare_flight_responses(const StudyRun& run) {
  const StudyTable& root = run.study.root();
  refuse_recording(root, "[flight]");
  const auto study = std::make_shared<const aircraft::FlightSensitivityStudy>(aircraft::read_flight_sensitivity(root));
  root.table_or_empty("sensitivity").finish();
  finish_flight_study(root);
  const aircraft::SimulationOptions& flight = study->flight;
  const std::string what = fmt::format("manoeuvres of {:g} s of flight of {}", flight.duration, flight.subject.name);
  PreparedResponses prepared{.stage = "the nominal flight", .options = study->options};
  prepared.context = {.program = program_name(),
                      .title = root.text_or("title", flight.subject.name),
                      .subject = fmt::format("{}: sensitivity of a simulated flight", flight.subject.name),
                      .what = what,
                      .facts = {{"Aircraft", flight.subject.name}},
                      .notes = flight.subject.warnings};
  prepared.context.notes.push_back(
      fmt::format("Each manoeuvre is flown again open loop, {:g} s at most, from the nominal state with the nominal "
                  "deflections and air. Results are root mean squares of differences from the nominal aircraft over "
                  "each signal's standard deviation in the whole flight: of all signals by manoeuvre, and by signal "
                  "over all manoeuvres.",
                  study->options.longest));
  prepared.analyse = [study](numerics::BlockStore& store, Progress& p) {
    return aircraft::analyse_flight(*study, store, p);
  };
  return prepared;
}

}  // namespace

int sensitivity_aircraft(const StudyRun& run) {
  return run_responses(run, [&](Progress&) { return prepare_flight_responses(run); });
}

}  // namespace veridyn::app
