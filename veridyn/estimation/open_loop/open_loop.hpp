#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"
#include "veridyn/estimation/result/estimate.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/numerics/theil_shares.hpp"

namespace veridyn::estimation {

/// A forecast that is shorter tells nothing [s].
inline constexpr double kLeastForecast_s = 2.0;

/// How long windows are. Keys of the study table `[validate]`, in every domain.
struct OpenLoopTimes {
  double duration_s = 0.0;  ///< of each window, at most; 0: nothing is integrated
  double start_s = 2.0;     ///< of each window, of which its initial state and the offsets are estimated

  /// Of the table `[validate]`.
  [[nodiscard]] static const KeyTable<OpenLoopTimes>& keys();
};

/// A state over all windows of its group, forecast against measured.
struct OpenLoopState {
  std::string name;        ///< "alpha", "yaw_rate"
  std::string unit;        ///< of the measures: m/s, deg, deg/s, m/s^2
  std::string group = {};  ///< of the windows that it is judged in: "longitudinal"; empty where there is one group
  numerics::FitMeasures fit = {};  ///< of what was forecast
  double normalised_rmse = 0.0;    ///< over the standard deviation of what was measured: 1 is no better than its mean
  numerics::TheilShares shares = {};  ///< of the squared error
  double inside = 0.0;                ///< share of the forecast's samples within the 95 % band
  /// Median over the windows of the time from the forecast's begin until the band is left; a window that ends before
  /// counts as if it were left at its end.
  double horizon_s = 0.0;
  std::size_t windows = 0, held = 0;  ///< windows, and those of them whose end came first
  /// All windows one after the other, several recordings too: time [s]; NaN between windows; SI. `sigma` is that of
  /// measured less predicted, NaN where the initial state is estimated.
  std::vector<double> time = {}, measured = {}, predicted = {}, sigma = {};
};

/// One stretch that was integrated.
struct OpenLoopWindow {
  std::string recording = {};  ///< its name, where there are several
  std::string group = {};
  TimeSpan span = {};          ///< in its recording's own time [s]
  double forecast_from = 0.0;  ///< what lies before gave the initial state [s]
  bool diverged = false;       ///< the simulation left the model's range, and was cut there
  /// The initial state, then the offsets, with names, units and values.
  std::vector<SegmentParameter> start = {};
  /// Until each state leaves its band, in the order of the model's outputs, judged here or in another group.
  std::vector<double> horizon_s = {};
  double first_left_s = 0.0;  ///< the shortest of those that it is judged on
};

/// How well the states of one of several recordings are predicted.
struct OpenLoopRecording {
  std::string recording;
  std::vector<OpenLoopState> states = {};
};

/// An identified model integrated from recorded inputs alone.
struct OpenLoop {
  OpenLoopTimes times;
  std::string inputs = {};                ///< "deflections and thrust", "steering and speed"
  double forecast_s = 0.0;                ///< time that was forecast
  std::vector<std::string> offsets = {};  ///< constants that each window has of its own
  std::vector<OpenLoopWindow> windows = {};
  std::vector<OpenLoopState> states = {};
  std::vector<OpenLoopRecording> by_recording = {};  ///< the same recording by recording, where there are several
  std::string text = {};                             ///< what was done, in one sentence; empty: nothing was asked for

  [[nodiscard]] bool available() const { return !states.empty(); }
  /// The groups of its states, in their order.
  [[nodiscard]] std::vector<std::string> groups() const;
};

/// The name of a state in estimate.json: "open_loop.alpha".
[[nodiscard]] std::string open_loop_name(const OpenLoopState& state);
/// The scores in the terms of estimate.json: `validation` and `fit` of each state.
void add_open_loop(const OpenLoop& open_loop, Estimate& estimate);

/// The unit in which a quantity is shown: deg for rad, deg/s for rad/s, others as they are.
[[nodiscard]] std::string shown_unit(std::string_view unit);
/// What a quantity of this SI unit is multiplied with to be in `shown_unit`.
[[nodiscard]] double shown_factor(std::string_view unit);
/// The SI unit of a state's series.
[[nodiscard]] std::string si_unit(const OpenLoopState& state);
/// What they are multiplied with to be in `state.unit`.
[[nodiscard]] double shown_factor(const OpenLoopState& state);

}  // namespace veridyn::estimation
