#include "veridyn/vehicle/track_drive.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/channel_faults.hpp"
#include "tests/support/refusal.hpp"
#include "tests/vehicle/drive_with_drop.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::vehicle {
namespace {

using testing::drive_with_drop;
using testing::mapped;
using testing::study_of;

/// The recording up to a moment.
Recording cut_at(const Recording& whole, double until) {
  Recording part = recording::without_channels(whole);
  for (Channel channel : whole.channels()) {
    const auto times = channel.times();
    const auto n = std::upper_bound(times.begin(), times.end(), until) - times.begin();
    channel.value.resize(n);
    channel.time = make_time_base(std::vector<double>(times.begin(), times.begin() + n));
    part.add(std::move(channel));
  }
  return part;
}

TEST(TrackedDrive, DoesNotDependOnThePiecesInWhichARecordingComes) {
  const Recording whole = drive_with_drop(4, 80.0, 1e9);
  VehicleStudy study = study_of(whole);
  Progress silent;
  const DriveTracking at_once = track(study, silent);
  TrackedDrive pieces(study);
  for (const double until : {5.0, 21.0, 60.2, 61.0, 77.3}) {
    static_cast<void>(pieces.advance(mapped(cut_at(whole, until)), false, silent));
  }
  static_cast<void>(pieces.advance(mapped(whole), true, silent));
  const DriveTracker &a = *at_once.drive.tracker(), &b = *pieces.tracker();
  EXPECT_EQ(a.rows(), b.rows());
  for (const TrackedAxle axle : kAllTrackedAxles) {
    EXPECT_NEAR(a.value(axle), b.value(axle), 1e-9 * std::abs(a.value(axle)));
  }
}

TEST(TrackedDrive, HasNoTrackerBeforeItKnowsNoiseAndBody) {
  const Recording whole = drive_with_drop(4, 70.0, 1e9);
  const VehicleStudy study = study_of(whole);
  Progress silent;
  // 20 s for the noise, and for the body as long as the study says.
  for (const double learning : {0.0, 60.0}) {
    VehicleStudy learning_study = study;
    learning_study.track.learning_s = learning;
    TrackedDrive drive(learning_study);
    const double begins = std::max(20.0, learning);
    EXPECT_TRUE(drive.advance(mapped(cut_at(whole, begins - 1.0)), false, silent).empty());
    EXPECT_EQ(drive.tracker(), nullptr) << learning;
    EXPECT_TRUE(drive.estimate().parameters.empty());
    static_cast<void>(drive.advance(mapped(cut_at(whole, begins + 1.0)), false, silent));
    ASSERT_NE(drive.tracker(), nullptr) << learning;
    EXPECT_EQ(drive.estimate().parameters.size(), kTrackedAxles);
    EXPECT_EQ(drive.tracker()->body().source, learning > 0.0 ? BodySource::kLearned : BodySource::kNone);
  }
}

TEST(TrackedDrive, RefusesADriveWithoutALateralAcceleration) {
  const Recording whole = drive_with_drop(4, 30.0, 1e9);
  Recording without = recording::without_channels(whole);
  for (const Channel& channel : whole.channels())
    if (channel.name != "accel_y") without.add(channel);
  Progress silent;
  EXPECT_THAT(why([&] { static_cast<void>(track(study_of(without), silent)); }), ::testing::HasSubstr("accel_y"));
}

// A tracker has no model whose delay it could find; what signals tell is coarser than what moves the stiffnesses.
TEST(TrackedDrive, DoesNotVerifyThatTheSteeringIsInTime) {
  for (const double late_s : {0.0, 0.03}) {
    Recording whole = drive_with_drop(4, 70.0, 1e9);
    test::delayed({"steer"}, late_s)(whole);
    Progress silent;
    const estimation::Estimate estimate = track(study_of(whole), silent).drive.estimate();
    const auto row =
        std::ranges::find(estimate.evidence, estimation::Check::kSteeringOrder, &estimation::Evidence::check);
    ASSERT_NE(row, estimate.evidence.end()) << late_s;
    EXPECT_EQ(row->outcome, estimation::Outcome::kNotVerified) << late_s << ": " << says(*row);
  }
}

TEST(HistoryRecording, HoldsWhatTheTrackerFollowed) {
  const VehicleStudy study = study_of(drive_with_drop(4, 30.0, 1e9));
  Progress silent;
  const DriveTracking tracking = track(study, silent);
  const DriveTracker& tracker = *tracking.drive.tracker();
  EXPECT_FALSE(tracking.interrupted);
  const Recording history = history_recording(tracker);
  for (const TrackedAxle axle : kAllTrackedAxles) {
    const std::string name(kTrackedAxleNames[axle]);
    const DriveTrackHistory& h = tracker.history(axle);
    const Channel& value = history.at(name);
    EXPECT_EQ(value.value, h.value) << name;
    EXPECT_EQ(std::vector<double>(value.times().begin(), value.times().end()), h.time);
    EXPECT_EQ(history.at("sigma_" + name).value.back(), h.sigma.back());
    EXPECT_EQ(history.at("held_" + name).value.back(), h.held.back() ? 1.0 : 0.0);
    EXPECT_EQ(history.at("suspicion_" + name).value.size(), h.time.size());
  }
}

}  // namespace
}  // namespace veridyn::vehicle
