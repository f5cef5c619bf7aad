#pragma once

#include <span>

namespace veridyn::numerics {

/// What a model's squared error is made of: three shares that add up to 1 (Theil 1970, Economic Forecasts and Policy;
/// Jategaonkar 2006, Flight Vehicle System Identification, 11.2). With means m, standard deviations s (over N) and the
/// correlation r of measurement z and model y,
///
///     mean (y - z)^2 = (m_y - m_z)^2 + (s_y - s_z)^2 + 2 (1 - r) s_y s_z
///
/// A model that is right leaves noise, which is all covariance; an offset shows as bias, a wrong gain as variance.
struct TheilShares {
  double bias = 0.0;        ///< of the means
  double variance = 0.0;    ///< of the standard deviations
  double covariance = 0.0;  ///< what is left: shape, time, noise
};

/// Pairs with a NaN on either side are left out; NaN where there is no error, or no pair.
/// @throws InputError when the sizes differ.
[[nodiscard]] TheilShares theil_shares(std::span<const double> measured, std::span<const double> model);

}  // namespace veridyn::numerics
