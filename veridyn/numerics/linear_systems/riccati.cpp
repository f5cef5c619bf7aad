#include "veridyn/numerics/linear_systems/riccati.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/numerics/linear_algebra/general_eigen.hpp"
#include "veridyn/numerics/linear_systems/lyapunov.hpp"

namespace veridyn::numerics {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr const char* kNoLoop = "no control makes the loop stable, or a mode on its border costs nothing";
constexpr int kNewtonSteps = 3;

MatrixXd symmetric(const MatrixXd& m) { return 0.5 * (m + m.transpose()); }

/// A problem whose sizes were checked, N of full size.
struct Problem {
  MatrixXd A, B, Q, R, N;
  Eigen::LLT<MatrixXd> R_factor;

  Problem(const MatrixXd& a, const MatrixXd& b, const MatrixXd& q, const MatrixXd& r, const MatrixXd& n)
      : A(a), B(b), Q(symmetric(q)), R(symmetric(r)), N(n.size() == 0 ? MatrixXd::Zero(b.rows(), b.cols()) : n) {
    const Index states = A.rows(), inputs = B.cols();
    if (A.cols() != states || B.rows() != states || Q.rows() != states || Q.cols() != states || R.rows() != inputs ||
        R.cols() != inputs || N.rows() != states || N.cols() != inputs)
      throw InputError(
          "linear-quadratic problem",
          fmt::format("sizes do not fit: A {} x {}, B {} x {}, Q {} x {}, R {} x {}, N {} x {}", states, A.cols(),
                      B.rows(), inputs, Q.rows(), Q.cols(), R.rows(), R.cols(), N.rows(), N.cols()));
    if (!A.allFinite() || !B.allFinite() || !Q.allFinite() || !R.allFinite() || !N.allFinite())
      throw InputError("linear-quadratic problem", "has an entry that is not finite");
    R_factor.compute(R);
    if (R_factor.info() != Eigen::Success)
      throw InputError("linear-quadratic problem", "R is not positive definite: some control would cost nothing");
  }

  /// Of the problem without N: u = v - R^-1 N' x.
  [[nodiscard]] MatrixXd drift() const { return A - B * R_factor.solve(N.transpose()); }
  [[nodiscard]] MatrixXd weight() const { return symmetric(Q - N * R_factor.solve(N.transpose())); }
  [[nodiscard]] MatrixXd authority() const { return symmetric(B * R_factor.solve(B.transpose())); }
  /// x' W x, what the states cost under u = -K x.
  [[nodiscard]] MatrixXd cost_of(const MatrixXd& K) const {
    const MatrixXd NK = N * K;
    return symmetric(Q + K.transpose() * R * K - NK - NK.transpose());
  }
};

/// sign(H) by Newton's iteration, scaled by the determinant. Empty where it does not converge: an eigenvalue on the
/// imaginary axis has no sign.
MatrixXd matrix_sign(MatrixXd H) {
  constexpr int kMost = 60;
  const auto n = static_cast<double>(H.rows());
  for (int i = 0; i < kMost; ++i) {
    const Eigen::PartialPivLU<MatrixXd> lu(H);
    const double size = lu.matrixLU().diagonal().array().abs().log().sum() / n;
    if (!std::isfinite(size)) return {};
    const double scale = std::exp(-size);
    const MatrixXd next = 0.5 * (scale * H + lu.inverse() / scale);
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
  s.P = symmetric(left.colPivHouseholderQr().solve(right));
  const auto gain = [&] { return MatrixXd(p.R_factor.solve(p.B.transpose() * s.P + p.N.transpose())); };
  s.K = gain();
  const auto check = [&] {
    s.slowest = largest_real_part(p.A - p.B * s.K);
    if (!(s.slowest < 0.0)) throw InputError("linear-quadratic problem", kNoLoop);
  };
  check();
  for (int i = 0; i < kNewtonSteps; ++i) {
    s.P = lyapunov((p.A - p.B * s.K).transpose(), p.cost_of(s.K)).X;
    s.K = gain();
  }
  check();
  const MatrixXd PA = s.P * p.A, KRK = s.K.transpose() * p.R * s.K;
  s.residual = (PA + PA.transpose() - KRK + p.Q).norm() / std::max({PA.norm(), KRK.norm(), p.Q.norm()});
  return s;
}

LinearQuadratic discrete_linear_quadratic(const MatrixXd& A, const MatrixXd& B, const MatrixXd& Q, const MatrixXd& R,
                                          const MatrixXd& N) {
  const Problem p(A, B, Q, R, N);
  const Index n = A.rows();
  MatrixXd F = p.drift(), G = p.authority(), H = p.weight();
  constexpr int kMost = 60;
  for (int i = 0; i < kMost; ++i) {
    const Eigen::PartialPivLU<MatrixXd> lu(MatrixXd::Identity(n, n) + G * H);
    const MatrixXd F_next = F * lu.solve(F);
    const MatrixXd change = F.transpose() * H * lu.solve(F);
    G = symmetric(G + F * lu.solve(G) * F.transpose());
    H = symmetric(H + change);
    F = F_next;
    if (!H.allFinite()) throw InputError("linear-quadratic problem", kNoLoop);
    if (change.norm() <= 1e-14 * H.norm()) break;
  }
  LinearQuadratic s;
  s.P = H;
  const auto gain = [&] {
    return MatrixXd((p.R + p.B.transpose() * s.P * p.B).llt().solve(p.B.transpose() * s.P * p.A + p.N.transpose()));
  };
  s.K = gain();
  const auto check = [&] {
    s.slowest = largest_modulus(p.A - p.B * s.K);
    if (!(s.slowest < 1.0)) throw InputError("linear-quadratic problem", kNoLoop);
  };
  check();
  for (int i = 0; i < kNewtonSteps; ++i) {
    s.P = discrete_lyapunov((p.A - p.B * s.K).transpose(), p.cost_of(s.K)).X;
    s.K = gain();
  }
  check();
  const MatrixXd APA = p.A.transpose() * s.P * p.A;
  const MatrixXd KSK = s.K.transpose() * (p.R + p.B.transpose() * s.P * p.B) * s.K;
  s.residual = (APA - KSK + p.Q - s.P).norm() / std::max({APA.norm(), KSK.norm(), p.Q.norm(), s.P.norm()});
  return s;
}

}  // namespace veridyn::numerics
