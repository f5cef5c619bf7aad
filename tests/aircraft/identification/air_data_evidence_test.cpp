#include "veridyn/aircraft/identification/air_data_evidence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/aircraft/campaign/campaign.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Outcome;

TEST(DoubtOf, IsTheMeasurementsWhereThatIsGoodAndThePriorsWhereItIsNot) {
  EXPECT_NEAR(doubt_of(Determined{1.03, 0.001}, 1.0, 0.1), 0.03, 1e-4);
  EXPECT_NEAR(doubt_of(Determined{1.0, 0.001}, 1.0, 0.1), 0.001, 1e-6);
  EXPECT_NEAR(doubt_of(Determined{3.0, 100.0}, 1.0, 0.1), 0.1, 1e-4);
  EXPECT_EQ(doubt_of(std::nullopt, 1.0, 0.1), 0.1);
  EXPECT_EQ(doubt_of(Determined{kNaN, kNaN}, 0.0, 0.05), 0.05);
  // Posterior of a normal prior: mean 0.05, variance 0.005.
  EXPECT_NEAR(doubt_of(Determined{1.1, 0.1}, 1.0, 0.1), std::sqrt(0.05 * 0.05 + 0.005), 1e-12);
}

/// The doubts of a flight of 150 s with a channel scaled.
std::vector<FlightEvidence> evidence_with(const char* channel, double factor, const char* turbulence) {
  FlightStudy study = aircraft::testing::campaign_flight("unatrap", 1, 150.0, turbulence);
  Channel changed = study.mapped.recording.at(channel);
  for (double& v : changed.value) v *= factor;
  study.mapped.recording.set(std::move(changed));
  return aircraft::testing::identified(study).analysis.recording_evidence;
}

double doubt_about(const std::vector<FlightEvidence>& rows, FlightSignal signal) {
  double largest = 0.0;
  for (const FlightEvidence& row : rows)
    if (row.doubt && row.doubt->signal == signal) largest = std::max(largest, row.doubt->scale);
  return largest;
}

TEST(AirDataEvidence, LeavesLittleInDoubtInCalmAirAndMoreInTurbulence) {
  const std::vector<FlightEvidence> calm = evidence_with("alpha", 1.0, "none");
  const std::vector<FlightEvidence> rough = evidence_with("alpha", 1.0, "low_moderate");
  for (const FlightSignal signal : {FlightSignal::kAirspeed, FlightSignal::kAlpha, FlightSignal::kBeta}) {
    EXPECT_LT(doubt_about(calm, signal), 0.05) << kFlightSignalNames[static_cast<std::size_t>(signal)];
    EXPECT_GT(doubt_about(rough, signal), doubt_about(calm, signal));
  }
}

// A dynamic pressure of 1.2 times is within what headings in turbulence leave of the airspeed's scale. In calm air it
// is named.
TEST(AirDataEvidence, DoubtsAWrongScaleThatItCannotName) {
  const auto row_of = [](const std::vector<FlightEvidence>& rows) {
    return std::ranges::find_if(rows, [](const FlightEvidence& e) { return e.row.about == "airspeed" && e.doubt; });
  };
  const std::vector<FlightEvidence> calm = evidence_with("dynamic_pressure", 1.2, "none");
  ASSERT_NE(row_of(calm), calm.end());
  EXPECT_EQ(row_of(calm)->row.outcome, Outcome::kCare);
  const std::vector<FlightEvidence> rough = evidence_with("dynamic_pressure", 1.2, "low_moderate");
  ASSERT_NE(row_of(rough), rough.end());
  EXPECT_GT(row_of(rough)->doubt->scale, 0.02);
}

}  // namespace
}  // namespace veridyn::aircraft
