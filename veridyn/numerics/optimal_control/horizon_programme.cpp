#include "veridyn/numerics/optimal_control/horizon_programme.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "veridyn/core/constants.hpp"

namespace veridyn::numerics {

template <int kStates, int kInputs>
HorizonProgramme<kStates, kInputs>::Stage::Stage() {
  x_low.setConstant(-kInfinity);
  x_high.setConstant(kInfinity);
  u_low.setConstant(-kInfinity);
  u_high.setConstant(kInfinity);
}

template <int kStates, int kInputs>
HorizonProgramme<kStates, kInputs>::HorizonProgramme(std::size_t n)
    : stages(n + 1),
      x_(n + 1, State::Zero()),
      dx_(n + 1, State::Zero()),
      gx_(n + 1, State::Zero()),
      dgx_(n + 1, State::Zero()),
      u_(n, Input::Zero()),
      du_(n, Input::Zero()),
      gu_(n, Input::Zero()),
      k_(n, Input::Zero()),
      K_(n),
      G_(n),
      F_(n),
      P_(n + 1),
      of_x_(n + 1),
      of_u_(n) {}

template <int kStates, int kInputs>
template <int kSize>
void HorizonProgramme<kStates, kInputs>::Bounds<kSize>::begin(const Vector& z, const Vector& low, const Vector& high,
                                                              bool warm) {
  for (int i = 0; i < kSize; ++i) {
    const double range = high(i) - low(i);
    // Away from the bounds; a warm start keeps what it knows of them.
    const double least = (warm ? 1e-4 : 1e-2) * (std::isfinite(range) ? range : 1.0);
    const auto one = [&](double distance, bool is, double& s_of, double& multiplier) {
      if (!is) {
        s_of = 1.0;
        multiplier = 0.0;
        return;
      }
      s_of = std::max(distance, least);
      const double before = warm && std::isfinite(multiplier) ? multiplier : 0.0;
      multiplier = std::max(before, (warm ? 1e-4 : 1.0) * 1e-1 / s_of * (warm ? least : 1.0));
    };
    one(z(i) - low(i), std::isfinite(low(i)), s(i), lambda(i));
    one(high(i) - z(i), std::isfinite(high(i)), t(i), mu(i));
  }
}

template <int kStates, int kInputs>
template <int kSize>
void HorizonProgramme<kStates, kInputs>::Bounds<kSize>::condense(const Vector& z, const Vector& low, const Vector& high,
                                                                 double centre, bool corrected, Vector& diagonal,
                                                                 Vector& gradient) const {
  for (int i = 0; i < kSize; ++i) {
    // Added to each other first: mirrored bounds give the mirrored sum, bit for bit.
    double from_low = 0.0, from_high = 0.0, weight_low = 0.0, weight_high = 0.0;
    if (std::isfinite(low(i))) {
      const double target = centre - (corrected ? s_affine(i) * lambda_affine(i) : 0.0);
      const double off = z(i) - low(i) + give(i) * lambda(i) - s(i), stiffness = s(i) + give(i) * lambda(i);
      weight_low = lambda(i) / stiffness;
      from_low = -(target + give(i) * lambda(i) * lambda(i)) / stiffness + weight_low * off;
    }
    if (std::isfinite(high(i))) {
      const double target = centre - (corrected ? t_affine(i) * mu_affine(i) : 0.0);
      const double off = high(i) - z(i) + give(i) * mu(i) - t(i), stiffness = t(i) + give(i) * mu(i);
      weight_high = mu(i) / stiffness;
      from_high = (target + give(i) * mu(i) * mu(i)) / stiffness - weight_high * off;
    }
    diagonal(i) += weight_low + weight_high;
    gradient(i) += from_low + from_high;
  }
}

template <int kStates, int kInputs>
template <int kSize>
void HorizonProgramme<kStates, kInputs>::Bounds<kSize>::take(const Vector& step, const Vector& z, const Vector& low,
                                                             const Vector& high, double centre, bool corrected) {
  for (int i = 0; i < kSize; ++i) {
    s_step(i) = lambda_step(i) = t_step(i) = mu_step(i) = 0.0;
    if (std::isfinite(low(i))) {
      const double target = centre - (corrected ? s_affine(i) * lambda_affine(i) : 0.0);
      const double off = z(i) - low(i) + give(i) * lambda(i) - s(i);
      lambda_step(i) = (target - lambda(i) * (s(i) + step(i) + off)) / (s(i) + give(i) * lambda(i));
      s_step(i) = step(i) + off + give(i) * lambda_step(i);
    }
    if (std::isfinite(high(i))) {
      const double target = centre - (corrected ? t_affine(i) * mu_affine(i) : 0.0);
      const double off = high(i) - z(i) + give(i) * mu(i) - t(i);
      mu_step(i) = (target - mu(i) * (t(i) - step(i) + off)) / (t(i) + give(i) * mu(i));
      t_step(i) = -step(i) + off + give(i) * mu_step(i);
    }
  }
  if (!corrected) {
    s_affine = s_step;
    lambda_affine = lambda_step;
    t_affine = t_step;
    mu_affine = mu_step;
  }
}

template <int kStates, int kInputs>
template <int kSize>
double HorizonProgramme<kStates, kInputs>::Bounds<kSize>::longest(double fraction) const {
  double most = 1.0;
  const auto keep = [&](double value, double step) {
    if (step < 0.0) most = std::min(most, -fraction * value / step);
  };
  for (int i = 0; i < kSize; ++i) {
    keep(s(i), s_step(i));
    keep(lambda(i), lambda_step(i));
    keep(t(i), t_step(i));
    keep(mu(i), mu_step(i));
  }
  return most;
}

template <int kStates, int kInputs>
template <int kSize>
void HorizonProgramme<kStates, kInputs>::Bounds<kSize>::advance(double length) {
  s += length * s_step;
  lambda += length * lambda_step;
  t += length * t_step;
  mu += length * mu_step;
}

template <int kStates, int kInputs>
template <int kSize>
void HorizonProgramme<kStates, kInputs>::Bounds<kSize>::measure(double length, double& sum, double& largest,
                                                                long& count) const {
  for (int i = 0; i < kSize; ++i) {
    const double below = (s(i) + length * s_step(i)) * (lambda(i) + length * lambda_step(i)),
                 above = (t(i) + length * t_step(i)) * (mu(i) + length * mu_step(i));
    // Zero: there is no bound.
    sum += below + above;
    largest = std::max({largest, below, above});
    count += (below != 0.0 ? 1 : 0) + (above != 0.0 ? 1 : 0);
  }
}

template <int kStates, int kInputs>
template <int kSize>
double HorizonProgramme<kStates, kInputs>::Bounds<kSize>::violation(const Vector& z, const Vector& low,
                                                                    const Vector& high) const {
  double most = 0.0;
  for (int i = 0; i < kSize; ++i)
    most = std::max({most, low(i) - z(i) - give(i) * lambda(i), z(i) - high(i) - give(i) * mu(i)});
  return most;
}

template <int kStates, int kInputs>
void HorizonProgramme<kStates, kInputs>::roll_out(const State& x0) {
  x_[0] = x0;
  for (std::size_t k = 0; k < u_.size(); ++k) {
    const Stage& s = stages[k];
    x_[k + 1].noalias() = s.A * x_[k];
    x_[k + 1].noalias() += s.B * u_[k];
    x_[k + 1] += s.b;
  }
}

template <int kStates, int kInputs>
bool HorizonProgramme<kStates, kInputs>::factorise() {
  const std::size_t n = u_.size();
  State unused_x = State::Zero();
  Input unused_u = Input::Zero();
  State diagonal = State::Zero();
  of_x_[n].condense(x_[n], stages[n].x_low, stages[n].x_high, 0.0, false, diagonal, unused_x);
  P_[n] = stages[n].Q;
  P_[n].diagonal() += diagonal;
  for (std::size_t k = n; k-- > 0;) {
    const Stage& s = stages[k];
    Input of_u = Input::Zero();
    of_u_[k].condense(u_[k], s.u_low, s.u_high, 0.0, false, of_u, unused_u);
    const Map PB = P_[k + 1] * s.B;
    InputMatrix F = s.R + s.B.transpose() * PB;
    F.diagonal() += of_u;
    F_[k].compute(F);
    if (F_[k].info() != Eigen::Success) return false;
    G_[k].noalias() = PB.transpose() * s.A;
    K_[k] = F_[k].solve(G_[k]);
    const StateMatrix PA = P_[k + 1] * s.A;
    P_[k] = s.Q;
    P_[k].noalias() += s.A.transpose() * PA;
    P_[k].noalias() -= G_[k].transpose() * K_[k];
    if (k == 0) break;
    diagonal.setZero();
    of_x_[k].condense(x_[k], s.x_low, s.x_high, 0.0, false, diagonal, unused_x);
    P_[k].diagonal() += diagonal;
  }
  return true;
}

template <int kStates, int kInputs>
void HorizonProgramme<kStates, kInputs>::newton(double centre, bool corrected) {
  const std::size_t n = u_.size();
  State unused_x = State::Zero();
  Input unused_u = Input::Zero();
  State p = stages[n].Q * x_[n] + stages[n].q;
  of_x_[n].condense(x_[n], stages[n].x_low, stages[n].x_high, centre, corrected, unused_x, p);
  for (std::size_t k = n; k-- > 0;) {
    const Stage& s = stages[k];
    Input g = s.R * u_[k] + s.r + s.B.transpose() * p;
    of_u_[k].condense(u_[k], s.u_low, s.u_high, centre, corrected, unused_u, g);
    k_[k] = F_[k].solve(g);
    State before = s.Q * x_[k] + s.q + s.A.transpose() * p;
    before.noalias() -= G_[k].transpose() * k_[k];
    if (k > 0) of_x_[k].condense(x_[k], s.x_low, s.x_high, centre, corrected, unused_x, before);
    p = before;
  }
  dx_[0].setZero();
  for (std::size_t k = 0; k < n; ++k) {
    const Stage& s = stages[k];
    du_[k] = -k_[k] - K_[k] * dx_[k];
    dx_[k + 1].noalias() = s.A * dx_[k];
    dx_[k + 1].noalias() += s.B * du_[k];
    of_u_[k].take(du_[k], u_[k], s.u_low, s.u_high, centre, corrected);
    of_x_[k + 1].take(dx_[k + 1], x_[k + 1], stages[k + 1].x_low, stages[k + 1].x_high, centre, corrected);
  }
}

template <int kStates, int kInputs>
double HorizonProgramme<kStates, kInputs>::gradient() const {
  const std::size_t n = u_.size();
  double most = 0.0;
  State nu = stages[n].Q * x_[n] + stages[n].q - of_x_[n].lambda + of_x_[n].mu;
  for (std::size_t k = n; k-- > 0;) {
    const Stage& s = stages[k];
    const Input g = s.R * u_[k] + s.r + s.B.transpose() * nu - of_u_[k].lambda + of_u_[k].mu;
    most = std::max(most, g.cwiseAbs().maxCoeff());
    if (k == 0) break;
    const State before = s.Q * x_[k] + s.q + s.A.transpose() * nu - of_x_[k].lambda + of_x_[k].mu;
    nu = before;
  }
  return most;
}

template <int kStates, int kInputs>
double HorizonProgramme<kStates, kInputs>::cost() const {
  double sum = 0.0;
  for (std::size_t k = 0; k < stages.size(); ++k) {
    const Stage& s = stages[k];
    sum += 0.5 * x_[k].dot(s.Q * x_[k]) + s.q.dot(x_[k]);
    if (k < u_.size()) sum += 0.5 * u_[k].dot(s.R * u_[k]) + s.r.dot(u_[k]);
    if (k > 0) sum += 0.5 * s.x_give.dot(of_x_[k].lambda.cwiseAbs2() + of_x_[k].mu.cwiseAbs2());
  }
  return sum;
}

template <int kStates, int kInputs>
void HorizonProgramme<kStates, kInputs>::complementarity(double length, double& mean, double& largest) const {
  double sum = 0.0;
  largest = 0.0;
  long count = 0;
  for (std::size_t k = 0; k < u_.size(); ++k) {
    of_u_[k].measure(length, sum, largest, count);
    of_x_[k + 1].measure(length, sum, largest, count);
  }
  mean = count > 0 ? sum / static_cast<double>(count) : 0.0;
}

namespace internal {
/// Share of the products that is left after the predictor, from which on it is not corrected; where to go then.
inline constexpr double kGoesSomewhere = 0.8, kToTheMiddle = 0.5;
}  // namespace internal

template <int kStates, int kInputs>
ProgrammeResult HorizonProgramme<kStates, kInputs>::solve(const State& x0, const ProgrammeOptions& options, bool warm) {
  const std::size_t n = u_.size();
  ProgrammeResult result;
  if (!x0.allFinite()) return result;
  if (!warm) std::fill(u_.begin(), u_.end(), Input::Zero());
  roll_out(x0);
  for (std::size_t k = 0; k < n; ++k) {
    of_u_[k].begin(u_[k], stages[k].u_low, stages[k].u_high, warm);
    of_x_[k + 1].give = stages[k + 1].x_give;
    of_x_[k + 1].begin(x_[k + 1], stages[k + 1].x_low, stages[k + 1].x_high, warm);
  }
  const auto longest = [&](double fraction) {
    double length = 1.0;
    for (std::size_t k = 0; k < n; ++k)
      length = std::min({length, of_u_[k].longest(fraction), of_x_[k + 1].longest(fraction)});
    return length;
  };
  for (std::size_t k = 0; k < n; ++k) {
    of_u_[k].s_step.setZero(), of_u_[k].lambda_step.setZero(), of_u_[k].t_step.setZero(), of_u_[k].mu_step.setZero();
    Bounds<kStates>& b = of_x_[k + 1];
    b.s_step.setZero(), b.lambda_step.setZero(), b.t_step.setZero(), b.mu_step.setZero();
  }
  for (int iteration = 0;; ++iteration) {
    double mean = 0.0;
    complementarity(0.0, mean, result.complementarity);
    result.gradient = gradient();
    result.violation = 0.0;
    double bound = 0.0;  // what the distances are off
    for (std::size_t k = 0; k < n; ++k) {
      const Stage &s = stages[k], &after = stages[k + 1];
      result.violation = std::max({result.violation, of_u_[k].violation(u_[k], s.u_low, s.u_high),
                                   of_x_[k + 1].violation(x_[k + 1], after.x_low, after.x_high)});
    }
    bound = result.violation;
    result.iterations = iteration;
    if (!std::isfinite(result.gradient) || !std::isfinite(mean)) {
      result.end = ProgrammeEnd::kInfeasible;
      break;
    }
    if (result.gradient < options.tolerance && bound < options.tolerance &&
        result.complementarity < options.tolerance) {
      result.end = ProgrammeEnd::kSolved;
      break;
    }
    if (iteration == options.iterations) {
      result.end = ProgrammeEnd::kIterationLimit;
      break;
    }
    if (!factorise()) {
      result.end = ProgrammeEnd::kInfeasible;
      break;
    }
    newton(0.0, false);
    double after = 0.0, unused = 0.0;
    complementarity(longest(1.0), after, unused);
    const double ratio = mean > 0.0 ? std::clamp(after / mean, 0.0, 1.0) : 0.0;
    if (ratio < internal::kGoesSomewhere || result.violation > options.tolerance) {
      // Products far below the tolerance would leave nothing but rounding in the next step.
      newton(std::max(ratio * ratio * ratio * mean, 1e-2 * options.tolerance), true);
    } else {
      // The predictor runs into a bound at once: its correction may lead round in circles, so to the middle first.
      newton(internal::kToTheMiddle * mean, false);
    }
    const double length = longest(0.995);
    if (!(length > 1e-10)) {
      result.end = ProgrammeEnd::kInfeasible;
      break;
    }
    for (std::size_t k = 0; k < n; ++k) {
      u_[k] += length * du_[k];
      of_u_[k].advance(length);
      of_x_[k + 1].advance(length);
    }
    roll_out(x0);
  }
  result.cost = cost();
  return result;
}

template <int kStates, int kInputs>
void HorizonProgramme<kStates, kInputs>::shift() {
  for (std::size_t k = 0; k + 1 < u_.size(); ++k) {
    u_[k] = u_[k + 1];
    of_u_[k] = of_u_[k + 1];
    of_x_[k + 1] = of_x_[k + 2];
  }
}

template class HorizonProgramme<4, 1>;
template class HorizonProgramme<5, 1>;
template class HorizonProgramme<7, 1>;
template class HorizonProgramme<9, 2>;

}  // namespace veridyn::numerics
