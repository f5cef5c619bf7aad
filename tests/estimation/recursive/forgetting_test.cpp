#include "veridyn/estimation/recursive/forgetting.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "veridyn/core/error.hpp"

namespace veridyn::estimation {
namespace {

TEST(Forgetting, CutsOffAfterTheTimeOfTheClosedForm) {
  EXPECT_NEAR(cut_off_time(0.9997, 100.0), 99.84, 0.005);  // the source prints 99.8 s
  EXPECT_NEAR(cut_off_time(0.9997 * 0.9997, 100.0), 49.92, 0.005);
  EXPECT_TRUE(std::isinf(cut_off_time(1.0, 100.0)));
  // By counting.
  double weight = 1.0;
  int samples = 0;
  for (; weight > 0.05; ++samples) weight *= 0.99;
  EXPECT_NEAR(cut_off_time(0.99, 10.0), 0.1 * samples, 0.1);
}

TEST(Forgetting, WeightsRowsBySquareOfLambdaOnRequest) {
  ForgettingOptions options{.lambda = 0.99, .row_weight = true};
  EXPECT_DOUBLE_EQ(options.square_weight(), 0.9801);
  VariableForgetting forgetting(options, 3);
  EXPECT_DOUBLE_EQ(forgetting.update(1.0, 0.1), 0.9801);
}

TEST(Forgetting, TriggersOftenOnWhiteNoiseWithThePublishedWindowAndNeverWithTheDefaults) {
  // 300 s at 100 Hz, four parameters. The source reports about 7 (gamma 1.5) and 90 (1.3) with K_a = 2 and leaves K_b
  // open; a direct simulation of the printed recursion by exponential windows gives the same counts as ours below.
  ForgettingOptions published{.variable = true, .K_a = 2.0, .K_b = 12.0, .gamma = 1.5};
  const double at_1_5 = 300.0 * false_trigger_rate(published, 4, 100.0).per_second;
  published.gamma = 1.3;
  const double at_1_3 = 300.0 * false_trigger_rate(published, 4, 100.0).per_second;
  EXPECT_GT(at_1_5, 3.0);
  EXPECT_LT(at_1_5, 15.0);
  EXPECT_GT(at_1_3, 90.0);
  const FalseTriggerRate standard = false_trigger_rate({.variable = true}, 4, 100.0);
  EXPECT_TRUE(standard.bound);
  EXPECT_NEAR(standard.per_second, 3.0 / 40000.0, 1e-12);

  // The same recursion written again, on other noise: counts agree within three Poisson deviations.
  std::mt19937_64 generator(5);
  std::normal_distribution<double> normal;
  double r2 = 1.0, e2 = 1.0;
  int count = 0;
  bool before = false;
  for (int k = 0; k < 1000000; ++k) {
    const double e = normal(generator);
    r2 = (1.0 - 1.0 / 8.0) * r2 + e * e / 8.0;
    e2 = (1.0 - 1.0 / 48.0) * e2 + e * e / 48.0;
    const bool now = k >= 48 && std::sqrt(r2) > 1.3 * std::sqrt(e2);
    count += now && !before ? 1 : 0;
    before = now;
  }
  const double expected = at_1_3 * 1e6 / 30000.0;
  EXPECT_NEAR(count, expected, 3.0 * std::sqrt(1.5 * expected));
}

TEST(Forgetting, DropsToItsLeastValueAfterAJumpAndComesBack) {
  const ForgettingOptions options{.variable = true};
  VariableForgetting forgetting(options, 4);
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 1000; ++k) ASSERT_EQ(forgetting.update(normal(generator), 1e-3), options.lambda);
  double least = 1.0;
  for (int k = 0; k < 20; ++k) least = std::min(least, forgetting.update(5.0 * normal(generator), 1e-3));
  EXPECT_EQ(least, options.lambda_min);
  EXPECT_EQ(forgetting.triggers(), 1u);
  double last = 0.0;
  for (int k = 0; k < 1000; ++k) last = forgetting.update(normal(generator), 1e-3);
  EXPECT_EQ(last, options.lambda);
}

TEST(Forgetting, NamesTheOptionThatIsWrong) {
  const auto message = [](const ForgettingOptions& options) -> std::string {
    try {
      options.validate();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message({}), "");
  EXPECT_EQ(message({.lambda = 0.0}), "forgetting.lambda: is 0; must be in (0, 1]");
  EXPECT_EQ(message({.lambda_min = 0.9999}), "forgetting.lambda_min: is 0.9999; must be in (0, lambda]");
  EXPECT_EQ(message({.K_a = 1.0}), "forgetting.K_a: is 1; must be at least 2");
  EXPECT_EQ(message({.K_b = 10.0}), "forgetting.K_b: is 10; must be above K_a");
  EXPECT_EQ(message({.gamma = 2.0}), "forgetting.gamma: is 2; must be in (1, 2)");
}

}  // namespace
}  // namespace veridyn::estimation
