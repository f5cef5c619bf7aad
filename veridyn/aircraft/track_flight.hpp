#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/aircraft/tracking/filter_history.hpp"
#include "veridyn/aircraft/tracking/flight_tracker.hpp"
#include "veridyn/aircraft/tracking/tracked_model.hpp"

namespace veridyn::aircraft {

/// Tracks a flight, from a whole recording or from one that is still being written.
///
/// Both ways go through the same steps on the same instants, with nothing but the past and the half-width of the
/// smoothing filters (0.3 s at 10 Hz): airspeed and flow angles by `TrackOptions::air_data`, flight signals as in batch
/// identification, recursive regression. A growing recording is read again and its last seconds are processed, so a
/// truncated record at its end is met again, whole, at the next reading; a gap leaves a hole without rows.
///
/// With `track.filter = "guarded"` every window of the tracker (10 s) may end in a new model (TrackedModel), which a
/// guarded filter has from the moment that the window's smoothing filters could have been ready, and not before: it
/// goes over the same samples as the model-free filter, whose estimate alone the tracker reads.
class TrackedFlight {
 public:
  /// Reads the study's estimate to start from, where there is one.
  /// @throws InputError for a file that cannot be read, and where `[reconstruct]` and `[track]` contradict each other
  explicit TrackedFlight(const FlightStudy& study);

  /// Takes what the recording has beyond what was taken before. `finished`: nothing will follow, so that the end is
  /// taken too. @return the changes found. @throws InputError when channels are missing
  std::vector<FlightChange> advance(const MappedRecording& mapped, const FlightStudy& study, bool finished,
                                    Progress& progress, std::span<const DelayReport> delays = {});

  /// Checks the whole recording against itself and physics, as `identify` does, where `advance` has not done so already
  /// (it does when it takes a whole, finished recording through the filter). Runs the state estimation.
  /// @param delays what the alignment of the clocks found
  void check_recording(const MappedRecording& mapped, const FlightStudy& study, std::span<const DelayReport> delays,
                       Progress& progress);

  [[nodiscard]] const FlightTracker& tracker() const { return tracker_; }
  /// The estimates as they stand, with evidence and grades; see judged_estimate.
  [[nodiscard]] estimation::Estimate estimate() const;
  /// Of the guarded filter; empty with any other.
  [[nodiscard]] const FilterHistory& filter() const { return filter_; }
  [[nodiscard]] AirDataSource air_data() const { return air_data_; }
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }
  [[nodiscard]] double end_time() const { return end_; }  ///< last stamp seen [s]

 private:
  void judge_recording(const MappedRecording& mapped, const FlightStudy& study, const Reconstruction& reconstruction,
                       const FlightSignals& signals, std::span<const DelayReport> delays);

  std::vector<FlightChange> feed(const FlightSignals& signals, double from, double until);
  void run_filter(const Recording& part, const FlightStudy& study, const Recording& model_free,
                  const DrydenSettings& turbulence, Progress& progress);

  FlightTracker tracker_;
  std::optional<TrackedModel> model_;  ///< with a guarded filter
  FilterHistory filter_;
  std::vector<estimation::Evidence> recording_evidence_;
  AirDataSource air_data_ = AirDataSource::kFilter;
  std::vector<std::string> notes_;
  double end_ = 0.0;
};

/// Delays found and removed, then the whole flight.
struct TrackingAnalysis {
  std::vector<DelayReport> delays;
  TrackedFlight flight;
  bool interrupted = false;
};
/// @throws InputError when channels are missing.
[[nodiscard]] TrackingAnalysis track_flight(const FlightStudy& study, Progress& progress);

/// History of all coefficients as a recording: `CL_alpha`, `sigma_CL_alpha`, `lambda_CL`, `excited_CL`,
/// `suspicion_CL`, ...
[[nodiscard]] Recording history_recording(const FlightTracker& tracker);

}  // namespace veridyn::aircraft
