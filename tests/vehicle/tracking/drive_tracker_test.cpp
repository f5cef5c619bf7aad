#include "veridyn/vehicle/tracking/drive_tracker.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/vehicle/drive_with_drop.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/vehicle/identification/vehicle_identification.hpp"
#include "veridyn/vehicle/track_drive.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::Check;
using testing::family_car;
using testing::mapped;

using testing::drive_with_drop;
using testing::study_of;

TEST(DriveTracker, FindsAGripDropAndFollowsIt) {
  for (const std::uint64_t seed : {1U, 2U}) {
    VehicleStudy study = study_of(drive_with_drop(seed, 90.0, 60.0));
    Progress silent;
    const DriveTracking tracking = track(study, silent);
    const DriveTracker& tracker = *tracking.drive.tracker();
    ASSERT_FALSE(tracker.changes().empty()) << seed;
    for (const DriveChange& c : tracker.changes()) EXPECT_GT(c.change.detected_s, 60.0) << seed;
    EXPECT_LT(tracker.changes().front().change.detected_s, 65.0) << seed;
    const VehicleParameters<double> p = family_car();
    EXPECT_NEAR(tracker.value(TrackedAxle::kFront), 0.6 * p.C_f, 0.02 * p.C_f) << seed;
    EXPECT_NEAR(tracker.value(TrackedAxle::kRear), 0.6 * p.C_r, 0.02 * p.C_r) << seed;
    EXPECT_NEAR(tracker.value(TrackedAxle::kUndersteer), understeer_gradient(p) / 0.6, 2e-4) << seed;
    // Ten seconds after the change, and before it, the history is at the true value.
    const DriveTrackHistory& h = tracker.history(TrackedAxle::kFront);
    for (std::size_t i = 0; i < h.time.size(); ++i) {
      const bool dry = h.time[i] > 20.0 && h.time[i]<59.5, wet = h.time[i]> 72.0;
      const double truth = wet ? 0.6 * p.C_f : p.C_f;
      EXPECT_TRUE(!(dry || wet) || std::abs(h.value[i] - truth) < 0.03 * p.C_f) << h.time[i] << ": " << h.value[i];
    }
  }
}

// Stated: one false alarm in 1000 hours, both axles together. In 1000 s there is one with probability
// 0.0003.
TEST(DriveTracker, RaisesNoMoreFalseAlarmsThanStated) {
  std::size_t alarms = 0;
  for (const std::uint64_t seed : {1U, 2U}) {
    VehicleStudy study = study_of(drive_with_drop(seed, 500.0, 1e9));
    Progress silent;
    alarms += track(study, silent).drive.tracker()->changes().size();
  }
  EXPECT_EQ(alarms, 0u);
}

// Noise is all that moves the rows of straight driving after lively driving.
TEST(DriveTracker, TakesStraightDrivingForNoChange) {
  const DriveSignals lively = prepare_drive_signals(mapped(drive_with_drop(1, 120.0, 1e9)), {});
  const DriveSignals straight = prepare_drive_signals(mapped(drive_with_drop(2, 600.0, 1e9, 1e-4)), {});
  DriveTracker tracker({.vehicle = family_car()}, {}, 3.0, 100.0, {1e-3, 0.05, 1e-3, 0.05});
  double after = 0.0;
  for (const DriveSignals* part : {&lively, &straight}) {
    const DriveSignals& s = *part;
    for (std::size_t k = 0; k < s.size(); ++k)
      static_cast<void>(
          tracker.append({after + s.grid.at(k), s[DriveSignal::kSteer].value[k], s[DriveSignal::kSpeed].value[k],
                          s[DriveSignal::kYawRate].value[k], s[DriveSignal::kAccelY].value[k]}));
    after += s.grid.at(s.size() - 1) + s.grid.step;
  }
  EXPECT_GT(tracker.rows(), 5000u);
  EXPECT_TRUE(tracker.changes().empty());
}

TEST(DriveTracker, HoldsWhatStraightDrivingDoesNotExcite) {
  VehicleStudy study = study_of(drive_with_drop(1, 120.0, 1e9, 1e-4));
  study.vehicle = family_car();
  Progress silent;
  const DriveTracking tracking = track(study, silent);
  const DriveTracker& tracker = *tracking.drive.tracker();
  for (const TrackedAxle axle : {TrackedAxle::kFront, TrackedAxle::kRear}) {
    const DriveTrackHistory& h = tracker.history(axle);
    ASSERT_GT(h.time.size(), 100u);
    EXPECT_TRUE(h.held.back());
    // Once held it does not move at all.
    std::size_t first = h.held.size();
    while (first > 0 && h.held[first - 1]) --first;
    ASSERT_LT(first, h.held.size() / 2);
    for (std::size_t i = first; i < h.value.size(); ++i)
      EXPECT_NEAR(h.value[i], h.value[first], 1e-6 * std::abs(h.value[first]));
  }
  EXPECT_NE(tracker.estimate("car").verdict.find("held at the end"), std::string::npos);
}

const estimation::Evidence* tracked_row(const estimation::Estimate& estimate, Check check, std::string_view about) {
  const auto row = std::ranges::find_if(estimate.evidence, [&](const estimation::Evidence& e) {
    return estimation::check_named(name_of(e)) == check && e.about == about;
  });
  return row == estimate.evidence.end() ? nullptr : &*row;
}

estimation::Estimate tracked_estimate(const Recording& recording) {
  VehicleStudy study = study_of(recording);
  Progress silent;
  return track(study, silent).drive.estimate();
}

TEST(DriveTrackerRows, PassForACarThatDoesNotChange) {
  const estimation::Estimate estimate = tracked_estimate(drive_with_drop(3, 100.0, 1e9));
  for (const std::string_view axle : kTrackedAxleNames) {
    for (const Check check : {Check::kResidualBeyondSensors, Check::kInnovationCorrelation, Check::kCollinearity,
                              Check::kTrackedExcitation, Check::kTrackedParts, Check::kChanges, Check::kNextRow}) {
      const estimation::Evidence* row = tracked_row(estimate, check, axle);
      ASSERT_NE(row, nullptr) << to_string(check) << " of " << axle;
      EXPECT_TRUE(row->passed() || row->bears_on.empty()) << to_string(check) << " of " << axle << ": " << says(*row);
    }
    EXPECT_EQ(estimate.find(std::string(axle))->status, estimation::ParameterStatus::kIdentified) << axle;
  }
  EXPECT_EQ(estimate.judgement.parameters.grade, estimation::Grade::kYes);
  EXPECT_EQ(estimate.judgement.prediction.grade, estimation::Grade::kYes);
  EXPECT_EQ(estimate.judgement.data.grade, estimation::Grade::kYes);
  const estimation::Evidence* body = tracked_row(estimate, Check::kBodyLean, "");
  ASSERT_NE(body, nullptr);
  EXPECT_TRUE(body->passed()) << says(*body);
}

TEST(DriveTrackerRows, SayThatGripDroppedAndWhatIsNotExcited) {
  const estimation::Estimate wet = tracked_estimate(drive_with_drop(1, 90.0, 60.0));
  const bool found = std::ranges::any_of(kTrackedAxleNames, [&](std::string_view axle) {
    return tracked_row(wet, Check::kChanges, axle)->outcome == estimation::Outcome::kCare;
  });
  EXPECT_TRUE(found);
  EXPECT_EQ(wet.judgement.parameters.grade, estimation::Grade::kWithCare);
  const estimation::Estimate straight = tracked_estimate(drive_with_drop(1, 40.0, 1e9, 1e-4));
  EXPECT_EQ(tracked_row(straight, Check::kTrackedExcitation, "C_f")->outcome, estimation::Outcome::kCare);
}

// A steering sensor of the wrong sign, which a whole recording is refused for: to turn that way, the front tyres would
// have to push the other way.
TEST(DriveTrackerRows, RefuseTyresThatPushTheWrongWay) {
  const DriveSignals s = prepare_drive_signals(mapped(drive_with_drop(3, 40.0, 1e9)), {});
  const auto followed = [&](double sign) {
    DriveTracker tracker({.vehicle = family_car()}, {}, 3.0, 100.0, {1e-3, 0.05, 1e-3, 0.05});
    for (std::size_t k = 0; k < s.size(); ++k)
      static_cast<void>(
          tracker.append({s.grid.at(k), sign * s[DriveSignal::kSteer].value[k], s[DriveSignal::kSpeed].value[k],
                          s[DriveSignal::kYawRate].value[k], s[DriveSignal::kAccelY].value[k]}));
    return tracker.estimate("car");
  };
  EXPECT_TRUE(tracked_row(followed(1.0), Check::kPlausibleStiffness, "C_f")->passed());
  const estimation::Estimate reversed = followed(-1.0);
  EXPECT_LT(reversed.find("C_f")->value, 0.0);
  const estimation::Evidence* row = tracked_row(reversed, Check::kPlausibleStiffness, "C_f");
  ASSERT_NE(row, nullptr);
  EXPECT_EQ(row->outcome, estimation::Outcome::kFailed);
  EXPECT_NE(reversed.find("C_f")->status, estimation::ParameterStatus::kIdentified);
  EXPECT_NE(reversed.judgement.parameters.grade, estimation::Grade::kYes);
  EXPECT_TRUE(tracked_row(reversed, Check::kPlausibleStiffness, "C_r")->passed())
      << "the rear axle does not know the steering";
  EXPECT_EQ(tracked_row(reversed, Check::kBodyLean, "")->outcome, estimation::Outcome::kCare) << "it was not learned";
}

TEST(DriveTracker, UsesNoSampleAfterTheOneItWasGiven) {
  const auto run = [](double spoil_after) {
    DriveTracker tracker({.vehicle = family_car()}, {}, 3.0, 100.0, {1e-3, 0.05, 1e-3, 0.05});
    const DriveSignals s = prepare_drive_signals(mapped(drive_with_drop(5, 30.0, 1e9)), {});
    double value = 0.0;
    for (std::size_t k = 0; k < s.size(); ++k) {
      const double t = s.grid.at(k);
      const double factor = t > spoil_after ? 5.0 : 1.0;
      static_cast<void>(tracker.append({t, s[DriveSignal::kSteer].value[k] * factor, s[DriveSignal::kSpeed].value[k],
                                        s[DriveSignal::kYawRate].value[k], s[DriveSignal::kAccelY].value[k]}));
      if (t <= 20.0) value = tracker.value(TrackedAxle::kFront);
    }
    return value;
  };
  EXPECT_EQ(run(20.0), run(1e9));
}

TEST(DriveTracker, LeavesHolesOutAndGoesOn) {
  DriveTracker tracker({.vehicle = family_car()}, {}, 3.0, 100.0, {1e-3, 0.05, 1e-3, 0.05});
  const DriveSignals s = prepare_drive_signals(mapped(drive_with_drop(5, 60.0, 1e9)), {});
  for (std::size_t k = 0; k < s.size(); ++k) {
    DriveSample sample{s.grid.at(k), s[DriveSignal::kSteer].value[k], s[DriveSignal::kSpeed].value[k],
                       s[DriveSignal::kYawRate].value[k], s[DriveSignal::kAccelY].value[k]};
    if (sample.time > 10.0 && sample.time < 12.0) continue;
    if (sample.time > 20.0 && sample.time < 21.0) sample.yaw_rate = std::nan("");
    if (sample.time > 30.0 && sample.time < 32.0) sample.speed = 0.0;
    static_cast<void>(tracker.append(sample));
  }
  const VehicleParameters<double> p = family_car();
  EXPECT_NEAR(tracker.value(TrackedAxle::kFront), p.C_f, 0.03 * p.C_f);
  EXPECT_NEAR(tracker.value(TrackedAxle::kRear), p.C_r, 0.03 * p.C_r);
}

}  // namespace
}  // namespace veridyn::vehicle
