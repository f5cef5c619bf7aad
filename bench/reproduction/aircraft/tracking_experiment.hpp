#pragma once

#include <string>
#include <vector>

#include "bench/reproduction/aircraft/experiment.hpp"
#include "veridyn/aircraft/tracking/coefficient_tracker.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {

/// One way to follow a coefficient, by name: `[[experiment.tracker]]` with `name` and the keys of `[track]`.
struct TrackerSetting {
  std::string name;
  TrackOptions options;
};
/// @throws InputError as TrackOptions::keys.
[[nodiscard]] std::vector<TrackerSetting> read_trackers(const StudyTable& experiment);

/// What one tracker did in one repetition.
struct TrackingRun {
  /// Per phase (before the first change, after each): time from its beginning until what changed (at the start: every
  /// parameter) has settled for the rest of the phase [s]; NaN: it never did. A changed parameter has settled within
  /// 5 % of its new value; at the start and after events every parameter has to, and has settled when its error moves
  /// the coefficient by less than 5 % of the coefficient's standard deviation.
  std::vector<double> settling_s;
  double excited_s = kNaN;  ///< first time at which every direction stood above the threshold [s]; NaN: never
  /// Time [s] from which, for the rest of the first phase, every parameter is right and known to be: its error and its
  /// 95 % interval's half-width each move the coefficient by less than 5 % of the coefficient's standard deviation.
  /// NaN: never.
  double known_s = kNaN;
  std::vector<estimation::Change> changes;  ///< alarms of the change detector
  std::uint64_t triggers = 0;               ///< of variable forgetting
  TrackHistory history;                     ///< of the first repetition only
};

/// All trackers over all repetitions.
struct TrackingExperiment {
  ExactRows rows;
  std::vector<double> phase_s;          ///< beginnings of the phases
  std::vector<std::string> phase_text;  ///< what changed
  std::vector<TrackerSetting> trackers;
  std::vector<std::vector<TrackingRun>> runs;  ///< by tracker, by repetition
  bool interrupted = false;

  /// Settling times of a tracker in a phase over the repetitions, those that never settled as infinity, sorted.
  [[nodiscard]] std::vector<double> settling(std::size_t tracker, std::size_t phase) const;
  /// Alarms that no change explains: before the first change, or more than `window_s` after the last one.
  [[nodiscard]] int false_alarms(std::size_t tracker, double window_s) const;
  /// Time [h] in which an alarm would be false, over all repetitions: what `false_alarms` counts in, less the time in
  /// which the detector learns.
  [[nodiscard]] double unchanged_hours(std::size_t tracker, double window_s) const;
  /// Share of repetitions that raise an alarm within `window_s` of the beginning of a phase.
  [[nodiscard]] double detected(std::size_t tracker, std::size_t phase, double window_s) const;
};

/// Runs every tracker over the same rows, with the noise of each repetition.
[[nodiscard]] TrackingExperiment run_tracking_experiment(const ExperimentOptions& options,
                                                         const std::vector<TrackerSetting>& trackers,
                                                         Progress& progress);

}  // namespace veridyn::aircraft
