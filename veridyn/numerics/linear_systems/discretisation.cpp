#include "veridyn/numerics/linear_systems/discretisation.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/linear_algebra/matrix_exponential.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/numerics/linear_algebra/products.hpp"

namespace veridyn::numerics {

HeldSystem held(const StateSpace& system, double step, Hold hold) {
  if (!(step >= 0.0 && std::isfinite(step)))
    throw InputError("step", fmt::format("is {} s; must be finite and not negative", step));
  const Eigen::Index n = system.states(), m = system.inputs();
  // d/dt [x; u; slope] with the slope in units of one step.
  Eigen::MatrixXd rates = Eigen::MatrixXd::Zero(n + 2 * m, n + 2 * m);
  rates.topLeftCorner(n, n) = step * system.A;
  rates.block(0, n, n, m) = step * system.B;
  rates.block(n, n + m, m, m).setIdentity();
  const Eigen::MatrixXd e = matrix_exponential(rates);
  HeldSystem h{e.topLeftCorner(n, n), e.block(0, n, n, m), Eigen::MatrixXd::Zero(n, m)};
  if (hold == Hold::kFirstOrder) h.Slope = e.block(0, n + m, n, m);
  return h;
}

StateSpace bilinear(const StateSpace& system, double step, double omega) {
  if (!(step > 0.0 && std::isfinite(step))) throw InputError("step", fmt::format("is {} s; must be > 0", step));
  if (!(omega >= 0.0 && omega * step < kPi))
    throw InputError(
        "omega", fmt::format("is {} rad/s; must be from 0 to below {}, half of the sampling rate", omega, kPi / step));
  const double a = omega == 0.0 ? 2.0 / step : omega / std::tan(0.5 * omega * step);
  const Eigen::Index n = system.states();
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(n, n);
  const std::optional<Eigen::MatrixXd> v_to_x = inverse(a * identity - system.A);
  if (!v_to_x)
    throw InputError("step", fmt::format("of {} s makes a pole of the system one of the transformation", step));
  // States v = (a I - A) x - B u.
  const Eigen::MatrixXd A = product(a * identity + system.A, *v_to_x), C = product(system.C, *v_to_x);
  return {A, product(A, system.B) + system.B, C, product(C, system.B) + system.D};
}

}  // namespace veridyn::numerics
