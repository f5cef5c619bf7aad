#include "veridyn/estimation/recursive/parameter_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/refusal.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::estimation {
namespace {

constexpr double kRate = 8.0;

/// Rows z = x theta + e of a regressor of unit power and noise of a standard deviation, judged by an estimate of 1.
struct Rows {
  double theta = 1.0;
  double noise = 0.5;
  double scale = 1.0;            ///< of the regressor
  double regressor_noise = 0.0;  ///< of what is seen of it
};

/// Watches rows from `begin` [s] on, and says when alarms were raised.
std::vector<Change> watched(ParameterWatch& watch, numerics::RandomStream& random, const Rows& rows, double begin_s,
                            double duration_s) {
  std::vector<Change> changes;
  const auto count = static_cast<int>(duration_s * kRate);
  for (int k = 0; k < count; ++k) {
    const double x = rows.scale * random.normal(), error = rows.regressor_noise * random.normal();
    // z = x theta + noise, seen by x + error and an estimate of 1.
    const double innovation = x * (rows.theta - 1.0) - error + rows.noise * random.normal();
    const double variance = rows.regressor_noise * rows.regressor_noise;
    const RowNoise noise{.regressor = variance, .shared = -variance};
    if (const auto change = watch.update(begin_s + k / kRate, x + error, innovation, 1.0, noise))
      changes.push_back(*change);
  }
  return changes;
}

// Lorden's bound leaves much: alarms are there, but no more than a quarter of those stated.
TEST(ParameterWatch, RaisesFewerFalseAlarmsThanStated) {
  numerics::RandomStream random(1, "watch");
  const ParameterWatchOptions options{.share = 0.5, .settle_s = 1.0, .false_alarm_interval_s = 100.0};
  // Weakly excited, as where chance is nearest to a change.
  std::size_t alarms = 0;
  for (const double noise : {1.0, 2.0, 4.0}) {
    ParameterWatch watch(options, kRate);
    constexpr double kHours = 10.0;
    const std::size_t found = watched(watch, random, {.noise = noise}, 0.0, kHours * 3600.0).size();
    EXPECT_LE(static_cast<double>(found), 0.25 * kHours * 36.0) << noise;
    alarms += found;
  }
  EXPECT_GE(alarms, 10u);
}

// Noise of the regressor alone makes its innovations go with it: straight driving is no change of grip.
TEST(ParameterWatch, IsNotMovedByNoiseOfTheRegressor) {
  numerics::RandomStream random(6, "watch");
  ParameterWatch watch({.share = 0.5, .false_alarm_interval_s = 3.6e6}, kRate);
  static_cast<void>(watched(watch, random, {.noise = 0.1, .regressor_noise = 0.05}, 0.0, 60.0));
  ASSERT_TRUE(watch.watching());
  for (const double scale : {0.0, 0.05, 0.2})
    EXPECT_TRUE(watched(watch, random, {.noise = 0.1, .scale = scale, .regressor_noise = 0.05}, 60.0, 3600.0).empty())
        << scale;
  EXPECT_FALSE(watched(watch, random, {.theta = 1.67, .noise = 0.1, .regressor_noise = 0.05}, 3660.0, 10.0).empty());
}

TEST(ParameterWatch, PausesWhereItIsTold) {
  numerics::RandomStream random(7, "watch");
  ParameterWatch watch({.share = 0.5, .settle_s = 5.0}, kRate);
  static_cast<void>(watched(watch, random, {}, 0.0, 60.0));
  watch.pause();
  EXPECT_TRUE(watched(watch, random, {.theta = 1.67, .noise = 0.1}, 60.0, 5.0).empty());
  EXPECT_FALSE(watched(watch, random, {.theta = 1.67, .noise = 0.1}, 65.0, 5.0).empty());
}

TEST(ParameterWatch, FindsAChangeEitherWayAndSaysHowLarge) {
  for (const double theta : {1.67, 0.6}) {
    numerics::RandomStream random(2, "watch");
    ParameterWatch watch({.share = 0.5}, kRate);
    EXPECT_TRUE(watched(watch, random, {.noise = 0.25}, 0.0, 100.0).empty());
    ASSERT_TRUE(watch.watching());
    const std::vector<Change> changes = watched(watch, random, {.theta = theta, .noise = 0.25}, 100.0, 9.0);
    ASSERT_EQ(changes.size(), 1u) << theta;
    EXPECT_EQ(changes[0].kind, ChangeKind::kParameter);
    EXPECT_LT(changes[0].detected_s, 104.0);
    EXPECT_NEAR(changes[0].began_s, 100.0, 2.0);
    EXPECT_NEAR(changes[0].shift, theta - 1.0, 0.3);
  }
}

// A tyre that is driven harder seems softer; however clearly the rows show that, it is no change.
TEST(ParameterWatch, TakesNothingBelowHalfOfTheShareForAChange) {
  numerics::RandomStream random(3, "watch");
  ParameterWatch watch({.share = 0.5}, kRate);
  static_cast<void>(watched(watch, random, {.noise = 0.05}, 0.0, 60.0));
  EXPECT_TRUE(watched(watch, random, {.theta = 1.2, .noise = 0.05, .scale = 3.0}, 60.0, 600.0).empty());
  EXPECT_FALSE(watched(watch, random, {.theta = 1.67, .noise = 0.05, .scale = 3.0}, 660.0, 4.0).empty());
}

TEST(ParameterWatch, IsNotMovedByRowsThatDoNotExciteIt) {
  numerics::RandomStream random(4, "watch");
  ParameterWatch watch({.share = 0.5}, kRate);
  static_cast<void>(watched(watch, random, {}, 0.0, 60.0));
  EXPECT_TRUE(watched(watch, random, {.theta = 1.67, .scale = 0.0}, 60.0, 600.0).empty());
  EXPECT_LT(watch.suspicion(), 0.5);
}

TEST(ParameterWatch, RaisesNoAlarmOnASingleBlockNorBeforeItHasLearned) {
  numerics::RandomStream random(5, "watch");
  ParameterWatch watch({.share = 0.5}, kRate);
  EXPECT_TRUE(watched(watch, random, {.theta = 3.0}, 0.0, 20.0).empty());
  ParameterWatch learned({.share = 0.5}, kRate);
  static_cast<void>(watched(learned, random, {.noise = 0.1}, 0.0, 60.0));
  // Four rows are a block.
  for (int k = 0; k < 4; ++k) EXPECT_FALSE(learned.update(60.0 + k / kRate, 50.0, 50.0, 1.0, {}).has_value());
  EXPECT_GT(learned.suspicion(), 0.5);
  EXPECT_LT(learned.suspicion(), 1.0);
}

TEST(ParameterWatch, LeavesOutWhatIsNotFinite) {
  ParameterWatch watch({.share = 0.5}, kRate);
  for (int k = 0; k < 1000; ++k) EXPECT_FALSE(watch.update(k / kRate, std::nan(""), 1.0, 1.0, {}).has_value());
  EXPECT_FALSE(watch.watching());
  EXPECT_EQ(watch.suspicion(), 0.0);
}

TEST(ParameterWatch, RefusesOptionsThatMakeNoSense) {
  const auto refused = [](const ParameterWatchOptions& options) {
    return why([&] { ParameterWatch(options, kRate); });
  };
  EXPECT_THAT(refused({.share = -0.1}), ::testing::HasSubstr("parameter_watch.share: is -0.1"));
  EXPECT_THAT(refused({.share = 0.5, .block_s = 0.0}), ::testing::HasSubstr("block_s"));
  EXPECT_THAT(refused({.share = 0.5, .learn_s = 1.0}), ::testing::HasSubstr("learn_s"));
  EXPECT_THAT(refused({.share = 0.5, .false_alarm_interval_s = 1.0}), ::testing::HasSubstr("false_alarm_interval_s"));
}

}  // namespace
}  // namespace veridyn::estimation
