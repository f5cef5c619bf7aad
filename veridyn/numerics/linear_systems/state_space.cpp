#include "veridyn/numerics/linear_systems/state_space.hpp"

#include <fmt/format.h>

#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/numerics/linear_algebra/products.hpp"
#include "veridyn/numerics/linear_algebra/real_form.hpp"

namespace veridyn::numerics {
namespace {

Eigen::MatrixXcd response_at(const StateSpace& system, std::complex<double> s) {
  const Eigen::Index n = system.states();
  if (n == 0) return system.D.cast<std::complex<double>>();
  Eigen::MatrixXcd shifted = -system.A.cast<std::complex<double>>();
  shifted.diagonal().array() += s;
  Eigen::MatrixXd real_B = Eigen::MatrixXd::Zero(2 * n, system.inputs());
  real_B.topRows(n) = system.B;
  const Eigen::MatrixXd states = solve_linear(real_form(shifted), real_B);
  Eigen::MatrixXcd response(system.outputs(), system.inputs());
  response.real() = product(system.C, states.topRows(n)) + system.D;
  response.imag() = product(system.C, states.bottomRows(n));
  return response;
}

}  // namespace

Eigen::MatrixXcd StateSpace::response(double omega) const { return response_at(*this, {0.0, omega}); }

Eigen::MatrixXcd StateSpace::response(double omega, double step) const {
  return response_at(*this, std::polar(1.0, omega * step));
}

void StateSpace::validate() const {
  const Eigen::Index n = A.rows();
  if (A.cols() != n || B.rows() != n || C.cols() != n || C.rows() != D.rows() || B.cols() != D.cols())
    throw InputError("state space", fmt::format("sizes do not fit: A {} x {}, B {} x {}, C {} x {}, D {} x {}", n,
                                                A.cols(), B.rows(), B.cols(), C.rows(), C.cols(), D.rows(), D.cols()));
  if (!A.allFinite() || !B.allFinite() || !C.allFinite() || !D.allFinite())
    throw InputError("state space", "has an entry that is not finite");
}

StateSpace realise(TransferFunction t) {
  t.normalise();
  const std::size_t n = t.denominator.size() - 1;
  const double lead = t.denominator.front();
  std::vector<double> a, b(n - (t.numerator.size() - 1), 0.0);
  for (const double c : t.denominator) a.push_back(c / lead);
  for (const double c : t.numerator) b.push_back(c / lead);
  StateSpace s{Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, 1), Eigen::MatrixXd::Zero(1, n),
               Eigen::MatrixXd::Constant(1, 1, b.front())};
  if (n == 0) return s;
  // Of the poles that are not zero.
  std::size_t last = n;
  while (last > 0 && a[last] == 0.0) --last;
  const double scale = last == 0 ? 1.0 : std::pow(std::abs(a[last]), 1.0 / static_cast<double>(last));
  double power = scale;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Index column = signed_index(i);
    s.A(0, column) = -a[i + 1] / power * scale;
    s.C(0, column) = (b[i + 1] - b.front() * a[i + 1]) / power;
    if (i + 1 < n) s.A(column + 1, column) = scale;
    power *= scale;
  }
  s.B(0, 0) = scale;
  return s;
}

StateSpace in_series(const StateSpace& first, const StateSpace& second) {
  if (first.outputs() != second.inputs())
    throw InputError("state space", fmt::format("{} outputs do not fit {} inputs", first.outputs(), second.inputs()));
  const Eigen::Index n = first.states(), m = second.states();
  StateSpace s{Eigen::MatrixXd::Zero(n + m, n + m), Eigen::MatrixXd(n + m, first.inputs()),
               Eigen::MatrixXd(second.outputs(), n + m), product(second.D, first.D)};
  s.A.topLeftCorner(n, n) = first.A;
  s.A.bottomLeftCorner(m, n) = product(second.B, first.C);
  s.A.bottomRightCorner(m, m) = second.A;
  s.B << first.B, product(second.B, first.D);
  s.C << product(second.D, first.C), second.C;
  return s;
}

}  // namespace veridyn::numerics
