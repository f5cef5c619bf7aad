#include "veridyn/cueing/perception/perception.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::cueing {
namespace {

const Eigen::Vector3d kLevel(0.0, 0.0, -9.80665);

TEST(Perception, IsAtRestAfterReset) {
  for (const VestibularModel& m : vestibular_models()) {
    Perception perception(m);
    const Perception::Felt rest = perception.reset(kLevel, Eigen::Vector3d::Zero());
    EXPECT_EQ(rest.rate.norm(), 0.0);
    EXPECT_NEAR(rest.force.z(), -9.80665 * m.otoliths.response(0.0).real(), 1e-12 * rest.force.norm());
    for (int k = 0; k < 200; ++k) {
      const Perception::Felt felt = perception.step(kLevel, Eigen::Vector3d::Zero(), 0.01);
      ASSERT_LT((felt.force - rest.force).norm(), 1e-10 * rest.force.norm()) << m.name;
      ASSERT_EQ(felt.rate.norm(), 0.0);
    }
  }
}

TEST(Perception, EachAxisIsFeltByItself) {
  Perception perception(vestibular_model("young_meiry"));
  perception.reset(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  Perception::Felt felt{};
  for (int k = 1; k <= 100; ++k)
    felt = perception.step(Eigen::Vector3d(0.0, 1.0, 0.0), Eigen::Vector3d(0.0, 0.0, 0.2), 0.01);
  EXPECT_EQ(felt.rate.x(), 0.0);
  EXPECT_EQ(felt.rate.y(), 0.0);
  EXPECT_GT(felt.rate.z(), 0.15);
  EXPECT_EQ(felt.force.x(), 0.0);
  EXPECT_GT(felt.force.y(), 0.6);
}

TEST(Perception, DoesNotDependOnTheRateOfSamples) {
  // A turn of half a second, sampled at 50 Hz, 1 kHz and irregularly: lines between samples carry it.
  const auto felt_after = [](const std::vector<double>& steps) {
    Perception perception(vestibular_model("telban_cardullo"));
    perception.reset(kLevel, Eigen::Vector3d::Zero());
    Perception::Felt felt{};
    double t = 0.0;
    for (const double step : steps) {
      t += step;
      const Eigen::Vector3d rate(0.5 * t, 0.0, -0.1 * t);
      felt = perception.step(kLevel, rate, step);
    }
    return felt;
  };
  std::vector<double> irregular;
  double sum = 0.0;
  for (int k = 0; sum < 0.46; ++k) sum += irregular.emplace_back(k % 2 == 0 ? 0.007 : 0.031);
  irregular.push_back(0.5 - sum);
  const Perception::Felt slow = felt_after(std::vector(25, 0.02)), fast = felt_after(std::vector(500, 0.001)),
                         jittered = felt_after(irregular);
  EXPECT_LT((slow.rate - fast.rate).norm(), 1e-12);
  EXPECT_LT((jittered.rate - fast.rate).norm(), 1e-12);
}

}  // namespace
}  // namespace veridyn::cueing
