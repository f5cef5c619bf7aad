#include "veridyn/camera/fusion/inertial_camera_fusion.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/camera/fusion/simulated_sensors.hpp"
#include "tests/support/refusal.hpp"
#include "veridyn/numerics/filters.hpp"

namespace veridyn::camera {
namespace {

using testing::RunOptions;
using testing::SimulatedRun;

/// The whole run, frames as they arrive.
std::vector<FusedMotion> fused(const SimulatedRun& run, const FusionOptions& options = {}) {
  InertialCameraFusion fusion(options);
  std::vector<FusedMotion> result;
  std::size_t frame = 0;
  for (const testing::InertialSample& s : run.inertial) {
    while (frame < run.frames.size() && run.frames[frame].arrival <= s.time) {
      const testing::CameraSample& f = run.frames[frame++];
      fusion.add_camera(f.stamp, f.pose, f.covariance);
    }
    fusion.add_inertial(s.time, s.rate, s.force);
    result.push_back(fusion.now().value_or(FusedMotion{.time = kNaN}));
  }
  return result;
}

constexpr std::size_t kSettled = 1000;  // 10 s

struct Figures {
  double pitch_worst = 0.0, roll_worst = 0.0, naive_pitch_worst = 0.0, acceleration_rms = 0.0, offset_error = 0.0;
  double pitch_share = 0.0, roll_share = 0.0, position_share = 0.0;
};

/// Below 1 Hz: flat to 1 Hz, 60 dB down at 2 Hz.
std::vector<double> slow(const std::vector<double>& x) {
  return numerics::filter(x, numerics::low_pass({.rate_Hz = 100.0, .pass_Hz = 1.0, .stop_Hz = 2.0}));
}

Figures figures_of(const SimulatedRun& run, const RunOptions& o, const FusionOptions& options = {}) {
  const std::vector<FusedMotion> estimate = fused(run, options);
  Figures f;
  std::vector<double> off[2], naive;
  double count = 0.0;
  for (std::size_t i = kSettled; i < estimate.size(); ++i) {
    const FusedMotion& e = estimate[i];
    const testing::TrueMotion& t = run.truth[i];
    const double pitch = e.pitch - t.pitch, roll = e.roll - t.roll;
    f.pitch_worst = std::max(f.pitch_worst, std::abs(pitch));
    f.roll_worst = std::max(f.roll_worst, std::abs(roll));
    f.pitch_share += std::abs(pitch) <= 1.96 * e.sigma(InertialModel::kPitch) ? 1.0 : 0.0;
    f.roll_share += std::abs(roll) <= 1.96 * e.sigma(InertialModel::kRoll) ? 1.0 : 0.0;
    f.position_share += std::abs(e.position(0) - t.position(0)) <= 1.96 * e.sigma(0) ? 1.0 : 0.0;
    count += 1.0;
    for (int k = 0; k < 2; ++k) off[k].push_back(e.acceleration(k) - t.along_the_car(k));
    naive.push_back(-std::asin(std::clamp(run.inertial[i].force(0) / kGravity, -1.0, 1.0)) - t.pitch);
    f.offset_error = e.offset - o.offset;
  }
  f.pitch_share /= count;
  f.roll_share /= count;
  f.position_share /= count;
  for (const double e : slow(naive)) f.naive_pitch_worst = std::max(f.naive_pitch_worst, std::abs(e));
  for (const auto& axis : off)
    for (const double e : slow(axis)) f.acceleration_rms += e * e / count;
  f.acceleration_rms = std::sqrt(f.acceleration_rms / 2.0);
  return f;
}

TEST(InertialCameraFusion, SeparatesInclinationAndAccelerationOnAFlatTrack) {
  Figures worst;
  for (const double offset : {-0.08, -0.03, 0.0, 0.05, 0.08}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const RunOptions o{.seed = seed, .offset = offset};
      const Figures f = figures_of(testing::simulated_run(o), o);
      EXPECT_GT(f.naive_pitch_worst, 6.0 * kDegree)
          << "the accelerometer alone must be wrong for this to mean anything";
      EXPECT_LT(f.pitch_worst, 2.0 * kDegree) << offset << " seed " << seed;
      EXPECT_LT(f.roll_worst, 2.0 * kDegree) << offset << " seed " << seed;
      EXPECT_LT(f.acceleration_rms, 0.17) << offset << " seed " << seed;
      EXPECT_LT(std::abs(f.offset_error), 5e-3) << offset << " seed " << seed;
      worst.pitch_worst = std::max(worst.pitch_worst, f.pitch_worst / kDegree);
      worst.naive_pitch_worst = std::max(worst.naive_pitch_worst, f.naive_pitch_worst / kDegree);
      worst.acceleration_rms = std::max(worst.acceleration_rms, f.acceleration_rms);
      worst.offset_error = std::max(worst.offset_error, 1e3 * std::abs(f.offset_error));
    }
  }
  RecordProperty("worst",
                 fmt::format("pitch {:.2f} deg, naive {:.2f} deg, acceleration {:.3f} m/s^2, offset {:.2f} ms",
                             worst.pitch_worst, worst.naive_pitch_worst, worst.acceleration_rms, worst.offset_error));
}

/// Over runs of which none was looked at when the filter's noise was chosen: errors of a run have much in common.
TEST(InertialCameraFusion, BandsOfInclinationHold) {
  for (const bool hills : {false, true}) {
    double pitch = 0.0, roll = 0.0, position = 0.0;
    constexpr int kRuns = 24;
    for (std::uint64_t seed = 101; seed < 101 + kRuns; ++seed) {
      const RunOptions o{.seed = seed, .offset = 0.01 * static_cast<double>(seed % 17) - 0.08, .hills = hills};
      const Figures f = figures_of(testing::simulated_run(o), o);
      pitch += f.pitch_share / kRuns;
      roll += f.roll_share / kRuns;
      position += f.position_share / kRuns;
      EXPECT_LT(std::abs(f.offset_error), 5e-3) << "seed " << seed;
    }
    EXPECT_GE(pitch, 0.90) << hills;
    EXPECT_LE(pitch, 0.98) << hills;
    EXPECT_GE(roll, 0.90) << hills;
    EXPECT_LE(roll, 0.98) << hills;
    EXPECT_GE(position, 0.90) << hills;
    RecordProperty(hills ? "hills" : "flat", fmt::format("pitch {:.3f}, roll {:.3f}, x {:.3f}", pitch, roll, position));
  }
}

/// The same frames at once and up to 0.25 s late leave the same filter behind, but for rounding.
TEST(InertialCameraFusion, LateFramesCountAsIfTheyHadComeInTime) {
  SimulatedRun late = testing::simulated_run({.seed = 5, .duration_s = 20.0, .offset = 0.02, .latest_s = 0.25});
  SimulatedRun punctual = late;
  for (std::size_t i = 1; i < punctual.frames.size(); ++i)
    if (punctual.frames[i].stamp > 0.5) punctual.frames[i].arrival = punctual.frames[i].stamp;
  std::stable_sort(punctual.frames.begin(), punctual.frames.end(),
                   [](const auto& a, const auto& b) { return a.arrival < b.arrival; });
  const std::vector<FusedMotion> a = fused(late), b = fused(punctual);
  EXPECT_NEAR(a.back().pitch, b.back().pitch, 1e-9);
  EXPECT_NEAR(a.back().offset, b.back().offset, 1e-9);
  EXPECT_LT((a.back().position - b.back().position).norm(), 1e-9);
  EXPECT_LT((a.back().sigma - b.back().sigma).norm(), 1e-9);
}

/// By hand: at rest on a slope of 5 deg, nose down, f = (-g sin, 0, g cos) in the body frame.
TEST(InertialCameraFusion, FindsASlopeAtRest) {
  InertialCameraFusion fusion({});
  const double slope = 5.0 * kDegree;
  const Eigen::Vector3d force(-kGravity * std::sin(slope), 0.0, kGravity * std::cos(slope));
  const Eigen::Matrix3d covariance = Eigen::Vector3d(1e-6, 1e-6, 1e-5).asDiagonal();
  EXPECT_FALSE(fusion.now());
  EXPECT_FALSE(fusion.add_camera(0.0, {1.0, 2.0, 0.5}, covariance)) << "before the first sample";
  for (int k = 0; k < 3000; ++k) {
    fusion.add_inertial(0.01 * k, Eigen::Vector3d::Zero(), force);
    if (k % 3 == 0) fusion.add_camera(0.01 * k, {1.0, 2.0, 0.5}, covariance);
  }
  const FusedMotion m = *fusion.now();
  // What remains is the bias of the accelerometer, which at rest nothing distinguishes from a slope.
  EXPECT_NEAR(m.pitch, slope, 0.1 * kDegree);
  EXPECT_NEAR(m.sigma(InertialModel::kPitch), 0.1 / kGravity, 0.1 * 0.1 / kGravity);
  EXPECT_NEAR(m.roll, 0.0, 0.02 * kDegree);
  EXPECT_LT(m.acceleration.norm(), 0.01);
  EXPECT_LT(m.velocity.norm(), 1e-3);
  EXPECT_LT((m.position - Eigen::Vector2d(1.0, 2.0)).norm(), 1e-3);
  EXPECT_NEAR(m.heading, 0.5, 1e-3);
  // A car at rest says nothing of the offset; what is lost of 0.06 s is the transient of the unknown speed at the
  // start.
  EXPECT_GT(m.sigma(InertialModel::kOffset), 0.03);
}

TEST(InertialCameraFusion, SensorsOffTheReferencePointAreCarriedAlong) {
  // On a circle about the origin, at 2 rad/s; the sensors are 0.2 m ahead of the reference point.
  FusionOptions options;
  options.sensor_place = {0.2, 0.0};
  InertialCameraFusion fusion(options);
  const double radius = 0.5, rate = 2.0;
  const Eigen::Matrix3d covariance = Eigen::Vector3d(1e-6, 1e-6, 1e-5).asDiagonal();
  // Centripetal, towards the left, of the reference point; and of the arm, towards the rear.
  const Eigen::Vector3d force(-0.2 * rate * rate, radius * rate * rate, kGravity);
  for (int k = 0; k < 3000; ++k) {
    const double t = 0.01 * k, angle = rate * t;
    fusion.add_inertial(t, {0.0, 0.0, rate}, force);
    if (k % 3 == 0)
      fusion.add_camera(
          t, {radius * std::cos(angle), radius * std::sin(angle), numerics::wrap_angle(angle + kPi / 2.0)}, covariance);
  }
  const FusedMotion m = *fusion.now();
  EXPECT_NEAR(m.position.norm(), std::hypot(0.5, 0.2), 2e-3);
  EXPECT_NEAR(m.velocity.norm(), rate * std::hypot(0.5, 0.2), 0.01);
  EXPECT_NEAR(m.offset, 0.0, 2e-3);
  EXPECT_NEAR(m.acceleration(1), radius * rate * rate, 0.1);
}

TEST(InertialCameraFusion, StartsAgainAfterAGapAndRefusesWhatComesTooLate) {
  InertialCameraFusion fusion({});
  const Eigen::Vector3d rest(0.0, 0.0, kGravity);
  const Eigen::Matrix3d covariance = Eigen::Vector3d(1e-6, 1e-6, 1e-5).asDiagonal();
  for (int k = 0; k < 200; ++k) {
    fusion.add_inertial(0.01 * k, Eigen::Vector3d::Zero(), rest);
    if (k == 10) {
      EXPECT_TRUE(fusion.add_camera(0.1, {1.0, 1.0, 0.0}, covariance));
    }
  }
  EXPECT_TRUE(fusion.now());
  EXPECT_FALSE(fusion.add_camera(0.5, {1.0, 1.0, 0.0}, covariance));
  EXPECT_EQ(fusion.too_late(), 1U);
  fusion.add_inertial(2.5, Eigen::Vector3d::Zero(), rest);
  EXPECT_FALSE(fusion.now());
  EXPECT_EQ(fusion.gaps(), 1U);
  EXPECT_TRUE(fusion.add_camera(2.5, {1.0, 1.0, 0.0}, covariance));
  EXPECT_TRUE(fusion.now());
}

TEST(InertialCameraFusion, RefusesWhatItCannotUse) {
  InertialCameraFusion fusion({});
  fusion.add_inertial(1.0, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  EXPECT_EQ(why([&] { fusion.add_inertial(1.0, zero, zero); }),
            "inertial sample: its time 1.000000 s does not follow 1.000000 s");
  EXPECT_NE(why([&] { fusion.add_inertial(2.0, {kNaN, 0.0, 0.0}, zero); }).find("not a finite"), std::string::npos);
  EXPECT_NE(why([&] { fusion.add_camera(1.0, zero, Eigen::Matrix3d::Zero()); }).find("not positive definite"),
            std::string::npos);
  FusionOptions options;
  options.lag_s = 0.1;
  EXPECT_NE(why([&] { InertialCameraFusion{options}; }).find("fusion: lag is 0.1 s"), std::string::npos);
  options = {};
  options.noise.gyro = -1.0;
  EXPECT_EQ(why([&] { InertialCameraFusion{options}; }), "fusion: noise.gyro must be > 0");
}

}  // namespace
}  // namespace veridyn::camera
