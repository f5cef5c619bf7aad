#pragma once

/// Parameters and states from data of any domain, each with its uncertainty.
///
///     estimation::compare(data)                   // a linear regression by all methods, and which is recommended
///     estimation::RegressionTracker               // the same on line, with forgetting and an alarm at changes
///     estimation::output_error(model, measured)   // any simulated model (ParametricModel) against what was measured
///     estimation::ExtendedKalmanFilter            // states of a model, from sensors at any rate
///     estimation::FixedIntervalSmoother           // the same with what came later
///     estimation::particle_swarm, pattern_search  // where only values are known, each of them expensive
///     estimation::response_indices                // which input moves which result
///     estimation::compare_estimates               // do estimates agree within their error bars?
///
/// What an identification delivers, whatever its domain, is an `Estimate` (parameters, covariance, verdict, evidence);
/// `Analysis` holds it with predictions and methods. Component `estimation`.

#include "veridyn/core.hpp"
#include "veridyn/estimation/kalman/kalman_filter.hpp"
#include "veridyn/estimation/kalman/smoother.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"
#include "veridyn/estimation/recursive/regression_tracker.hpp"
#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/estimation/regression/regression_judgement.hpp"
#include "veridyn/estimation/regression/structure_search.hpp"
#include "veridyn/estimation/result/analysis.hpp"
#include "veridyn/estimation/result/estimate.hpp"
#include "veridyn/estimation/result/estimate_comparison.hpp"
#include "veridyn/estimation/search/particle_swarm.hpp"
#include "veridyn/estimation/search/pattern_search.hpp"
#include "veridyn/estimation/uncertainty/monte_carlo.hpp"
#include "veridyn/estimation/uncertainty/profile_likelihood.hpp"
#include "veridyn/estimation/uncertainty/response_indices.hpp"
