#include "veridyn/vehicle/identification/fit/drive_whitening.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace veridyn::vehicle {
namespace {

constexpr double kStep = 0.01;

/// One state that follows the steering within 0.1 s, shown by one output; and its rate by another.
LinearDrive first_order() {
  LinearDrive drive{
      .A = Eigen::MatrixXd(1, 1), .C = Eigen::MatrixXd(2, 1), .B = Eigen::VectorXd(1), .D = Eigen::VectorXd(2)};
  drive.A << -10.0;
  drive.B << 10.0;
  drive.C << 1.0, -10.0;
  drive.D << 0.0, 10.0;
  return drive;
}

/// Autocorrelation of each column at one sample.
Eigen::VectorXd lag1(const Eigen::MatrixXd& x) {
  const Eigen::Index n = x.rows() - 1;
  return (x.topRows(n).cwiseProduct(x.bottomRows(n)))
      .colwise()
      .sum()
      .cwiseQuotient(x.cwiseAbs2().colwise().sum())
      .transpose();
}

struct Residual {
  Eigen::MatrixXd coloured, white;
};

/// What such noise makes of the outputs, and what the filter leaves of it.
Residual simulated(const DriveNoise& noise, const DriveWhitening::Filter& filter, Eigen::Index samples) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  const Eigen::Index outputs = noise.C.rows();
  Residual out{Eigen::MatrixXd(samples, outputs), Eigen::MatrixXd(samples, outputs)};
  Eigen::VectorXd x = Eigen::VectorXd::Zero(noise.F.rows()), s = x;
  for (Eigen::Index k = 0; k < samples; ++k) {
    Eigen::VectorXd y = noise.C * x;
    for (Eigen::Index j = 0; j < outputs; ++j) y(j) += std::sqrt(noise.R(j, j)) * normal(random);
    const Eigen::VectorXd white = y - filter.output * s;
    s = filter.transition * s + filter.gain * white;
    x = noise.F * x + noise.G * normal(random);
    out.coloured.row(k) = y.transpose();
    out.white.row(k) = white.transpose();
  }
  return out;
}

TEST(DriveWhitening, TakesTheColourOutOfWhatNoisySteeringDoes) {
  const DriveNoise noise =
      drive_noise(first_order(), {.sigma = 1e-3, .band_share = 0.1, .step = kStep}, Eigen::Vector2d(5e-5, 2e-3));
  constexpr Eigen::Index kSamples = 40000;
  const Residual residual = simulated(noise, whitening_filter(noise), kSamples);
  // White within four standard errors of an autocorrelation.
  EXPECT_LT(lag1(residual.white).cwiseAbs().maxCoeff(), 4.0 / std::sqrt(static_cast<double>(kSamples)));
  EXPECT_GT(lag1(residual.coloured).minCoeff(), 0.3);
  // And smaller than what comes in: the filter predicts.
  EXPECT_LT(residual.white.col(0).squaredNorm(), 0.7 * residual.coloured.col(0).squaredNorm());
}

// White noise through an ideal low pass of a twentieth of the band keeps a twentieth of its variance; the two poles are
// as wide. 200 s have some 1000 independent values: 7 % are three standard errors of their rms.
TEST(DriveWhitening, LeavesTheShareOfTheBandOfTheSteeringsNoise) {
  LinearDrive direct = first_order();
  direct.B.setZero();
  direct.C.setZero();
  direct.D << 1.0, 2.0;
  const DriveNoise noise =
      drive_noise(direct, {.sigma = 0.01, .band_share = 0.05, .step = kStep}, Eigen::Vector2d::Zero());
  constexpr Eigen::Index kSamples = 20000;
  const DriveWhitening::Filter none{noise.F, Eigen::MatrixXd::Zero(3, 2), noise.C};
  const Eigen::MatrixXd shown = simulated(noise, none, kSamples).coloured;
  EXPECT_NEAR(std::sqrt(shown.col(0).squaredNorm() / kSamples) / (0.01 * std::sqrt(0.05)), 1.0, 0.07);
  EXPECT_TRUE(shown.col(1).isApprox(2.0 * shown.col(0)));
}

// With exact steering there is nothing to predict a residual by.
TEST(DriveWhitening, WithoutNoiseOfTheSteeringChangesNothing) {
  const DriveNoise noise =
      drive_noise(first_order(), {.sigma = 0.0, .band_share = 0.1, .step = kStep}, Eigen::Vector2d(1e-4, 0.02));
  EXPECT_LT(whitening_filter(noise).gain.norm(), 1e-9);
}

TEST(DriveWhitening, IsOnTheStraightLineBetweenItsSpeeds) {
  const auto filter = [](double value) {
    return DriveWhitening::Filter{Eigen::MatrixXd::Constant(1, 1, value), Eigen::MatrixXd::Constant(1, 1, 2.0 * value),
                                  Eigen::MatrixXd::Constant(1, 1, 3.0 * value)};
  };
  const DriveWhitening whitening{.speed = {10.0, 20.0}, .filter = {filter(1.0), filter(2.0)}};
  EXPECT_FALSE(whitening.empty());
  for (const auto& [speed, value] :
       {std::pair{5.0, 1.0}, std::pair{10.0, 1.0}, std::pair{12.5, 1.25}, std::pair{20.0, 2.0}, std::pair{30.0, 2.0}}) {
    DriveWhitening::Filter there;
    whitening.at(speed, there);
    EXPECT_DOUBLE_EQ(there.transition(0, 0), value) << speed;
    EXPECT_DOUBLE_EQ(there.gain(0, 0), 2.0 * value) << speed;
    EXPECT_DOUBLE_EQ(there.output(0, 0), 3.0 * value) << speed;
  }
}

}  // namespace
}  // namespace veridyn::vehicle
