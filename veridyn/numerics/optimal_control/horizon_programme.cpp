#include "veridyn/numerics/optimal_control/horizon_programme.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "veridyn/core/constants.hpp"

namespace veridyn::numerics {
namespace {

// Products of small matrices as plain loops of known length, columns one after the other: what Eigen makes of the same
// expressions is no faster, and takes ten times as long to compile.

/// out += A B
template <int kRows, int kInner, int kColumns>
void add_product(const Eigen::Matrix<double, kRows, kInner>& A, const Eigen::Matrix<double, kInner, kColumns>& B,
                 Eigen::Matrix<double, kRows, kColumns>& out) {
  const double *a = A.data(), *b = B.data();
  double* to = out.data();
  for (int j = 0; j < kColumns; ++j)
    for (int k = 0; k < kInner; ++k)
      for (int i = 0; i < kRows; ++i) to[i + kRows * j] += a[i + kRows * k] * b[k + kInner * j];
}

/// out += A' B
template <int kRows, int kInner, int kColumns>
void add_transposed_product(const Eigen::Matrix<double, kInner, kRows>& A,
                            const Eigen::Matrix<double, kInner, kColumns>& B,
                            Eigen::Matrix<double, kRows, kColumns>& out) {
  // Columns of A' one after the other, so that the innermost loop becomes vector instructions.
  Eigen::Matrix<double, kRows, kInner> transposed;
  for (int i = 0; i < kRows; ++i)
    for (int k = 0; k < kInner; ++k) transposed.data()[i + kRows * k] = A.data()[k + kInner * i];
  add_product(transposed, B, out);
}

template <int kSize>
double dot(const Eigen::Matrix<double, kSize, 1>& a, const Eigen::Matrix<double, kSize, 1>& b) {
  double sum = 0.0;
  for (int i = 0; i < kSize; ++i) sum += a.data()[i] * b.data()[i];
  return sum;
}

/// out += factor a, of every entry.
template <int kRows, int kColumns>
void add(double factor, const Eigen::Matrix<double, kRows, kColumns>& a, Eigen::Matrix<double, kRows, kColumns>& out) {
  for (int i = 0; i < kRows * kColumns; ++i) out.data()[i] += factor * a.data()[i];
}

/// The lower triangle of F becomes its Cholesky factor; false where F is not positive definite.
template <int kSize>
bool factorise_in_place(Eigen::Matrix<double, kSize, kSize>& F) {
  for (int j = 0; j < kSize; ++j) {
    for (int i = j; i < kSize; ++i) {
      double rest = F(i, j);
      for (int k = 0; k < j; ++k) rest -= F(i, k) * F(j, k);
      if (i == j && !(rest > 0.0)) return false;
      F(i, j) = i == j ? std::sqrt(rest) : rest / F(j, j);
    }
  }
  return true;
}

/// x = (L L')^-1 x, every column.
template <int kSize, int kColumns>
void solve_in_place(const Eigen::Matrix<double, kSize, kSize>& L, Eigen::Matrix<double, kSize, kColumns>& x) {
  for (int c = 0; c < kColumns; ++c) {
    for (int i = 0; i < kSize; ++i) {
      for (int k = 0; k < i; ++k) x(i, c) -= L(i, k) * x(k, c);
      x(i, c) /= L(i, i);
    }
    for (int i = kSize - 1; i >= 0; --i) {
      for (int k = i + 1; k < kSize; ++k) x(i, c) -= L(k, i) * x(k, c);
      x(i, c) /= L(i, i);
    }
  }
}

}  // namespace

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
  add(length, s_step, s);
  add(length, lambda_step, lambda);
  add(length, t_step, t);
  add(length, mu_step, mu);
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
    x_[k + 1] = s.b;
    add_product(s.A, x_[k], x_[k + 1]);
    add_product(s.B, u_[k], x_[k + 1]);
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
  for (int i = 0; i < kStates; ++i) P_[n](i, i) += diagonal(i);
  for (std::size_t k = n; k-- > 0;) {
    const Stage& s = stages[k];
    Input of_u = Input::Zero();
    of_u_[k].condense(u_[k], s.u_low, s.u_high, 0.0, false, of_u, unused_u);
    Map PB = Map::Zero();
    add_product(P_[k + 1], s.B, PB);
    F_[k] = s.R;
    add_transposed_product(s.B, PB, F_[k]);
    for (int i = 0; i < kInputs; ++i) F_[k](i, i) += of_u(i);
    if (!factorise_in_place(F_[k])) return false;
    G_[k].setZero();
    add_transposed_product(PB, s.A, G_[k]);
    K_[k] = G_[k];
    solve_in_place(F_[k], K_[k]);
    StateMatrix PA = StateMatrix::Zero();
    add_product(P_[k + 1], s.A, PA);
    P_[k] = s.Q;
    add_transposed_product(s.A, PA, P_[k]);
    // P -= G' K
    for (int j = 0; j < kStates; ++j)
      for (int i = 0; i < kStates; ++i)
        for (int l = 0; l < kInputs; ++l) P_[k](i, j) -= G_[k](l, i) * K_[k](l, j);
    if (k == 0) break;
    diagonal.setZero();
    of_x_[k].condense(x_[k], s.x_low, s.x_high, 0.0, false, diagonal, unused_x);
    for (int i = 0; i < kStates; ++i) P_[k](i, i) += diagonal(i);
  }
  return true;
}

template <int kStates, int kInputs>
void HorizonProgramme<kStates, kInputs>::newton(double centre, bool corrected) {
  const std::size_t n = u_.size();
  State unused_x = State::Zero();
  Input unused_u = Input::Zero();
  State p = stages[n].q;
  add_product(stages[n].Q, x_[n], p);
  of_x_[n].condense(x_[n], stages[n].x_low, stages[n].x_high, centre, corrected, unused_x, p);
  for (std::size_t k = n; k-- > 0;) {
    const Stage& s = stages[k];
    Input g = s.r;
    add_product(s.R, u_[k], g);
    add_transposed_product(s.B, p, g);
    of_u_[k].condense(u_[k], s.u_low, s.u_high, centre, corrected, unused_u, g);
    solve_in_place(F_[k], g);
    for (int i = 0; i < kInputs; ++i) k_[k](i) = -g(i);
    State before = s.q;
    add_product(s.Q, x_[k], before);
    add_transposed_product(s.A, p, before);
    add_transposed_product(G_[k], k_[k], before);
    if (k > 0) of_x_[k].condense(x_[k], s.x_low, s.x_high, centre, corrected, unused_x, before);
    p = before;
  }
  dx_[0].setZero();
  for (std::size_t k = 0; k < n; ++k) {
    const Stage& s = stages[k];
    Input from_state = Input::Zero();
    add_product(K_[k], dx_[k], from_state);
    for (int i = 0; i < kInputs; ++i) du_[k](i) = k_[k](i) - from_state(i);
    dx_[k + 1].setZero();
    add_product(s.A, dx_[k], dx_[k + 1]);
    add_product(s.B, du_[k], dx_[k + 1]);
    of_u_[k].take(du_[k], u_[k], s.u_low, s.u_high, centre, corrected);
    of_x_[k + 1].take(dx_[k + 1], x_[k + 1], stages[k + 1].x_low, stages[k + 1].x_high, centre, corrected);
  }
}

template <int kStates, int kInputs>
double HorizonProgramme<kStates, kInputs>::gradient() const {
  const std::size_t n = u_.size();
  double most = 0.0;
  State nu = stages[n].q;
  add_product(stages[n].Q, x_[n], nu);
  add(-1.0, of_x_[n].lambda, nu);
  add(1.0, of_x_[n].mu, nu);
  for (std::size_t k = n; k-- > 0;) {
    const Stage& s = stages[k];
    Input g = s.r;
    add_product(s.R, u_[k], g);
    add_transposed_product(s.B, nu, g);
    add(-1.0, of_u_[k].lambda, g);
    add(1.0, of_u_[k].mu, g);
    for (int i = 0; i < kInputs; ++i) {
      // A maximum would lose what is no number.
      if (!std::isfinite(g(i))) return kNaN;
      most = std::max(most, std::abs(g(i)));
    }
    if (k == 0) break;
    State before = s.q;
    add_product(s.Q, x_[k], before);
    add_transposed_product(s.A, nu, before);
    add(-1.0, of_x_[k].lambda, before);
    add(1.0, of_x_[k].mu, before);
    nu = before;
  }
  return most;
}

template <int kStates, int kInputs>
double HorizonProgramme<kStates, kInputs>::cost() const {
  double sum = 0.0;
  for (std::size_t k = 0; k < stages.size(); ++k) {
    const Stage& s = stages[k];
    State Qx = State::Zero();
    add_product(s.Q, x_[k], Qx);
    sum += 0.5 * dot(x_[k], Qx) + dot(s.q, x_[k]);
    if (k < u_.size()) {
      Input Ru = Input::Zero();
      add_product(s.R, u_[k], Ru);
      sum += 0.5 * dot(u_[k], Ru) + dot(s.r, u_[k]);
    }
    if (k == 0) continue;
    const auto &lambda = of_x_[k].lambda, &mu = of_x_[k].mu;
    for (int i = 0; i < kStates; ++i) sum += 0.5 * s.x_give(i) * (lambda(i) * lambda(i) + mu(i) * mu(i));
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

namespace {
/// Share of the products that is left after the predictor, from which on it is not corrected; where to go then.
constexpr double kGoesSomewhere = 0.8, kToTheMiddle = 0.5;
}  // namespace

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
    if (ratio < kGoesSomewhere || result.violation > options.tolerance) {
      // Products far below the tolerance would leave nothing but rounding in the next step.
      newton(std::max(ratio * ratio * ratio * mean, 1e-2 * options.tolerance), true);
    } else {
      // The predictor runs into a bound at once: its correction may lead round in circles, so to the middle first.
      newton(kToTheMiddle * mean, false);
    }
    const double length = longest(0.995);
    if (!(length > 1e-10)) {
      result.end = ProgrammeEnd::kInfeasible;
      break;
    }
    for (std::size_t k = 0; k < n; ++k) {
      add(length, du_[k], u_[k]);
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
