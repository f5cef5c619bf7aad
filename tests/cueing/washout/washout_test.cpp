#include "veridyn/cueing/washout/washout.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/cueing/washout/pushed.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::cueing {
namespace {

using recording::MotionSample;
using testing_support::pushed;

/// An algorithm that does nothing but remember what it was shown.
class Remembering final : public Washout {
 public:
  [[nodiscard]] std::unique_ptr<Washout> clone() const override { return std::make_unique<Remembering>(*this); }
  std::vector<Eigen::Vector3d> force, rate;
  std::vector<SampleStep> step_s;

 private:
  PlatformCommand next(const VehicleMotion& motion, SampleStep step) override {
    force.push_back(motion.force);
    rate.push_back(motion.rate);
    step_s.push_back(step);
    return {};
  }
};

// 2 m/s^2 at the beginning come in as 1 - (1 + t/T) exp(-t/T), T = 0.4 s: critically damped, without a jump.
TEST(Washout, LeadsInWhatTheVehicleDoesAtTheBeginning) {
  Remembering w;
  w.reset(pushed(2.0));
  EXPECT_EQ(w.force[0], recording::force_at_rest(Frame::kFrd));
  EXPECT_FALSE(w.step_s[0].has_value());
  for (int k = 1; k <= 200; ++k) {
    w.step(pushed(2.0), 0.01);
    const double t = 0.01 * k / 0.4;
    ASSERT_NEAR(w.force.back().x(), 2.0 * (1.0 - (1.0 + t) * std::exp(-t)), 1e-12) << k;
  }
  EXPECT_GT(w.force.back().x(), 0.95 * 2.0) << "after two seconds";
  EXPECT_NEAR(w.force.back().z(), -kGravity, 1e-12) << "gravity is there from the beginning";
}

TEST(Washout, TakesTheSampleBeforeForValuesThatAreNotFinite) {
  Remembering w;
  w.reset(pushed(0.0));
  w.step(pushed(1.5), 0.1);
  MotionSample broken = pushed(std::nan(""));
  broken.rate.y() = std::numeric_limits<double>::infinity();
  w.step(broken, 0.1);
  EXPECT_EQ(w.force.back().x(), 1.5);
  EXPECT_EQ(w.rate.back().y(), 0.0);
}

TEST(Washout, BoundsWhatNoVehicleCanDo) {
  Remembering w;
  w.reset(pushed(0.0));
  MotionSample wild = pushed(1e6);
  wild.rate.z() = -1e6;
  w.step(wild, 0.1);
  EXPECT_EQ(w.force.back().x(), 1000.0);
  EXPECT_EQ(w.rate.back().z(), -100.0);
}

TEST(Washout, BoundsTheStepOfTime) {
  Remembering w;
  w.reset(pushed(0.0));
  for (const double step : {-1.0, std::nan(""), 1e9, 0.25}) w.step(pushed(0.0), step);
  EXPECT_EQ(w.step_s[1], 0.0);
  EXPECT_EQ(w.step_s[2], 0.0);
  EXPECT_EQ(w.step_s[3], 10.0);
  EXPECT_EQ(w.step_s[4], 0.25);
}

// Axes forward, left, up are those of many games; the algorithm sees forward, right, down.
TEST(Washout, SeesForwardRightDownWhateverTheSamplesFrame) {
  Remembering w;
  w.reset(pushed(0.0));
  MotionSample flu;
  flu.frame = Frame::kFlu;
  flu.force = Eigen::Vector3d(0.5, 1.0, kGravity);
  flu.rate = Eigen::Vector3d(0.1, 0.2, 0.3);
  w.step(flu, 0.1);
  EXPECT_LT((w.force.back() - Eigen::Vector3d(0.5, -1.0, -kGravity)).norm(), 1e-12);
  EXPECT_LT((w.rate.back() - Eigen::Vector3d(0.1, -0.2, -0.3)).norm(), 1e-12);
}

TEST(Washout, BeginsAgainAtEachReset) {
  Remembering w;
  w.reset(pushed(2.0));
  for (int k = 0; k < 500; ++k) w.step(pushed(2.0), 0.01);
  w.reset(pushed(3.0));
  EXPECT_EQ(w.force.back(), recording::force_at_rest(Frame::kFrd));
  w.step(pushed(3.0), 0.01);
  EXPECT_LT(w.force.back().x(), 0.01);
}

}  // namespace
}  // namespace veridyn::cueing
