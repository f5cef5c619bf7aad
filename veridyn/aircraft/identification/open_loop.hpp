#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/aircraft/identification/flight_rows.hpp"
#include "veridyn/aircraft/identification/open_loop_options.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/estimate.hpp"
#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/numerics/theil_shares.hpp"

namespace veridyn::aircraft {

/// A state over all windows of its axis, flown against measured.
struct OpenLoopState {
  std::string name;  ///< "alpha", "q"
  std::string unit;  ///< of the measures: m/s, deg, deg/s
  Axis axis = Axis::kLongitudinal;
  numerics::FitMeasures fit = {};  ///< of what was forecast
  double normalised_rmse = 0.0;    ///< over the standard deviation of what was measured: 1 is no better than its mean
  numerics::TheilShares shares = {};  ///< of the squared error
  double inside = 0.0;                ///< share of the forecast's samples within the 95 % band
  /// Median over the windows of the time from the forecast's begin until the band is left; a window that ends before
  /// counts as if it were left at its end.
  double horizon_s = 0.0;
  std::size_t windows = 0, held = 0;  ///< windows, and those of them whose end came first
  /// All windows one after the other, several flights too (PreparedFlight::shift_s): time [s]; NaN between windows;
  /// SI. `sigma` is that of measured less predicted, infinite where the initial state is estimated.
  std::vector<double> time = {}, measured = {}, predicted = {}, sigma = {};
};

/// One stretch that was flown.
struct OpenLoopWindow {
  std::string flight = {};  ///< its name, where there are several
  Axis axis = Axis::kLongitudinal;
  TimeSpan span = {};          ///< in its flight's own time [s]
  double forecast_from = 0.0;  ///< what lies before gave the initial state [s]
  bool diverged = false;       ///< the simulation left the model's range, and was cut there
  /// The initial state, then the offsets, with names, units and values.
  std::vector<estimation::SegmentParameter> start = {};
  /// Until each simulated state leaves its band, in their order: those of the axis that it is judged on and the others.
  std::vector<double> horizon_s = {};
  double first_left_s = 0.0;  ///< the shortest of those that it is judged on
};

/// How well the states of one of several flights are predicted.
struct OpenLoopFlight {
  std::string flight;
  std::vector<OpenLoopState> states = {};
};

/// The identified model flown open loop: integrated from recorded deflections and thrust alone.
struct OpenLoop {
  OpenLoopOptions options;
  double forecast_s = 0.0;                ///< time that was forecast
  std::vector<Coefficient> offsets = {};  ///< that have a constant of their own in each window
  std::vector<OpenLoopWindow> windows;
  std::vector<OpenLoopState> states;          ///< longitudinal, then lateral
  std::vector<OpenLoopFlight> by_flight;      ///< the same flight by flight, where there are several
  bool air_known = true;                      ///< gusts are an input, or the study says that there were none
  std::vector<std::string> driven = {};       ///< states that no coefficient moves: taken as measured
  std::optional<double> short_period_s = {};  ///< of the model where it was flown; of alpha and q
  std::optional<double> dutch_roll_s = {};    ///< of beta and r
  std::string text;                           ///< what was done, in one sentence; empty: nothing was asked for
  [[nodiscard]] bool available() const { return !states.empty(); }
};

/// Flies the model over what it was not identified from, with its six degrees of freedom (OutputErrorModel: Va, alpha,
/// beta, p, q, r, roll, pitch; position and heading do not act back), from recorded deflections, thrust, air density
/// and, where asked for, the reconstructed gust. A state whose coefficient is not in `known` is taken as measured.
///
/// A window begins at the begin of each excited span of `use`, and where the one before it ends in there, and lasts for
/// `open_loop`, or until the stretch in the air that identification of its axis did not see is over. Its first
/// `open_loop_start` seconds give the initial state and the offsets, by output error on the measured states weighted
/// by their sensors; all else is forecast. Airspeed, alpha, q and pitch are judged in longitudinal windows, beta, p, r
/// and roll in lateral ones.
///
/// The band of a state is +-1.96 sigma of measured less predicted,
///
///     sigma^2 = g P g' + S_x P_x S_x' + R,   g = S_theta - S_x P_x A_x' W A_theta
///
/// with the parameters' covariance P (of `estimate`), the information A_x' W A_x = P_x^-1 of the first seconds about
/// initial state and offsets (these have a prior of 0 +- 0.05), the sensitivities S of the prediction and A of those
/// seconds, and the sensor's error R as it passes the filters; so an error of a parameter that the initial state made
/// up for does not count twice. Errors of smoothed signals count as one observation in those seconds, since they hardly
/// change in them. The band counts as left where the error of the next half second exceeds
/// three sigma (RMS): 5 % of the samples are outside of a right band, and a state that leaves may cross it again.
///
/// The integration is that of Runge-Kutta of fourth order at steps of 2 ms at most, inputs linear between samples.
/// Windows run on the threads of `progress`, to the same bits on any number.
/// @param estimate  of the parameters' covariance, by name; what it lacks is taken for exact
[[nodiscard]] OpenLoop fly_open_loop(std::span<const PreparedFlight> flights, RowUse use, const Subject& subject,
                                     std::span<const Coefficient> known, const estimation::Estimate& estimate,
                                     const OpenLoopOptions& options, Progress& progress);

/// The rows that grade it, which bear on the prediction:
/// - *open loop horizon*, of each axis: how long its states stay within their bands, in periods of the short-period
///   motion (longitudinal) or the Dutch roll (lateral). Below 10 with care. Below 3 failed where the error is also more
///   than a quarter of the motion's standard deviation: the bands know parameters and sensors, and not the gusts that a
///   reconstruction misses, which throw a right model out of them by less. Where nothing is known of the air
///   (`air_known`), more than 3.3 times, an R^2 of -10. Not verified where the windows are shorter than 10 periods and
///   most are held to their end;
/// - *open loop against the mean*, of each state: with care where the error is larger than the motion's standard
///   deviation;
/// - *open loop divergence*: failed where a simulation left the model's range.
[[nodiscard]] std::vector<estimation::Evidence> open_loop_evidence(const OpenLoop& flown);

}  // namespace veridyn::aircraft
