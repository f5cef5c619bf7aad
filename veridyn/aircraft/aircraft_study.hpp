#pragma once

#include <optional>
#include <string>
#include <vector>

#include "veridyn/aircraft/identification/coefficient_uncertainty.hpp"
#include "veridyn/aircraft/identification/identification.hpp"
#include "veridyn/aircraft/identification/other_estimators.hpp"
#include "veridyn/aircraft/identification/validation.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct.hpp"
#include "veridyn/aircraft/sensors/delays.hpp"
#include "veridyn/aircraft/simulation/simulation.hpp"
#include "veridyn/aircraft/tracking/coefficient_tracker.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::aircraft {

/// A study of one flight, read and checked: the aircraft, the recording, what to do with it.
///
///     seed = 1
///     [subject]      see read_subject
///     [data]         `calibration = "calibration.toml"`: see read_calibration; the rest: recording::read_study_data;
///                    `[data.map]`: see map_channels. Without it the study must have a `[flight]`, which is then
///                    simulated
///     [delays]       see DelayAlignment          [signals]   see SignalOptions
///     [reconstruct]  see ReconstructOptions      [segments]  see SegmentOptions
///     [identify]     see IdentifyOptions         [validate]  see ValidationOptions
///     [track]        see TrackOptions
///     [uncertainty]  see UncertaintyOptions
struct FlightStudy {
  std::string name;
  std::uint64_t seed = 0;
  Subject subject;
  MappedRecording mapped;
  std::optional<Recording> truth;  ///< of a simulated flight
  std::optional<Subject> true_subject;
  std::optional<Subject> filter_subject;  ///< whose derivatives the model-based filter takes, where not `subject`
  DelayAlignment delays;
  ReconstructOptions reconstruct;
  SignalOptions signals;
  SegmentOptions segments;
  IdentifyOptions identify;
  ValidationOptions validate;
  TrackOptions track;
  std::vector<ModelChange> true_changes;  ///< of a simulated flight
  UncertaintyOptions uncertainty;
  std::vector<std::filesystem::path> inputs;  ///< files that were read
};

/// Reads every table of the study and its recording.
/// @throws InputError for anything that is wrong in either.
[[nodiscard]] FlightStudy read_study(const Study& study, Progress& progress);

/// What the stages of the pipeline made of a flight, in their order.
struct FlightAnalysis : estimation::Analysis {
  MappedRecording aligned;  ///< the study's recording with the delays taken off
  std::vector<DelayReport> delays;
  Reconstruction reconstruction;
  FlightSignals signals;
  Segments segments;
  std::vector<FlightEvidence> recording_evidence;  ///< does the recording agree with itself and with physics?
  std::vector<CoefficientResult> coefficients;
  OtherEstimators others;         ///< output error, frequency domain, bootstrap, where the study has them
  UncertaintyReport uncertainty;  ///< of the measured coefficients
  Subject identified;             ///< the subject with the identified values
  Validation validation;
};

/// Delays and state estimation only.
/// @throws InputError when a channel that it needs is missing.
[[nodiscard]] FlightAnalysis reconstruct(const FlightStudy& study, Progress& progress);

/// The full pipeline: delays, state estimation, segments, coefficients, validation on the hold-out, verdict.
/// @throws InputError when a channel that it needs is missing, or the aircraft never flies.
[[nodiscard]] FlightAnalysis identify(const FlightStudy& study, Progress& progress);

/// An estimate validated on the flight of a study, which it was not identified from: coefficients and trajectory on
/// every excited segment.
/// @throws InputError as `identify`, and when the estimate has no parameter of the study's model.
[[nodiscard]] FlightAnalysis validate(const FlightStudy& study, const estimation::Estimate& estimate,
                                      Progress& progress);

}  // namespace veridyn::aircraft
