#include "veridyn/cueing/washout/classical_washout.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/support/folders.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::cueing {
namespace {

using recording::MotionSample;
using Complex = std::complex<double>;

/// Level, with an acceleration forward, right, down and rates.
MotionSample level(const Eigen::Vector3d& acceleration, const Eigen::Vector3d& rate = Eigen::Vector3d::Zero()) {
  MotionSample s;
  s.frame = Frame::kFrd;
  s.force = acceleration + recording::force_at_rest(Frame::kFrd);
  s.rate = rate;
  return s;
}

/// Gain and phase from one input to one output at a frequency, after the beginning has died away: least squares of sine
/// and cosine.
Complex response(double omega, double rate, const std::function<MotionSample(double)>& input,
                 const std::function<double(const PlatformCommand&, const ClassicalWashout&)>& output) {
  ClassicalWashout washout(ClassicalDesign{});
  const double step = 1.0 / rate, settle = 80.0, end = settle + 2.0 + 2.0 * kPi / omega;
  washout.reset(input(0.0));
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  Eigen::Vector2d products = Eigen::Vector2d::Zero();
  for (long k = 1; static_cast<double>(k) * step < end; ++k) {
    const double t = static_cast<double>(k) * step;
    const Eigen::Vector2d wave(std::sin(omega * t), std::cos(omega * t));
    const PlatformCommand command = washout.step(input(wave(0)), step);
    if (t < settle) continue;
    squares += wave * wave.transpose();
    products += wave * output(command, washout);
  }
  const Eigen::Vector2d fit = squares.inverse() * products;
  return {fit(0), fit(1)};
}

/// What a driver in the platform feels forward: its acceleration, and gravity by its tilt.
double felt_forward(const PlatformCommand& c, const ClassicalWashout& w) {
  return c.acceleration.x() + kGravity * std::sin(w.tilt()[1]);
}

/// So small that neither the arcsine nor the limit of the rate is seen.
constexpr double kSmall = 1e-3;

TEST(ClassicalWashout, OmctResponsesAreThoseOfTheReference) {
  const std::filesystem::path file = test::shared_folder() / "reference" / "cueing_reference.json";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file << "; ResponsesAreThoseOfItsFilters is without it";
  const auto reference = nlohmann::json::parse(std::ifstream(file));
  const auto frequencies = reference["omct_frequencies_rad_s"].get<std::vector<double>>();
  const auto along = [](Eigen::Index axis) {
    return [axis](double u) { return level(kSmall * u * Eigen::Vector3d::Unit(axis)); };
  };
  const auto about = [](Eigen::Index axis) {
    return [axis](double u) { return level(Eigen::Vector3d::Zero(), kSmall * u * Eigen::Vector3d::Unit(axis)); };
  };
  const auto felt_right = [](const PlatformCommand& c, const ClassicalWashout& w) {
    return c.acceleration.y() - kGravity * std::sin(w.tilt()[0]);
  };
  const auto tilt_only = [](const PlatformCommand&, const ClassicalWashout& w) {
    return kGravity * std::sin(w.tilt()[1]);
  };
  struct Case {
    std::string name;
    std::function<MotionSample(double)> input;
    std::function<double(const PlatformCommand&, const ClassicalWashout&)> output;
  };
  const std::vector<Case> cases = {
      {"surge_full k=0.6 HP2(wn 0.8)+LP2(wn 2.0)", along(0), felt_forward},
      {"sway_full k=0.6 HP2(wn 1.0)+LP2(wn 2.0)", along(1), felt_right},
      {"tilt_only (3-DOF rig) k=0.6 LP2(wn 2.0)", along(0), tilt_only},
      {"heave k=0.5 HP2(wn 1.0)*HP1(wb 0.2)", along(2),
       [](const PlatformCommand& c, const ClassicalWashout&) { return -c.acceleration.z(); }},
      {"roll/yaw k=0.6 HP2(wn 1.0)", about(0),
       [](const PlatformCommand& c, const ClassicalWashout&) { return c.rate.x(); }},
      {"pitch k=0.6 HP2(wn 0.8)", about(1),
       [](const PlatformCommand& c, const ClassicalWashout&) { return c.rate.y(); }}};
  for (const Case& c : cases) {
    const auto& expected = reference["simona_classical_continuous"].at(c.name);
    for (std::size_t i = 0; i < frequencies.size(); ++i) {
      for (const auto& [rate, tolerance] : {std::pair(100.0, 1e-3), std::pair(1000.0, 1e-5)}) {
        if (rate > 100.0 && frequencies[i] < 2.0) continue;  // the error grows with the frequency
        const Complex found = response(frequencies[i], rate, c.input, c.output) / kSmall;
        const Complex exact =
            std::polar(expected["mag"][i].get<double>(), expected["phase_deg"][i].get<double>() * kDegree);
        EXPECT_NEAR(std::abs(found - exact), 0.0, tolerance)
            << c.name << " at " << frequencies[i] << ", " << rate << " Hz";
      }
    }
  }
}

TEST(ClassicalWashout, ResponsesAreThoseOfItsFilters) {
  const Complex s(0.0, 2.5);
  const Complex expected = 0.6 * (s * s / ((s + 0.8) * (s + 0.8)) + 4.0 / ((s + 2.0) * (s + 2.0)));
  const auto input = [](double u) { return level({kSmall * u, 0.0, 0.0}); };
  EXPECT_NEAR(std::abs(response(2.5, 200.0, input, felt_forward) / kSmall - expected), 0.0, 1e-4);
}

TEST(ClassicalWashout, ASteadyForceBecomesTiltAtTheLimitOfItsRate) {
  ClassicalWashout washout(ClassicalDesign{});
  washout.reset(level(Eigen::Vector3d::Zero()));
  PlatformCommand command;
  double fastest = 0.0, before = 0.0;
  for (int k = 0; k < 6000; ++k) {
    command = washout.step(level({2.0, -1.0, 0.0}), 0.01);
    fastest = std::max(fastest, std::abs(washout.tilt()[1] - before) / 0.01);
    before = washout.tilt()[1];
  }
  EXPECT_NEAR(fastest, 3.0 * kDegree, 1e-12);
  // Nose up for forward; the right side up for a force to the left.
  EXPECT_NEAR(command.angle.y(), std::asin(1.2 / kGravity), 1e-9);
  EXPECT_NEAR(command.angle.x(), std::asin(0.6 / kGravity), 1e-9);
  EXPECT_LT(command.shift.norm(), 1.2 / (0.8 * 0.8) + 0.6 + 1e-6);
  EXPECT_LT(command.acceleration.norm(), 1e-9);
}

TEST(ClassicalWashout, NothingJumpsAtTheBeginningAndRestIsRest) {
  ClassicalWashout washout(ClassicalDesign{});
  MotionSample braking = level({-6.0, 3.0, 1.0}, {0.3, -0.2, 0.4});
  braking.attitude = numerics::quaternion_from_euler(0.1, -0.05, 2.0);
  const PlatformCommand first = washout.reset(braking);
  EXPECT_LT(first.angle.norm(), 1e-12);
  EXPECT_LT((washout.step(braking, 0.01).angle - first.angle).norm(), 0.05 * kDegree);
  washout.reset(level(Eigen::Vector3d::Zero()));
  for (int k = 0; k < 1000; ++k) {
    const PlatformCommand rest = washout.step(level(Eigen::Vector3d::Zero()), 0.01);
    ASSERT_EQ(rest.angle.norm(), 0.0);
    ASSERT_LT(rest.shift.norm(), 1e-14);
  }
}

TEST(ClassicalWashout, ReturnsToNeutralAfterAManoeuvre) {
  ClassicalWashout washout(ClassicalDesign{});
  washout.reset(level(Eigen::Vector3d::Zero()));
  for (int k = 0; k < 300; ++k) washout.step(level({5.0, 4.0, -3.0}, {0.5, 0.3, 0.8}), 0.01);
  PlatformCommand command;
  for (int k = 0; k < 6000; ++k) command = washout.step(level(Eigen::Vector3d::Zero()), 0.01);
  EXPECT_LT(command.angle.norm(), 1e-6);
  EXPECT_LT(command.shift.norm(), 1e-4);
}

TEST(ClassicalWashout, MirroredMotionGivesTheMirroredCommandBitForBit) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  ClassicalWashout one(ClassicalDesign{}), other(ClassicalDesign{});
  const auto mirrored = [](const MotionSample& s) {
    MotionSample m = s;
    m.force.y() = -s.force.y();
    m.rate = Eigen::Vector3d(-s.rate.x(), s.rate.y(), -s.rate.z());
    m.attitude = Eigen::Quaterniond(s.attitude.w(), -s.attitude.x(), s.attitude.y(), -s.attitude.z());
    return m;
  };
  MotionSample s = level(Eigen::Vector3d::Zero());
  one.reset(s);
  other.reset(mirrored(s));
  for (int k = 0; k < 500; ++k) {
    s.force += Eigen::Vector3d(normal(random), normal(random), normal(random));
    s.rate = 0.3 * Eigen::Vector3d(normal(random), normal(random), normal(random));
    s.attitude = numerics::quaternion_from_euler(0.2 * normal(random), 0.1 * normal(random), normal(random));
    const double step = k % 3 == 0 ? 0.007 : 0.031;
    const PlatformCommand a = one.step(s, step), b = other.step(mirrored(s), step);
    ASSERT_EQ(a.angle, Eigen::Vector3d(-b.angle.x(), b.angle.y(), -b.angle.z())) << k;
    ASSERT_EQ(a.shift, Eigen::Vector3d(b.shift.x(), -b.shift.y(), b.shift.z())) << k;
  }
}

TEST(ClassicalWashout, ACopyGoesOnAlikeAndBadValuesStandForTheLast) {
  ClassicalWashout washout(ClassicalDesign{});
  washout.reset(level(Eigen::Vector3d::Zero()));
  for (int k = 0; k < 100; ++k) washout.step(level({1.0, 2.0, 0.0}, {0.1, 0.0, 0.2}), 0.01);
  const std::unique_ptr<Washout> copy = washout.clone();
  MotionSample bad = level({1.0, 2.0, 0.0}, {0.1, 0.0, 0.2});
  bad.force.x() = kNaN;
  bad.rate.z() = kInfinity;
  const PlatformCommand a = washout.step(bad, 0.01), b = copy->step(level({1.0, 2.0, 0.0}, {0.1, 0.0, 0.2}), 0.01);
  EXPECT_TRUE(a.angle.allFinite() && a.shift.allFinite());
  EXPECT_EQ(a.angle, b.angle);
  EXPECT_EQ(washout.step(bad, kNaN).shift, washout.step(bad, -1.0).shift);
}

TEST(ClassicalWashout, RefusesFiltersThatAreNone) {
  ClassicalDesign o;
  o.onset[1] = 0.0;
  try {
    const ClassicalWashout washout(o);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), ::testing::HasSubstr("washout.onset"));
  }
  o = ClassicalDesign{};
  o.tilt_rate = -1.0;
  EXPECT_THROW(ClassicalWashout{o}, InputError);
}

TEST(ClassicalDesign, IsReadFromAStudy) {
  const Study study = Study::parse("[washout]\nforce_gain = [0.5, 0.4, 0.3]\ntilt_rate = \"6 deg/s\"\n", "s.toml");
  ClassicalDesign o;
  read_knobs(study.root().table("washout"), o.knobs());
  EXPECT_EQ(o.force_gain[1], 0.4);
  EXPECT_NEAR(o.tilt_rate, 6.0 * kDegree, 1e-15);
  EXPECT_EQ(o.onset[0], 0.8);
}

}  // namespace
}  // namespace veridyn::cueing
