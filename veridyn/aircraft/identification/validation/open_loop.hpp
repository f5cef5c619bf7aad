#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/aircraft/identification/options/open_loop_options.hpp"
#include "veridyn/aircraft/identification/rows/flight_rows.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/estimation/open_loop/open_loop.hpp"
#include "veridyn/estimation/result/estimate.hpp"

namespace veridyn::aircraft {

/// The identified model flown open loop: integrated from recorded deflections and thrust alone. Its states are in two
/// groups, longitudinal and lateral (`to_string(Axis)`).
struct OpenLoop : estimation::OpenLoop {
  OpenLoopOptions options = {};
  bool air_known = true;                      ///< gusts are an input, or the study says that there were none
  bool air_in_bands = true;                   ///< where it is not known: what may have blown widens the bands
  std::vector<std::string> driven = {};       ///< states that no coefficient moves: taken as measured
  std::optional<double> short_period_s = {};  ///< of the model where it was flown; of alpha and q
  std::optional<double> dutch_roll_s = {};    ///< of beta and r
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
/// Bands and horizon are those of `estimation::open_loop_forecasts`, with the parameters' covariance (of `estimate`),
/// a prior of 0 +- 0.05 of the offsets, the sensors' errors as they pass the filters, and what moves the aircraft and
/// is no input: `MissedGusts` of the spectrum that the reconstruction assumed, all of the gusts where none are an
/// input. Errors of smoothed signals last: they hardly change within seconds. A thrust that was computed from the
/// throttle is that at the simulated airspeed.
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
///   than a quarter of the motion's standard deviation: gusts that are stronger than was assumed throw a right model
///   out of its bands by less. Where nothing is known of the air
///   (`air_known`), more than 3.3 times, an R^2 of -10. Not verified where the windows are shorter than 10 periods and
///   most are held to their end;
/// - *open loop against the mean*, of each state: with care where the error is larger than the motion's standard
///   deviation;
/// - *open loop divergence*: failed where a simulation left the model's range.
[[nodiscard]] std::vector<estimation::Evidence> open_loop_evidence(const OpenLoop& flown);

}  // namespace veridyn::aircraft
