#include "veridyn/aircraft/reconstruction/guarded_filter.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/aircraft/simulated_flight.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

using testing::Flown;
using testing::fly;
using testing::reconstructed;
using testing::reference_options;

Subject with_wrong_lift(Subject s, double factor) {
  CoefficientModel& lift = s.model.at(Coefficient::kCL);
  for (std::size_t i = 0; i < lift.size(); ++i) {
    if (lift.terms[i].expression == "alpha") lift.values[i] *= factor;
  }
  return s;
}

TEST(GuardedFilter, StaysWithARightModel) {
  Flown f = fly({.duration = 90.0, .seed = 3});
  ReconstructOptions o = reference_options();
  o.filter = FilterKind::kGuarded;
  const Reconstruction r = reconstructed(f, o);
  EXPECT_EQ(r.guard->reverts, 0U);
  EXPECT_EQ(r.guard->model_based_share, 1.0);
  EXPECT_LT(testing::rms_error(r.filtered, f.truth, "alpha"), 0.12 * kDegree);
}

TEST(GuardedFilter, RevertsFromAWrongModelAndIsThenAsGoodAsTheModelFreeFilter) {
  Flown f = fly({.duration = 60.0, .seed = 2});
  ReconstructOptions o = reference_options();
  o.filter = FilterKind::kGuarded;
  const Subject wrong = with_wrong_lift(f.subject, 2.0);
  Progress quiet;
  const Reconstruction r = reconstruct(f.measured, o, quiet, &wrong);
  ASSERT_FALSE(r.guard->model_free.empty());
  EXPECT_LE(r.guard->model_free.front().begin, 2.0) << "two windows";
  EXPECT_LT(r.guard->model_based_share, 0.1);
  o.filter = FilterKind::kModelFree;
  const Reconstruction free = reconstructed(f, o);
  for (const char* name : {"alpha", "beta", "airspeed"}) {
    EXPECT_LE(testing::rms_error(r.filtered, f.truth, name), 1.001 * testing::rms_error(free.filtered, f.truth, name));
    EXPECT_LE(testing::rms_error(r.smoothed, f.truth, name), 1.05 * testing::rms_error(free.smoothed, f.truth, name));
  }
  o.filter = FilterKind::kModelBased;
  const Reconstruction trusting = reconstruct(f.measured, o, quiet, &wrong);
  EXPECT_GT(testing::rms_error(trusting.filtered, f.truth, "alpha"),
            1.2 * testing::rms_error(free.filtered, f.truth, "alpha"))
      << "without the guard the wrong model does harm";
}

class GuardSoak : public ::testing::TestWithParam<int> {};
TEST_P(GuardSoak, NeverDistrustsARightModelInTenMinutes) {
  if (std::getenv("VERIDYN_SOAK") == nullptr) GTEST_SKIP() << "long-running test; set VERIDYN_SOAK=1 to run it";
  Flown f = fly({.duration = 600.0, .seed = static_cast<std::uint64_t>(GetParam())});
  ReconstructOptions o = reference_options();
  o.filter = FilterKind::kGuarded;
  EXPECT_EQ(reconstructed(f, o).guard->reverts, 0U);
}
INSTANTIATE_TEST_SUITE_P(Seeds, GuardSoak, ::testing::Range(1, 11));

}  // namespace
}  // namespace veridyn::aircraft
