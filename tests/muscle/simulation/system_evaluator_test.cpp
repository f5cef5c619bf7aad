#include "veridyn/muscle/simulation/system_evaluator.hpp"

#include <gtest/gtest.h>

#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

class SystemEvaluatorOfTheArm : public ::testing::Test {
 protected:
  /// The state of muscles in equilibrium at activation 0.1.
  std::vector<double> state(double elbow, double elbow_speed) {
    std::vector<double> x(system.layout().size, 0.0);
    x[0] = 0.3;
    x[1] = elbow;
    x[3] = elbow_speed;
    evaluator.set_motion(x.data(), x.data() + 2);
    evaluator.start_muscles(activation.data(), x.data());
    return x;
  }
  MusculoskeletalSystem system{load_model("arm").model()};
  SystemEvaluator<double> evaluator{system};
  std::vector<double> activation = std::vector<double>(6, 0.1);
};

TEST_F(SystemEvaluatorOfTheArm, StartedMusclesStayAsTheyAreWhileTheArmRests) {
  const std::vector<double> x = state(0.9, 0.0);
  std::vector<double> rate(x.size());
  ASSERT_TRUE(evaluator.derivative(x.data(), {activation, {}}, rate.data()));
  for (std::size_t i = 4; i < x.size(); ++i) EXPECT_NEAR(rate[i], 0.0, 1e-9) << system.state_name(i);
}

TEST_F(SystemEvaluatorOfTheArm, SpeedsAreTheRatesOfValuesAndPaths) {
  const std::vector<double> x = state(0.9, 2.0);
  std::vector<double> rate(x.size());
  ASSERT_TRUE(evaluator.derivative(x.data(), {activation, {}}, rate.data()));
  EXPECT_EQ(rate[0], 0.0);
  EXPECT_EQ(rate[1], 2.0);
  const std::vector<double> speed(evaluator.path_speed().begin(), evaluator.path_speed().end());
  const double h = 1e-6;
  state(0.9 + 2.0 * h, 2.0);
  const std::vector<double> after(evaluator.path_length().begin(), evaluator.path_length().end());
  state(0.9 - 2.0 * h, 2.0);
  for (std::size_t m = 0; m < 6; ++m)
    EXPECT_NEAR(speed[m], (after[m] - evaluator.path_length()[m]) / (2.0 * h), 1e-7) << m;
}

TEST(SystemEvaluator, TakesTheFreeCoordinatesAndTheLockedOnesOfAPose) {
  Model model = load_model("arm").model();
  model.coordinates[0].locked = true;
  const MusculoskeletalSystem system(model);
  SystemEvaluator<double> evaluator(system), by_hand(system);
  const Eigen::Vector2d q(0.4, 1.1), qdot(7.0, 0.3);
  evaluator.set_pose(q.data(), qdot.data());
  by_hand.hold(q.data());
  by_hand.set_motion(&q(1), &qdot(1));
  EXPECT_EQ(evaluator.q()[0], 0.4);
  EXPECT_EQ(evaluator.q()[1], 1.1);
  EXPECT_EQ(evaluator.qdot()[0], 0.0) << "locked";
  EXPECT_EQ(evaluator.qdot()[1], 0.3);
  for (std::size_t m = 0; m < 6; ++m) EXPECT_EQ(evaluator.path_length()[m], by_hand.path_length()[m]);
}

TEST_F(SystemEvaluatorOfTheArm, AForceOnACoordinateAddsToItsAcceleration) {
  const std::vector<double> x = state(0.9, 0.0);
  std::vector<double> rate(x.size()), pushed(x.size()), force{0.0, 2.0};
  ASSERT_TRUE(evaluator.derivative(x.data(), {activation, {}}, rate.data()));
  ASSERT_TRUE(evaluator.derivative(x.data(), {activation, force}, pushed.data()));
  EXPECT_GT(pushed[3], rate[3]);
  EXPECT_EQ(pushed[5], rate[5]);
}

}  // namespace
}  // namespace veridyn::muscle
