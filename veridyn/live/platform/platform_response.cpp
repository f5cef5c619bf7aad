#include "veridyn/live/platform/platform_response.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/linear_systems/causal_filter.hpp"

namespace veridyn::live {
namespace {

/// Logarithms keep omega and zeta above zero.
struct Unknowns {
  double gain = 1.0, log_omega = std::log(30.0), log_zeta = 0.0, delay = 0.02;
  [[nodiscard]] Eigen::Vector4d vector() const { return {gain, log_omega, log_zeta, delay}; }
  static Unknowns of(const Eigen::Vector4d& v) { return {v(0), v(1), v(2), v(3)}; }
};

Eigen::VectorXd simulated(const ToldAndReached& m, const Unknowns& u) {
  const double omega = std::exp(u.log_omega), zeta = std::exp(u.log_zeta);
  numerics::CausalFilter filter(numerics::TransferFunction{{omega * omega}, {1.0, 2.0 * zeta * omega, omega * omega}});
  filter.reset(m.ordered.front());
  const double behind = std::max(u.delay, 0.0) / m.step;
  const auto whole = static_cast<std::ptrdiff_t>(behind);
  const double part = behind - static_cast<double>(whole);
  const auto ordered = [&](std::ptrdiff_t k) { return m.ordered[std::max<std::ptrdiff_t>(k, 0)]; };
  Eigen::VectorXd y(m.ordered.size());
  for (Eigen::Index k = 0; k < y.size(); ++k)
    y(k) = u.gain * filter.step((1.0 - part) * ordered(k - whole) + part * ordered(k - whole - 1), m.step);
  return y;
}

double sum_of_squares(const Eigen::VectorXd& y, const Unknowns& u, const ToldAndReached& m) {
  return (y - simulated(m, u)).squaredNorm();
}

/// The nearest of some starts: delay and lag trade for each other, and a bad start ends far off.
Unknowns best_start(const ToldAndReached& m, const Eigen::VectorXd& y) {
  Unknowns best;
  double least = kInfinity;
  for (const double omega : {6.0, 15.0, 40.0, 100.0}) {
    for (const double delay : {0.005, 0.03, 0.1}) {
      Unknowns u{.gain = 1.0, .log_omega = std::log(omega), .log_zeta = std::log(0.8), .delay = delay};
      const Eigen::VectorXd s = simulated(m, u);
      u.gain = s.dot(y) / s.squaredNorm();
      const double cost = sum_of_squares(y, u, m);
      if (cost < least) {
        least = cost;
        best = u;
      }
    }
  }
  return best;
}

/// Of the simulated motion by each unknown, by differences.
Eigen::MatrixXd derivatives(const ToldAndReached& m, const Unknowns& u) {
  Eigen::MatrixXd J(m.ordered.size(), 4);
  const Eigen::Vector4d steps(1e-4, 1e-4, 1e-4, 1e-2 * m.step);
  for (int i = 0; i < 4; ++i) {
    Eigen::Vector4d up = u.vector(), down = up;
    up(i) += steps(i);
    down(i) -= steps(i);
    J.col(i) = (simulated(m, Unknowns::of(up)) - simulated(m, Unknowns::of(down))) / (2.0 * steps(i));
  }
  return J;
}

/// The unknowns with the least sum of squares, by damped Gauss-Newton steps within what an actuator can be.
Unknowns fitted(const ToldAndReached& m, const Eigen::VectorXd& y) {
  Unknowns u = best_start(m, y);
  double cost = sum_of_squares(y, u, m), damping = 1e-3;
  constexpr int kMaxIterations = 100;
  for (int iteration = 0; iteration < kMaxIterations && damping < 1e10; ++iteration) {
    const Eigen::MatrixXd J = derivatives(m, u);
    const Eigen::VectorXd r = y - simulated(m, u);
    const Eigen::Matrix4d H = J.transpose() * J;
    const Eigen::Vector4d g = J.transpose() * r;
    bool better = false;
    while (!better && damping < 1e10) {
      Eigen::Matrix4d D = H;
      D.diagonal() *= 1.0 + damping;
      Unknowns next = Unknowns::of(u.vector() + D.ldlt().solve(g));
      next.delay = std::max(next.delay, 0.0);
      next.log_omega = std::clamp(next.log_omega, std::log(0.3), std::log(1e3));
      next.log_zeta = std::clamp(next.log_zeta, std::log(0.05), std::log(20.0));
      const double then = sum_of_squares(y, next, m);
      better = then < cost;
      if (better) {
        const bool done = cost - then < 1e-10 * cost;
        u = next;
        cost = then;
        damping = std::max(damping / 10.0, 1e-9);
        if (done) iteration = kMaxIterations;
      } else {
        damping *= 10.0;
      }
    }
  }
  return u;
}

}  // namespace

PlatformResponse fit_response(const ToldAndReached& m) {
  constexpr std::size_t kFewest = 200;
  if (m.ordered.size() < kFewest || m.ordered.size() != m.reached.size())
    throw InputError("platform response", fmt::format("{} answers; takes {} at least", m.reached.size(), kFewest));
  const Eigen::Map<const Eigen::VectorXd> reached(m.reached.data(), m.reached.size()),
      ordered(m.ordered.data(), reached.size());
  if (!reached.allFinite() || !ordered.allFinite()) throw InputError("platform response", "a position is not finite");
  const Eigen::VectorXd y = reached.array() - reached.mean();
  ToldAndReached centred = m;
  const double mean_ordered = ordered.mean();
  for (double& v : centred.ordered) v -= mean_ordered;
  const double moved = std::sqrt(y.squaredNorm() / static_cast<double>(y.size()));
  const double asked = std::sqrt((ordered.array() - mean_ordered).square().mean());
  constexpr double kStands = 1e-6;
  if (!(asked > kStands)) throw InputError("platform response", "the platform had no order");
  if (!(moved > 0.01 * asked)) throw InputError("platform response", "the platform does not move");

  const Unknowns u = fitted(centred, y);
  const Eigen::MatrixXd J = derivatives(centred, u);
  const Eigen::VectorXd r = y - simulated(centred, u);
  const double n = static_cast<double>(r.size());
  PlatformResponse p;
  p.correlation = r.head(r.size() - 1).dot(r.tail(r.size() - 1)) / std::max(r.squaredNorm(), 1e-300);
  p.rms = std::sqrt(r.squaredNorm() / n) / moved;
  // What is left is correlated: as many independent samples fewer as its first-lag correlation says.
  const double widen =
      std::sqrt((1.0 + std::clamp(p.correlation, 0.0, 0.999)) / (1.0 - std::clamp(p.correlation, 0.0, 0.999)));
  const Eigen::Matrix4d covariance =
      (J.transpose() * J).ldlt().solve(Eigen::Matrix4d::Identity()) * r.squaredNorm() / (n - 4.0);
  const Eigen::Vector4d sigma = widen * covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  p.gain = {u.gain, sigma(0)};
  p.omega = {std::exp(u.log_omega), std::exp(u.log_omega) * sigma(1)};
  p.zeta = {std::exp(u.log_zeta), std::exp(u.log_zeta) * sigma(2)};
  p.delay = {u.delay, sigma(3)};
  constexpr double kFast = 500.0;
  p.at_once = p.omega.value > kFast;
  if (p.gain.value < 0.0) p.notes.push_back("it moves the other way: the axis has the wrong sign");
  if (p.rms > 0.1)
    p.notes.push_back(fmt::format(
        "{:.0f} % of the motion is not explained: friction, play, or an order that was held back", 100.0 * p.rms));
  if (std::abs(p.gain.value - 1.0) > 0.05)
    p.notes.push_back(fmt::format("it reaches {:.0f} % of what is commanded", 100.0 * p.gain.value));
  return p;
}

}  // namespace veridyn::live
