#include "veridyn/estimation/kalman/kalman_filter.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <atomic>
#include <cmath>
#include <vector>

#include "veridyn/estimation/kalman/smoother.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/numerics/linear_algebra/products.hpp"
#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::estimation {
namespace {

using numerics::RandomStream;

// A damped oscillator pushed by a random-walk force: three dynamic states, two random walks, all driven by noise so
// that the batch problem below has an invertible process covariance.
struct Oscillator {
  static constexpr int kStates = 5;
  static constexpr int kDynamic = 3;
  template <typename Scalar>
  struct State {
    Eigen::Matrix<Scalar, 5, 1> x = Eigen::Matrix<Scalar, 5, 1>::Zero();
  };
  struct Input {
    double push = 0.0;
  };
  [[nodiscard]] static Eigen::Matrix<double, 5, 5> F(double dt) {
    Eigen::Matrix<double, 5, 5> A = Eigen::Matrix<double, 5, 5>::Zero();
    A.row(0) << 0, 1, 0, 0, 0;
    A.row(1) << -4, -0.3, 0.5, 1, 0;
    A.row(2) << 0.1, 0, -0.7, 0, 0.4;
    return Eigen::Matrix<double, 5, 5>::Identity() + A * dt + A * A * (dt * dt / 2);
  }
  [[nodiscard]] static Eigen::Matrix<double, 5, 5> Q(double dt) {
    Eigen::Matrix<double, 5, 5> q = Eigen::Matrix<double, 5, 5>::Zero();
    q.diagonal() << 0.02, 0.3, 0.2, 0.05, 0.01;
    q(0, 1) = q(1, 0) = 0.03;
    return q * dt;
  }
  template <typename S>
  [[nodiscard]] State<S> propagate(const State<S>& s, const Input& u, double dt) const {
    State<S> next;
    next.x = F(dt).cast<S>() * s.x;
    next.x(1) += S(u.push * dt);
    return next;
  }
  template <typename S>
  [[nodiscard]] static State<S> retract(const State<double>& s, const Eigen::Matrix<S, 5, 1>& d) {
    State<S> r;
    r.x = s.x.cast<S>() + d;
    return r;
  }
  template <typename S>
  [[nodiscard]] static Eigen::Matrix<S, 5, 1> local(const State<double>& from, const State<S>& to) {
    return to.x - from.x.cast<S>();
  }
  void add_process_noise(const State<double>&, const Input&, double dt, Eigen::Matrix<double, 5, 5>& P) const {
    P += Q(dt);
  }
};

struct Measurement {
  std::size_t step;
  Eigen::Matrix<double, 5, 1> H;
  double r, z;
};

struct Problem {
  std::vector<double> dt;
  std::vector<double> push;
  std::vector<Measurement> measurements;  // at states 0..dt.size()
  Eigen::Matrix<double, 5, 1> x0;
  Eigen::Matrix<double, 5, 5> P0;
};

Problem make_problem(std::uint64_t seed) {
  RandomStream random(seed, "oscillator");
  Problem p;
  p.x0 << 0.5, -0.2, 0.1, 0.3, 0.0;
  p.P0 = Eigen::Matrix<double, 5, 5>::Identity() * 0.8;
  p.P0(0, 3) = p.P0(3, 0) = 0.2;
  for (std::size_t k = 0; k < 40; ++k) {
    p.dt.push_back(random.uniform(0.02, 0.3));
    p.push.push_back(random.normal());
  }
  for (std::size_t k = 0; k <= p.dt.size(); ++k) {
    const auto sensors = random.index(4);  // 0 to 3 measurements at a time
    for (std::uint64_t s = 0; s < sensors; ++s) {
      Measurement m{k, {}, random.uniform(0.01, 0.5), 2.0 * random.normal()};
      for (int i = 0; i < 5; ++i)
        m.H(i) = random.uniform(0.0, 1.0) < 0.5 ? 0.0 : random.normal();  // a sensor reads few states
      p.measurements.push_back(m);
    }
  }
  return p;
}

// The run of the filter over the problem, as `smooth_in_blocks` wants it.
struct Replay {
  const Problem* problem;
  ExtendedKalmanFilter<Oscillator> filter;
  InnovationMonitor monitor{InnovationGate{.threshold = 1e9}};
  std::size_t next = 0;
  std::size_t next_measurement = 0;

  bool advance(SmootherTape<Oscillator>* tape) {
    if (next > problem->dt.size()) return false;
    if (next > 0) filter.propagate({}, {problem->push[next - 1]}, problem->dt[next - 1], tape);
    while (next_measurement < problem->measurements.size() && problem->measurements[next_measurement].step == next) {
      const auto& m = problem->measurements[next_measurement++];
      filter.update(static_cast<double>(next), m.z - m.H.dot(filter.state().x), m.H, m.r, monitor, tape);
    }
    filter.mark(next, tape);
    ++next;
    return true;
  }
};

Replay start(const Problem& p) {
  Oscillator::State<double> x;
  x.x = p.x0;
  return {.problem = &p, .filter = {x, p.P0}};
}

// Maximum a posteriori of the whole trajectory: one least-squares problem in all states, by QR.
struct Batch {
  Eigen::VectorXd x;
  Eigen::MatrixXd P;
};
Batch batch(const Problem& p, std::size_t last) {
  const auto n = static_cast<Eigen::Index>(5 * (last + 1));
  std::vector<const Measurement*> used;
  for (const auto& m : p.measurements)
    if (m.step <= last) used.push_back(&m);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n + static_cast<Eigen::Index>(used.size()), n);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(A.rows());
  using M5 = Eigen::Matrix<double, 5, 5>;
  const auto whitener = [](const M5& C) -> M5 { return numerics::Cholesky(C).solve_lower(M5::Identity()); };
  const M5 W0 = whitener(p.P0);
  A.topLeftCorner<5, 5>() = W0;
  b.head<5>() = W0 * p.x0;
  for (std::size_t k = 0; k < last; ++k) {
    const M5 W = whitener(Oscillator::Q(p.dt[k]));
    const auto row = static_cast<Eigen::Index>(5 * (k + 1));
    A.block<5, 5>(row, row) = W;
    A.block<5, 5>(row, row - 5) = -W * Oscillator::F(p.dt[k]);
    Eigen::Matrix<double, 5, 1> input = Eigen::Matrix<double, 5, 1>::Zero();
    input(1) = p.push[k] * p.dt[k];
    b.segment<5>(row) = W * input;
  }
  for (std::size_t i = 0; i < used.size(); ++i) {
    const auto row = n + static_cast<Eigen::Index>(i);
    A.block<1, 5>(row, static_cast<Eigen::Index>(5 * used[i]->step)) = used[i]->H.transpose() / std::sqrt(used[i]->r);
    b(row) = used[i]->z / std::sqrt(used[i]->r);
  }
  const numerics::HouseholderQr qr(A);
  const Eigen::MatrixXd inverse = numerics::solve_upper(qr.R(), Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n)));
  return {qr.solve(b), numerics::product_transposed(inverse, inverse)};
}

TEST(KalmanFilter, EqualsTheBatchSolutionOfAllDataSoFar) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Problem p = make_problem(seed);
    Replay run = start(p);
    for (std::size_t k = 0; k <= p.dt.size(); ++k) {
      ASSERT_TRUE(run.advance(nullptr));
      if (k % 13 != 0 && k != p.dt.size()) continue;
      const Batch all = batch(p, k);
      const auto at = static_cast<Eigen::Index>(5 * k);
      EXPECT_LT((all.x.segment<5>(at) - run.filter.state().x).cwiseAbs().maxCoeff(), 1e-10) << "seed " << seed;
      EXPECT_LT((all.P.block<5, 5>(at, at) - run.filter.covariance()).cwiseAbs().maxCoeff(), 1e-10);
    }
    EXPECT_FALSE(run.advance(nullptr));
  }
}

TEST(Smoother, EqualsTheBatchSolutionOfAllData) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Problem p = make_problem(seed);
    const Batch all = batch(p, p.dt.size());
    std::atomic<std::size_t> emitted = 0;
    smooth_in_blocks<Oscillator>(
        start(p), 7, 2, [](const Replay&) { return true; },
        [&](std::size_t k, const Oscillator::State<double>& x, const Eigen::Matrix<double, 5, 5>& P) {
          const auto at = static_cast<Eigen::Index>(5 * k);
          EXPECT_LT((all.x.segment<5>(at) - x.x).cwiseAbs().maxCoeff(), 1e-10) << "seed " << seed << " step " << k;
          EXPECT_LT((all.P.block<5, 5>(at, at) - P).cwiseAbs().maxCoeff(), 1e-10);
          ++emitted;
        });
    EXPECT_EQ(emitted, p.dt.size() + 1);
  }
}

// The classical recursion, written from Rauch, Tung & Striebel (1965) with the system of equations that ours avoids.
TEST(Smoother, EqualsRauchTungStriebel) {
  using M5 = Eigen::Matrix<double, 5, 5>;
  using V5 = Eigen::Matrix<double, 5, 1>;
  const Problem p = make_problem(11);
  std::vector<V5> x(p.dt.size() + 1);
  std::vector<M5> P(p.dt.size() + 1);
  Replay run = start(p);
  for (std::size_t k = 0; run.advance(nullptr); ++k) {
    x[k] = run.filter.state().x;
    P[k] = run.filter.covariance();
  }
  std::vector<V5> xs = x;
  std::vector<M5> Ps = P;
  for (std::size_t k = p.dt.size(); k-- > 0;) {
    const M5 F = Oscillator::F(p.dt[k]);
    const M5 Pp = F * P[k] * F.transpose() + Oscillator::Q(p.dt[k]);
    V5 xp = F * x[k];
    xp(1) += p.push[k] * p.dt[k];
    // C = P F' Pp^-1
    const M5 C = numerics::solve_symmetric(Pp, Eigen::MatrixXd(F * P[k])).transpose();
    xs[k] = x[k] + C * (xs[k + 1] - xp);
    Ps[k] = P[k] + C * (Ps[k + 1] - Pp) * C.transpose();
  }
  smooth_in_blocks<Oscillator>(
      start(p), 1000, 2, [](const Replay&) { return true; },
      [&](std::size_t k, const Oscillator::State<double>& s, const M5& S) {
        EXPECT_LT((xs[k] - s.x).cwiseAbs().maxCoeff(), 1e-10);
        EXPECT_LT((Ps[k] - S).cwiseAbs().maxCoeff(), 1e-10);
      });
}

TEST(Smoother, IsTheSameForAnyLengthOfBlockAndNumberOfThreads) {
  const Problem p = make_problem(4);
  std::vector<Eigen::Matrix<double, 5, 1>> one(p.dt.size() + 1), many(p.dt.size() + 1);
  const auto into = [](auto& where) {
    return [&where](std::size_t k, const Oscillator::State<double>& s, const auto&) { where[k] = s.x; };
  };
  const auto on = [](const Replay&) { return true; };
  smooth_in_blocks<Oscillator>(start(p), 1, 1, on, into(one));
  for (const int threads : {1, 2}) {
    for (const std::size_t block : {1U, 7U, 41U}) {
      smooth_in_blocks<Oscillator>(start(p), block, threads, on, into(many));
      for (std::size_t k = 0; k < one.size(); ++k)
        EXPECT_EQ(one[k], many[k]) << "step " << k << " of blocks of " << block << " on " << threads;
    }
  }
}

TEST(Smoother, SmoothsWhatWasDoneWhenTheForwardPassIsStopped) {
  const Problem p = make_problem(4);
  std::atomic<std::size_t> marks = 0;
  const Replay end = smooth_in_blocks<Oscillator>(
      start(p), 4, 2, [](const Replay& run) { return run.next < 10; },
      [&](std::size_t, const Oscillator::State<double>&, const auto&) { ++marks; });
  EXPECT_EQ(end.next, 10U);
  EXPECT_EQ(marks, 10U);
}

// Joseph's form keeps P symmetric and positive where a precise sensor meets a nearly unknown state: variances 1e12
// apart.
TEST(KalmanFilter, StaysPositiveWhenAPreciseSensorMeetsAnUnknownState) {
  Oscillator::State<double> x;
  ExtendedKalmanFilter<Oscillator> filter(x, Eigen::Matrix<double, 5, 5>::Identity() * 1e6);
  InnovationMonitor monitor(InnovationGate{.threshold = 1e9});
  RandomStream random(3, "ill");
  for (int i = 0; i < 200; ++i) {
    Eigen::Matrix<double, 5, 1> H;
    for (int j = 0; j < 5; ++j) H(j) = 1.0 + 1e-2 * random.normal();
    filter.update(i, 0.0, H, 1e-6, monitor);
  }
  const auto& P = filter.covariance();
  EXPECT_EQ(P, P.transpose());
  const Eigen::VectorXd values = numerics::symmetric_eigenvalues(P);
  EXPECT_GT(values.minCoeff(), 0.0) << values.transpose();
}

}  // namespace
}  // namespace veridyn::estimation
