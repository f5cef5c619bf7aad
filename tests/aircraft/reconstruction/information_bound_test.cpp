#include "veridyn/aircraft/reconstruction/information_bound.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/kalman/kalman_filter.hpp"
#include "veridyn/estimation/kalman/smoother.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::aircraft {
namespace {

const DrydenSettings kModerate{200.0, 200.0, 50.0, 2.12, 2.12, 1.4};
const DrydenSettings kLight{200.0, 200.0, 50.0, 1.06, 1.06, 0.7};

// Section 5 of the specification, printed with two decimals; vanes of 2 sigma = 1.2 deg at 100 Hz.
TEST(InformationBound, ReproducesTheSpecificationsValues) {
  struct Printed {
    DrydenSettings spectrum;
    double speed, alpha_filter, alpha_smoother, beta_filter, beta_smoother;
  };
  for (const Printed& p :
       {Printed{kModerate, 15.0, 0.45, 0.37, 0.41, 0.33}, Printed{kModerate, 25.0, 0.41, 0.34, 0.37, 0.29},
        Printed{kLight, 15.0, 0.35, 0.27, 0.31, 0.24}}) {
    const auto b = information_bound(p.spectrum, p.speed, 0.6 * kDegree, 100.0);
    // Half of the last printed digit. One value rounds otherwise: alpha, smoother, 25 m/s is 0.3347, printed 0.34.
    EXPECT_NEAR(b.alpha.filter / kDegree, p.alpha_filter, 0.0055);
    EXPECT_NEAR(b.alpha.smoother / kDegree, p.alpha_smoother, 0.0055);
    EXPECT_NEAR(b.beta.filter / kDegree, p.beta_filter, 0.0055);
    EXPECT_NEAR(b.beta.smoother / kDegree, p.beta_smoother, 0.0055);
  }
}

TEST(InformationBound, GrowsWithNoiseAndTurbulenceAndShrinksWithRate) {
  const auto b = information_bound(kModerate, 20.0, 0.6 * kDegree, 100.0);
  EXPECT_GT(information_bound(kModerate, 20.0, 0.7 * kDegree, 100.0).alpha.filter, b.alpha.filter);
  EXPECT_LT(information_bound(kLight, 20.0, 0.6 * kDegree, 100.0).beta.smoother, b.beta.smoother);
  EXPECT_LT(information_bound(kModerate, 20.0, 0.6 * kDegree, 200.0).alpha.smoother, b.alpha.smoother);
  EXPECT_LT(b.alpha.smoother, b.alpha.filter);
  EXPECT_LT(b.alpha.filter, 0.6 * kDegree);
}

// The gust alone: two states and the vane.
struct Gust {
  static constexpr int kStates = 2;
  static constexpr int kDynamic = 2;
  template <typename S>
  struct State {
    Eigen::Matrix<S, 2, 1> x = Eigen::Matrix<S, 2, 1>::Zero();
  };
  struct Input {};
  Eigen::Matrix2d F, Q;
  template <typename S>
  [[nodiscard]] State<S> propagate(const State<S>& s, const Input&, double) const {
    return {F.cast<S>() * s.x};
  }
  template <typename S>
  [[nodiscard]] static State<S> retract(const State<double>& s, const Eigen::Matrix<S, 2, 1>& e) {
    return {s.x.template cast<S>() + e};
  }
  template <typename S>
  [[nodiscard]] static Eigen::Matrix<S, 2, 1> local(const State<double>& from, const State<S>& to) {
    return to.x - from.x.template cast<S>();
  }
  void add_process_noise(const State<double>&, const Input&, double, Eigen::Matrix2d& P) const { P += Q; }
};

struct GustReplay {
  const Gust* model;
  const std::vector<double>* z;
  Eigen::Vector2d H;
  double r;
  estimation::ExtendedKalmanFilter<Gust> filter;
  estimation::InnovationMonitor monitor{estimation::InnovationGate{.threshold = 1e9}};
  std::size_t k = 0;
  bool advance(estimation::SmootherTape<Gust>* tape) {
    if (k == z->size()) return false;
    filter.propagate(*model, {}, 0.01, tape);
    filter.update(0.01 * static_cast<double>(k), (*z)[k] - H.dot(filter.state().x), H, r, monitor, tape);
    filter.mark(k++, tape);
    return true;
  }
};

// Long simulation of the linear problem with the filter and smoother of the estimation module: 2000 s, several hundred
// correlation times, so that the sample RMS scatters by about a percent.
TEST(InformationBound, IsWhatALongLinearSimulationAttains) {
  constexpr double kSpeed = 15.0, kSigma = 0.6 * kDegree;
  Gust model;
  const double b = kSpeed / kModerate.Lw, theta = b * 0.01;
  // From the continuous model by its matrix exponential and the Lyapunov balance, in unscaled canonical states.
  const double e = std::exp(-theta);
  model.F << e * (1.0 + theta), e * 0.01, -e * b * b * 0.01, e * (1.0 - theta);
  const Eigen::Matrix2d Pi = Eigen::Vector2d(1.0 / (4.0 * b * b * b), 1.0 / (4.0 * b)).asDiagonal();
  model.Q = Pi - model.F * Pi * model.F.transpose();
  const Eigen::Vector2d H = kModerate.sigma_w / kSpeed * std::sqrt(3.0 * b) * Eigen::Vector2d(b / std::sqrt(3.0), 1.0);
  ASSERT_NEAR(H.dot(Pi * H), std::pow(kModerate.sigma_w / kSpeed, 2), 1e-12);

  numerics::RandomStream random(5, "gust");
  const Eigen::Matrix2d root = model.Q.llt().matrixL();
  Eigen::Vector2d x = Eigen::Vector2d::Zero();
  std::vector<double> truth, z;
  for (int k = 0; k < 200000; ++k) {
    x = model.F * x + root * Eigen::Vector2d(random.normal(), random.normal());
    truth.push_back(H.dot(x));
    z.push_back(truth.back() + kSigma * random.normal());
  }
  double filter_square = 0.0, smoother_square = 0.0;
  const GustReplay start{.model = &model, .z = &z, .H = H, .r = kSigma * kSigma, .filter = {{}, Pi}};
  estimation::smooth_in_blocks<Gust>(
      start, 4096, 1,
      [&](const GustReplay& run) {
        filter_square += std::pow(H.dot(run.filter.state().x) - truth[run.k - 1], 2);
        return true;
      },
      [&](std::size_t k, const Gust::State<double>& s, const Eigen::Matrix2d&) {
        smoother_square += std::pow(H.dot(s.x) - truth[k], 2);
      });
  const auto bound = information_bound(kModerate, kSpeed, kSigma, 100.0);
  EXPECT_NEAR(std::sqrt(filter_square / 2e5) / bound.alpha.filter, 1.0, 0.02);
  EXPECT_NEAR(std::sqrt(smoother_square / 2e5) / bound.alpha.smoother, 1.0, 0.02);
}

// --- With the aircraft's derivatives
// ------------------------------------------------------------------------------

Subject unatrap_without_stall() {
  Subject s = builtin_subject("unatrap", "test");
  s.model.stall.reset();
  return s;
}

// Section 5 of the specification: UnATRaP, moderate; printed with two decimals.
TEST(InformationBound, ReproducesTheSpecificationsValuesForAKnownAircraft) {
  const Subject subject = unatrap_without_stall();
  const auto at15 = information_bound(kModerate, subject, 15.0, {.airspeed_known = true, .axial_force = false});
  const auto at20 = information_bound(kModerate, subject, 20.0, {.airspeed_known = true, .axial_force = false});
  ASSERT_TRUE(at15.usable && at20.usable);
  // 0.0749 and 0.0741: the normal force also holds drag's share (slope 3.73 where CL_alpha is 3.607; lift alone would
  // give 0.0775, which prints as 0.08).
  EXPECT_NEAR(at15.angles.alpha.filter / kDegree, 0.0775 * 3.607 / 3.73, 0.001);
  EXPECT_LT(at15.angles.alpha.filter / kDegree, 0.08);
  EXPECT_LT(at15.angles.alpha.smoother, at15.angles.alpha.filter);
  EXPECT_NEAR(at15.angles.alpha.smoother / at15.angles.alpha.filter, 1.0, 0.02);  // 0.08 and 0.08 are printed
  EXPECT_NEAR(at15.angles.beta.filter / kDegree, 0.28, 0.005);
  EXPECT_NEAR(at15.angles.beta.smoother / kDegree, 0.24, 0.005);
  EXPECT_NEAR(at20.angles.alpha.filter / kDegree, 0.04, 0.005);
  EXPECT_NEAR(at20.angles.alpha.smoother / kDegree, 0.04, 0.005);
  EXPECT_NEAR(at20.angles.beta.filter / kDegree, 0.19, 0.005);
  EXPECT_NEAR(at20.angles.beta.smoother / kDegree, 0.17, 0.005);
}

// An accelerometer of infinite noise leaves the bound of who does not know the aircraft, computed by the other
// recursion.
TEST(InformationBound, IsTheModelFreeOneWithoutAnAccelerometer) {
  const auto b = information_bound(kModerate, unatrap_without_stall(), 20.0,
                                   {.accelerometer = 1e6, .dynamic_pressure = 0.0, .airspeed_known = true});
  const auto free = information_bound(kModerate, 20.0, 0.6 * kDegree, 100.0);
  // At an angle of attack, alpha also turns with the gust along x, which is known here, and beta's gain is 1/Va still.
  EXPECT_NEAR(b.angles.alpha.filter / free.alpha.filter, 1.0, 0.01);
  EXPECT_NEAR(b.angles.alpha.smoother / free.alpha.smoother, 1.0, 0.01);
  EXPECT_NEAR(b.angles.beta.filter / free.beta.filter, 1.0, 0.01);
  EXPECT_NEAR(b.angles.beta.smoother / free.beta.smoother, 1.0, 0.01);
}

TEST(InformationBound, GrowsWhenTheAirspeedIsNotKnown) {
  const Subject subject = unatrap_without_stall();
  const auto known = information_bound(kModerate, subject, 15.0, {.airspeed_known = true});
  const auto unknown = information_bound(kModerate, subject, 15.0, {});
  EXPECT_GT(unknown.angles.alpha.filter, 1.5 * known.angles.alpha.filter);
  EXPECT_NEAR(unknown.angles.beta.filter, known.angles.beta.filter, 1e-3 * known.angles.beta.filter);
  EXPECT_FALSE(information_bound(kModerate, subject, 5.0, {}).usable) << "cannot fly level at 5 m/s";
}

}  // namespace
}  // namespace veridyn::aircraft
