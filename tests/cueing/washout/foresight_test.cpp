#include "veridyn/cueing/washout/foresight.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/cueing/washout/predictive_washout.hpp"

namespace veridyn::cueing {
namespace {

/// Foresees nothing, but notes whether it was shown a place that is none.
class Witness final : public Foresight {
 public:
  explicit Witness(std::shared_ptr<bool> wild) : wild_(std::move(wild)) {}
  void reset() override {}
  bool look(const recording::MotionSample& sample, double /*step*/, Foreseen& /*foreseen*/) override {
    constexpr double kNowhere = 1e9;  // [m]
    const bool somewhere = (sample.position.array().abs() < kNowhere).all();
    *wild_ = *wild_ || (sample.position_from != recording::Origin::kAbsent && !somewhere);
    return false;
  }
  [[nodiscard]] std::unique_ptr<Foresight> clone() const override { return std::make_unique<Witness>(*this); }
  [[nodiscard]] std::string from() const override { return "nothing"; }

 private:
  std::shared_ptr<bool> wild_;
};

TEST(Foresight, IsShownFinitePlacesOnly) {
  const auto wild = std::make_shared<bool>(false);
  PredictiveDesign design;
  design.foresee_from(Witness(wild));
  const std::unique_ptr<Washout> washout = design.make(built_in_platform("three_axis"));
  recording::MotionSample sample;
  sample.force = recording::force_at_rest(sample.frame);
  sample.position_from = recording::Origin::kMeasured;
  washout->reset(sample);
  for (const Eigen::Index axis : {0, 1}) {
    for (const double value : {kNaN, -kNaN, kInfinity, 1e300}) {
      recording::MotionSample s = sample;
      s.position(axis) = value;
      washout->step(s, 0.01);
      EXPECT_FALSE(*wild) << axis << " " << value;
    }
  }
}

TEST(ForesightAccount, OfASineIsItsClosedForm) {
  // sin(w t) against sin(w (t + d)): RMS of the difference 2 sin(w d / 2) / sqrt(2) of the amplitude.
  const double w = 1.7, amplitude = 3.0, d = ForesightAccount::kAhead;
  ForesightAccount account;
  for (int k = 0; k < 40000; ++k) {
    const double t = 0.0025 * k;
    account.add(amplitude * std::sin(w * t), amplitude * std::sin(w * (t + d)) + 0.5, true, k > 0 ? 0.0025 : 0.0);
  }
  EXPECT_NEAR(account.missed_held(), amplitude * std::sqrt(2.0) * std::sin(0.5 * w * d), 0.01);
  EXPECT_NEAR(account.missed(), 0.5, 0.01);
  EXPECT_EQ(account.share(), 1.0);
  EXPECT_EQ(account.text("the lap").find("misleads"), std::string::npos);
}

TEST(ForesightAccount, SaysWhenItMisleads) {
  ForesightAccount account;
  for (int k = 0; k < 3000; ++k) account.add(1.0, 3.0, k % 2 == 0, 0.01);
  EXPECT_NEAR(account.share(), 0.5, 1e-9);
  EXPECT_NE(account.text("the lap").find("the lap foresaw 50 % of the time"), std::string::npos);
  EXPECT_NE(account.text("the lap").find("it misleads"), std::string::npos);
}

}  // namespace
}  // namespace veridyn::cueing
