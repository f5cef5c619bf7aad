#include "veridyn/aircraft/identification/signals/segments.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {
namespace {

using ::testing::HasSubstr;

constexpr double kStep = 0.02;

/// 200 s: on the ground until 20 s; elevator doublets with a pitching answer at 60..90 s, aileron at 120..140 s; a
/// little of everything all the time.
struct Flight {
  std::vector<double> airspeed, p, q, r, elevator, aileron, rudder;

  Flight() {
    for (std::size_t k = 0; k < 10000; ++k) {
      const double t = kStep * static_cast<double>(k);
      const double busy = std::sin(2.0 * t);
      const bool pitching = t > 60.0 && t < 90.0;
      const bool rolling = t > 120.0 && t < 140.0;
      airspeed.push_back(t > 20.0 ? 15.0 : 1.0);
      elevator.push_back((pitching ? 4.0 : 0.1) * kDegree * busy);
      q.push_back((pitching ? 20.0 : 0.5) * kDegree * busy);
      aileron.push_back((rolling ? 5.0 : 0.1) * kDegree * busy);
      p.push_back((rolling ? 30.0 : 0.5) * kDegree * busy);
      r.push_back(0.0);
      rudder.push_back(0.0);
    }
  }
  [[nodiscard]] SegmentSignals signals() const { return {0.0, kStep, airspeed, p, q, r, elevator, aileron, rudder}; }
};

SegmentOptions options() {
  SegmentOptions o;
  o.min_airspeed_mps = 8.0;
  return o;
}

TEST(Segments, FindTheFlightAndTheManoeuvresOfEachAxis) {
  const Flight flight;
  const Segments found = find_segments(flight.signals(), options());
  ASSERT_EQ(found.airborne.size(), 1u);
  EXPECT_NEAR(found.airborne[0].begin, 20.0, 0.05);
  ASSERT_EQ(found.longitudinal.excited.size(), 1u);
  // The window of 4 s sees the manoeuvre up to 2 s before and after.
  EXPECT_NEAR(found.longitudinal.excited[0].begin, 60.0, 2.0);
  EXPECT_NEAR(found.longitudinal.excited[0].end, 90.0, 2.0);
  ASSERT_EQ(found.lateral.excited.size(), 1u);
  EXPECT_NEAR(found.lateral.excited[0].begin, 120.0, 2.0);
}

TEST(Segments, AssignTheChosenShareToTheHoldoutWithoutOverlap) {
  const Flight flight;
  const Segments found = find_segments(flight.signals(), options());
  double held = 0.0;
  for (const TimeSpan& h : found.longitudinal.holdout) {
    held += h.duration();
    for (const TimeSpan& i : found.longitudinal.identification) EXPECT_TRUE(h.end <= i.begin || h.begin >= i.end);
  }
  EXPECT_NEAR(held / found.longitudinal.excited_s(), 1.0 / 3.0, 0.08);
}

TEST(Segments, FindNothingInACalmFlight) {
  Flight flight;
  for (double& e : flight.elevator) e = 0.1 * kDegree;
  const Segments found = find_segments(flight.signals(), options());
  EXPECT_TRUE(found.longitudinal.excited.empty());
  EXPECT_THAT(found.longitudinal.text, HasSubstr("longitudinal segments: 0 found"));
}

TEST(Segments, NeedAnAnswerOfTheBody) {
  Flight flight;
  for (double& q : flight.q) q = 0.0;
  EXPECT_TRUE(find_segments(flight.signals(), options()).longitudinal.excited.empty());
}

// A transport aircraft: the elevator moves by 0.4 deg, and the body answers with half a degree a second.
TEST(Segments, FollowAFlightThatIsGentleThroughout) {
  Flight flight;
  for (double& e : flight.elevator) e *= 0.1;
  for (double& q : flight.q) q *= 0.025;
  const AxisSegments found = find_segments(flight.signals(), options()).longitudinal;
  ASSERT_EQ(found.excited.size(), 1U);
  EXPECT_NEAR(found.excited[0].begin, 60.0, 2.0);
  EXPECT_NEAR(found.excited[0].end, 90.0, 2.0);
  EXPECT_NEAR(found.input_threshold_rad, 0.5 * 0.4 * kDegree / std::sqrt(2.0), 0.02 * kDegree);
  EXPECT_THAT(found.text, HasSubstr("exceeds 0.14 deg"));

  SegmentOptions strict = options();
  strict.min_input_rad = 0.01;
  EXPECT_TRUE(find_segments(flight.signals(), strict).longitudinal.excited.empty()) << "as it was before";
  strict.min_input_rad.reset();
  strict.min_rate_radps = 0.035;
  EXPECT_TRUE(find_segments(flight.signals(), strict).longitudinal.excited.empty());

  // One short manoeuvre of a long flight counts by the calm parts alone; trembling of hundredths of a degree does not.
  for (std::size_t k = 0; k < flight.elevator.size(); ++k)
    if (const double t = kStep * static_cast<double>(k); t > 64.0 && t < 90.0) flight.elevator[k] *= 0.025;
  const AxisSegments single = find_segments(flight.signals(), options()).longitudinal;
  ASSERT_EQ(single.excited.size(), 1U);
  EXPECT_NEAR(single.excited[0].end, 64.0, 2.0);
  EXPECT_NEAR(single.input_threshold_rad, 0.05 * kDegree, 1e-9);
}

// As much as usual where the flight is lively, however much that is.
TEST(Segments, AskOfALivelyFlightWhatTheyAlwaysDid) {
  Flight flight;
  for (double& e : flight.elevator) e *= 3.0;
  const AxisSegments found = find_segments(flight.signals(), options()).longitudinal;
  EXPECT_DOUBLE_EQ(found.input_threshold_rad, 0.01);
  EXPECT_DOUBLE_EQ(found.rate_threshold_radps, 0.035);
}

TEST(Segments, FollowTheUser) {
  const Flight flight;
  SegmentOptions given = options();
  given.longitudinal = {{100.0, 110.0}};
  given.holdout = 0.0;
  const Segments found = find_segments(flight.signals(), given);
  EXPECT_EQ(found.longitudinal.excited, given.longitudinal);
  EXPECT_EQ(found.longitudinal.identification, given.longitudinal);
  EXPECT_TRUE(found.longitudinal.holdout.empty());
}

/// Three seconds cut out of a flight: nothing but a doublet of the elevator.
TEST(Segments, TakeAFileOfOneManoeuvreForWhatItIs) {
  Flight cut;
  const auto part = [](std::vector<double>& x) { x = std::vector<double>(x.begin() + 3500, x.begin() + 3650); };
  for (std::vector<double>* x : {&cut.airspeed, &cut.p, &cut.q, &cut.r, &cut.elevator, &cut.aileron, &cut.rudder})
    part(*x);
  const Segments found = find_segments(cut.signals(), options());
  ASSERT_EQ(found.airborne.size(), 1u);
  ASSERT_EQ(found.longitudinal.identification.size(), 1u);
  EXPECT_NEAR(found.longitudinal.identification[0].duration(), 3.0, 0.05);
  EXPECT_TRUE(found.longitudinal.holdout.empty());
  EXPECT_TRUE(found.lateral.excited.empty());
}

// 30 s of aileron, in the second block of which alone the rudder is moved: without it nothing says what it does.
TEST(Segments, KeepTheOnlyManoeuvreOfASurfaceForIdentification) {
  Flight flight;
  for (std::size_t k = 0; k < flight.rudder.size(); ++k) {
    const double t = kStep * static_cast<double>(k);
    if (t > 120.0 && t < 150.0) {
      flight.aileron[k] = 5.0 * kDegree * std::sin(2.0 * t);
      flight.p[k] = 30.0 * kDegree * std::sin(2.0 * t);
    }
  }
  const Segments before = find_segments(flight.signals(), options());
  ASSERT_FALSE(before.lateral.holdout.empty());
  const TimeSpan held = before.lateral.holdout.front();
  for (std::size_t k = 0; k < flight.rudder.size(); ++k) {
    const double t = kStep * static_cast<double>(k);
    if (t > held.begin + 2.0 && t < held.end - 2.0) flight.rudder[k] = 5.0 * kDegree * std::sin(3.0 * t);
  }
  for (const TimeSpan& span : find_segments(flight.signals(), options()).lateral.holdout)
    EXPECT_FALSE(span.contains(0.5 * (held.begin + held.end)));
}

// The aircraft climbs by 1 m/s from 30 s on, ten seconds after it is fast enough, and comes back at 190 s.
TEST(Segments, LeaveOutTheGroundRollAndTheLanding) {
  Flight flight;
  std::vector<double> vel_down;
  for (std::size_t k = 0; k < flight.airspeed.size(); ++k) {
    const double t = kStep * static_cast<double>(k);
    vel_down.push_back(t > 30.0 && t < 50.0 ? -1.0 : t > 170.0 && t < 190.0 ? 1.0 : 0.0);
    if (t > 195.0) flight.airspeed[k] = 1.0;
  }
  SegmentSignals signals = flight.signals();
  signals.vel_down = vel_down;
  const Segments found = find_segments(signals, options());
  ASSERT_EQ(found.airborne.size(), 1u);
  EXPECT_NEAR(found.airborne[0].begin, 35.0, 0.1);
  EXPECT_NEAR(found.airborne[0].end, 185.0, 0.1);
  // In a recording that begins and ends in the air nothing is cut off.
  std::ranges::fill(flight.airspeed, 15.0);
  signals.airspeed = flight.airspeed;
  EXPECT_NEAR(find_segments(signals, options()).airborne[0].begin, 0.0, 0.1);
}

// A flight that never leaves the ground by its vertical velocity is as long as its airspeed says.
TEST(Segments, CutNothingByAVerticalVelocityThatSaysNothing) {
  const Flight flight;
  SegmentSignals signals = flight.signals();
  const std::vector<double> nothing(flight.airspeed.size(), 0.0);
  signals.vel_down = nothing;
  EXPECT_NEAR(find_segments(signals, options()).airborne.at(0).begin, 20.0, 0.05);
}

TEST(Segments, KeepGapsOutOfTheFlight) {
  Flight flight;
  for (std::size_t k = 3500; k < 4000; ++k) flight.airspeed[k] = std::numeric_limits<double>::quiet_NaN();
  const Segments found = find_segments(flight.signals(), options());
  EXPECT_EQ(found.airborne.size(), 2u);
}

TEST(SegmentOptions, RefuseASegmentWithoutLength) {
  const Study study = Study::parse("[segments]\nlongitudinal = [10, 10]\n", "study.toml");
  try {
    static_cast<void>(SegmentOptions::keys().read(study.root().table("segments")));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "study.toml:2: segments.longitudinal: segment 10 s to 10 s has no length");
  }
}

}  // namespace
}  // namespace veridyn::aircraft
