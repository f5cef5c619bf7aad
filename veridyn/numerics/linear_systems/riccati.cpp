#include "veridyn/numerics/linear_systems/riccati.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/numerics/linear_algebra/general_eigen.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/numerics/linear_algebra/products.hpp"
#include "veridyn/numerics/linear_systems/lyapunov.hpp"

namespace veridyn::numerics {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr const char* kNoLoop = "no control makes the loop stable, or a mode on its border costs nothing";
constexpr int kNewtonSteps = 3;

MatrixXd symmetric(const MatrixXd& m) { return 0.5 * (m + m.transpose()); }

/// L L' of the problem's R, once the sizes were checked.
Cholesky checked_weight(const MatrixXd& A, const MatrixXd& B, const MatrixXd& Q, const MatrixXd& R, const MatrixXd& N) {
  const Index states = A.rows(), inputs = B.cols();
  if (A.cols() != states || B.rows() != states || Q.rows() != states || Q.cols() != states || R.rows() != inputs ||
      R.cols() != inputs || N.rows() != states || N.cols() != inputs)
    throw InputError(
        "linear-quadratic problem",
        fmt::format("sizes do not fit: A {} x {}, B {} x {}, Q {} x {}, R {} x {}, N {} x {}", states, A.cols(),
                    B.rows(), inputs, Q.rows(), Q.cols(), R.rows(), R.cols(), N.rows(), N.cols()));
  if (!A.allFinite() || !B.allFinite() || !Q.allFinite() || !R.allFinite() || !N.allFinite())
    throw InputError("linear-quadratic problem", "has an entry that is not finite");
  Cholesky factor(symmetric(R));
  if (!factor.positive_definite())
    throw InputError("linear-quadratic problem", "R is not positive definite: some control would cost nothing");
  return factor;
}

/// A problem whose sizes were checked, N of full size.
struct Problem {
  MatrixXd A, B, N;
  Cholesky R_factor;
  MatrixXd Q, R;

  Problem(const MatrixXd& a, const MatrixXd& b, const MatrixXd& q, const MatrixXd& r, const MatrixXd& n)
      : A(a),
        B(b),
        N(n.size() == 0 ? MatrixXd::Zero(b.rows(), b.cols()) : n),
        R_factor(checked_weight(a, b, q, r, N)),
        Q(symmetric(q)),
        R(symmetric(r)) {}

  /// Of the problem without N: u = v - R^-1 N' x.
  [[nodiscard]] MatrixXd drift() const { return A - product(B, R_factor.solve(MatrixXd(N.transpose()))); }
  [[nodiscard]] MatrixXd weight() const { return symmetric(Q - product(N, R_factor.solve(MatrixXd(N.transpose())))); }
  [[nodiscard]] MatrixXd authority() const { return symmetric(product(B, R_factor.solve(MatrixXd(B.transpose())))); }
  /// A - B K
  [[nodiscard]] MatrixXd closed(const MatrixXd& K) const { return A - product(B, K); }
  /// x' W x, what the states cost under u = -K x.
  [[nodiscard]] MatrixXd cost_of(const MatrixXd& K) const {
    const MatrixXd NK = product(N, K);
    return symmetric(Q + transposed_product(K, product(R, K)) - NK - NK.transpose());
  }
};

/// sign(H) by Newton's iteration, scaled so that H and its inverse are of one size. Empty where it does not converge:
/// an eigenvalue on the imaginary axis has no sign.
MatrixXd matrix_sign(MatrixXd H) {
  constexpr int kMaxIterations = 60;
  const auto n = static_cast<double>(H.rows());
  const MatrixXd identity = MatrixXd::Identity(H.rows(), H.cols());
  for (int i = 0; i < kMaxIterations; ++i) {
    const MatrixXd inverse = solve_linear(H, identity);
    const double scale = std::sqrt(inverse.norm() / H.norm());
    if (!std::isfinite(scale) || !(scale > 0.0)) return {};
    const MatrixXd next = 0.5 * (scale * H + inverse / scale);
    const double change = (next - H).norm();
    H = next;
    if (!H.allFinite()) return {};
    if (change <= 1e-13 * n * H.norm()) return H;
  }
  return {};
}

double largest_real_part(const MatrixXd& A) { return general_eigenvalues(A).real().maxCoeff(); }
double largest_modulus(const MatrixXd& A) { return general_eigenvalues(A).cwiseAbs().maxCoeff(); }

}  // namespace

LinearQuadratic linear_quadratic(const MatrixXd& A, const MatrixXd& B, const MatrixXd& Q, const MatrixXd& R,
                                 const MatrixXd& N) {
  const Problem p(A, B, Q, R, N);
  const Index n = A.rows();
  MatrixXd hamiltonian(2 * n, 2 * n);
  hamiltonian << p.drift(), -p.authority(), -p.weight(), -p.drift().transpose();
  const MatrixXd sign = matrix_sign(hamiltonian);
  if (sign.size() == 0) throw InputError("linear-quadratic problem", kNoLoop);
  // (sign + 1) vanishes on the stable subspace [1; P].
  MatrixXd left = sign.rightCols(n), right = -sign.leftCols(n);
  left.bottomRows(n).diagonal().array() += 1.0;
  right.topRows(n).diagonal().array() -= 1.0;
  LinearQuadratic s;
  s.P = symmetric(shortest_least_squares(left, right));
  const auto gain = [&] { return p.R_factor.solve(MatrixXd(transposed_product(p.B, s.P) + p.N.transpose())); };
  s.K = gain();
  const auto check = [&] {
    s.slowest = largest_real_part(p.closed(s.K));
    if (!(s.slowest < 0.0)) throw InputError("linear-quadratic problem", kNoLoop);
  };
  check();
  for (int i = 0; i < kNewtonSteps; ++i) {
    s.P = lyapunov(p.closed(s.K).transpose(), p.cost_of(s.K)).X;
    s.K = gain();
  }
  check();
  const MatrixXd PA = product(s.P, p.A), KRK = transposed_product(s.K, product(p.R, s.K));
  s.residual = (PA + PA.transpose() - KRK + p.Q).norm() / std::max({PA.norm(), KRK.norm(), p.Q.norm()});
  return s;
}

LinearQuadratic discrete_linear_quadratic(const MatrixXd& A, const MatrixXd& B, const MatrixXd& Q, const MatrixXd& R,
                                          const MatrixXd& N) {
  const Problem p(A, B, Q, R, N);
  const Index n = A.rows();
  MatrixXd F = p.drift(), G = p.authority(), H = p.weight();
  constexpr int kMaxIterations = 60;
  for (int i = 0; i < kMaxIterations; ++i) {
    MatrixXd both(n, 2 * n);
    both << F, G;
    both = solve_linear(MatrixXd::Identity(n, n) + product(G, H), both);
    const MatrixXd F_next = product(F, both.leftCols(n));
    const MatrixXd change = transposed_product(F, product(H, both.leftCols(n)));
    G = symmetric(G + product_transposed(product(F, both.rightCols(n)), F));
    H = symmetric(H + change);
    F = F_next;
    if (!H.allFinite()) throw InputError("linear-quadratic problem", kNoLoop);
    if (change.norm() <= 1e-14 * H.norm()) break;
  }
  LinearQuadratic s;
  s.P = H;
  const auto gain = [&] {
    const MatrixXd BP = transposed_product(p.B, s.P);
    return Cholesky(p.R + product(BP, p.B)).solve(MatrixXd(product(BP, p.A) + p.N.transpose()));
  };
  s.K = gain();
  const auto check = [&] {
    s.slowest = largest_modulus(p.closed(s.K));
    if (!(s.slowest < 1.0)) throw InputError("linear-quadratic problem", kNoLoop);
  };
  check();
  for (int i = 0; i < kNewtonSteps; ++i) {
    s.P = discrete_lyapunov(p.closed(s.K).transpose(), p.cost_of(s.K)).X;
    s.K = gain();
  }
  check();
  const MatrixXd APA = transposed_product(p.A, product(s.P, p.A));
  const MatrixXd S = p.R + transposed_product(p.B, product(s.P, p.B));
  const MatrixXd KSK = transposed_product(s.K, product(S, s.K));
  s.residual = (APA - KSK + p.Q - s.P).norm() / std::max({APA.norm(), KSK.norm(), p.Q.norm(), s.P.norm()});
  return s;
}

}  // namespace veridyn::numerics
