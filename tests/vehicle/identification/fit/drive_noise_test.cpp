#include "veridyn/vehicle/identification/fit/drive_noise.hpp"

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

/// What such noise makes of the outputs.
Eigen::MatrixXd simulated(const DriveNoise& noise, Eigen::Index samples) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd out(samples, noise.C.rows());
  Eigen::VectorXd x = Eigen::VectorXd::Zero(noise.F.rows());
  for (Eigen::Index k = 0; k < samples; ++k) {
    out.row(k) = (noise.C * x).transpose();
    x = noise.F * x + noise.G * normal(random);
  }
  return out;
}

// White noise through an ideal low pass of a twentieth of the band keeps a twentieth of its variance; the two poles are
// as wide. 200 s have some 1000 independent values: 7 % are three standard errors of their rms.
TEST(DriveNoise, LeavesTheShareOfTheBandOfTheSteeringsNoise) {
  LinearDrive direct = first_order();
  direct.B.setZero();
  direct.C.setZero();
  direct.D << 1.0, 2.0;
  const DriveNoise noise = drive_noise(direct, {.sigma = 0.01, .band_share = 0.05, .step = kStep});
  constexpr Eigen::Index kSamples = 20000;
  const Eigen::MatrixXd shown = simulated(noise, kSamples);
  EXPECT_NEAR(std::sqrt(shown.col(0).squaredNorm() / kSamples) / (0.01 * std::sqrt(0.05)), 1.0, 0.07);
  EXPECT_TRUE(shown.col(1).isApprox(2.0 * shown.col(0)));
}

// Slow noise moves a first-order follower as it is, and its rate hardly: at a corner of a tenth of the follower's.
TEST(DriveNoise, ComesThroughTheVehicle) {
  const DriveNoise noise = drive_noise(first_order(), {.sigma = 0.01, .band_share = 0.002, .step = kStep});
  constexpr Eigen::Index kSamples = 400000;
  const Eigen::MatrixXd shown = simulated(noise, kSamples);
  EXPECT_NEAR(std::sqrt(shown.col(0).squaredNorm() / kSamples) / (0.01 * std::sqrt(0.002)), 1.0, 0.1);
  EXPECT_LT(shown.col(1).norm(), 1.5 * shown.col(0).norm());
}

}  // namespace
}  // namespace veridyn::vehicle
