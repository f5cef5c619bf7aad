#pragma once

#include "veridyn/numerics/linear_systems/state_space.hpp"

namespace veridyn::numerics {

/// What the input does between two samples.
enum class Hold {
  kZeroOrder,   ///< keeps the value of the first
  kFirstOrder,  ///< goes on a line from one to the other
};

/// x(k+1) = Phi x(k) + Gamma u(k) + Slope (u(k+1) - u(k)), y(k) = C x(k) + D u(k): exact for inputs that are held so.
struct HeldSystem {
  Eigen::MatrixXd Phi, Gamma;
  Eigen::MatrixXd Slope;  ///< zero with kZeroOrder
};

/// Over a step of `step` [s], by one matrix exponential (Van Loan 1978, IEEE Trans Autom Control 23:395). @throws
/// InputError for a step that is negative or not finite.
[[nodiscard]] HeldSystem held(const StateSpace& system, double step, Hold hold);

/// By the bilinear transformation s = a (z - 1) / (z + 1), a = omega / tan(omega step / 2): the frequency response of
/// the continuous system at `omega` is that of the discrete one. @param omega [rad/s]; 0: a = 2 / step (Tustin)
/// @throws InputError unless 0 <= omega step < pi, and where a is a pole.
[[nodiscard]] StateSpace bilinear(const StateSpace& system, double step, double omega = 0.0);

}  // namespace veridyn::numerics
