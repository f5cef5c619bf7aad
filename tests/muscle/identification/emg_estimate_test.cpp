#include "veridyn/muscle/identification/emg_estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/muscle/identification/moved_arm.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::muscle {
namespace {

const std::vector<std::string> kGains = {"brachialis.excitation_gain", "triceps_long.excitation_gain"};

/// The elbow's moment of an arm whose gains are 5 % above the model's, with white noise of 0.05 N m.
struct RecordedArm {
  RecordedArm() : model(arm.along(10, 1e-6)) {
    estimation::ModelResponse response;
    EXPECT_TRUE(arm.moved && model.respond(0, hidden(), {}, response));
    numerics::RandomStream random(5, "noise of a moment");
    for (double& moment : response.output.reshaped()) moment += kMomentNoise * random.normal();
    measured = {response.output};
  }
  [[nodiscard]] Eigen::VectorXd hidden() const { return arm.theta.head(2); }
  [[nodiscard]] EmgEstimate estimated(const Eigen::VectorXd& noise, const EmgError& error) const {
    return estimated(noise, error, measured);
  }
  [[nodiscard]] EmgEstimate estimated(const Eigen::VectorXd& noise, const EmgError& error,
                                      const std::vector<estimation::RowMatrix>& moments) const {
    Progress progress;
    const EmgDrivenModel with_errors = arm.along(10, 1e-6, error);
    return estimate_from_emg(with_errors, with_errors, moments, noise, {.starts = 1}, progress);
  }
  static constexpr double kMomentNoise = 0.05;
  test::MovedArm arm{load_model("arm").model(), PathSource::kFitted, kGains, {{MuscleOutputKind::kMoment, 1, 0.0}}};
  EmgDrivenModel model;
  std::vector<estimation::RowMatrix> measured;
};

const RecordedArm& recorded_arm() {
  static const RecordedArm recording;
  return recording;
}

const Eigen::VectorXd kStated = Eigen::VectorXd::Constant(1, RecordedArm::kMomentNoise);

TEST(EmgEstimate, FindsTheGainsWithinTheIntervalsOfTheMomentsNoise) {
  const RecordedArm& r = recorded_arm();
  const EmgEstimate e = r.estimated(kStated, {.relative = 0.0});
  ASSERT_TRUE(e.estimate.usable()) << e.estimate.best.message;
  EXPECT_EQ(e.noise, kStated);
  ASSERT_EQ(e.input_share.size(), 1U);
  EXPECT_NEAR(e.input_share[0], 0.0, 1e-12) << "exact EMG";
  for (std::size_t i = 0; i < 2; ++i) {
    const estimation::Parameter& p = e.estimate.best.parameters[i];
    EXPECT_LT(std::abs(p.value - r.hidden()(signed_index(i))), 4.0 * p.sigma) << p.name;
    EXPECT_EQ(p.status, estimation::ParameterStatus::kIdentified) << p.name;
    EXPECT_LT(p.sigma, 0.05) << "and they are narrow";
  }
  // The residuals are in units of the noise.
  EXPECT_NEAR(e.estimate.chi_square, 1.0, 0.5);
}

TEST(EmgEstimate, IsLessSureWhereTheEmgHasAnError) {
  const RecordedArm& r = recorded_arm();
  const EmgEstimate exact = r.estimated(kStated, {.relative = 0.0}), noisy = r.estimated(kStated, {.relative = 0.1});
  ASSERT_TRUE(exact.estimate.usable() && noisy.estimate.usable());
  EXPECT_GT(noisy.input_share[0], 0.5) << "most of the residual's variance is then the EMG's";
  EXPECT_LT(noisy.input_share[0], 1.0);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_GT(noisy.estimate.best.parameters[i].sigma, 1.5 * exact.estimate.best.parameters[i].sigma);
  // Twice the error of the EMG, twice the interval, as far as it is the EMG's.
  const EmgEstimate worse = r.estimated(kStated, {.relative = 0.2});
  EXPECT_GT(worse.estimate.best.parameters[0].sigma, 1.4 * noisy.estimate.best.parameters[0].sigma);
  EXPECT_GT(worse.input_share[0], noisy.input_share[0]);
}

// 1/2 sum (z - y(theta, c))^2/sigma^2 + 1/2 sum (c/f)^2
TEST(EmgEstimate, FindsErrorsThatMakeTheRecordingLikelier) {
  const RecordedArm& r = recorded_arm();
  const EmgDrivenModel model = r.arm.along(10, 1e-6, {.relative = 0.1});
  const EmgEstimate e = r.estimated(kStated, {.relative = 0.1});
  ASSERT_TRUE(e.estimate.usable());
  const Eigen::VectorXd found = e.about->errors()[0];
  ASSERT_EQ(found.size(), model.errors(0));
  const auto cost = [&](double share) {
    Eigen::VectorXd theta(2 + found.size());
    theta << e.estimate.best.theta, share * found;
    estimation::ModelResponse response;
    EXPECT_TRUE(model.respond(0, theta, {}, response));
    double sum = (r.measured[0] - response.output).squaredNorm() / std::pow(RecordedArm::kMomentNoise, 2);
    const std::vector<int> part = model.error_parts(0);
    for (Eigen::Index i = 0; i < found.size(); ++i) sum += std::pow(share * found(i) / e.error_factors(part[at(i)]), 2);
    return 0.5 * sum;
  };
  EXPECT_LT(cost(1.0), cost(0.0) - 3.0) << "than as it was recorded";
  EXPECT_LT(cost(1.0), cost(1.5));
}

TEST(EmgEstimate, FindsHowLargeTheErrorsOfTheEmgAre) {
  const RecordedArm& r = recorded_arm();
  const EmgEstimate exact = r.estimated(kStated, {.relative = 0.1});
  ASSERT_EQ(exact.error_factors.size(), kEmgErrorParts);
  EXPECT_LT(exact.error_factors.maxCoeff(), 1.0) << "this EMG is exact";
  // It is not where a moment is 30 % larger for a while.
  std::vector<estimation::RowMatrix> wrong = r.measured;
  wrong[0].middleRows(20, 25) *= 1.3;
  const EmgEstimate more = r.estimated(kStated, {.relative = 0.01}, wrong);
  ASSERT_TRUE(more.estimate.usable());
  EXPECT_GT(more.error_factors.maxCoeff(), 1.1);
}

TEST(EmgEstimate, FindsTheNoiseThatIsNotStated) {
  const EmgEstimate e = recorded_arm().estimated({}, {.relative = 0.0});
  ASSERT_TRUE(e.estimate.usable()) << e.estimate.best.message;
  ASSERT_EQ(e.noise.size(), 1);
  // 71 values: their standard deviation is known to 8 %.
  EXPECT_NEAR(e.noise(0), RecordedArm::kMomentNoise, 0.25 * RecordedArm::kMomentNoise);
}

TEST(EmgEstimate, WhitensWhatWasMeasured) {
  const RecordedArm& r = recorded_arm();
  const EmgEstimate e = r.estimated(kStated, {.relative = 0.0});
  ASSERT_TRUE(e.model != nullptr);
  ASSERT_EQ(e.measured.size(), 1U);
  // With exact EMG whitening divides by the noise.
  for (Eigen::Index k = 0; k < e.measured[0].rows(); ++k)
    EXPECT_NEAR(std::abs(e.measured[0](k, 0)), std::abs(r.measured[0](k, 0)) / RecordedArm::kMomentNoise, 1e-9) << k;
}

}  // namespace
}  // namespace veridyn::muscle
