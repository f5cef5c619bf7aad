#pragma once

namespace veridyn::estimation {

// Limits that several checks, or checks and estimators, have in common: one idea, one number. Those of one check alone
// stand in its table (`checks/*.inc`).

/// Residual variance over what the sensors explain, up to which their noise may be all of it: a standard deviation of
/// noise is known to a factor of two. (2 of 199 clean flights are beyond it: docs/judgement.md.)
inline constexpr double kNoiseKnownTo = 4.0;

/// Correlation of neighbouring residuals from which they are motion that the model lacks. Bartlett (1946): that of
/// white noise has a standard deviation of 1/sqrt(n), so that this is three of them for 100 values, and far beyond
/// chance for the thousands of a recording.
inline constexpr double kAutocorrelatedFrom = 0.3;

/// p below which estimates from two parts differ by more than their error bars: intervals are widened (Birge 1932). The
/// usual level; one pair in twenty by chance.
inline constexpr double kPartsDiffer = 0.05;
/// p below which they contradict each other, so that the values are no constants. By chance one pair in a thousand; 5
/// of 199 clean flights (docs/judgement.md).
inline constexpr double kPartsContradict = 1e-3;

/// Share of the variance of what an estimate has not seen (R2) that it explains at least: below it is with care,
/// Nash-Sutcliffe efficiency of a "satisfactory" model by Moriasi et al. (2007).
inline constexpr double kHoldOutCare = 0.5;
/// Below it is no prediction; `identify.min_holdout_r2` sets another. (0 of 199 clean flights: docs/judgement.md.)
inline constexpr double kHoldOutFailed = 0.3;

/// Share of the variance that may be neither modelled nor noise of the sensors; `identify.max_unmodelled` sets another.
/// (2 of 199 clean flights: docs/judgement.md.)
inline constexpr double kMostUnmodelled = 0.1;

/// Variance inflation from which regressors move together (Marquardt 1970, Technometrics 12(3)).
inline constexpr double kMostInflation = 10.0;

}  // namespace veridyn::estimation
