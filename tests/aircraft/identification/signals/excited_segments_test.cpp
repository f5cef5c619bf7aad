#include "veridyn/aircraft/identification/signals/excited_segments.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/aircraft/pitching_flight.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"

namespace veridyn::aircraft {
namespace {

/// Two minutes: calm, a minute of elevator and pitching, calm.
FlightSignals manoeuvring(FlightSignal control, FlightSignal rate) {
  FlightSignals s = aircraft::testing::pitching(builtin_subject("thor"));
  for (std::size_t i = 0; i < kFlightSignals; ++i) {
    if (i != static_cast<std::size_t>(FlightSignal::kAirspeed)) s.signals[i].value.assign(s.size(), 0.0);
  }
  for (std::size_t k = 0; k < s.size(); ++k) {
    const double t = s.grid.at(k);
    if (t < 60.0 || t > 120.0) continue;
    s[control].value[k] = 0.1 * std::sin(2.0 * t);
    s[rate].value[k] = 0.5 * std::cos(2.0 * t);
  }
  return s;
}

SegmentOptions above_ten() {
  SegmentOptions o;
  o.min_airspeed_mps = 10.0;
  return o;
}

TEST(ExcitedSegments, AreWhereASurfaceMovesAndTheBodyAnswersOnTheSurfacesAxis) {
  const Segments pitch = excited_segments(manoeuvring(FlightSignal::kElevator, FlightSignal::kQ), above_ten());
  ASSERT_EQ(pitch.airborne.size(), 1U);
  ASSERT_FALSE(pitch.longitudinal.excited.empty());
  EXPECT_NEAR(pitch.longitudinal.excited.front().begin, 60.0, 3.0);
  EXPECT_NEAR(pitch.longitudinal.excited.back().end, 120.0, 3.0);
  EXPECT_TRUE(pitch.lateral.excited.empty());
  for (const FlightSignal surface : {FlightSignal::kAileron, FlightSignal::kRudder}) {
    const FlightSignal rate = surface == FlightSignal::kAileron ? FlightSignal::kP : FlightSignal::kR;
    const Segments lateral = excited_segments(manoeuvring(surface, rate), above_ten());
    EXPECT_FALSE(lateral.lateral.excited.empty());
    EXPECT_TRUE(lateral.longitudinal.excited.empty());
  }
}

TEST(ExcitedSegments, LieInTheAir) {
  FlightSignals s = manoeuvring(FlightSignal::kElevator, FlightSignal::kQ);
  for (std::size_t k = 0; k < s.size(); ++k)
    if (s.grid.at(k) < 90.0) s[FlightSignal::kAirspeed].value[k] = 5.0;
  const Segments segments = excited_segments(s, above_ten());
  ASSERT_EQ(segments.airborne.size(), 1U);
  EXPECT_NEAR(segments.airborne[0].begin, 90.0, 0.1);
  ASSERT_FALSE(segments.longitudinal.excited.empty());
  EXPECT_GE(segments.longitudinal.excited.front().begin, 89.9);
}

TEST(ExcitedSegments, FormNoRowsWhereTheAirspeedFailsForAMoment) {
  FlightSignals s = manoeuvring(FlightSignal::kElevator, FlightSignal::kQ);
  const auto failing = [&s](std::size_t k) { return s.grid.at(k) > 80.0 && s.grid.at(k) < 81.5; };
  for (std::size_t k = 0; k < s.size(); ++k)
    if (failing(k)) s[FlightSignal::kAirspeed].value[k] = 1e-3;
  const Segments segments = excited_segments(s, above_ten());
  ASSERT_EQ(segments.airborne.size(), 1U) << "a dip of less than two seconds is no landing";
  const std::size_t notes = s.notes.size();
  leave_out_slow_flight(s, segments, 10.0);
  for (std::size_t k = 0; k < s.size(); ++k)
    ASSERT_EQ(std::isfinite(s[FlightSignal::kAirspeed].value[k]), !failing(k)) << s.grid.at(k);
  ASSERT_EQ(s.notes.size(), notes + 1);
  EXPECT_THAT(s.notes.back(), ::testing::HasSubstr("below 10.0 m/s (segments.min_airspeed) for 1.5 s"));

  FlightSignals sound = manoeuvring(FlightSignal::kElevator, FlightSignal::kQ);
  leave_out_slow_flight(sound, segments, 10.0);
  EXPECT_EQ(sound.notes.size(), notes);
}

}  // namespace
}  // namespace veridyn::aircraft
