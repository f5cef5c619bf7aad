#include "veridyn/recording/motion_recording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::recording {
namespace {

using ::testing::HasSubstr;

/// Driving on irregular stamps, in frame flu: an accelerometer that rolls, gyros, attitude.
std::vector<MotionSample> driven() {
  std::vector<MotionSample> all;
  double t = 3.0;
  for (int k = 0; k < 500; ++k) {
    t += 0.012 + 0.009 * std::sin(1.7 * k);
    MotionSample s;
    s.time = t;
    s.frame = Frame::kFlu;
    s.attitude = numerics::quaternion_from_euler(0.05 * std::sin(t), 0.03 * std::cos(t), 0.4 * t - 1.0);
    s.force = s.attitude.conjugate() * Eigen::Vector3d(0.0, 0.0, kGravity) +
              Eigen::Vector3d(std::sin(t), 2.0 * std::cos(t), 0.1);
    s.rate = {0.05 * std::cos(t), -0.03 * std::sin(t), 0.4};
    s.position = {20.0 * t, std::sin(t)};
    s.force_from = s.rate_from = s.attitude_from = s.position_from = Origin::kMeasured;
    all.push_back(s);
  }
  return all;
}

Recording recorded() {
  Recording r = to_recording(driven());
  r.source = "drive.csv";
  return r;
}

/// With one channel changed.
Recording with(const char* name, const std::function<double(double)>& change) {
  Recording r = recorded();
  Channel c = r.at(name);
  for (double& v : c.value) v = change(v);
  r.set(c);
  return r;
}
Recording without(std::initializer_list<std::string> names) {
  Recording r;
  const Recording all = recorded();
  r.frame = all.frame;
  r.source = all.source;
  for (const Channel& c : all.channels()) {
    if (std::find(names.begin(), names.end(), c.name) == names.end()) r.add(c);
  }
  return r;
}

std::string refusal(const Recording& r) {
  try {
    static_cast<void>(motion_samples(r));
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}

TEST(MotionSamples, ComeBackFromTheirRecordingWithTheirStamps) {
  const std::vector<MotionSample> before = driven();
  const RecordedMotion after = motion_samples(recorded());
  ASSERT_EQ(after.samples.size(), before.size());
  EXPECT_TRUE(after.notes.empty());
  for (std::size_t k = 0; k < before.size(); ++k) {
    EXPECT_EQ(after.samples[k].time, before[k].time);
    EXPECT_LT((after.samples[k].force - before[k].force).norm(), 1e-12);
    EXPECT_LT((after.samples[k].rate - before[k].rate).norm(), 1e-12);
    EXPECT_LT(after.samples[k].attitude.angularDistance(before[k].attitude), 1e-7);
    EXPECT_EQ(after.samples[k].position, before[k].position);
    EXPECT_EQ(after.samples[k].position_from, Origin::kMeasured);
    EXPECT_EQ(after.samples[k].force_from, Origin::kMeasured);
    EXPECT_EQ(after.samples[k].angular_acceleration_from, Origin::kDerived);
  }
}

TEST(MotionSamples, WithoutGravityItIsPutInByTheAttitude) {
  std::vector<MotionSample> bare = driven();
  for (MotionSample& s : bare) s.force -= s.attitude.conjugate() * Eigen::Vector3d(0.0, 0.0, kGravity);
  const RecordedMotion after = motion_samples(to_recording(bare));
  const std::vector<MotionSample> whole = driven();
  for (std::size_t k = 0; k < whole.size(); ++k) ASSERT_LT((after.samples[k].force - whole[k].force).norm(), 1e-9) << k;
  ASSERT_EQ(after.notes.size(), 1u);
  EXPECT_THAT(after.notes[0], HasSubstr("without gravity"));
}

TEST(MotionSamples, SayWhatIsNotRecorded) {
  const RecordedMotion m = motion_samples(without({"accel_z", "gyro_x", "gyro_y", "roll", "pitch", "yaw"}));
  EXPECT_EQ(m.notes.size(), 3u);
  EXPECT_EQ(m.samples[0].force.z(), kGravity);
  EXPECT_EQ(m.samples[0].rate.x(), 0.0);
  EXPECT_EQ(m.samples[0].attitude_from, Origin::kAbsent);
}

TEST(MotionSamples, RefuseWhatCannotBe) {
  EXPECT_THAT(refusal(without({"accel_x"})), HasSubstr("accel_x"));
  EXPECT_THAT(refusal(with("gyro_z", [](double v) { return v / kDegree; })), HasSubstr("deg/s"));
  EXPECT_THAT(refusal(with("accel_z", [](double v) { return v + kGravity; })), HasSubstr("twice"));
  EXPECT_THAT(refusal(with("accel_z", [](double v) { return v / kGravity; })), HasSubstr("in g"));
  EXPECT_THAT(refusal(with("accel_z", [](double v) { return -v; })), HasSubstr("accel_z is -9.9"));
  EXPECT_THAT(refusal(with("accel_z", [](double) { return 5.0; })), HasSubstr("neither 1 g nor none"));
  Recording slow;
  slow.frame = Frame::kFlu;
  slow.source = "gps.csv";
  const TimeBase seconds = make_time_base({0.0, 1.0, 2.0, 3.0});
  for (const char* name : {"accel_x", "accel_y"})
    slow.add(
        {.name = name, .unit = parse_unit("m/s^2"), .recorded_unit = "m/s^2", .time = seconds, .value = {0, 0, 0, 0}});
  EXPECT_THAT(refusal(slow), HasSubstr("1 samples a second"));
}

}  // namespace
}  // namespace veridyn::recording
