#include "veridyn/aircraft/sensors/sensors.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::aircraft {
namespace {

const SensorKind& kind(std::string_view name) {
  for (const SensorKind& k : sensor_kinds())
    if (k.name == name) return k;
  return sensor_kinds()[0];
}

/// A sensor that watches a roll angle of `roll(t)` and a rate of `t` over `duration`, at 2.5 ms.
template <typename Roll>
Recording watch(std::string_view name, const SensorSettings& s, double duration, Roll roll, std::uint64_t seed = 1) {
  Sensor sensor(kind(name), s, seed);
  const long steps = std::lround(duration / 0.0025);
  for (long k = 0; k <= steps; ++k) {
    const double t = 0.0025 * static_cast<double>(k);
    TruthSample x;
    x[Truth::kRoll] = std::remainder(roll(t), 2 * M_PI);
    x[Truth::kGyroX] = t;
    sensor.observe(t, x);
  }
  Recording r;
  sensor.move_into(r);
  return r;
}

TEST(Sensor, SamplesAtItsRateBetweenTheSteps) {
  // 30 Hz is no divisor of 400 Hz; a rate of t is a straight line, so interpolation is exact.
  const Recording r = watch("gyro", {.rate = 30.0}, 2.0, [](double) { return 0.0; });
  const Channel& c = r.at("gyro_x");
  ASSERT_EQ(c.size(), 61u);
  for (std::size_t i = 0; i < c.size(); ++i) {
    EXPECT_NEAR(c.times()[i], static_cast<double>(i) / 30.0, 1e-12);
    EXPECT_NEAR(c.value[i], c.times()[i], 1e-9);
  }
}

TEST(Sensor, StampsADelayedValueWithALaterTime) {
  const Recording r = watch("gyro", {.rate = 50.0, .delay = 0.033}, 1.0, [](double) { return 0.0; });
  const Channel& c = r.at("gyro_x");
  EXPECT_NEAR(c.times()[0], 0.04, 1e-12);
  for (std::size_t i = 0; i < c.size(); ++i) EXPECT_NEAR(c.value[i], c.times()[i] - 0.033, 1e-9);
}

TEST(Sensor, InterpolatesAnglesAcrossTheWrap) {
  const Recording r = watch("ahrs", {.rate = 30.0}, 10.0, [](double t) { return 2.0 * t; });
  const Channel& c = r.at("roll");
  for (std::size_t i = 0; i < c.size(); ++i) {
    EXPECT_NEAR(std::remainder(c.value[i] - 2.0 * c.times()[i], 2 * M_PI), 0.0, 1e-9);
  }
}

TEST(Sensor, AppliesBiasScaleAndQuantisation) {
  SensorSettings s{.rate = 100.0, .bias = {0.5, 0, 0, 0}, .scale = 0.1, .resolution = 0.25};
  const Channel c = watch("gyro", s, 5.0, [](double) { return 0.0; }).at("gyro_x");
  for (std::size_t i = 0; i < c.size(); ++i) {
    EXPECT_NEAR(
        c.value[i], 0.25 * std::round((0.5 + 1.1 * c.times()[i]) / 0.25),
        1e-7 + 0.2500001 * (std::abs(std::remainder((0.5 + 1.1 * c.times()[i]) / 0.25 - 0.5, 1.0)) < 1e-6 ? 1.0 : 0.0));
  }
}

TEST(Sensor, HasTheGivenNoiseAndWalk) {
  // Roll axis: truth 0. 30001 samples: relative standard error of a variance sqrt(2/30000) = 0.8 %.
  const Channel c =
      watch("ahrs", {.rate = 100.0, .sigma = {0.2, 0, 0, 0}}, 300.0, [](double) { return 0.0; }).at("roll");
  double sum = 0, lag = 0;
  for (std::size_t i = 1; i < c.size(); ++i) {
    sum += c.value[i] * c.value[i];
    lag += c.value[i] * c.value[i - 1];
  }
  const double n = static_cast<double>(c.size() - 1);
  EXPECT_NEAR(sum / n, 0.04, 4 * 0.008 * 0.04);
  EXPECT_NEAR(lag / n, 0.0, 4 * 0.04 / std::sqrt(n));
  // A walk of 0.01 a second after 4 s, 400 flights: 0.02 with a relative standard error of 3.5 %.
  double walk = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const double end = watch(
                           "ahrs", {.rate = 20.0, .walk = 0.01}, 4.0, [](double) { return 0.0; }, seed)
                           .at("roll")
                           .value.back();
    walk += end * end;
  }
  EXPECT_NEAR(std::sqrt(walk / 400), 0.02, 4 * 0.035 * 0.02);
}

TEST(Sensor, DropsTheGivenShareOfSamples) {
  for (const double length : {0.0, 0.5}) {
    const Channel c = watch("gyro", {.rate = 100.0, .dropout = 0.2, .dropout_duration = length}, 2000.0, [](double) {
                        return 0.0;
                      }).at("gyro_x");
    // Runs of 50 samples leave about 200000 * 0.2 / 50 = 800 losses: relative standard error of the share 4 %.
    EXPECT_NEAR(1.0 - static_cast<double>(c.size()) / 200001.0, 0.2, length > 0.0 ? 4 * 0.04 * 0.2 : 0.005);
    if (length > 0.0) {
      EXPECT_GT(c.gaps(1.0).size(), 50u);
    }
  }
}

// A roll rate of t through a first-order lag: t - T (1 - e^(-t/T)); and an oscillation through a vane.
TEST(Sensor, FollowsByItsOwnDynamics) {
  const Channel lagged =
      watch("gyro", {.rate = 50.0, .time_constant = 0.1}, 2.0, [](double) { return 0.0; }).at("gyro_x");
  for (std::size_t i = 0; i < lagged.size(); ++i) {
    const double t = lagged.times()[i];
    EXPECT_NEAR(lagged.value[i], t - 0.1 * (1.0 - std::exp(-t / 0.1)), 1e-9);
  }
  constexpr double kW = 6.0, kNatural = 20.0, kDamping = 0.3;
  const Channel vane = watch("ahrs", {.rate = 50.0, .frequency = kNatural, .damping = kDamping}, 10.0, [](double t) {
                         return 3.1 + 0.2 * std::sin(kW * t);
                       }).at("roll");  // across +-180 deg
  const double x = kW / kNatural, gain = 1.0 / std::hypot(1.0 - x * x, 2.0 * kDamping * x);
  const double phase = std::atan2(2.0 * kDamping * x, 1.0 - x * x);
  for (std::size_t i = vane.size() / 2; i < vane.size(); ++i) {
    const double expected = 3.1 + 0.2 * gain * std::sin(kW * vane.times()[i] - phase);
    // The truth is a straight line in each step of 2.5 ms: h^2/8 w^2 0.2 = 6e-6.
    EXPECT_NEAR(std::remainder(vane.value[i] - expected, 2 * M_PI), 0.0, 1e-5);
  }
}

TEST(Sensor, JitterIsOfTheStampsAlone) {
  const Channel c =
      watch("gyro", {.rate = 50.0, .delay = 0.04, .jitter = 0.002}, 400.0, [](double) { return 0.0; }).at("gyro_x");
  double squares = 0.0;
  for (std::size_t i = 0; i < c.size(); ++i) {
    EXPECT_NEAR(c.value[i], 0.02 * static_cast<double>(i), 1e-9) << "a rate of t, taken at its rate";
    if (i > 0) {
      EXPECT_GT(c.times()[i], c.times()[i - 1]);
    }
    squares += std::pow(c.times()[i] - c.value[i] - 0.04, 2) / static_cast<double>(c.size());
  }
  EXPECT_NEAR(std::sqrt(squares), 0.002, 4.0 * 0.002 / std::sqrt(2.0 * 20000.0));
}

/// Allan variance of a channel over m samples, overlapping.
double allan_variance(const std::vector<double>& x, std::size_t m) {
  std::vector<double> sum(x.size() + 1, 0.0);
  for (std::size_t i = 0; i < x.size(); ++i) sum[i + 1] = sum[i] + x[i];
  double total = 0.0;
  const std::size_t count = x.size() - 2 * m + 1;
  for (std::size_t i = 0; i < count; ++i) {
    const double d = (sum[i + 2 * m] - 2.0 * sum[i + m] + sum[i]) / static_cast<double>(m);
    total += 0.5 * d * d;
  }
  return total / static_cast<double>(count);
}

// White noise of density S has the Allan variance S/tau, a random walk of K^2 s^-1 has K^2 tau/3 (IEEE 952, annex C).
TEST(Sensor, HasTheAllanVarianceOfWhiteNoiseAndOfARandomWalk) {
  const Channel white =
      watch("ahrs", {.rate = 50.0, .sigma = {0.2, 0, 0, 0}}, 1000.0, [](double) { return 0.0; }).at("roll");
  for (const std::size_t m : {1U, 10U, 100U}) {
    const double expected = 0.04 / static_cast<double>(m);
    // Overlapping estimate over N/m independent stretches: relative standard error about sqrt(m/N).
    const double error = std::sqrt(static_cast<double>(m) / static_cast<double>(white.size()));
    EXPECT_NEAR(allan_variance(white.value, m), expected, 4.0 * 1.5 * error * expected) << m;
  }
  const Channel walk = watch("ahrs", {.rate = 50.0, .walk = 0.003}, 1000.0, [](double) { return 0.0; }).at("roll");
  for (const std::size_t m : {20U, 100U, 400U}) {
    const double tau = static_cast<double>(m) / 50.0;
    // Sums of a discrete walk: K^2 tau/3 (1 + 1/(2 m^2)).
    const double expected = 0.003 * 0.003 * tau / 3.0 * (1.0 + 0.5 / static_cast<double>(m * m));
    const double error = std::sqrt(static_cast<double>(m) / static_cast<double>(walk.size()));
    EXPECT_NEAR(allan_variance(walk.value, m), expected, 4.0 * 1.5 * error * expected) << m;
  }
}

// The error of rounding a signal that crosses many steps is uniform: variance step^2/12, mean 0 (Widrow).
TEST(Sensor, HasTheQuantisationNoiseOfAUniformError) {
  const Channel c = watch("gyro", {.rate = 97.0, .resolution = 0.05}, 400.0, [](double) { return 0.0; }).at("gyro_x");
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double error = c.value[i] - c.times()[i];
    EXPECT_LE(std::abs(error), 0.025 + 1e-9);
    sum += error;
    squares += error * error;
  }
  const auto n = static_cast<double>(c.size());
  EXPECT_NEAR(sum / n, 0.0, 4.0 * 0.05 / std::sqrt(12.0 * n));
  EXPECT_NEAR(squares / n, 0.05 * 0.05 / 12.0, 0.02 * 0.05 * 0.05 / 12.0);
}

}  // namespace
}  // namespace veridyn::aircraft
