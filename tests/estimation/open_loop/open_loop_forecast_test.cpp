#include "veridyn/estimation/open_loop/open_loop_forecast.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/estimation/open_loop/decay.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/open_loop/open_loop_scores.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::estimation {
namespace {

constexpr double kA = 0.05, kSigmaA = 0.01;

std::vector<double> decaying(std::size_t samples, double a, double noise, double offset_after_s = kInfinity) {
  numerics::RandomStream random(1, "decay");
  std::vector<double> x;
  for (std::size_t k = 0; k < samples; ++k) {
    const double t = Decay::kStep * static_cast<double>(k);
    x.push_back(2.0 * std::exp(-a * t) + noise * random.normal() + (t > offset_after_s ? 10.0 * noise : 0.0));
  }
  return x;
}

template <typename Model>
OpenLoopForecast forecast_of(const Model& decay, const OpenLoopError& error, double sigma_a,
                             std::vector<std::string> drifting = {}) {
  Model model = decay, first = decay;
  const Eigen::MatrixXd covariance = Eigen::MatrixXd::Constant(1, 1, sigma_a * sigma_a);
  const std::vector<OpenLoopError> errors{error};
  Progress silent;
  auto forecasts = open_loop_forecasts(model, first,
                                       {.covariance = covariance,
                                        .errors = errors,
                                        .judged = {true},
                                        .start_s = 2.0,
                                        .recording = "one",
                                        .drifting = std::move(drifting)},
                                       silent);
  EXPECT_EQ(forecasts.size(), 1u);
  return std::move(forecasts.at(0));
}

// The band by the formulas of one unknown: 21 samples of the first two seconds give x_0.
TEST(OpenLoopForecast, HasTheBandOfParametersStartAndErrors) {
  const double white = 0.02;
  const OpenLoopForecast f = forecast_of(Decay(decaying(201, kA, white), kA), {.white = white}, kSigmaA);
  ASSERT_EQ(f.predicted.rows(), 201);
  EXPECT_EQ(f.window.recording, "one");
  EXPECT_EQ(f.window.forecast_from, 102.0);
  const double x_0 = f.window.start.at(0).value;
  EXPECT_NEAR(x_0, 2.0, 4.0 * white / std::sqrt(21.0));
  double information = 0.0, cross = 0.0;
  for (int k = 0; k <= 20; ++k) {
    const double t = 0.1 * k, decay = std::exp(-kA * t);
    information += decay * decay / (white * white);
    cross += decay * (-t * x_0 * decay) / (white * white);
  }
  for (const int k : {0, 20, 100, 200}) {
    const double t = 0.1 * k, decay = std::exp(-kA * t);
    EXPECT_NEAR(f.predicted(k, 0), x_0 * decay, 1e-12);
    const double g = -t * x_0 * decay - decay * cross / information;
    EXPECT_NEAR(f.sigma(k, 0), std::sqrt(std::pow(g * kSigmaA, 2.0) + decay * decay / information + white * white),
                1e-9);
  }
  // Where the start has made up for a wrong parameter, that error does not count.
  EXPECT_LT(f.sigma(10, 0), std::hypot(white, kSigmaA * 1.0 * 2.0 * std::exp(-0.05)));
}

TEST(OpenLoopForecast, CountsAnErrorThatLastsOnceInTheFirstSeconds) {
  const OpenLoopForecast f = forecast_of(Decay(decaying(101, kA, 0.0), kA), {.white = 1e-9, .lasting = 0.1}, 0.0);
  // As uncertain as one sample of the first two seconds leaves x_0; so is what is measured later.
  double mean = 0.0;
  for (int k = 0; k <= 20; ++k) mean += std::exp(-2.0 * kA * 0.1 * k) / 21.0;
  EXPECT_NEAR(f.sigma(50, 0), 0.1 * std::sqrt(1.0 + std::exp(-2.0 * kA * 5.0) / mean), 1e-9);
}

// Three of the 21 samples tell the same: seven observations.
TEST(OpenLoopForecast, CountsAnErrorOfKnownMemoryOnceInThat) {
  const OpenLoopForecast f =
      forecast_of(Decay(decaying(101, kA, 0.0), kA), {.white = 1e-9, .lasting = 0.1, .memory = 3.0}, 0.0);
  double mean = 0.0;
  for (int k = 0; k <= 20; ++k) mean += std::exp(-2.0 * kA * 0.1 * k) / 21.0;
  EXPECT_NEAR(f.sigma(50, 0), 0.1 * std::sqrt(1.0 + std::exp(-2.0 * kA * 5.0) / (7.0 * mean)), 1e-9);
}

TEST(OpenLoopForecast, HasThePriorOfAConditionThatDoesNotStay) {
  const double prior = 0.3, white = 0.01;
  const Decay decay(decaying(101, kA, 0.0), kA, kInfinity, prior);
  const OpenLoopForecast stays = forecast_of(decay, {.white = white}, 0.0);
  const OpenLoopForecast drifts = forecast_of(decay, {.white = white}, 0.0, {"x_0"});
  const double response = std::exp(-kA * 5.0);
  EXPECT_LT(stays.sigma(50, 0), 1.1 * white);
  EXPECT_NEAR(drifts.sigma(50, 0), std::hypot(stays.sigma(50, 0), response * prior), 1e-9);
}

/// Pushed by what is not among its inputs: two draws, one of them up, one down, and one that diverged.
class PushedDecay : public Decay {
 public:
  using Decay::Decay;
  static double pushed(Eigen::Index k) { return 0.1 * kStep * static_cast<double>(k); }
  std::vector<RowMatrix> disturbances(std::size_t segment, const Eigen::VectorXd&) const override {
    RowMatrix up(samples(segment), 1);
    for (Eigen::Index k = 0; k < up.rows(); ++k) up(k, 0) = pushed(k);
    return {up, -up, {}};
  }
};

// The start is disturbed as what comes after it, and makes up for a part: what all samples of the first two seconds
// share weighs less than what is new in each.
TEST(OpenLoopForecast, HasWhatDisturbancesDoLessWhatTheStartMakesUpFor) {
  const double white = 0.02;
  const OpenLoopForecast f = forecast_of(PushedDecay(decaying(201, kA, white), kA), {.white = white}, 0.0);
  double sum = 0.0;
  for (int k = 0; k <= 20; ++k) sum += PushedDecay::pushed(k);
  const double variance = white * white + sum * sum / 21.0;
  double information = 0.0, pull = 0.0;
  for (int k = 0; k <= 20; ++k) {
    const double decay = std::exp(-kA * 0.1 * k);
    information += decay * decay / variance;
    pull += decay * PushedDecay::pushed(k) / variance;
  }
  for (const int k : {0, 20, 100, 200}) {
    const double decay = std::exp(-kA * 0.1 * k);
    const double d = PushedDecay::pushed(k) - decay * pull / information;
    EXPECT_NEAR(f.sigma(k, 0), std::sqrt(decay * decay / information + white * white + d * d), 1e-9) << k;
  }
}

TEST(OpenLoopForecast, LeavesItsBandWhereTheErrorOfHalfASecondIsThreeSigma) {
  const double white = 0.02;
  const OpenLoopForecast right = forecast_of(Decay(decaying(201, kA, white), kA), {.white = white}, 0.0);
  EXPECT_NEAR(right.window.first_left_s, 18.0, 1e-9) << "never left: to its end";
  const OpenLoopForecast left = forecast_of(Decay(decaying(201, kA, white, 12.0), kA), {.white = white}, 0.0);
  EXPECT_NEAR(left.window.first_left_s, 10.0, 0.5);
  const std::vector<OpenLoopForecast> all{right, left};
  const std::vector<ModelOutput> outputs{{"x", "m/s"}};
  const std::vector<std::string> groups{""};
  const auto states = open_loop_scores(outputs, all, groups, [](std::string_view) { return std::string(); });
  ASSERT_EQ(states.size(), 1u);
  EXPECT_EQ(states[0].windows, 2u);
  EXPECT_EQ(states[0].held, 1u);
  EXPECT_NEAR(states[0].horizon_s, 14.0, 0.5) << "the median of both";
  EXPECT_EQ(states[0].fit.count, 2u * 181u);
  EXPECT_NEAR(states[0].inside, (181.0 * 0.95 + 101.0 * 0.95) / 362.0, 0.03);
  EXPECT_TRUE(std::isnan(states[0].sigma[19])) << "where the start is estimated";
  EXPECT_TRUE(std::isnan(states[0].measured[201])) << "between windows";
}

TEST(OpenLoopForecast, IsCutWhereItDiverges) {
  const OpenLoopForecast f = forecast_of(Decay(decaying(201, -0.2, 0.0), -0.2, 20.0), {.white = 0.01}, 0.0);
  EXPECT_TRUE(f.window.diverged);
  EXPECT_NEAR(f.window.span.duration(), std::log(10.0) / 0.2, 0.1 + 20.0);
  EXPECT_EQ(f.predicted.rows(), f.measured.rows());
  EXPECT_NEAR(static_cast<double>(f.predicted.rows()), 10.0 * std::log(10.0) / 0.2, 1.5);
}

}  // namespace
}  // namespace veridyn::estimation
