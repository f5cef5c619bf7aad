#include "veridyn/cueing/perception/felt_pair.hpp"

#include <gtest/gtest.h>

#include <complex>

#include "tests/support/refusal.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::cueing {
namespace {

// Each input by the organs' own transfer functions: the rider feels g angle + shift'' - height angle'' and turns with
// the angle's rate; the driver's share counts against.
TEST(FeltPair, IsTheOrgansBehindTheMotionOfThePlatform) {
  const VestibularModel& model = vestibular_model("young_meiry");
  const MotionThresholds thresholds = usual_thresholds();
  const double height = 0.7;
  for (const Eigen::Index pair : {0, 1}) {
    const FeltPair felt = felt_pair(model, thresholds, pair, true, height);
    const auto canal_axis = static_cast<std::size_t>(pair);  // roll or pitch
    const double of_force = thresholds.force[1 - canal_axis], of_rate = thresholds.rate[canal_axis];
    for (const double omega : {0.1, 1.0, 7.0}) {
      const std::complex<double> s(0.0, omega);
      const std::complex<double> otoliths = model.otoliths.response(omega) / of_force,
                                 canal = model.canals[canal_axis].response(omega) / of_rate;
      const Eigen::MatrixXcd H = felt.system.response(omega);
      const auto close = [&](Eigen::Index output, Eigen::Index input, std::complex<double> expected) {
        EXPECT_LT(std::abs(H(output, input) - expected), 1e-9 * (1.0 + std::abs(expected)))
            << pair << " " << omega << " " << output << input;
      };
      close(0, FeltPair::kAngleInput, otoliths * (kGravity / (s * s) - height));
      close(0, FeltPair::kShiftInput, otoliths);
      close(0, FeltPair::kForce, -otoliths);
      close(0, FeltPair::kRateInput, 0.0);
      close(1, FeltPair::kAngleInput, canal / s);
      close(1, FeltPair::kShiftInput, 0.0);
      close(1, FeltPair::kForce, 0.0);
      close(1, FeltPair::kRateInput, -canal);
    }
  }
}

TEST(FeltPair, HasNoShiftWhereThePlatformHasNone) {
  const FeltPair felt = felt_pair(vestibular_model("young_meiry"), usual_thresholds(), 1, false, 0.0);
  EXPECT_EQ(felt.system.states(), 7);
  EXPECT_EQ(felt.system.B.col(FeltPair::kShiftInput).norm(), 0.0);
}

TEST(FeltPair, RefusesOrgansOfAnotherOrder) {
  VestibularModel model = vestibular_model("young_meiry");
  model.otoliths = {{1.0}, {1.0, 1.0}};
  EXPECT_NE(
      why([&] { (void)felt_pair(model, usual_thresholds(), 0, true, 0.0); }).find("of second and canals of third"),
      std::string::npos);
}

}  // namespace
}  // namespace veridyn::cueing
