#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <mutex>

#include "tests/aircraft/campaign/campaign.hpp"
#include "tests/aircraft/stripped_recording.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

/// Simulated flights stripped of sensors: what each costs, and whether what is still said is true.
namespace veridyn::aircraft {
namespace {

using aircraft::testing::campaign_flight;
using aircraft::testing::Identified;

/// What a flight was recorded without.
struct Stripped {
  std::string name;
  std::vector<std::string> channels;
  FilterKind filter = FilterKind::kModelFree;
};

std::vector<std::string> together(std::initializer_list<std::vector<std::string>> parts) {
  std::vector<std::string> all;
  for (const std::vector<std::string>& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

std::vector<Stripped> steps() {
  const std::vector<std::string> ground{"vel_north", "vel_east", "vel_down"}, heading{"yaw"},
      attitude{"roll", "pitch", "yaw"}, pitot{"dynamic_pressure", "airspeed"}, vanes{"alpha", "beta"};
  return {{"nothing", {}},
          {"ground velocity", ground},
          {"heading", heading},
          {"ground velocity, heading", together({ground, heading})},
          {"attitude, heading", attitude},
          {"ground velocity, attitude, heading", together({ground, attitude})},
          {"pitot tube", pitot},
          {"beta vane", {"beta"}},
          {"vanes", vanes},
          {"pitot tube, vanes", together({pitot, vanes})},
          {"vanes, ground velocity, heading", together({vanes, ground, heading})},
          {"nothing, no filter", {}, FilterKind::kNone}};
}

Identified flown_without(FlightStudy study, const Stripped& stripped) {
  study.mapped.recording = testing::without(study.mapped.recording, stripped.channels);
  study.reconstruct.filter = stripped.filter;
  // Said of accelerometer and air, which are simulated without: their own unknowns are not what is counted here.
  using enum SensorErrorKind;
  for (const SensorErrorKind kind : {kZeroX, kZeroY, kZeroZ, kPlaceX, kPlaceY, kPlaceZ})
    study.known_sensors.errors.push_back({BudgetSensor::kAccelerometer, kind, 0.0, 0.0});
  for (const SensorErrorKind kind : {kGustRoll, kGustPitch, kGustYaw, kDownwash})
    study.known_sensors.errors.push_back({BudgetSensor::kAir, kind, 0.0, 0.0});
  return testing::identified(study);
}

/// Of flights without the same sensors: what was identified, and how it agrees with the truth.
struct Tally {
  std::size_t flights = 0, identified = 0, covered = 0, effective = 0, rejected = 0, graded_yes = 0, wrong = 0;
  std::string which;    ///< parameters that are graded yes and wrong
  std::string outside;  ///< all whose interval does not hold the truth

  void add(const Identified& flight) {
    ++flights;
    for (const estimation::ParameterGroup& group : flight.analysis.groups) {
      effective += group.verdict == estimation::GroupVerdict::kEffective ? 1 : 0;
      rejected += group.verdict == estimation::GroupVerdict::kRejected ? 1 : 0;
      if (group.verdict != estimation::GroupVerdict::kIdentified) continue;
      for (const estimation::Parameter& p : group.parameters) {
        const auto truth = flight.analysis.truth.find(p.name);
        const bool stated =
            p.status == estimation::ParameterStatus::kIdentified || p.status == estimation::ParameterStatus::kWeak;
        if (!stated || truth == flight.analysis.truth.end()) continue;
        ++identified;
        const bool holds = p.low95 <= truth->second && truth->second <= p.high95;
        covered += holds ? 1 : 0;
        if (!holds)
          outside += fmt::format("{} {:.3g} +- {:.2g} ({:.3g}); ", p.name, p.value, p.high95 - p.value, truth->second);
      }
    }
    graded_yes += flight.confidence.confident;
    wrong += flight.confidence.wrong.size();
    for (const auto& [name, text] : flight.confidence.wrong) which += text + "; ";
  }
  [[nodiscard]] double coverage() const {
    return identified > 0 ? static_cast<double>(covered) / static_cast<double>(identified) : 1.0;
  }
  [[nodiscard]] std::string row(const std::string& name) const {
    return fmt::format("| {} | {} | {} | {:.0f} % | {} | {} | {} |", name, flights, identified, 100.0 * coverage(),
                       effective, rejected, wrong);
  }
};

const std::vector<std::string> kAircraft{"unatrap", "aerosonde", "skywalker_2013"};

/// A tally a step.
std::vector<Tally> tallies(std::size_t seeds, double duration_s, const std::string& turbulence) {
  const std::vector<Stripped> all = steps();
  std::vector<Tally> sums(all.size());
  std::mutex adding;
  numerics::parallel_for(kAircraft.size() * seeds, 0, [&](std::size_t k) {
    const FlightStudy study =
        campaign_flight(kAircraft[k % kAircraft.size()], 1 + k / kAircraft.size(), duration_s, turbulence);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Identified flight = flown_without(study, all[i]);
      ASSERT_FALSE(flight.refused) << all[i].name << ": " << flight.message;
      const std::lock_guard lock(adding);
      sums[i].add(flight);
    }
  });
  return sums;
}

// Writes missing_sensors.md: a table for each turbulence.
TEST(MissingSensorsCampaignSoak, IntervalsHoldTheTruthWhereTheyAreStated) {
  std::ofstream table("missing_sensors.md");
  for (const char* turbulence : {"none", "low_light", "low_moderate"}) {
    const std::vector<Tally> sums = tallies(4, 300.0, turbulence);
    table << fmt::format(
        "\n{}:\n\n| recorded without | flights | identified | truth inside | effective | rejected | "
        "graded yes and wrong |\n|---|---|---|---|---|---|---|\n",
        turbulence);
    for (std::size_t i = 0; i < sums.size(); ++i) {
      table << sums[i].row(steps()[i].name) << " " << sums[i].which << "\n" << std::flush;
      EXPECT_LE(sums[i].wrong, sums[i].graded_yes / 100 + 1) << steps()[i].name << ": " << sums[i].which;
    }
  }
}

const Tally& of_step(const std::vector<Tally>& sums, const std::string& name) {
  const std::vector<Stripped> all = steps();
  return sums[std::ranges::find(all, name, &Stripped::name) - all.begin()];
}

// In light turbulence. Motion over ground, heading and attitude cost little of what pitot tube and vanes show: where
// nothing verifies these the priors are in the intervals, and up to a fifth of them become too wide. Without pitot tube
// or vanes no parameter that rests on them is said to be a constant of the aircraft.
TEST(MissingSensorsCampaign, CostWhatDependsOnThem) {
  const std::vector<Tally> sums = tallies(1, 300.0, "low_light");
  const std::size_t all = of_step(sums, "nothing").identified;
  for (const char* name : {"ground velocity", "heading", "ground velocity, heading", "attitude, heading",
                           "ground velocity, attitude, heading", "nothing, no filter"}) {
    const Tally& tally = of_step(sums, name);
    EXPECT_GE(5 * tally.identified, 4 * all) << name;
    EXPECT_GE(tally.coverage(), 0.9) << name << ": " << tally.outside;
    EXPECT_LE(tally.wrong, 1U) << name << ": " << tally.which;
  }
  for (const char* name : {"pitot tube", "vanes", "pitot tube, vanes", "vanes, ground velocity, heading"}) {
    const Tally& tally = of_step(sums, name);
    EXPECT_EQ(tally.identified, 0U) << name;
    EXPECT_GT(tally.effective, tally.rejected) << name;
  }
  const Tally& beta = of_step(sums, "beta vane");
  EXPECT_GE(beta.identified, 20U) << "CL, CD and Cm rest on the alpha vane";
  EXPECT_GE(beta.coverage(), 0.9) << beta.outside;
}

using estimation::Check;

TEST(MissingSensorsCampaign, AreNamedByTheRowsThatDecide) {
  const FlightStudy study = campaign_flight("unatrap", 1, 200.0, "low_light");
  const auto row_of = [&](const char* step, Check check, std::string_view about) {
    const std::vector<Stripped> all = steps();
    const Identified flight = flown_without(study, *std::ranges::find(all, step, &Stripped::name));
    const auto& rows = flight.analysis.estimate.evidence;
    const auto row =
        std::ranges::find_if(rows, [&](const estimation::Evidence& e) { return e.check == check && e.about == about; });
    return row == rows.end() ? estimation::Evidence{} : *row;
  };
  EXPECT_EQ(row_of("pitot tube", Check::kNoAirspeedSensor, "airspeed").outcome, estimation::Outcome::kFailed);
  EXPECT_EQ(row_of("vanes", Check::kNoVane, "alpha").outcome, estimation::Outcome::kFailed);
  EXPECT_EQ(row_of("beta vane", Check::kNoVane, "beta").outcome, estimation::Outcome::kFailed);
  EXPECT_TRUE(row_of("beta vane", Check::kNoVane, "alpha").check == Check::kUnknown);
  EXPECT_EQ(row_of("ground velocity", Check::kNoGroundVelocity, "ground velocity").outcome,
            estimation::Outcome::kNotVerified);
  EXPECT_EQ(row_of("attitude, heading", Check::kNoAttitude, "attitude").outcome, estimation::Outcome::kNotVerified);
}

}  // namespace
}  // namespace veridyn::aircraft
