#include "veridyn/recording/grid_signals.hpp"

#include <cmath>
#include <numbers>

#include "tests/io/support.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::recording {
namespace {

using ::testing::HasSubstr;
using testing::message_of;

Channel channel(std::vector<double> stamps, std::vector<double> values, const char* unit = "rad/s") {
  return make_channel("gyro_x", unit, make_time_base(std::move(stamps)), std::move(values));
}

/// `seconds` of f(t) at `rate`.
template <typename F>
Channel sampled(double rate, double seconds, F f) {
  std::vector<double> stamps, values;
  for (std::size_t k = 0; static_cast<double>(k) <= rate * seconds; ++k) {
    stamps.push_back(static_cast<double>(k) / rate);
    values.push_back(f(stamps.back()));
  }
  return channel(std::move(stamps), std::move(values));
}

enum class Two : std::size_t { kFirst, kSecond };

TEST(GridSignals, IndicesOfASpanCountTheMomentsOnItsBorders) {
  GridSignals<Two, 2> s;
  s.grid = {10.0, 0.1, 101};
  EXPECT_EQ(s.indices({10.5, 11.0}), (std::pair<std::size_t, std::size_t>{5, 11}));
  EXPECT_EQ(s.indices({10.51, 10.99}), (std::pair<std::size_t, std::size_t>{6, 10}));
  EXPECT_EQ(s.indices({0.0, 1e9}), (std::pair<std::size_t, std::size_t>{0, 101}));
  s[Two::kSecond].value = {1.0};
  EXPECT_TRUE(s.signals[1].available());
  EXPECT_FALSE(s[Two::kFirst].available());
}

TEST(GridSignals, RateIsTheChosenOneOrThatOfTheSensorUpToAHundredHertz) {
  const Channel slow = sampled(49.9, 10.0, [](double) { return 0.0; });
  const Channel fast = sampled(400.0, 10.0, [](double) { return 0.0; });
  EXPECT_EQ(grid_rate(slow), 50.0);
  EXPECT_EQ(grid_rate(fast), 100.0);
  EXPECT_EQ(grid_rate(fast, 250.0), 250.0);
}

TEST(GridSignals, RefusesAGridThatOnlyStampsInAnotherUnitNeed) {
  // Microseconds called seconds: 60 s become two years.
  const Channel wrong = channel({0.0, 6e7}, {0.0, 0.0});
  EXPECT_EQ(message_of([&] { (void)grid_over(wrong, 100.0, "flight.csv"); }),
            "flight.csv: its gyro_x spans 6e+07 s, at 100 Hz more than 10000000 samples: are its stamps in another "
            "unit? (key `unit` of [data.time])");
  EXPECT_EQ(grid_over(channel({1.0, 2.0}, {0.0, 0.0}), 100.0, "flight.csv").count, 101u);
}

TEST(GridSignals, HoleOfASecondIsAHoleAndASlowSensorIsInterpolated) {
  const numerics::UniformGrid grid{0.0, 0.1, 60};
  const Channel gap = channel({0.0, 0.1, 0.2, 0.3, 1.3, 1.4, 1.5}, {0, 0, 0, 0, 0, 0, 0});
  EXPECT_TRUE(std::isnan(on_grid(gap, grid)[8]));
  EXPECT_EQ(on_grid(gap, grid)[2], 0.0);
  const Channel slow = channel({0.0, 1.0, 2.0, 3.0}, {0.0, 1.0, 2.0, 3.0});
  EXPECT_NEAR(on_grid(slow, grid)[5], 0.5, 1e-12);
  // By the sensor's rate 0.4 s are a hole in 0.01 s, half a second is the shortest otherwise.
  const Channel fast = channel({0.0, 0.01, 0.02, 0.03, 0.43, 0.44}, {0, 0, 0, 0, 0, 0});
  const numerics::UniformGrid fine{0.0, 0.01, 45};
  EXPECT_EQ(on_grid(fast, fine)[20], 0.0);
  EXPECT_TRUE(std::isnan(on_grid(fast, fine, Holes::kOfTheSensor)[20]));
}

TEST(GridSignals, AnglesAreUnwrappedBeforeTheyAreInterpolated) {
  const double almost = std::numbers::pi - 0.1;
  const Channel yaw = channel({0.0, 0.1, 0.2}, {almost, -almost, -almost + 0.2}, "rad");
  const std::vector<double> values = angle_on_grid(yaw, {0.0, 0.05, 5});
  EXPECT_NEAR(values[1], std::numbers::pi, 0.05);
  EXPECT_GT(values[4], values[2]);
}

TEST(GridSignals, NoiseFloorIsThatOfTheWhiteNoiseUnderATailOfTheSignal) {
  // A slow motion and a random walk, whose density falls with the square of the frequency, under white noise of 0.02.
  numerics::RandomStream noise(7, "noise"), walk(7, "walk");
  double position = 0.0;
  const Channel gyro = sampled(100.0, 300.0, [&](double t) {
    position += 0.01 * walk.normal();
    return std::sin(t) + position + 0.02 * noise.normal();
  });
  EXPECT_NEAR(noise_floor(gyro), 0.02, 0.002);
  EXPECT_EQ(noise_floor(channel({0.0}, {1.0})), 0.0);
}

// Between two samples there is less noise than at either, so that values interpolated over lost rows show too little.
TEST(GridSignals, NoiseFloorIsThatOfTheSamplesWhereverTheirStampsAre) {
  numerics::RandomStream random(5, "noise");
  std::vector<double> stamps, values, kept_stamps, kept;
  for (std::size_t k = 0; k < 12000; ++k) {
    const double t = 0.0043 + 0.01 * static_cast<double>(k);
    stamps.push_back(t);
    values.push_back(0.3 * std::sin(4.0 * t) + 0.02 * random.normal());
    if (random.uniform() < 0.2) continue;
    kept_stamps.push_back(t);
    kept.push_back(values.back());
  }
  EXPECT_NEAR(noise_floor(channel(stamps, values)), 0.02, 0.001);
  EXPECT_NEAR(noise_floor(channel(kept_stamps, kept)), 0.02, 0.001);
}

TEST(GridSignals, GivenNoiseIsReadByStandardNameAndInItsUnit) {
  const std::vector<StandardChannel> known{{"alpha", "rad"}, {"gyro_x", "rad/s"}};
  const Study study = Study::parse("[noise]\nalpha = '1 deg'\n", "study.toml", ".");
  const GivenNoise given = read_noise(study.root().table("noise"), known);
  EXPECT_NEAR(given_noise(given, "alpha").value(), std::numbers::pi / 180.0, 1e-15);
  EXPECT_FALSE(given_noise(given, "gyro_x").has_value());
  const Study wrong = Study::parse("[noise]\nalpha = -1\n", "study.toml", ".");
  EXPECT_THAT(message_of([&] { (void)read_noise(wrong.root().table("noise"), known); }), HasSubstr("alpha"));
}

}  // namespace
}  // namespace veridyn::recording
