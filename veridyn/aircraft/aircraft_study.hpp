#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/aircraft/flying_qualities/levels.hpp"
#include "veridyn/aircraft/identification/budget/sensor_priors.hpp"
#include "veridyn/aircraft/identification/fit/coefficient_uncertainty.hpp"
#include "veridyn/aircraft/identification/identification.hpp"
#include "veridyn/aircraft/identification/other_estimators.hpp"
#include "veridyn/aircraft/identification/validation/open_loop.hpp"
#include "veridyn/aircraft/identification/validation/validation.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct.hpp"
#include "veridyn/aircraft/sensors/delays.hpp"
#include "veridyn/aircraft/simulation/simulation.hpp"
#include "veridyn/aircraft/tracking/coefficient_tracker.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/recording/study_data.hpp"

namespace veridyn::aircraft {

/// The keys of `[data]` of a flight.
struct FlightDataKeys : recording::DataKeys {
  std::filesystem::path calibration;

  [[nodiscard]] static const KeyTable<FlightDataKeys>& keys();
};

/// A study of one flight, read and checked: the aircraft, the recording, what to do with it. A study that names several
/// recordings (recording::read_study_recordings) is one of these a flight, which differ in their recording only.
struct FlightStudy {
  std::string name;
  std::uint64_t seed = 0;
  std::string run = {};   ///< name of its recording among those of the study; empty: the only one
  bool held_out = false;  ///< none of it is for identification
  Subject subject;
  MappedRecording mapped;
  std::optional<Recording> truth;  ///< of a simulated flight
  std::optional<Subject> true_subject;
  std::optional<Subject> filter_subject;  ///< whose derivatives the model-based filter takes, where not `subject`
  DelayAlignment delays;
  KnownSensors known_sensors;  ///< what is known of the real ones
  ReconstructOptions reconstruct;
  SignalOptions signals;
  SegmentOptions segments;
  IdentifyOptions identify;
  ValidationOptions validate;
  TrackOptions track;
  std::vector<ModelChange> true_changes;  ///< of a simulated flight
  UncertaintyOptions uncertainty;
  FlyingQualities flying_qualities;
  std::vector<std::filesystem::path> inputs;  ///< files that were read
};

/// Reads every table of the study and its recordings: a study a flight, in the order of the study.
///
/// Of several, all get the rate of the slowest (`signals.rate`), so that their rows may be regressed together; where
/// some are held out as a whole, the others are for identification as a whole.
/// @throws InputError for anything that is wrong in either.
[[nodiscard]] std::vector<FlightStudy> read_flights(const Study& study, Progress& progress);

/// The same of a study with one recording. @throws InputError also where it names several.
[[nodiscard]] FlightStudy read_study(const Study& study, Progress& progress);

/// What the stages of the pipeline made of a flight, or of several together, in their order.
struct FlightAnalysis : estimation::Analysis {
  std::vector<PreparedFlight> flights;  ///< in the order of the study, each made ready by itself
  std::vector<CoefficientResult> coefficients;
  OtherEstimators others;         ///< output error, frequency domain, bootstrap, where the study has them
  UncertaintyReport uncertainty;  ///< of the measured coefficients
  Subject identified;             ///< the subject with the identified values
  Validation validation;
  OpenLoop open_loop;  ///< where the study asks for it
};

/// Delays and state estimation only.
/// @throws InputError when a channel that it needs is missing.
[[nodiscard]] FlightAnalysis reconstruct(const FlightStudy& study, Progress& progress);

/// The full pipeline: delays, state estimation, segments, coefficients, validation on the hold-out, verdict. Several
/// flights are each reconstructed by themselves, in their own wind and with their own delays and errors of sensors; the
/// coefficients are those of all.
/// @param studies  from `read_flights`, at least one
/// @throws InputError when a channel that it needs is missing, or the aircraft never flies, naming the recording.
[[nodiscard]] FlightAnalysis identify(std::span<const FlightStudy> studies, Progress& progress);
/// One flight alone.
[[nodiscard]] FlightAnalysis identify(const FlightStudy& study, Progress& progress);

/// An estimate validated on the flight of a study, which it was not identified from: coefficients and trajectory on
/// every excited segment.
/// @throws InputError as `identify`, and when the estimate has no parameter of the study's model.
[[nodiscard]] FlightAnalysis validate(std::span<const FlightStudy> studies, const estimation::Estimate& estimate,
                                      Progress& progress);
/// One flight alone.
[[nodiscard]] FlightAnalysis validate(const FlightStudy& study, const estimation::Estimate& estimate,
                                      Progress& progress);

}  // namespace veridyn::aircraft
