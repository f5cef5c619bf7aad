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

/// A study of one flight, read and checked: who flew, what was recorded, what to do with it.
///
///     seed = 1
///     [subject]      see read_subject
///     [data]         `calibration = "calibration.toml"`: see read_calibration; the rest: recording::read_study_data;
///     `[data.map]` see map_channels. Without it the study must have a
///     `[flight]`,
///                    which is then simulated
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

/// Everything that became of a flight.
struct FlightAnalysis {
  std::vector<DelayReport> delays;
  Reconstruction reconstruction;
  FlightSignals signals;
  Segments segments;
  std::vector<CoefficientResult> coefficients;
  OtherEstimators others;         ///< output error, frequency domain, bootstrap, where asked for
  UncertaintyReport uncertainty;  ///< of the measured coefficients
  Subject identified;             ///< the subject with the identified values
  Validation validation;
  estimation::Estimate estimate;
  bool interrupted = false;
};

/// Delays and state estimation only.
/// @throws InputError when a channel that it needs is missing.
[[nodiscard]] FlightAnalysis reconstruct(FlightStudy& study, Progress& progress);

/// The whole way: delays, state estimation, segments, coefficients, validation on the hold-out, verdict.
/// @throws InputError when a channel that it needs is missing, or the aircraft never flew.
[[nodiscard]] FlightAnalysis identify(FlightStudy& study, Progress& progress);

/// An estimate against the flight of a study, none of which it has seen: coefficients and trajectory on every excited
/// segment.
[[nodiscard]] FlightAnalysis validate(FlightStudy& study, const estimation::Estimate& estimate, Progress& progress);

}  // namespace veridyn::aircraft
