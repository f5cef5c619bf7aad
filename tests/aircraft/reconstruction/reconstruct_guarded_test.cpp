#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/aircraft/simulated_flight.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_solve.hpp"

namespace veridyn::aircraft {
namespace {

/// The three reconstructions of one flight.
struct ThreeWays {
  explicit ThreeWays(double lift_factor) {
    aircraft::testing::Flown flown = aircraft::testing::fly({.duration = 40.0, .seed = 4});
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

TEST(GuardedReconstruction, OfARightModelIsTheModelBasedOne) {
  const ThreeWays flight(1.0);
  ASSERT_TRUE(flight.guarded.guard);
  const std::vector<double>& used = flight.guarded.filtered.at("model_based").value;
  ASSERT_TRUE(std::ranges::all_of(used, [](double u) { return u == 1.0; }));
  for (const char* name : {"alpha", "airspeed", "sigma_beta", "gyro_bias_x", "CL_error"})
    EXPECT_EQ(flight.guarded.smoothed.at(name).value, flight.based.smoothed.at(name).value) << name;
}

// Where the model was distrusted, and for three seconds around, the smoothed estimate is the model-free one; sensor
// errors, one estimate over the whole flight, are the model-free filter's throughout.
TEST(GuardedReconstruction, OfAWrongModelIsTheModelFreeOneAroundTheDistrust) {
  const ThreeWays flight(0.5);
  ASSERT_TRUE(flight.guarded.guard);
  const std::vector<double>& used = flight.guarded.filtered.at("model_based").value;
  const auto stamps = flight.guarded.smoothed.at("alpha").times();
  ASSERT_EQ(used.size(), stamps.size());
  ASSERT_TRUE(std::ranges::any_of(used, [](double u) { return u == 0.0; })) << "half the lift is to be noticed";
  std::size_t from_free = 0, from_based = 0;
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    double nearest = 1e9;
    for (std::size_t j = 0; j < used.size(); ++j)
      if (used[j] == 0.0) nearest = std::min(nearest, std::abs(stamps[j] - stamps[k]));
    const bool distrusted = nearest < internal::kGuardMargin_s;
    ++(distrusted ? from_free : from_based);
    const Reconstruction& expected = distrusted ? flight.free : flight.based;
    for (const char* name : {"alpha", "sigma_alpha", "wind_north", "gust_z"})
      ASSERT_EQ(flight.guarded.smoothed.at(name).value[k], expected.smoothed.at(name).value[k]) << name << " " << k;
    ASSERT_EQ(flight.guarded.smoothed.at("gyro_bias_x").value[k], flight.free.smoothed.at("gyro_bias_x").value[k]);
  }
  EXPECT_GT(from_free, 0U);
  // The causal estimate is the active filter's at every moment.
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    if (used[k] != 0.0) continue;
    ASSERT_EQ(flight.guarded.filtered.at("alpha").value[k], flight.free.filtered.at("alpha").value[k]) << k;
  }
}

}  // namespace
}  // namespace veridyn::aircraft
