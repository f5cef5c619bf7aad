#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/estimation/regression/regression_data.hpp"
#include "veridyn/muscle/actuator/muscle_group.hpp"
#include "veridyn/muscle/simulation/forward_simulation.hpp"
#include "veridyn/numerics/piecewise_polynomial.hpp"

namespace veridyn::muscle {

/// One muscle whose path is known beforehand as a function of time: a view of what it names.
struct MuscleAlongPath {
  const MuscleGroup<double>& muscle;             ///< of this one muscle
  const numerics::PiecewisePolynomial& length;   ///< of its path over time [m]
  const MuscleControls& controls;                ///< excitation of this one muscle, recorded; no reserves
  double begin = 0.0;                            ///< the fibre is in equilibrium with its tendon there [s]
  std::span<const double> time;                  ///< of the samples, increasing, none before `begin` [s]
  double accuracy = 1e-6;                        ///< largest error of a step, in units of 0.1 and a tenth of L0
  MusculotendonParameters<double> parameters{};  ///< in place of the muscle's own
  double gain = 1.0, delay = 0.0;                ///< u(t) = gain e(t - delay), kept within what a muscle can do
};

/// What a derivative is taken with respect to.
struct PathMuscleColumn {
  enum class Kind {
    kField,  ///< a number of the muscle
    kGain,
    kDelay,
    /// The error of the recorded excitation around an instant, in standard deviations: `relative` of the value and
    /// `absolute`, times cos(pi (t - knot)/(2 spacing)) where |t - knot| < spacing. The squares of neighbours' shapes
    /// add up to one, so that independent errors of knots `spacing` apart have the same variance at every instant.
    kError,
  };
  Kind kind = Kind::kField;
  std::size_t field = 0;  ///< of kField: `estimable_field`
  double knot = 0.0, spacing = 1.0, relative = 0.0, absolute = 0.0;
};

/// What a muscle does at the samples.
struct PathMuscleResponse {
  std::vector<double> force;                 ///< of the tendon [N]
  std::vector<double> fiber_length;          ///< of a rigid tendon what the path leaves [m]
  estimation::RowMatrix force_by, fiber_by;  ///< samples x columns
  std::string trouble;                       ///< why it cannot be integrated: at what time, and its state
};

/// Activation and fibre of one muscle by error-controlled steps (`numerics::AdditiveRungeKutta`, the fibre implicitly),
/// with exact derivatives by variational equations on the same steps. The excitation u is kept between the muscle's
/// least activation and 1: beyond, an activation that has run into its limit would take time to come back.
/// @returns false when it cannot be integrated, with `response.trouble`.
[[nodiscard]] bool simulate_along_path(const MuscleAlongPath& muscle, std::span<const PathMuscleColumn> columns,
                                       PathMuscleResponse& response);

}  // namespace veridyn::muscle
