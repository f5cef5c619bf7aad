#include "veridyn/vehicle/identification/signals/course_lateral_velocity.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/io/support.hpp"
#include "tests/vehicle/simulated_drive.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/io/read.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/vehicle/vehicle_study.hpp"

namespace veridyn::vehicle {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

constexpr double kCourseStep_s = 0.02;
constexpr std::size_t kCourseSamples = 3000;

/// Speed, yaw rate and lateral velocity of a drive in closed form: straight on for a third, then weaving.
struct WeavingMotion {
  std::vector<double> time, u, r, v, psi;

  WeavingMotion() {
    for (std::size_t k = 0; k < kCourseSamples; ++k) {
      const double t = kCourseStep_s * static_cast<double>(k), w = 0.5, turning = t < 20.0 ? 0.0 : t - 20.0;
      time.push_back(t);
      u.push_back(15.0 + 4.0 * std::sin(0.2 * t));
      r.push_back(0.2 * std::sin(w * turning));
      v.push_back(0.9 * std::sin(w * turning) * std::cos(0.02 * t));
      psi.push_back(2.0 + 0.2 / w * (1.0 - std::cos(w * turning)));
    }
  }
  [[nodiscard]] Channel course(double position, double sigma = 0.0) const {
    numerics::RandomStream noise(7, "course");
    std::vector<double> angles;
    for (std::size_t k = 0; k < kCourseSamples; ++k)
      angles.push_back(std::remainder(psi[k] + std::atan((v[k] + position * r[k]) / u[k]) + sigma * noise.normal(),
                                      2.0 * std::numbers::pi));
    return make_channel("course", "rad", make_time_base(time), angles);
  }
  [[nodiscard]] Channel yaw(double offset, double sigma = 0.0) const {
    numerics::RandomStream noise(8, "yaw");
    std::vector<double> angles;
    for (const double angle : psi) angles.push_back(angle + offset + sigma * noise.normal());
    return make_channel("yaw", "rad", make_time_base(time), angles);
  }
  [[nodiscard]] CourseLateralVelocity made(const Channel& course_seen, const Channel& yaw_seen, double position) const {
    return course_lateral_velocity({.course = course_seen,
                                    .yaw = yaw_seen,
                                    .speed = u,
                                    .yaw_rate = r,
                                    .speed_sigma = 0.1,
                                    .yaw_rate_sigma = 0.002,
                                    .grid = {.begin = 0.0, .step = kCourseStep_s, .count = kCourseSamples},
                                    .position = position});
  }
};

TEST(CourseLateralVelocity, IsThatOfTheCentreOfGravityWhateverTheZeroOfTheHeadingAndThePlaceOfTheAntenna) {
  const WeavingMotion m;
  for (const double position : {0.0, 1.4, -0.8}) {
    for (const double offset : {0.0, 1.9, -3.1}) {
      const CourseLateralVelocity found = m.made(m.course(position), m.yaw(offset), position);
      ASSERT_TRUE(found.signal.available()) << found.note;
      for (std::size_t k = 0; k < kCourseSamples; ++k) ASSERT_NEAR(found.signal.value[k], m.v[k], 1e-9) << k;
    }
  }
  EXPECT_THAT(m.made(m.course(1.4), m.yaw(0.3), 1.4).note, HasSubstr("speed tan(course - yaw), moved by -1.4 m"));
}

TEST(CourseLateralVelocity, HasTheErrorThatItsNoisesMake) {
  const WeavingMotion m;
  const double sigma_course = 0.3 * kDegree, sigma_yaw = 0.1 * kDegree;
  const CourseLateralVelocity found = m.made(m.course(1.4, sigma_course), m.yaw(0.5, sigma_yaw), 1.4);
  ASSERT_TRUE(found.signal.available());
  std::vector<double> error;
  for (std::size_t k = 0; k < kCourseSamples; ++k) error.push_back(found.signal.value[k] - m.v[k]);
  // The exact channels of speed and yaw rate and a known place have a share of a tenth in what is stated.
  EXPECT_NEAR(found.signal.sigma, numerics::rms(error), 0.12 * numerics::rms(error));
}

TEST(CourseLateralVelocity, LeavesOutSlowAndReversingAndCountsHeldValuesOnce) {
  WeavingMotion m;
  for (std::size_t k = 1500; k < 1600; ++k) m.u[k] = 1.0;
  const CourseLateralVelocity found = m.made(m.course(0.0), m.yaw(0.0), 0.0);
  EXPECT_TRUE(std::isnan(found.signal.value[1550]));
  EXPECT_TRUE(std::isfinite(found.signal.value[1650]));
  const WeavingMotion even;
  Channel held = even.course(0.0);
  for (std::size_t k = 0; k < kCourseSamples; ++k) held.value[k] = held.value[k - k % 10];
  const CourseLateralVelocity slow = even.made(held, even.yaw(0.0), 0.0);
  EXPECT_NEAR(slow.signal.rate_Hz, 5.0, 0.1);
  for (std::size_t k = 1000; k < kCourseSamples - 20; ++k) ASSERT_NEAR(slow.signal.value[k], even.v[k], 0.02) << k;
  Channel backwards = even.course(0.0);
  for (std::size_t k = 2000; k < 2100; ++k) backwards.value[k] += std::numbers::pi;
  EXPECT_TRUE(std::isnan(even.made(backwards, even.yaw(0.0), 0.0).signal.value[2050]));
}

TEST(CourseLateralVelocity, IsNotMadeOfAHeadingThatWandersNorOfTheCourseItself) {
  const WeavingMotion m;
  Channel drifts = m.yaw(0.0);
  for (std::size_t k = 0; k < kCourseSamples; ++k) drifts.value[k] += 0.1 * m.time[k] / 20.0;
  EXPECT_FALSE(m.made(m.course(0.0), drifts, 0.0).signal.available());
  EXPECT_THAT(m.made(m.course(0.0), drifts, 0.0).note, HasSubstr("the heading is a compass's or drifts"));
  const CourseLateralVelocity copy = m.made(m.course(0.0), m.course(0.0), 0.0);
  EXPECT_FALSE(copy.signal.available());
  EXPECT_THAT(copy.note, HasSubstr("one of them is made of the other"));
  WeavingMotion turning;
  for (double& r : turning.r) r = 0.5;
  EXPECT_THAT(turning.made(turning.course(0.0), turning.yaw(0.0), 0.0).note, HasSubstr("hardly goes straight"));
}

/// A weaving drive with straight stretches, at speeds from 12 to 28 m/s; course and heading of a receiver with two
/// antennas at 10 Hz whose mounting and time are off.
Recording drive_with_course(const VehicleParameters<double>& p, std::uint64_t seed, double delay, double mounting) {
  const testing::WanderingSteer steer(seed, 0.02);
  const VehicleTrajectory trajectory = testing::drive_bicycle<BicycleModel<double, LinearTyre<double>>>(
      [&](double) { return testing::linear_bicycle(p); }, 120.0,
      [&](double t) { return std::fmod(t, 30.0) < 6.0 ? 0.0 : steer(t); },
      [](double t) { return 20.0 + 8.0 * std::sin(0.15 * t); });
  Recording recording = record_drive(trajectory, reference_drive_sensors(), seed);
  numerics::RandomStream noise(seed, "gnss");
  std::vector<double> stamps, course, yaw;
  for (std::size_t k = 20; k < trajectory.time.size(); k += 10) {
    const auto late = k - static_cast<std::size_t>(std::lround(delay / 0.01));
    stamps.push_back(trajectory.time[k]);
    course.push_back(trajectory.yaw[late] + std::atan(trajectory.v[late] / trajectory.u[late]) +
                     0.03 / trajectory.u[late] * noise.normal());
    yaw.push_back(trajectory.yaw[k] + mounting + 0.1 * kDegree * noise.normal());
  }
  const TimeBase time = make_time_base(stamps);
  recording.add(make_channel("course", "rad", time, course));
  recording.add(make_channel("yaw", "rad", time, yaw));
  return recording;
}

/// By how much the course of such a drive was found to be late.
double course_shift(const Recording& recording) {
  const recording::MappedRecording mapped = testing::mapped(recording);
  const DriveSignals signals = prepare_drive_signals(mapped, {});
  return course_lateral_velocity({.course = *mapped.recording.find("course"),
                                  .yaw = *mapped.recording.find("yaw"),
                                  .speed = signals[DriveSignal::kSpeed].value,
                                  .yaw_rate = signals[DriveSignal::kYawRate].value,
                                  .speed_sigma = 0.1,
                                  .yaw_rate_sigma = 0.002,
                                  .grid = signals.grid})
      .shift_s;
}

estimation::Estimate estimate_of_drive(const Recording& recording) {
  const Study study = Study::parse(
      "[subject]\nkind = 'vehicle'\nmass = 1500\na = 1.2\nb = 1.5\n[data]\nframe = 'flu'\n"
      "[identify]\nstructure = 'bicycle'\n",
      "study.toml");
  Progress silent;
  return identify(read_study(study, recording, silent), silent).estimate;
}

TEST(CourseLateralVelocity, OfALateCourseAndATurnedHeadingLeavesTheStiffnessesRight) {
  const VehicleParameters<double> p = testing::family_car();
  for (const double delay : {0.0, 0.05, 0.2}) {
    SCOPED_TRACE(delay);
    const Recording recording = drive_with_course(p, 3, delay, 1.0 * kDegree);
    const DriveSignals signals = prepare_drive_signals(testing::mapped(recording), {});
    const double shift = course_shift(recording);
    EXPECT_NEAR(shift, delay < 0.1 ? 0.0 : delay, 0.08);
    ASSERT_TRUE(signals.lateral_by_course);
    const estimation::Estimate found = estimate_of_drive(recording);
    for (const auto& [name, truth] : {std::pair{"C_f", p.C_f}, std::pair{"C_r", p.C_r}, std::pair{"I_z", p.I_z},
                                      std::pair{"course_delay", delay - shift}}) {
      const estimation::Parameter* const e = found.find(name);
      ASSERT_NE(e, nullptr) << name;
      EXPECT_NEAR(e->value, truth, 4.0 * e->sigma) << name;
    }
    EXPECT_LT(found.find("C_r")->sigma, 0.13 * p.C_r);
    EXPECT_LT(found.find("course_delay")->sigma, 0.025);
    EXPECT_THAT(signals.notes, Contains(HasSubstr("lateral velocity is speed tan(course - yaw)")));
  }
}

TEST(CourseLateralVelocity, OfARecordedDriveWhoseHeadingIsACompassIsNotUsed) {
  const std::filesystem::path file =
      test::shared_folder() / "data" / "vehicle" / "kalman_balzer82" / "2014-03-26-000-Data.csv";
  VERIDYN_NEEDS_SHARED(file);
  const Study study = Study::parse(
      "[map]\nyaw_rate = { channel = 'yawrate', unit = 'deg/s' }\nspeed = { channel = 'speed', unit = 'km/h' }\n"
      "yaw = { channel = 'yaw', unit = 'deg' }\ncourse = { channel = 'course', unit = 'deg', scale = -1 }\n"
      "roll = 'none'\npitch = 'none'\naccel_y = { channel = 'ay', unit = 'm/s^2', scale = -1 }\n",
      "study.toml");
  io::ReadOptions options;
  options.csv.time_column = "millis";
  options.csv.time_unit = "ms";
  const Recording recording = io::read_recording(file, options);
  const DriveSignals signals =
      prepare_drive_signals(map_drive_channels(recording, study.root().table("map"), "flu"), {}, false);
  EXPECT_FALSE(signals.lateral_by_course);
  EXPECT_FALSE(signals[DriveSignal::kLateralVelocity].available());
  EXPECT_THAT(signals.notes, Contains(HasSubstr("course and heading are not used for the lateral velocity")));
}

}  // namespace
}  // namespace veridyn::vehicle
