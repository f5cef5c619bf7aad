// What every algorithm of the table has to do, whatever it does besides.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <ostream>
#include <random>

#include "tests/support/sanitized.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/cueing/platform/platform_guard.hpp"
#include "veridyn/cueing/washout/washout_design.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::cueing {
namespace {

using recording::MotionSample;
using Vector = Eigen::Vector3d;

MotionSample moving(const Vector& acceleration, const Vector& rate) {
  MotionSample s;
  s.frame = Frame::kFrd;
  s.force = acceleration + recording::force_at_rest(Frame::kFrd);
  s.rate = rate;
  return s;
}
MotionSample standing() { return moving(Vector::Zero(), Vector::Zero()); }

/// Smooth driving.
MotionSample drive(double t) {
  const Vector a(3.0 * std::sin(0.9 * t) + std::sin(2.3 * t), 4.0 * std::sin(0.7 * t + 1.0), 0.8 * std::sin(3.1 * t));
  const Vector rate(0.05 * std::sin(1.3 * t), 0.04 * std::cos(1.7 * t), 0.3 * std::sin(0.7 * t));
  return moving(a, rate);
}

struct Subject {
  std::string algorithm, platform;
};
void PrintTo(const Subject& of, std::ostream* out) { *out << of.algorithm << " on " << of.platform; }
std::vector<Subject> subjects() {
  std::vector<Subject> all;
  for (const WashoutAlgorithm& a : washout_algorithms()) {
    for (const char* platform : {"three_axis", "hexapod"}) all.push_back({std::string(a.name), platform});
  }
  return all;
}

class EveryWashout : public ::testing::TestWithParam<Subject> {
 protected:
  [[nodiscard]] const Platform& platform() const { return built_in_platform(GetParam().platform); }
  [[nodiscard]] std::unique_ptr<Washout> make() const {
    return washout_algorithm(GetParam().algorithm).design()->make(platform());
  }
};

INSTANTIATE_TEST_SUITE_P(Washouts, EveryWashout, ::testing::ValuesIn(subjects()),
                         [](const auto& which) { return which.param.algorithm + "_" + which.param.platform; });

TEST_P(EveryWashout, StandsStillUnderAVehicleThatStands) {
  const std::unique_ptr<Washout> washout = make();
  washout->reset(standing());
  for (int k = 0; k < 2000; ++k) {
    const PlatformCommand c = washout->step(standing(), 0.01);
    ASSERT_EQ(c.angle, Vector::Zero()) << k;
    ASSERT_EQ(c.shift, Vector::Zero()) << k;
  }
}

TEST_P(EveryWashout, BeginsAtNeutralInWhateverMotionAndDoesNotJump) {
  const std::unique_ptr<Washout> washout = make();
  MotionSample s = moving({-7.0, 8.0, 3.0}, {0.4, -0.3, 0.8});
  s.attitude = numerics::quaternion_from_euler(0.3, -0.2, 2.0);
  // Some history first: beginning again is like beginning.
  washout->reset(standing());
  for (int k = 0; k < 300; ++k) washout->step(drive(0.01 * k), 0.01);
  const PlatformCommand first = washout->reset(s);
  EXPECT_EQ(first.angle, Vector::Zero());
  EXPECT_EQ(first.shift, Vector::Zero());
  const PlatformCommand second = washout->step(s, 0.01);
  EXPECT_LT(second.angle.cwiseAbs().maxCoeff(), 0.01 * kDegree);
  EXPECT_LT(second.shift.cwiseAbs().maxCoeff(), 1e-4);
}

TEST_P(EveryWashout, ReturnsToNeutralOnceTheVehicleStands) {
  const std::unique_ptr<Washout> washout = make();
  washout->reset(standing());
  PlatformCommand c;
  for (int k = 0; k < 2000; ++k) c = washout->step(drive(0.01 * k), 0.01);
  EXPECT_GT(c.angle.head<2>().norm(), 0.2 * kDegree);
  for (int k = 0; k < 12000; ++k) c = washout->step(standing(), 0.01);
  EXPECT_LT(c.angle.cwiseAbs().maxCoeff(), 0.02 * kDegree);
  EXPECT_LT(c.shift.cwiseAbs().maxCoeff(), 1e-3);
}

TEST_P(EveryWashout, TiltsAsGravityIsToStandForTheForce) {
  const std::unique_ptr<Washout> washout = make();
  washout->reset(standing());
  PlatformCommand c;
  for (int k = 0; k < 800; ++k) c = washout->step(moving({2.0, 1.5, 0.0}, Vector::Zero()), 0.01);
  EXPECT_GT(c.angle.y(), 1.0 * kDegree);   // the nose up for a force forward
  EXPECT_LT(c.angle.x(), -1.0 * kDegree);  // the left side down for one to the right
}

TEST_P(EveryWashout, MirroredMotionGivesTheMirroredCommandBitForBit) {
  const std::unique_ptr<Washout> one = make(), other = make();
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto mirrored = [](const MotionSample& s) {
    MotionSample m = s;
    m.force.y() = -s.force.y();
    m.rate = Vector(-s.rate.x(), s.rate.y(), -s.rate.z());
    m.attitude = Eigen::Quaterniond(s.attitude.w(), -s.attitude.x(), s.attitude.y(), -s.attitude.z());
    return m;
  };
  MotionSample s = standing();
  one->reset(s);
  other->reset(mirrored(s));
  for (int k = 0; k < 800; ++k) {
    s.force += 0.5 * Vector(normal(random), normal(random), normal(random));
    s.rate = 0.3 * Vector(normal(random), normal(random), normal(random));
    s.attitude = numerics::quaternion_from_euler(0.2 * normal(random), 0.1 * normal(random), normal(random));
    const double step = k % 3 == 0 ? 0.007 : 0.031;
    const PlatformCommand a = one->step(s, step), b = other->step(mirrored(s), step);
    ASSERT_EQ(a.angle, Vector(-b.angle.x(), b.angle.y(), -b.angle.z())) << k;
    ASSERT_EQ(a.shift, Vector(b.shift.x(), -b.shift.y(), b.shift.z())) << k;
  }
}

/// Angles [rad] and shifts [m] every fifth of a second of 20 s of driving.
std::vector<double> path(Washout& washout, const std::function<double(double)>& step_at) {
  std::vector<double> all;
  washout.reset(drive(0.0));
  double t = 0.0;
  for (int k = 1; k <= 100; ++k) {
    PlatformCommand c;
    for (const double end = 0.2 * k; t < end - 1e-9;) {
      const double step = std::min(step_at(t), end - t);
      t += step;
      c = washout.step(drive(t), step);
    }
    for (int i = 0; i < 3; ++i) {
      all.push_back(c.angle(i));
      all.push_back(c.shift(i));
    }
  }
  return all;
}

TEST_P(EveryWashout, DoesTheSameAtAnySamplingRateAndWithIrregularStamps) {
  // Within 0.15 deg and 10 mm, 2 % of the hexapod's range.
  const std::vector<double> fine = path(*make(), [](double) { return 0.001; });
  std::mt19937 random(7);
  std::uniform_real_distribution<double> between(0.007, 0.031);
  const std::vector<std::function<double(double)>> others = {[](double) { return 0.01; }, [](double) { return 0.02; },
                                                             [&](double) { return between(random); }};
  for (const auto& step_at : others) {
    const std::vector<double> coarse = path(*make(), step_at);
    double angle = 0.0, shift = 0.0;
    for (std::size_t i = 0; i < fine.size(); i += 2) {
      angle = std::max(angle, std::abs(fine[i] - coarse[i]));
      shift = std::max(shift, std::abs(fine[i + 1] - coarse[i + 1]));
    }
    EXPECT_LT(angle, 0.15 * kDegree);
    EXPECT_LT(shift, 0.01);
  }
}

TEST_P(EveryWashout, ACopyGoesOnAlikeBitForBit) {
  const std::unique_ptr<Washout> washout = make();
  washout->reset(standing());
  for (int k = 0; k < 500; ++k) washout->step(drive(0.01 * k), 0.01);
  const std::unique_ptr<Washout> copy = washout->clone();
  for (int k = 500; k < 1000; ++k) {
    const PlatformCommand a = washout->step(drive(0.01 * k), 0.013), b = copy->step(drive(0.01 * k), 0.013);
    ASSERT_EQ(a.angle, b.angle);
    ASSERT_EQ(a.shift, b.shift);
  }
}

TEST_P(EveryWashout, ValuesThatAreNoneStandForTheLast) {
  const std::unique_ptr<Washout> washout = make();
  washout->reset(standing());
  for (int k = 0; k < 100; ++k) washout->step(drive(0.01 * k), 0.01);
  const std::unique_ptr<Washout> copy = washout->clone();
  MotionSample bad = drive(0.99);
  bad.force.x() = kNaN;
  bad.rate.z() = kInfinity;
  bad.attitude = Eigen::Quaterniond(kNaN, 0.0, 0.0, 0.0);
  EXPECT_EQ(washout->step(bad, 0.01).angle, copy->step(drive(0.99), 0.01).angle);
  const PlatformCommand before = washout->step(bad, 0.0);
  for (const double step : {kNaN, -1.0, kInfinity}) {
    EXPECT_EQ(washout->step(bad, step).shift, before.shift);
    EXPECT_EQ(washout->step(bad, step).angle, before.angle);
  }
}

/// Anything: noise, values that are none, 1e30, jumps, pauses, time that goes back, states of other algorithms.
void run_adversary(const std::string& name, const Platform& platform, long steps, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  std::unique_ptr<Washout> washout = washout_algorithm(name).design()->make(platform);
  PlatformGuard guard(platform.limits);
  MotionSample s = standing();
  washout->reset(s);
  guard.reset();
  std::unique_ptr<Washout> saved = washout->clone();
  for (long k = 0; k < steps; ++k) {
    const double what = uniform(random);
    const Vector noise(normal(random), normal(random), normal(random));
    if (what < 0.5) {
      s.force += 0.3 * noise;
      s.rate += 0.01 * noise;
    } else if (what < 0.55) {
      s = moving(8.0 * noise, noise);
    } else if (what < 0.57) {
      s.force(k % 3) = kNaN;
    } else if (what < 0.58) {
      s.force = 1e30 * noise;
    } else if (what < 0.59) {
      s.rate = kInfinity * noise;
    } else if (what < 0.6) {
      s.attitude = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random));
    } else if (what < 0.65) {
      s = standing();
    }
    double step = 0.01;
    const double when = uniform(random);
    if (when < 0.2) step = 0.007 + 0.024 * uniform(random);
    if (when < 0.01) step = 5.0 * uniform(random);
    if (when < 0.006) step = -uniform(random);
    if (when < 0.003) step = 0.0;
    if (when < 0.001) step = kNaN;
    const double restart = uniform(random);
    if (restart < 5e-4) {
      washout->reset(s);
    } else if (restart < 1e-3) {
      std::swap(washout, saved);
    } else if (restart < 1.2e-3) {
      const auto all = washout_algorithms();
      washout =
          all[static_cast<std::size_t>(uniform(random) * static_cast<double>(all.size()))].design()->make(platform);
      washout->reset(s);
    }
    const PlatformState before = guard.state();
    const PlatformCommand desired = washout->step(s, step);
    ASSERT_TRUE(desired.angle.allFinite() && desired.shift.allFinite()) << "step " << k << " of seed " << seed;
    const PlatformState after = guard.step(desired, step);
    const double time = step > 0.0 ? step : 0.0;
    for (std::size_t i = 0; i < kPlatformAxes; ++i) {
      const AxisLimits& limits = platform.limits.axes[i];
      const AxisState a = axis(before, static_cast<PlatformAxis>(i)), b = axis(after, static_cast<PlatformAxis>(i));
      if (!limits.moves()) {
        ASSERT_EQ(b.position, 0.0);
        continue;
      }
      ASSERT_GE(b.position, limits.lowest);
      ASSERT_LE(b.position, limits.highest);
      ASSERT_LE(std::abs(b.rate), limits.rate);
      ASSERT_LE(std::abs(b.acceleration), limits.acceleration + 1e-12);
      ASSERT_LE(std::abs(b.acceleration - a.acceleration), limits.jerk * time * (1.0 + 1e-9) + 1e-12);
      ASSERT_LE(std::abs(b.position - a.position), limits.rate * time * (1.0 + 1e-9) + 1e-12);
    }
  }
}

TEST_P(EveryWashout, ThePlatformKeepsItsLimitsWhateverComesIn) {
  // A fault of one step in five thousand is met with 95 %; the soak below takes a million.
  run_adversary(GetParam().algorithm, platform(), test::kSanitized ? 5000 : 15000, 11);
}

TEST_P(EveryWashout, SoakThePlatformKeepsItsLimitsInAMillionSteps) {
  if (std::getenv("VERIDYN_SOAK") == nullptr) GTEST_SKIP() << "set VERIDYN_SOAK=1";
  run_adversary(GetParam().algorithm, platform(), 1000000, 12);
}

}  // namespace
}  // namespace veridyn::cueing
