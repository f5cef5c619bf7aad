#pragma once

#include <cstddef>
#include <vector>

#include "veridyn/aircraft/identification/signals/measured_coefficients.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/core/recording.hpp"
#include "veridyn/numerics/filters.hpp"
#include "veridyn/numerics/resample.hpp"

/// Rates with which an aircraft turns against the air around it, beside its own: gusts that differ over the aircraft,
/// and the downwash that reaches the tail late.
namespace veridyn::aircraft {

/// Along a flight. What of it is in the regressors is a share of each, 0 by default: an error of the budget.
struct AirRates {
  /// q_g and r_g of the reconstruction's gusts by MIL-F-8785C, as `GustGradients` [rad/s]; empty without gusts.
  std::vector<double> gust_q, gust_r;
  /// What alpha' of a tail three chords behind the wing differs by from alpha' in still air [rad/s].
  std::vector<double> downwash_q;
  double pitch_share = 0.0, yaw_share = 0.0, downwash_share = 0.0;
  /// Of gusts across the span nothing is recorded but the roll with which the aircraft answers them: what of the
  /// variance of p that would be by MIL-F-8785C, and that of p_g itself [rad^2/s^2]; 0 where it is not known.
  double answered_roll = 0.0, gust_roll = 0.0;
  double roll_share = 0.0;

  /// How much of the variance of the recorded p is no motion against the air [rad^2/s^2].
  [[nodiscard]] double error_of_roll() const { return roll_share > 0.0 ? roll_share * answered_roll : 0.0; }

  /// The sample with the rates against the air at grid point k.
  [[nodiscard]] FlightSample<double> against_air(FlightSample<double> sample, std::size_t k) const;
};

/// From channels `gust_y`, `gust_z` and `alpha` of a reconstruction, smoothed like the other signals.
/// @param airspeed  on the grid; rates are 0 where it is missing
[[nodiscard]] AirRates air_rates(const Recording& smoothed, const numerics::UniformGrid& grid,
                                 const std::vector<double>& airspeed, const numerics::FirKernel& smooth,
                                 const Subject& subject);

}  // namespace veridyn::aircraft
