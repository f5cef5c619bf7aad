#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/aircraft/simulated_flight.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_solve.hpp"

namespace veridyn::aircraft {
namespace {

/// The three reconstructions of one flight, by a model of so much of the aircraft's lift.
struct ThreeWays {
  explicit ThreeWays(aircraft::testing::Flown flown, double lift_factor = 1.0) {
    for (double& value : flown.subject.model.find(Coefficient::kCL)->values) value *= lift_factor;
    ReconstructOptions o = aircraft::testing::reference_options();
    o.gyro_bias = true;
    free = aircraft::testing::reconstructed(flown, o);
    o.filter = FilterKind::kModelBased;
    based = aircraft::testing::reconstructed(flown, o);
    o.filter = FilterKind::kGuarded;
    guarded = aircraft::testing::reconstructed(flown, o);
  }
  Reconstruction free, based, guarded;
};

aircraft::testing::Flown forty_seconds() { return aircraft::testing::fly({.duration = 40.0, .seed = 4}); }

TEST(GuardedReconstruction, OfARightModelIsTheModelBasedOne) {
  const ThreeWays flight(forty_seconds());
  ASSERT_TRUE(flight.guarded.guard);
  const std::vector<double>& used = flight.guarded.filtered.at("model_based").value;
  ASSERT_TRUE(std::ranges::all_of(used, [](double u) { return u == 1.0; }));
  for (const char* name : {"alpha", "airspeed", "sigma_beta", "gyro_bias_x", "CL_error"})
    EXPECT_EQ(flight.guarded.smoothed.at(name).value, flight.based.smoothed.at(name).value) << name;
}

// Where the model was distrusted, and for three seconds around, the smoothed estimate is the model-free one, and
// nowhere else; sensor errors, one estimate over the whole flight, are the model-free filter's throughout.
void expect_free_around_distrust(const ThreeWays& flight, bool trusted_elsewhere) {
  ASSERT_TRUE(flight.guarded.guard);
  const std::vector<double>& used = flight.guarded.filtered.at("model_based").value;
  const auto stamps = flight.guarded.smoothed.at("alpha").times();
  ASSERT_EQ(used.size(), stamps.size());
  ASSERT_TRUE(std::ranges::any_of(used, [](double u) { return u == 0.0; }));
  std::size_t from_free = 0, from_based = 0;
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    double nearest = 1e9;
    for (std::size_t j = 0; j < used.size(); ++j)
      if (used[j] == 0.0) nearest = std::min(nearest, std::abs(stamps[j] - stamps[k]));
    const bool distrusted = nearest < internal::kGuardMargin_s;
    ++(distrusted ? from_free : from_based);
    for (const char* name : {"alpha", "sigma_alpha", "wind_north", "gust_z"}) {
      const double value = flight.guarded.smoothed.at(name).value[k], free = flight.free.smoothed.at(name).value[k];
      ASSERT_EQ(value == free, distrusted) << name << " at " << stamps[k];
    }
    ASSERT_EQ(flight.guarded.smoothed.at("gyro_bias_x").value[k], flight.free.smoothed.at("gyro_bias_x").value[k]);
  }
  EXPECT_GT(from_free, 0U);
  EXPECT_EQ(from_based > 0, trusted_elsewhere);
  ASSERT_EQ(flight.guarded.sensor_errors.size(), flight.free.sensor_errors.size());
  for (std::size_t i = 0; i < flight.free.sensor_errors.size(); ++i) {
    EXPECT_EQ(flight.guarded.sensor_errors[i].value, flight.free.sensor_errors[i].value) << i;
    EXPECT_EQ(flight.guarded.sensor_errors[i].sigma, flight.free.sensor_errors[i].sigma) << i;
  }
  // The causal estimate is the active filter's at every moment.
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    if (used[k] != 0.0) continue;
    ASSERT_EQ(flight.guarded.filtered.at("alpha").value[k], flight.free.filtered.at("alpha").value[k]) << k;
  }
}

TEST(GuardedReconstruction, OfAWrongModelIsTheModelFreeOneAroundTheDistrust) {
  expect_free_around_distrust(ThreeWays(forty_seconds(), 0.5), false);
}

// A vane that shows 8 deg too much for five seconds contradicts a right model: it is trusted before, and again later.
TEST(GuardedReconstruction, OfAFaultIsTheModelFreeOneAroundIt) {
  aircraft::testing::Flown flown = forty_seconds();
  Channel alpha = flown.measured.at("alpha");
  for (std::size_t i = 0; i < alpha.size(); ++i)
    if (alpha.times()[i] > 15.0 && alpha.times()[i] < 20.0) alpha.value[i] += 8.0 * kDegree;
  flown.measured.set(std::move(alpha));
  expect_free_around_distrust(ThreeWays(std::move(flown)), true);
}

}  // namespace
}  // namespace veridyn::aircraft
