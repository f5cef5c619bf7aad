#include "veridyn/numerics/linear_systems/causal_filter.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "veridyn/core/error.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"

namespace veridyn::numerics {

static_assert(CausalFilter::kMostStates + 2 == SmallMatrix::MaxRowsAtCompileTime);

CausalFilter::CausalFilter(const StateSpace& system, Hold hold) : hold_(hold) {
  system.validate();
  const Eigen::Index n = system.states();
  if (system.inputs() != 1 || system.outputs() != 1 || n > kMostStates)
    throw InputError("filter", fmt::format("has {} inputs, {} outputs and {} states; takes one, one and {} at most",
                                           system.inputs(), system.outputs(), n, kMostStates));
  A_ = system.A;
  B_ = system.B.col(0);
  C_ = system.C.row(0).transpose();
  D_ = system.D(0, 0);
  const std::optional<Eigen::MatrixXd> A_inverse = n > 0 ? inverse(system.A) : std::nullopt;
  if (A_inverse)
    rest_ = -*A_inverse;
  else
    rest_.setZero(n, n);
  x_.setZero(n);
  next_.setZero(n);
  set_step(0.0);
}

double CausalFilter::reset(double input) {
  if (!std::isfinite(input)) input = 0.0;
  x_.noalias() = rest_.lazyProduct(B_) * input;
  return observe(input);
}

double CausalFilter::step(double input, double step) {
  if (!std::isfinite(input)) input = input_;
  if (!(step >= 0.0 && std::isfinite(step))) step = 0.0;
  if (step != step_) set_step(step);
  next_.noalias() = Phi_.lazyProduct(x_);
  next_ += Gamma_ * input_ + Slope_ * (input - input_);
  x_ = next_;
  return observe(input);
}

void CausalFilter::set_step(double step) {
  const Eigen::Index n = A_.rows();
  // As `held`, of one input.
  SmallMatrix rates = SmallMatrix::Zero(n + 2, n + 2);
  rates.topLeftCorner(n, n) = step * A_;
  rates.block(0, n, n, 1) = step * B_;
  rates(n, n + 1) = 1.0;
  const SmallMatrix e = matrix_exponential(rates);
  Phi_ = e.topLeftCorner(n, n);
  Gamma_ = e.block(0, n, n, 1);
  Slope_ = e.block(0, n + 1, n, 1);
  if (hold_ == Hold::kZeroOrder) Slope_.setZero();
  step_ = step;
}

double CausalFilter::observe(double input) {
  input_ = input;
  output_ = C_.dot(x_) + D_ * input;
  return output_;
}

}  // namespace veridyn::numerics
