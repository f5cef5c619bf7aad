#include "veridyn/aircraft/reconstruction/guarded_replay.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/aircraft/simulated_flight.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::aircraft {
namespace {

using testing::Flown;
using testing::fly;
using testing::reference_options;

const std::vector<double>& column(const Recording& r, const char* name) { return r.at(name).value; }

TEST(GuardedReplay, WithoutAModelIsTheModelFreeFilter) {
  const Flown f = fly({.duration = 40.0});
  Progress quiet;
  const Reconstruction free = reconstruct(f.measured, reference_options(), quiet);
  const Recording r = replay_guarded(f.measured, reference_options(), f.subject, {}, free.turbulence, quiet);
  for (const char* name : {"airspeed", "alpha", "beta", "sigma_alpha", "wind_north"})
    EXPECT_EQ(column(r, name), column(free.filtered, name)) << name;
  for (const double used : column(r, "model_based")) EXPECT_EQ(used, 0.0);
}

TEST(GuardedReplay, WithOneModelFromTheStartIsTheGuardedFilter) {
  const Flown f = fly({.duration = 40.0});
  ReconstructOptions o = reference_options();
  o.filter = FilterKind::kGuarded;
  const Reconstruction guarded = testing::reconstructed(f, o);
  const TimedModel known{.from_s = -kInfinity, .aero = f.subject.model, .error = {}};
  Progress quiet;
  const Recording r = replay_guarded(f.measured, o, f.subject, {&known, 1}, guarded.turbulence, quiet);
  for (const char* name : {"airspeed", "alpha", "beta", "sigma_alpha", "model_based", "guard_ratio"})
    EXPECT_EQ(column(r, name), column(guarded.filtered, name)) << name;
}

TEST(GuardedReplay, AFirstModelEarnsItsTrustAndALostOneEndsIt) {
  const Flown f = fly({.duration = 60.0});
  std::vector<TimedModel> models(2);
  models[0] = {.from_s = 20.0, .aero = f.subject.model, .error = {}};
  models[1].from_s = 50.0;
  Progress quiet;
  const ReconstructOptions o = reference_options();
  const Recording r = replay_guarded(f.measured, o, f.subject, models, o.turbulence->spectrum, quiet);
  const Channel& used = r.at("model_based");
  for (std::size_t k = 0; k < used.size(); ++k) {
    const double t = used.times()[k];
    if (t < 29.9 || t > 50.05) {
      EXPECT_EQ(used.value[k], 0.0) << t;
    }
    if (t > 32.1 && t < 49.95) {
      EXPECT_EQ(used.value[k], 1.0) << t;
    }
  }
}

TEST(GuardedReplay, AnAbsurdModelLeavesNumbersAndSoonNoTrace) {
  const Flown f = fly({.duration = 30.0});
  Progress quiet;
  const ReconstructOptions o = reference_options();
  const Reconstruction free = reconstruct(f.measured, o, quiet);
  for (const double factor : {-1e3, 1e6}) {
    TimedModel absurd{.from_s = -kInfinity, .aero = f.subject.model, .error = {}};
    for (const Coefficient c : {Coefficient::kCL, Coefficient::kCY})
      for (double& value : absurd.aero->at(c).values) value *= factor;
    const Recording r = replay_guarded(f.measured, o, f.subject, {&absurd, 1}, o.turbulence->spectrum, quiet);
    for (const char* name : {"airspeed", "alpha", "beta", "sigma_alpha", "wind_north"})
      for (const double v : column(r, name)) ASSERT_TRUE(std::isfinite(v)) << name;
    const std::size_t last = column(r, "alpha").size() - 1;
    EXPECT_EQ(column(r, "model_based")[last], 0.0);
    EXPECT_EQ(column(r, "alpha")[last], column(free.filtered, "alpha")[last]);
  }
}

TEST(GuardedReplay, RefusesErrorsThatNeedTheWholeFlight) {
  const Flown f = fly({.duration = 5.0});
  ReconstructOptions o = reference_options();
  o.alpha_bias = true;
  Progress quiet;
  EXPECT_THROW((void)replay_guarded(f.measured, o, f.subject, {}, o.turbulence->spectrum, quiet), InputError);
}

}  // namespace
}  // namespace veridyn::aircraft
