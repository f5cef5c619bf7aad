#include "veridyn/aircraft/tracking/tracked_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/aircraft/pitching_flight.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"

namespace veridyn::aircraft {
namespace {

/// A flight in which the side force is the subject's, by beta and rudder; from `lost_s` on twice the rudder's part.
FlightSignals slipping(const Subject& subject, double lost_s = 1e9) {
  using F = FlightSignal;
  FlightSignals s = aircraft::testing::pitching(subject);
  numerics::RandomStream random(5, "slipping");
  const CoefficientModel& side = *subject.model.find(Coefficient::kCY);
  const double per_force = 0.5 * 1.2 * 400.0 * subject.wing_area / subject.mass;
  for (std::size_t k = 0; k < s.size(); ++k) {
    const double t = s.grid.at(k);
    s[F::kBeta].value[k] = 0.1 * std::sin(0.9 * t);
    s[F::kRudder].value[k] = 0.2 * std::sin(1.9 * t);
    s[F::kAileron].value[k] = 0.2 * std::cos(1.3 * t);
    s[F::kP].value[k] = 0.8 * std::sin(2.2 * t);
    s[F::kR].value[k] = 0.5 * std::cos(0.6 * t);
    double CY = side.linear(aero_variables(s.sample(k), subject, 1.2)) + 0.002 * random.normal();
    if (t > lost_s) CY += side.value_of("beta").value() * s[F::kBeta].value[k];
    s[F::kAy].value[k] = per_force * CY;
  }
  s[F::kAy].sigma = per_force * 0.002;
  s[F::kAy].error = ErrorKind::kClassical;
  return s;
}

TrackOptions of_side_force() {
  TrackOptions o;
  o.coefficients = {Coefficient::kCY};
  return o;
}

TEST(TrackedModel, BeginsWithTheStudysValuesOrWithNone) {
  const Subject subject = builtin_subject("thor");
  TrackOptions o = of_side_force();
  const FilterModel study = TrackedModel(subject, o, {}).start();
  EXPECT_EQ(study.reason, "values of the study");
  ASSERT_TRUE(study.aero.has_value());
  for (const ModelSource source : study.source) EXPECT_EQ(source, ModelSource::kStudy);
  EXPECT_EQ(study.aero->find(Coefficient::kCL)->values, subject.model.find(Coefficient::kCL)->values);
  EXPECT_EQ(study.aero->find(Coefficient::kCm), nullptr) << "moments are not used";
  o.starts_from_study = false;
  const FilterModel none = TrackedModel(subject, o, {}).start();
  EXPECT_EQ(none.reason, "CL is not known");
  EXPECT_FALSE(none.aero.has_value());
  EXPECT_FALSE(none.error.modelled[0]);
}

TEST(TrackedModel, TakesTheStudysLiftOnlyWhereAllOfItIsKnown) {
  Subject subject = builtin_subject("thor");
  subject.model.find(Coefficient::kCD)->values[0] = std::nan("");
  const FilterModel start = TrackedModel(subject, of_side_force(), {}).start();
  EXPECT_EQ(start.source[0], ModelSource::kStudy);
  EXPECT_EQ(start.source[1], ModelSource::kNone);
  EXPECT_EQ(start.aero->find(Coefficient::kCD), nullptr);
  EXPECT_FALSE(start.error.modelled[1]);
}

TEST(TrackedModel, TakesWhatWasIdentifiedOnceAndAgainOnlyWhereItMoves) {
  const Subject subject = builtin_subject("thor");
  const FlightSignals signals = slipping(subject);
  FlightTracker tracker(subject, of_side_force(), 10.0, nullptr);
  TrackedModel model(subject, of_side_force(), {});
  EXPECT_FALSE(model.look(tracker, 0.0)) << "before there is a tracker";
  std::size_t given = 0;
  for (double until = 30.0; until <= 240.0; until += 10.0) {
    static_cast<void>(tracker.feed(signals, 0.0, until));
    const auto next = model.look(tracker, until);
    if (!next) continue;
    ++given;
    EXPECT_EQ(next->from_s, until);
    EXPECT_EQ(next->source[2], ModelSource::kTracked);
    EXPECT_EQ(next->reason == "CY identified", given == 1) << next->reason;
    // The uncertainty of the estimate comes on top of what a model is said to be wrong by.
    EXPECT_GT(next->error.initial[2], ReconstructOptions{}.model_error[2]);
    EXPECT_EQ(next->error.initial[0], ReconstructOptions{}.model_error[0]);
  }
  EXPECT_GE(given, 1U);
  EXPECT_LT(given, 10U) << "every new model starts the filter again";
}

// A change withdraws the coefficient, also that of the study.
TEST(TrackedModel, WithdrawsWhatChanged) {
  const Subject subject = builtin_subject("thor");
  const FlightSignals signals = slipping(subject, 100.0);
  FlightTracker tracker(subject, of_side_force(), 10.0, nullptr);
  TrackedModel model(subject, of_side_force(), {});
  std::optional<FilterModel> withdrawn;
  for (double until = 30.0; until <= 140.0 && !withdrawn; until += 2.0) {
    static_cast<void>(tracker.feed(signals, 0.0, until));
    const auto next = model.look(tracker, until);
    if (next && next->source[2] == ModelSource::kNone) withdrawn = next;
  }
  ASSERT_TRUE(withdrawn.has_value());
  EXPECT_TRUE(withdrawn->reason.starts_with("CY changed at 10")) << withdrawn->reason;
  EXPECT_EQ(withdrawn->source[0], ModelSource::kStudy) << "lift stays";
}

TEST(ModelSource, HasANameForEach) {
  EXPECT_EQ(to_string(ModelSource::kNone), "none");
  EXPECT_EQ(to_string(ModelSource::kStudy), "study");
  EXPECT_EQ(to_string(ModelSource::kTracked), "tracked");
}

}  // namespace
}  // namespace veridyn::aircraft
