#include "veridyn/aircraft/model/air_data.hpp"

#include <gtest/gtest.h>

#include "veridyn/numerics/random.hpp"

namespace veridyn::aircraft {
namespace {

TEST(AirData, GoesToVelocityAndBack) {
  numerics::RandomStream random(1, "air");
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d v(random.uniform(1, 30), random.uniform(-9, 9), random.uniform(-9, 9));
    const AirData<double> a = air_data(v);
    EXPECT_LT((air_velocity(a.Va, a.alpha, a.beta) - v).norm(), 1e-12);
  }
  EXPECT_EQ(air_data(Eigen::Vector3d(0, 0, 0)).alpha, 0.0);
}

}  // namespace
}  // namespace veridyn::aircraft
