#include "veridyn/estimation/kalman/additive_model.hpp"

#include <gtest/gtest.h>

#include "veridyn/estimation/kalman/kalman_model.hpp"

namespace veridyn::estimation {
namespace {

/// A place and a speed that stays.
struct Moving : AdditiveModel<2> {
  static constexpr int kDynamic = 1;
  struct Input {};
  template <typename Scalar>
  [[nodiscard]] State<Scalar> propagate(const State<Scalar>& x, const Input& /*unused*/, double dt) const {
    State<Scalar> after = x;
    after(0) += x(1) * dt;
    return after;
  }
};
static_assert(SystemModel<Moving>);

TEST(AdditiveModel, LocalTakesOutWhatRetractAdds) {
  const Eigen::Vector2d x(1.0, -2.0), error(0.25, 0.5);
  EXPECT_EQ(Moving::local<double>(x, Moving::retract<double>(x, error)), error);
}

TEST(AdditiveModel, IsDifferentiatedAsItsStateIs) {
  Eigen::Vector2d after;
  const auto F = transition(Moving{}, Eigen::Vector2d(1.0, 3.0), {}, 0.5, after);
  EXPECT_EQ(after, Eigen::Vector2d(2.5, 3.0));
  EXPECT_EQ(F(0, 0), 1.0);
  EXPECT_EQ(F(0, 1), 0.5);
}

}  // namespace
}  // namespace veridyn::estimation
