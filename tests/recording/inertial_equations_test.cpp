#include "veridyn/recording/inertial_equations.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <optional>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::recording::internal {
namespace {

constexpr int kWindows = 300;
constexpr double kNoise = 0.05;

/// A sensor that has scale factors, misalignments and biases.
struct Sensor {
  Matrix3 gain;
  Vector3 bias;
};
Sensor wrong_sensor() {
  Sensor s;
  s.gain << 1.1, 0.03, -0.02,  //
      0.01, 0.9, 0.05,         //
      -0.04, 0.02, 1.05;
  s.bias << 0.3, -0.2, 0.5;
  return s;
}

/// Delays, and zero and deviation of the heading.
using Moves = Eigen::Vector<double, internal::kDelays>;

/// Windows of what such a sensor reads in any attitude against what a noisy reference shows in the fixed frame.
/// @param rests an axis whose truth is constant @param delays by which what goes with them moves it [s, rad]
Equations equations(const Sensor& sensor, std::uint64_t seed, int windows = kWindows,
                    std::optional<Eigen::Index> rests = {}, const Moves& delays = Moves::Zero()) {
  numerics::RandomStream draw(seed, "windows");
  const auto vector = [&] { return Vector3(draw.normal(), draw.normal(), draw.normal()); };
  Equations all(kNoise * kNoise);
  for (int k = 0; k < windows; ++k) {
    const Matrix3 body_from_ned =
        numerics::R_body_from_ned<double>(0.4 * draw.normal(), 0.3 * draw.normal(), draw.uniform(-kPi, kPi));
    const Matrix3 T = body_from_ned.transpose();
    Vector3 truth = 3.0 * vector();
    truth(2) -= kGravity;
    if (rests) truth(*rests) = 0.0;
    Equations::Delays moves;
    for (Eigen::Index j = 0; j < moves.cols(); ++j) moves.col(j) = 5.0 * vector();
    const Vector3 seen = T * truth + moves * delays + kNoise * vector();
    all.add(regressors(T, sensor.gain * truth + sensor.bias), seen, moves);
  }
  return all;
}

// Standard errors come from those of the inverse gain, to first order; here they are held against the spread.
TEST(InertialEquations, FindGainAndBiasWithinTheirStandardErrors) {
  const Sensor sensor = wrong_sensor();
  constexpr int kRecordings = 100;
  Matrix3 gain = Matrix3::Zero();
  Vector3 bias = Vector3::Zero();
  for (std::uint64_t seed = 1; seed <= kRecordings; ++seed) {
    const std::optional<Solved> found = equations(sensor, seed).solve(false);
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(found->matrix.rows, kWindows);
    gain += ((found->matrix.gain - sensor.gain).array() / found->matrix.gain_sigma.array()).square().matrix();
    bias += ((found->matrix.bias - sensor.bias).array() / found->matrix.bias_sigma.array()).square().matrix();
  }
  // The mean of a hundred squares of standard normal numbers is 1 +- 0.14; diagonals allow for the reference's noise
  // too.
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      EXPECT_LT(gain(i, j) / kRecordings, 1.6) << i << j;
      if (i != j) EXPECT_GT(gain(i, j) / kRecordings, 0.55) << i << j;
    }
    EXPECT_LT(bias(i) / kRecordings, 1.6) << i;
    EXPECT_GT(bias(i) / kRecordings, 0.55) << i;
  }
}

TEST(InertialEquations, FindDelaysTogetherWithThem) {
  const Sensor sensor = wrong_sensor();
  const Moves delays(0.02, -0.05, 0.1, 0.01, 0.2, -0.1);
  const std::optional<Solved> found = equations(sensor, 1, kWindows, {}, delays).solve(true);
  ASSERT_TRUE(found.has_value());
  for (Eigen::Index j = 0; j < 3; ++j) {
    EXPECT_NEAR(found->delay(j), delays(j), 4.0 * found->delay_sigma(j)) << j;
    EXPECT_LT(found->delay_sigma(j), 0.002) << j;
  }
  EXPECT_LT((found->matrix.gain - sensor.gain).cwiseAbs().maxCoeff(), 0.01);
}

TEST(InertialEquations, TakeTheGainOfAnAxisThatRestsAsOne) {
  const Sensor sensor{Matrix3::Identity(), Vector3(0.1, 0.2, -0.1)};
  for (const Eigen::Index axis : {0, 1}) {
    const std::optional<Solved> found = equations(sensor, 1, kWindows, axis).solve(false);
    ASSERT_TRUE(found.has_value());
    for (Eigen::Index j = 0; j < 3; ++j) EXPECT_EQ(found->matrix.moved[static_cast<std::size_t>(j)], j != axis) << j;
    EXPECT_NEAR(found->matrix.gain(axis, axis), 1.0, 0.02);
    EXPECT_LT((found->matrix.bias - sensor.bias).cwiseAbs().maxCoeff(), 0.05);
  }
}

TEST(InertialEquations, SayNothingOfFewWindowsAndLeaveBadOnesOut) {
  const Sensor sensor = wrong_sensor();
  EXPECT_FALSE(equations(sensor, 1, 59).solve(false).has_value());
  EXPECT_TRUE(equations(sensor, 1, 60).solve(false).has_value());
  Equations all = equations(sensor, 1, 60);
  all.add(Eigen::Matrix<double, 3, kUnknowns>::Constant(std::nan("")), Vector3::Zero());
  all.add(Eigen::Matrix<double, 3, kUnknowns>::Zero(), Vector3::Constant(kInfinity));
  EXPECT_EQ(all.solve(false)->matrix.rows, 60);
}

}  // namespace
}  // namespace veridyn::recording::internal
