#include "veridyn/aircraft/tracking/flight_tracker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/aircraft/pitching_flight.hpp"
#include "tests/support/refusal.hpp"
#include "veridyn/aircraft/identification/identified_estimate.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"

namespace veridyn::aircraft {
namespace {

using aircraft::testing::kPitchingEnd_s;
using aircraft::testing::pitching;

TrackOptions of_pitching_moment() {
  TrackOptions o;
  o.coefficients = {Coefficient::kCm};
  return o;
}

TEST(FlightTracker, ComesToTheAircraftsParametersRowByRow) {
  const Subject subject = builtin_subject("thor");
  const FlightSignals signals = pitching(subject);
  FlightTracker tracker(subject, of_pitching_moment(), 10.0, nullptr);
  EXPECT_TRUE(tracker.feed(signals, 0.0, kPitchingEnd_s).empty()) << "nothing changes in this flight";
  EXPECT_EQ(tracker.rows(), signals.size());
  EXPECT_DOUBLE_EQ(tracker.last_time(), signals.grid.at(signals.size() - 1));
  EXPECT_DOUBLE_EQ(tracker.row_rate_Hz(), 20.0);
  ASSERT_EQ(tracker.coefficients().size(), 1U);
  EXPECT_EQ(tracker.coefficients()[0].start, "no estimate");
  const estimation::Estimate estimate = tracker.estimate();
  const CoefficientModel& truth = *subject.model.find(Coefficient::kCm);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const estimation::Parameter& p = estimate.parameters[i];
    EXPECT_EQ(p.name, truth.parameter_names()[i]);
    EXPECT_NEAR(p.value, truth.values[i], 4.0 * p.sigma) << p.name;
  }
  EXPECT_EQ(estimate.verdict, "followed: Cm");
}

// Rows and windows, over which the equation error is fitted, are by the clock: a flight in pieces gives the bits of the
// whole, wherever the pieces end.
TEST(FlightTracker, TakesAFlightInPiecesAsTheWhole) {
  const Subject subject = builtin_subject("thor");
  FlightSignals signals = pitching(subject, {.later_noise = 0.02});
  // With an error of the elevator the estimate depends on that of the equation, which grows with the noise.
  signals[FlightSignal::kElevator].sigma = 0.005;
  signals[FlightSignal::kElevator].error = ErrorKind::kClassical;
  FlightTracker whole(subject, of_pitching_moment(), 10.0, nullptr),
      pieces(subject, of_pitching_moment(), 10.0, nullptr);
  static_cast<void>(whole.feed(signals, 0.0, kPitchingEnd_s));
  for (double until = 7.0; until <= kPitchingEnd_s; until += 7.0) static_cast<void>(pieces.feed(signals, 0.0, until));
  static_cast<void>(pieces.feed(signals, 0.0, kPitchingEnd_s));
  EXPECT_EQ(pieces.rows(), whole.rows());
  const estimation::Estimate a = whole.estimate(), b = pieces.estimate();
  for (std::size_t i = 0; i < a.parameters.size(); ++i) {
    EXPECT_EQ(a.parameters[i].value, b.parameters[i].value) << a.parameters[i].name;
    EXPECT_EQ(a.parameters[i].sigma, b.parameters[i].sigma) << a.parameters[i].name;
  }
}

// Half the elevator is lost at 160 s.
TEST(FlightTracker, FindsThatTheAircraftChanged) {
  const Subject subject = builtin_subject("thor");
  FlightTracker tracker(subject, of_pitching_moment(), 10.0, nullptr);
  const auto changes = tracker.feed(pitching(subject, {.later_elevator = 0.5}), 0.0, kPitchingEnd_s);
  ASSERT_FALSE(changes.empty());
  EXPECT_EQ(changes[0].coefficient, Coefficient::kCm);
  EXPECT_GE(changes[0].change.detected_s, aircraft::testing::kPitchingHoldout_s);
  EXPECT_LT(changes[0].change.detected_s, aircraft::testing::kPitchingHoldout_s + 10.0);
  EXPECT_EQ(tracker.changes().size(), changes.size());
}

TEST(FlightTracker, BeginsWithABatchEstimateWhereThatIsComplete) {
  const Subject subject = builtin_subject("thor");
  const FlightSignals signals = pitching(subject);
  estimation::Estimate batch =
      make_estimate(subject, std::vector<CoefficientResult>{aircraft::testing::identified_cm(subject, signals)});
  FlightTracker started(subject, of_pitching_moment(), 10.0, &batch);
  static_cast<void>(started.feed(signals, 0.0, 30.0));
  EXPECT_EQ(started.coefficients()[0].start, "batch estimate");
  FlightTracker without(subject, of_pitching_moment(), 10.0, nullptr);
  static_cast<void>(without.feed(signals, 0.0, 30.0));
  const auto sigma = [](const FlightTracker& t) { return t.estimate().find("Cm_de")->sigma; };
  EXPECT_LT(sigma(started), 0.7 * sigma(without)) << "four minutes are known beforehand";
  batch.parameters.pop_back();
  FlightTracker incomplete(subject, of_pitching_moment(), 10.0, &batch);
  static_cast<void>(incomplete.feed(signals, 0.0, 30.0));
  EXPECT_EQ(incomplete.coefficients()[0].start, "no estimate");
}

TEST(FlightTracker, WaitsForItsNoiseAndForTheAir) {
  const Subject subject = builtin_subject("thor");
  FlightSignals signals = pitching(subject);
  FlightTracker tracker(subject, of_pitching_moment(), 10.0, nullptr);
  static_cast<void>(tracker.feed(signals, 0.0, FlightTracker::kLearnSeconds - 1.0));
  EXPECT_FALSE(tracker.coefficients()[0].tracker.has_value());
  EXPECT_THAT(tracker.estimate().warnings, ::testing::ElementsAre("Cm: less than 20 s in the air"));
  EXPECT_EQ(tracker.estimate().verdict, "followed: nothing; not followed: Cm");
  FlightTracker grounded(subject, of_pitching_moment(), 25.0, nullptr);
  static_cast<void>(grounded.feed(signals, 0.0, kPitchingEnd_s));
  EXPECT_EQ(grounded.rows(), 0U) << "20 m/s is below the least airspeed";
}

TEST(FlightTracker, SaysWhatItCannotFollow) {
  Subject subject = builtin_subject("thor");
  subject.model.coefficients[Coefficient::kCm].reset();
  EXPECT_EQ(why([&] { FlightTracker(subject, of_pitching_moment(), 10.0, nullptr); }),
            "thor: its model has none of the coefficients to track");
  const Subject whole = builtin_subject("thor");
  FlightSignals signals = pitching(whole);
  signals[FlightSignal::kElevator] = {};
  FlightTracker tracker(whole, of_pitching_moment(), 10.0, nullptr);
  static_cast<void>(tracker.feed(signals, 0.0, 40.0));
  EXPECT_FALSE(tracker.coefficients()[0].obstacle.empty());
  EXPECT_FALSE(tracker.coefficients()[0].tracker.has_value());
}

}  // namespace
}  // namespace veridyn::aircraft
