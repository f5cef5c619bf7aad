#include "veridyn/aircraft/identification/evidence/missing_sensor_evidence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Outcome;

/// A minute at 20 m/s; alpha moves by 2 deg root mean square.
struct UnfeltFlight {
  Recording recording;
  Reconstruction reconstruction;
  Segments segments;

  UnfeltFlight(double sigma_airspeed, double sigma_alpha) {
    std::vector<double> t, alpha;
    for (int i = 0; i <= 600; ++i) {
      t.push_back(0.1 * i);
      alpha.push_back(2.0 * std::sqrt(2.0) * kDegree * std::sin(0.1 * kPi * i));
    }
    const TimeBase time = make_time_base(t);
    const auto constant = [&](double v) { return std::vector<double>(t.size(), v); };
    Recording& r = reconstruction.smoothed;
    r.add(make_channel("airspeed", "m/s", time, constant(20.0)));
    r.add(make_channel("sigma_airspeed", "m/s", time, constant(sigma_airspeed)));
    r.add(make_channel("alpha", "rad", time, alpha));
    r.add(make_channel("sigma_alpha", "rad", time, constant(sigma_alpha)));
    r.add(make_channel("sigma_wind_down", "m/s", time, constant(0.1)));
    for (const char* name : {"roll", "pitch", "vel_north", "vel_east", "beta"})
      recording.add(make_channel(name, "rad", time, constant(0.0)));
    segments.airborne = segments.longitudinal.excited = {{0.0, 60.0}};
  }
  [[nodiscard]] std::vector<FlightEvidence> rows() const {
    return missing_sensor_evidence(recording, reconstruction, segments);
  }
  [[nodiscard]] FlightEvidence row(const std::string& name) const {
    const std::vector<FlightEvidence> all = rows();
    return *std::ranges::find(all, name, [](const FlightEvidence& e) { return e.row.name; });
  }
};

TEST(MissingSensorEvidence, SaysByHowMuchTheWindLeavesTheAirspeedInDoubt) {
  const FlightEvidence sure = UnfeltFlight(0.1, 0.001).row("no airspeed sensor");
  EXPECT_NEAR(sure.row.value, 0.1 / 20.0, 1e-12);
  EXPECT_EQ(sure.row.outcome, Outcome::kNotVerified);
  ASSERT_TRUE(sure.doubt.has_value());
  EXPECT_TRUE(sure.doubt->in_interval);
  EXPECT_NEAR(sure.doubt->scale, 0.1 / 20.0, 1e-12);
  EXPECT_EQ(UnfeltFlight(0.4, 0.001).row("no airspeed sensor").row.outcome, Outcome::kCare);
  EXPECT_EQ(UnfeltFlight(1.0, 0.001).row("no airspeed sensor").row.outcome, Outcome::kFailed);
}

// Unknown over known variance: (0.05/2)^2, (0.15/2)^2, (1/2)^2.
TEST(MissingSensorEvidence, ComparesUnfeltGustsWithManoeuvres) {
  const FlightEvidence calm = UnfeltFlight(0.1, 0.05 * kDegree).row("no alpha vane");
  EXPECT_NEAR(calm.row.value, 0.000625, 3e-6);
  EXPECT_EQ(calm.row.outcome, Outcome::kNotVerified);
  EXPECT_NEAR(calm.doubt->zero, 0.1 / 20.0, 1e-12);
  EXPECT_EQ(UnfeltFlight(0.1, 0.15 * kDegree).row("no alpha vane").row.outcome, Outcome::kCare);
  const FlightEvidence gusty = UnfeltFlight(0.1, 1.0 * kDegree).row("no alpha vane");
  EXPECT_EQ(gusty.row.outcome, Outcome::kFailed);
  EXPECT_TRUE(gusty.bears_on(Coefficient::kCm));
  EXPECT_FALSE(gusty.bears_on(Coefficient::kCn));
  EXPECT_FALSE(gusty.row.bears_on.contains(estimation::Purpose::kPrediction)) << "it may predict in such gusts";
}

TEST(MissingSensorEvidence, HasNoRowOfWhatIsThere) {
  UnfeltFlight flight(1.0, 1.0);
  const TimeBase time = make_time_base({0.0, 60.0});
  for (const char* name : {"airspeed", "alpha"}) flight.recording.add(make_channel(name, "1", time, {0.0, 0.0}));
  EXPECT_TRUE(flight.rows().empty());
}

TEST(MissingSensorEvidence, AskNothingOfAFilterThatDidNotRunButTheNoiseOfTheAirspeed) {
  UnfeltFlight flight(0.1, 1.0);
  flight.reconstruction.filter = FilterKind::kNone;
  EXPECT_TRUE(flight.rows().empty());
  flight.recording = {};
  ASSERT_EQ(flight.rows().size(), 2U);
  EXPECT_EQ(flight.rows().front().row.name, "ground velocity");
  UnfeltFlight noisy(0.4, 1.0);
  noisy.reconstruction.filter = FilterKind::kNone;
  EXPECT_EQ(noisy.row("noise of the airspeed").row.outcome, Outcome::kCare);
}

}  // namespace
}  // namespace veridyn::aircraft
