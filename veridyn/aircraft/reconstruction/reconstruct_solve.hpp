#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/aircraft/reconstruction/filter_engine.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_columns.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_streams.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/kalman/innovation.hpp"

/// Inside of reconstruct.cpp: filters and smoothers over all segments of a recording.
namespace veridyn::aircraft::internal {

/// View of what a reconstruction works on.
struct SolveTask {
  const FlightStreams* streams;
  const ReconstructOptions* options;
  std::span<const Segment> segments;
  const std::vector<double>* stamps;         ///< of the results, all segments
  std::span<const std::size_t> first_stamp;  ///< of each segment
  DrydenSettings spectrum;
  const Subject* subject = nullptr;      ///< the force model, for the model-based filter
  const Recording* recording = nullptr;  ///< that the streams were made of
  bool ends_at_contradiction = true;     ///< else the pass goes on by dead reckoning: another filter decides
};

/// What the guard did along a run, at the stamps of the results.
struct GuardTrace {
  std::vector<char> model_based;  ///< whether the estimate is the model-based filter's
  std::vector<double> nis_ratio;  ///< of the last judged window: largest sum of squared innovations over its limit
  std::size_t reverts = 0;        ///< from model-based to model-free
};

/// The force model that the model-based filter of a guarded one has from a time on.
struct ModelInUse {
  double from_s = 0.0;
  std::shared_ptr<const Subject> subject;  ///< null: none
  ModelError error;
};

/// What the guard did, and the estimate of the filter that was active.
struct GuardedPass {
  GuardTrace trace;
  std::optional<ResultColumns> filtered;
  std::size_t count = 0;  ///< samples that hold results
};

/// Innovations of one sensor along a forward pass, in its unit.
struct InnovationHistory {
  std::vector<double> time, innovation, sigma, refused;  ///< `sigma` expected; `refused` 1 or 0
};

/// Estimates of filter and smoother over all segments.
struct Solution {
  std::optional<ResultColumns> smoothed, filtered;
  Monitors monitors;
  EnumArray<Sensor, InnovationHistory, kSensors> innovations;  ///< where `keep_innovations`
  std::size_t count = 0;                                       ///< samples that hold results
  /// Covariance of the estimated sensor errors at the end of the longest segment, and their columns.
  std::vector<std::size_t> error_columns;
  Eigen::MatrixXd error_covariance;
  Eigen::Matrix<double, 5, 1> air_error = Eigen::Matrix<double, 5, 1>::Zero();  ///< as estimated, 0 elsewhere
  /// As found, also where they were not applied: then `air_error` and the columns are 0.
  Eigen::Matrix<double, 5, 1> air_error_found = Eigen::Matrix<double, 5, 1>::Zero();
  bool air_data_errors_converged = true;
  std::vector<std::string> not_applied;  ///< errors of the air data that were looked for and not found
  std::optional<GuardTrace> guard;
  std::optional<Contradiction> contradiction;  ///< then `count` ends where it began
};

/// Monitors of all sensors behind one gate.
[[nodiscard]] Monitors monitors_with(const estimation::InnovationGate& gate);
/// The inertial sensors' noise as power spectral densities, and the walk of the wind.
[[nodiscard]] AirDataNoise noise_of(const FlightStreams& streams, const ReconstructOptions& options);

/// By how much the subject's force coefficients may be off.
[[nodiscard]] ModelError model_error_of(const Subject& subject, const ReconstructOptions& options);

/// The filters' system as the task describes it.
[[nodiscard]] ModelBasedMotion motion_of(const SolveTask& task);

/// Filter and smoother of one kind over all segments; errors of the air data by likelihood (see
/// `estimate_air_data_errors`), and what they leave uncertain added to the covariances.
[[nodiscard]] Solution solve(const FilterEngine& engine, const SolveTask& task, Progress& progress);
/// `solve` with the model-free filter.
[[nodiscard]] Solution solve_model_free(const SolveTask& task, Progress& progress);
/// `solve` with the model-based filter.
[[nodiscard]] Solution solve_model_based(const SolveTask& task, Progress& progress);
/// Filters as GuardedFilter decides; the smoothed estimate is the model-based smoother's but for the time within
/// `kGuardMargin_s` of where the model was not trusted, there the model-free smoother's.
[[nodiscard]] Solution solve_guarded(const SolveTask& task, Progress& progress);
inline constexpr double kGuardMargin_s = 3.0;
/// Goes through the recording with the guarded filter.
/// @param models in the order of their times; before the first of them there is none
/// @param kept columns of the active filter's estimate; none: only the trace is
[[nodiscard]] GuardedPass run_guarded(const SolveTask& task, const Eigen::Matrix<double, 5, 1>& air_error,
                                      std::span<const ModelInUse> models, const std::optional<ColumnSet>& kept,
                                      Progress& progress);

/// `model_based` and `guard_ratio` on the first `count` stamps.
void add_guard_channels(const GuardTrace& trace, const TimeBase& time, std::size_t count, Recording& filtered);

/// The columns that the options estimate; `aerodynamics`: the filter knows a force model. Wind and velocity over ground
/// are left out where no sensor tells one from the other, the heading where nothing shows it.
[[nodiscard]] ColumnSet estimated_columns(const ReconstructOptions& options, const FlightStreams& streams,
                                          bool aerodynamics);

/// Stamps of the results.
struct OutputStamps {
  std::vector<double> time;
  std::vector<std::size_t> first;  ///< index of the first of each segment
};
/// At `rate_Hz`, or where that is 0 those of the gyro.
[[nodiscard]] OutputStamps output_stamps(const FlightStreams& streams, std::span<const Segment> segments,
                                         double rate_Hz);

}  // namespace veridyn::aircraft::internal
