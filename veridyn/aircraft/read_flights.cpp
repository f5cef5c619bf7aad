#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/absent_surfaces.hpp"
#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/aircraft/model/atmosphere.hpp"
#include "veridyn/aircraft/model/estimated_subject.hpp"
#include "veridyn/aircraft/sensors/air_data_calibration.hpp"
#include "veridyn/aircraft/simulation/simulate_study.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/io/results/estimate_json.hpp"
#include "veridyn/recording/grid_signals.hpp"
#include "veridyn/recording/study_data.hpp"

namespace veridyn::aircraft {
namespace {

/// Lift coefficient that few wings exceed: at 0.8 of the speed that it gives, nothing flies.
constexpr double kHighLift = 1.2;

double least_flying_airspeed(const Subject& subject) {
  return 0.8 * std::sqrt(2.0 * subject.mass * kGravity / (1.225 * subject.wing_area * kHighLift));
}

SurfaceThrows throws_of(const Subject& subject, const StudyTable& table) {
  const bool known = table.has("builtin") || table.table_or_empty("actuators").has("elevator");
  return {.elevator = subject.elevator.upper,
          .aileron = subject.aileron.upper,
          .rudder = subject.rudder.upper,
          .known = known};
}

/// All of a study but its recordings.
FlightStudy read_options(const Study& study) {
  const StudyTable& root = study.root();
  FlightStudy result;
  result.name = study.name();
  result.seed = static_cast<std::uint64_t>(root.integer_or("seed", 1));
  static_cast<void>(root.text_or("title", ""));
  result.subject = read_subject(root.table("subject"));
  result.delays = DelayAlignment::keys().read(root.table_or_empty("delays"));
  result.known_sensors = read_known_sensors(root.table_or_empty("sensors"));
  // A delay that is known roughly is taken off like one that is given; its standard deviation stays in the budget.
  for (const SensorError& error : result.known_sensors.errors) {
    const std::string name(kBudgetSensorNames[error.sensor]);
    if (error.kind == SensorErrorKind::kDelay && !result.delays.given_for(name))
      result.delays.given.emplace_back(name, error.mean);
  }
  result.reconstruct = ReconstructOptions::keys().read(root.table_or_empty("reconstruct"));
  if (const std::filesystem::path& estimate = result.reconstruct.estimate_file; !estimate.empty())
    result.filter_subject = estimated_subject(result.subject, io::read_estimate(estimate), estimate.string());
  result.signals = SignalOptions::keys().read(root.table_or_empty("signals"));
  result.segments = SegmentOptions::keys().read(root.table_or_empty("segments"));
  result.identify = IdentifyOptions::keys().read(root.table_or_empty("identify"));
  result.identify.seed = result.seed;
  result.validate = ValidationOptions::keys().read(root.table_or_empty("validate"));
  result.track = TrackOptions::keys().read(root.table_or_empty("track"));
  result.uncertainty = UncertaintyOptions::keys().read(root.table_or_empty("uncertainty"));
  result.flying_qualities = FlyingQualities::keys().read(root.table_or_empty("flying_qualities"));
  if (!(result.segments.min_airspeed_mps > 0.0))
    result.segments.min_airspeed_mps = least_flying_airspeed(result.subject);
  return result;
}

/// The flight of `[flight]`, simulated.
FlightStudy simulated(const Study& study, FlightStudy result, Progress& progress) {
  const StudyTable& root = study.root();
  if (!root.has("flight")) root.fail("data", "is missing: the study names no recording, and no [flight] to simulate");
  const SimulationOptions simulation = read_simulation(root);
  root.finish();
  progress.stage("simulating the flight");
  SimulatedFlight flight = simulate(simulation, progress);
  if (!flight.usable()) throw InputError(study.name(), flight.message());
  Recording log = std::move(flight.measured);
  log.source = study.name();
  result.truth = std::move(flight.truth);
  result.true_subject = result.subject;
  result.true_subject->model = quasi_steady_model(result.subject, standard_atmosphere(simulation.altitude).density,
                                                  flight.trim.condition.airspeed);
  result.true_changes = simulation.changes;
  if (!result.reconstruct.estimate_file.empty()) result.inputs.push_back(result.reconstruct.estimate_file);
  result.mapped = map_channels(log, StudyTable("data.map"), throws_of(result.subject, root.table("subject")));
  return result;
}

const KeyTable<FlightDataKeys>& calibration_file_keys() {
  static const auto table =
      KeyTable<FlightDataKeys>("data").file("calibration", &FlightDataKeys::calibration,
                                            "`calibration.toml` by which channels are corrected, after `[data.map]`");
  return table;
}

/// One of the recordings, in standard names and calibrated.
FlightStudy recorded(const recording::StudyRecording& run, const StudyTable& data, FlightStudy result,
                     const SurfaceThrows& throws) {
  result.run = run.name;
  result.held_out = run.held_out && !run.name.empty();
  result.inputs = run.files;
  if (!result.reconstruct.estimate_file.empty()) result.inputs.push_back(result.reconstruct.estimate_file);
  const StudyTable map = recording::table_with("map", run.own, data).table_or_empty("map");
  result.mapped = map_channels(run.recording, map, throws);
  FlightDataKeys keys;
  for (const StudyTable* table : {&data, &run.own}) calibration_file_keys().read(*table, keys);
  if (!keys.calibration.empty()) {
    apply_calibration(read_calibration(keys.calibration), result.mapped);
    result.inputs.push_back(keys.calibration);
  }
  for (const auto& [key, spans] :
       {std::pair("longitudinal", &result.segments.longitudinal), std::pair("lateral", &result.segments.lateral)}) {
    if (run.own.has(key)) *spans = recording::read_spans(run.own, key);
  }
  return result;
}

/// Surfaces that the aircraft does not have are no terms of its model.
void leave_out_absent_surfaces(std::vector<FlightStudy>& flights, const StudyTable& subject) {
  const auto recorded = [&](std::string_view name) {
    return std::ranges::any_of(flights, [&](const FlightStudy& f) { return f.mapped.recording.has(name); });
  };
  for (FlightStudy& flight : flights) {
    for (std::string& note : without_absent_surfaces(flight.subject.model, subject, recorded))
      flight.mapped.notes.push_back(std::move(note));
  }
}

/// What several flights have to have in common.
std::vector<FlightStudy> alike(std::vector<FlightStudy> flights) {
  const bool whole_flights = std::ranges::any_of(flights, &FlightStudy::held_out);
  double slowest = recording::kHighestGridRate_Hz, fastest = 0.0;
  for (FlightStudy& flight : flights) {
    if (whole_flights) flight.segments.holdout = 0.0;
    const Channel* gyro = flight.mapped.recording.find("gyro_x");
    if (gyro == nullptr) continue;
    const double rate = recording::grid_rate(*gyro);
    slowest = std::min(slowest, rate);
    fastest = std::max(fastest, rate);
  }
  for (FlightStudy& flight : flights) {
    if (!(flight.signals.rate_Hz > 0.0)) flight.signals.rate_Hz = slowest;
  }
  return flights;
}

}  // namespace

const KeyTable<FlightDataKeys>& FlightDataKeys::keys() {
  static const auto table =
      KeyTable<FlightDataKeys>("data", "The log of a flight, or of several flights of one aircraft.")
          .with(recording::DataKeys::keys())
          .with(calibration_file_keys());
  return table;
}

std::vector<FlightStudy> read_flights(const Study& study, Progress& progress) {
  const StudyTable& root = study.root();
  FlightStudy options = read_options(study);
  std::vector<FlightStudy> flights;
  if (!root.has("data")) {
    flights.push_back(simulated(study, std::move(options), progress));
    return flights;
  }
  const StudyTable data = root.table("data");
  // A study may carry the flight that its recording was simulated from.
  if (root.has("flight")) static_cast<void>(read_simulation(root));
  const StudyTable segments = root.table_or_empty("segments");
  for (const char* key : {"longitudinal", "lateral"}) {
    if (recording::names_runs(data) && segments.has(key))
      segments.fail(key, "gives times of one recording, but there are several: write it in the [[data.run]] of each");
  }
  progress.stage("reading the recording");
  const std::vector<recording::StudyRecording> runs = recording::read_study_recordings(data, progress.threads());
  const SurfaceThrows throws = throws_of(options.subject, root.table("subject"));
  for (const recording::StudyRecording& run : runs) flights.push_back(recorded(run, data, options, throws));
  leave_out_absent_surfaces(flights, root.table("subject"));
  root.finish();
  if (flights.size() > 1) return alike(std::move(flights));
  return flights;
}

FlightStudy read_study(const Study& study, Progress& progress) {
  const StudyTable& root = study.root();
  if (root.has("data") && root.is_table("data") && recording::names_runs(root.table("data"))) {
    const StudyTable data = root.table("data");
    data.fail(data.has("runs")  ? "runs"
              : data.has("run") ? "run"
                                : "holdout_runs",
              "is for `identify` and `validate`: this needs one recording, data.file = \"flight.csv\"");
  }
  return std::move(read_flights(study, progress).front());
}

}  // namespace veridyn::aircraft
