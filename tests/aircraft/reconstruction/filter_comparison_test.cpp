#include "veridyn/aircraft/reconstruction/filter_comparison.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/aircraft/simulated_flight.hpp"
#include "veridyn/aircraft/reconstruction/information_bound.hpp"

namespace veridyn::aircraft {
namespace {

// The errors are those of the reconstructions alone, and the bounds those of the flight's turbulence and sensors.
TEST(FilterComparison, HoldsTheErrorsOfBothFiltersAgainstTheTruth) {
  const aircraft::testing::Flown flown = aircraft::testing::fly({.duration = 40.0});
  ReconstructOptions o = aircraft::testing::reference_options();
  o.keep_filter = false;
  Progress silent;
  const std::vector<FilterError> errors = compare_filters(flown.measured, flown.truth, o, flown.subject, silent);
  ASSERT_EQ(errors.size(), 6U);
  o.keep_filter = true;
  const Reconstruction free = aircraft::testing::reconstructed(flown, o);
  o.filter = FilterKind::kModelBased;
  const Reconstruction based = aircraft::testing::reconstructed(flown, o);
  for (const char* quantity : {"airspeed", "alpha", "beta"}) {
    const auto error = std::ranges::find(errors, quantity, &FilterError::quantity);
    ASSERT_NE(error, errors.end()) << quantity;
    const auto rms = [&](const Recording& estimate) {
      return aircraft::testing::rms_error(estimate, flown.truth, quantity);
    };
    // The test's own count of the first ten seconds differs by a sample.
    EXPECT_NEAR(error->model_free.smoother_rms, rms(free.smoothed), 1e-3 * rms(free.smoothed)) << quantity;
    EXPECT_NEAR(error->model_free.filter_rms, rms(free.filtered), 1e-3 * rms(free.filtered)) << quantity;
    EXPECT_NEAR(error->model_based.smoother_rms, rms(based.smoothed), 1e-3 * rms(based.smoothed)) << quantity;
    EXPECT_LT(error->model_based.smoother_rms, error->model_based.filter_rms) << quantity;
    EXPECT_GT(error->signal_sd, error->model_free.smoother_rms) << quantity;
    EXPECT_LE(std::abs(error->model_free.smoother_bias), error->model_free.smoother_rms) << quantity;
  }
  const FilterError& alpha = *std::ranges::find(errors, "alpha", &FilterError::quantity);
  double airspeed = 0.0;
  for (const double v : free.smoothed.at("airspeed").value)
    airspeed += v / static_cast<double>(free.smoothed.at("airspeed").size());
  const AngleBound bound = information_bound(free.turbulence, airspeed, free.sigma.alpha, 100.0).alpha;
  EXPECT_NEAR(alpha.model_free.smoother_bound, bound.smoother, 1e-6);
  EXPECT_NEAR(alpha.model_free.filter_bound, bound.filter, 1e-6);
  EXPECT_LT(alpha.model_based.smoother_bound, alpha.model_free.smoother_bound) << "who knows the aircraft knows more";
  EXPECT_EQ(errors.back().quantity, "wind_total_down");
  EXPECT_EQ(errors.back().unit, "m/s");
  EXPECT_EQ(errors.back().model_free.filter_bound, 0.0) << "there is no bound of the wind";
}

}  // namespace
}  // namespace veridyn::aircraft
