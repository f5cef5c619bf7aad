#include "veridyn/aircraft/identification/output_error/missed_gusts.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "veridyn/aircraft/reconstruction/information_bound.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

constexpr double kSpeed = 15.0;
constexpr std::array<double, 3> kUnseen{kInfinity, kInfinity, kInfinity};

DrydenSettings moderate() { return dryden_settings("low_moderate", "test"); }

/// Passes all up to 20 of 100 Hz.
numerics::FirKernel wide() {
  return numerics::low_pass_differentiator({.rate_Hz = 100.0, .pass_Hz = 20.0, .stop_Hz = 30.0});
}

// What nothing sees is missed as a whole: Dryden's variance between two frequencies in closed form.
TEST(MissedGusts, AreAllOfThemWhereNothingSeesThem) {
  const DrydenSettings s = moderate();
  const MissedGusts missed(s, kSpeed, kUnseen, nullptr);
  const auto below = [](double f, double length) { return 2.0 / kPi * std::atan(2.0 * kPi * f * length / kSpeed); };
  EXPECT_NEAR(missed.variance(0), s.sigma_u * s.sigma_u * (below(10.0, s.Lu) - below(0.01, s.Lu)), 0.01);
  // Of (1 + 3 x^2)/(1 + x^2)^2 the integral is 2 atan x - x/(1 + x^2).
  const auto across = [](double f, double length) {
    const double x = 2.0 * kPi * f * length / kSpeed;
    return (2.0 * std::atan(x) - x / (1.0 + x * x)) / kPi;
  };
  EXPECT_NEAR(missed.variance(1), s.sigma_v * s.sigma_v * (across(10.0, s.Lv) - across(0.01, s.Lv)), 0.01);
  EXPECT_NEAR(missed.variance(2), s.sigma_w * s.sigma_w * (across(10.0, s.Lw) - across(0.01, s.Lw)), 0.01);
  // An input that knows nothing of them adds nothing.
  const numerics::FirKernel input = wide();
  EXPECT_EQ(MissedGusts(s, kSpeed, kUnseen, &input).variance(2), missed.variance(2));
  EXPECT_FALSE(MissedGusts({}, kSpeed, kUnseen, nullptr).any());
}

// The error of the best smoother, from Riccati's equation there and from Wiener's filter here, with what is slower than
// 0.01 and faster than 10 Hz in closed form. The vane is so bad that this is little.
TEST(MissedGusts, AreTheErrorsOfTheBestSmootherWhereAllOfItIsAnInput) {
  const DrydenSettings s = moderate();
  const double vane = 40.0 * kDegree, rate_Hz = 100.0, density = 2.0 * std::pow(vane * kSpeed, 2.0) / rate_Hz;
  const numerics::FirKernel input = wide();
  const MissedGusts missed(s, kSpeed, {kInfinity, density, density}, &input);
  const InformationBound bound = information_bound(s, kSpeed, vane, rate_Hz);
  const auto all = [&](std::size_t axis, double sigma, double length) {
    const double still = sigma * sigma * 2.0 * length / kSpeed, x = 2.0 * kPi * 10.0 * length / kSpeed;
    const double slow = 0.01 * still * density / (still + density);
    const double fast = sigma * sigma * (1.0 - (2.0 * std::atan(x) - x / (1.0 + x * x)) / kPi);
    return std::sqrt(missed.variance(axis) + slow + fast) / kSpeed;
  };
  EXPECT_NEAR(all(2, s.sigma_w, s.Lw), bound.alpha.smoother, 0.005 * bound.alpha.smoother);
  EXPECT_NEAR(all(1, s.sigma_v, s.Lv), bound.beta.smoother, 0.005 * bound.beta.smoother);
}

// What is faster than 2 Hz does not drive the simulation, however good the vane.
TEST(MissedGusts, AreThoseThatTheLowPassKeepsBack) {
  const DrydenSettings s = moderate();
  const numerics::FirKernel input = gust_differentiator(100.0);
  const MissedGusts missed(s, kSpeed, {1e-12, 1e-12, 1e-12}, &input);
  const double time = s.Lw / kSpeed;
  double above = 0.0, below = 0.0;
  constexpr double kStep_Hz = 1e-3;
  for (double f = 0.0105; f < 10.0; f += kStep_Hz) {
    const double x2 = std::pow(2.0 * kPi * f * time, 2.0);
    const double passed = input.gain(f) / (2.0 * kPi * f);
    const double gust = s.sigma_w * s.sigma_w * 2.0 * time * (1.0 + 3.0 * x2) / std::pow(1.0 + x2, 2.0);
    (f > 2.0 ? above : below) += kStep_Hz * gust * std::pow(1.0 - passed, 2.0);
  }
  EXPECT_NEAR(missed.variance(2), above + below, 0.03 * above);
  EXPECT_LT(below, 0.01 * above);
}

// Draws have the variance of the derivative, are Gaussian enough, and begin alike whatever their length.
TEST(MissedGusts, AreDrawnWithTheirVariance) {
  const DrydenSettings s = moderate();
  const MissedGusts missed(s, kSpeed, kUnseen, nullptr);
  const double time = s.Lw / kSpeed, step = 0.01;
  double expected = 0.0;
  for (double f = 0.0105; f < 10.0; f += 1e-3) {
    const double x2 = std::pow(2.0 * kPi * f * time, 2.0);
    expected += 1e-3 * std::pow(2.0 * kPi * f, 2.0) * s.sigma_w * s.sigma_w * 2.0 * time * (1.0 + 3.0 * x2) /
                std::pow(1.0 + x2, 2.0);
  }
  double squares = 0.0, fourth = 0.0, count = 0.0;
  for (std::uint64_t draw = 0; draw < 200; ++draw) {
    numerics::RandomStream random(1, draw), again(1, draw);
    const auto a = missed.acceleration(400, step, random);
    if (draw == 0) {
      const auto head = missed.acceleration(50, step, again);
      for (std::size_t k = 0; k < head.size(); ++k) EXPECT_EQ(head[k], a[k]);
    }
    for (std::size_t k = 0; k < a.size(); k += 20) {
      squares += a[k][2] * a[k][2];
      fourth += std::pow(a[k][2], 4.0);
      count += 1.0;
    }
  }
  EXPECT_NEAR(squares / count, expected, 0.06 * expected);
  EXPECT_NEAR(fourth / count / std::pow(squares / count, 2.0), 3.0, 0.4);
}

}  // namespace
}  // namespace veridyn::aircraft
