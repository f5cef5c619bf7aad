#include "veridyn/estimation/kalman/innovation_guard.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::estimation {
namespace {

/// Feeds sound innovations of three sensors at 100 Hz, their standard deviation times `scale` from `change` on. Returns
/// the time of the first alarm after `change`, or -1.
double first_alarm(InnovationGuard& guard, std::uint64_t seed, double duration, double change, double scale) {
  numerics::RandomStream random(seed, "guard");
  guard.restart(0.0, true);
  for (int k = 1; k <= static_cast<int>(duration * 100.0); ++k) {
    const double t = 0.01 * k;
    for (std::size_t sensor = 0; sensor < 3; ++sensor) {
      const double nu = random.normal() * (t > change && sensor == 1 ? scale : 1.0);
      guard.add(sensor, nu * nu);
    }
    static_cast<void>(guard.advance(t));
    if (guard.alarm() && t > change) return t;
  }
  return -1.0;
}

// With tolerance 1 the rate is the stated one: over 40 hours at 20 an hour 800 are expected, +-3 sigma of Poisson.
TEST(InnovationGuard, RaisesAsManyFalseAlarmsAsStated) {
  InnovationGuard guard(GuardOptions{.window_s = 0.1, .false_alarms_per_hour = 20.0, .tolerance = 1.0});
  numerics::RandomStream random(3, "guard");
  guard.restart(0.0, true);
  int alarms = 0;
  for (int k = 1; k <= 40 * 36000; ++k) {
    for (std::size_t sensor = 0; sensor < 2; ++sensor) {
      for (int i = 0; i < 2; ++i) {
        const double nu = random.normal();
        guard.add(sensor, nu * nu);
      }
    }
    if (guard.advance(0.1 * k + 1e-9) && guard.alarm()) ++alarms;
  }
  EXPECT_NEAR(alarms, 800, 85);
}

TEST(InnovationGuard, NoticesAChangeWithinTwoWindows) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    InnovationGuard guard;
    const double alarm = first_alarm(guard, seed, 30.0, 20.37, 2.0);
    EXPECT_GT(alarm, 20.37);
    EXPECT_LE(alarm, 20.37 + 2.0 * 1.0 + 0.01) << "seed " << seed;
    EXPECT_FALSE(guard.trusted());
    EXPECT_EQ(guard.worst_sensor(), 1U);
  }
}

TEST(InnovationGuard, ReturnsOnlyAfterSoundWindowsInARow) {
  InnovationGuard guard(GuardOptions{.return_after_s = 5.0});
  guard.restart(0.0, false);
  const std::size_t before = guard.reverts();
  double returned = -1.0;
  for (int k = 1; k <= 2000; ++k) {
    const double t = 0.01 * k;
    guard.add(0, t > 3.2 && t < 3.6 ? 9.0 : 1.0);  // one bad window interrupts
    static_cast<void>(guard.advance(t));
    if (guard.trusted() && returned < 0.0) returned = t;
  }
  EXPECT_NEAR(returned, 9.0, 0.02) << "the window up to 4 s was bad";
  EXPECT_EQ(guard.reverts(), before);
}

TEST(InnovationGuard, TakesSilenceAndNaNForNoProof) {
  InnovationGuard silent(GuardOptions{.return_after_s = 2.0});
  silent.restart(0.0, false);
  for (int k = 1; k <= 1000; ++k) static_cast<void>(silent.advance(0.01 * k));
  EXPECT_FALSE(silent.trusted());
  InnovationGuard poisoned;
  poisoned.restart(0.0, true);
  for (int k = 1; k <= 110; ++k) {
    poisoned.add(0, std::nan(""));
    static_cast<void>(poisoned.advance(0.01 * k));
  }
  EXPECT_FALSE(poisoned.trusted());
}

TEST(GuardOptions, RefusesWhatMakesNoSense) {
  const auto message = [](const char* text) -> std::string {
    try {
      const Study study = Study::parse(text, "study.toml");
      static_cast<void>(GuardOptions::keys().read(study.root().table("guard")));
      study.root().finish();
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(message("[guard]\ntolerance = 0.5\n").find("tolerance"), std::string::npos);
  EXPECT_NE(message("[guard]\nwindow = \"-1 s\"\n").find("window"), std::string::npos);
  EXPECT_NE(message("[guard]\nreturn_afer = \"1 s\"\n").find("return_after"), std::string::npos);
}

}  // namespace
}  // namespace veridyn::estimation
