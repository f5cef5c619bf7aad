#include "tests/aircraft/campaign/campaign.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <mutex>

#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/parallel.hpp"

namespace veridyn::aircraft {
namespace {

using aircraft::testing::campaign_flight;
using aircraft::testing::Fault;
using aircraft::testing::faults;
using aircraft::testing::Finding;
using aircraft::testing::Identified;
using aircraft::testing::Trial;

// All faults in all built-in aircraft. Writes campaign.md (what became of each fault) and campaign.csv (every trial).
TEST(CampaignSoak, CatchesFaultsInAllBuiltInAircraft) {
  const std::vector<std::string> aircraft = builtin_subject_names();
  std::vector<FlightStudy> studies(aircraft.size());
  std::vector<Identified> clean(aircraft.size());
  numerics::parallel_for(aircraft.size(), 0, [&](std::size_t i) {
    studies[i] = campaign_flight(aircraft[i], 1, 300.0);
    clean[i] = testing::identified(studies[i]);
  });
  std::ofstream log("campaign.csv");
  log << "aircraft,fault,finding,data,parameters,reason\n";
  for (std::size_t i = 0; i < aircraft.size(); ++i) {
    std::string wrong;
    for (const auto& [name, text] : clean[i].confidence.wrong) wrong += text + "; ";
    log << fmt::format("{},none,{} confident,{},{},\"{}\"\n", aircraft[i], clean[i].confidence.confident,
                       to_string(clean[i].analysis.estimate.judgement.data.grade),
                       to_string(clean[i].analysis.estimate.judgement.parameters.grade), wrong);
  }
  std::vector<Trial> trials(aircraft.size() * faults().size());
  std::mutex writing;
  numerics::parallel_for(trials.size(), 0, [&](std::size_t k) {
    const std::size_t i = k % aircraft.size();
    Trial trial = testing::try_fault(studies[i], clean[i], faults()[k / aircraft.size()]);
    trial.subject = aircraft[i];
    std::string reason = trial.reason;
    std::ranges::replace(reason, '"', '\'');
    const std::lock_guard lock(writing);
    log << fmt::format("{},{},{},{},{},\"{}\"\n", trial.subject, trial.fault, to_string(trial.finding), trial.data,
                       trial.parameters, reason)
        << std::flush;
    trials[k] = std::move(trial);
  });
  std::ofstream("campaign.md") << testing::confusion_table(trials);
  const auto count = [&](Finding finding) {
    return static_cast<double>(std::ranges::count(trials, finding, &Trial::finding));
  };
  const double found = count(Finding::kNamed) + count(Finding::kMisnamed);
  EXPECT_GE(count(Finding::kNamed), 0.8 * found);
  EXPECT_EQ(count(Finding::kMissed), 0.0);
}

/// Of all flights of an aircraft.
struct Coverage {
  std::size_t flights = 0, data_yes = 0, both_yes = 0, confident = 0, covered = 0;

  void add(const Identified& flight) {
    if (flight.refused) return;
    const estimation::Judgement& judgement = flight.analysis.estimate.judgement;
    const bool data = judgement.data.grade == estimation::Grade::kYes;
    ++flights;
    data_yes += data ? 1 : 0;
    both_yes += data && judgement.parameters.grade == estimation::Grade::kYes ? 1 : 0;
    confident += flight.confidence.confident;
    covered += flight.confidence.covered;
  }
  [[nodiscard]] double share() const { return static_cast<double>(covered) / static_cast<double>(confident); }
};

// Clean flights of all built-in aircraft, from calm to moderate turbulence. Writes coverage.md.
TEST(CampaignSoak, CleanFlightsAreGradedYesAndIntervalsHoldTheTruth) {
  const std::vector<std::string> aircraft = builtin_subject_names();
  const std::vector<std::string> turbulence{"none", "low_light", "low_moderate"};
  constexpr std::size_t kSeeds = 25;
  std::vector<std::array<Identified, 2>> flights(aircraft.size() * kSeeds);
  numerics::parallel_for(flights.size(), 0, [&](std::size_t k) {
    const std::size_t seed = k / aircraft.size();
    for (const auto assumed : {testing::Assumed::kTruth, testing::Assumed::kNothing}) {
      Identified flight;
      try {
        flight = testing::identified(campaign_flight(aircraft[k % aircraft.size()], seed + 1, 300.0,
                                                     turbulence[seed % turbulence.size()], assumed));
      } catch (const InputError&) {
        // The pilot lost the aircraft: no flight to identify from.
        flight.refused = true;
      }
      // What is counted; a hundred flights' signals take gigabytes.
      Identified kept;
      kept.refused = flight.refused;
      kept.confidence = flight.confidence;
      kept.analysis.estimate.judgement = flight.analysis.estimate.judgement;
      flights[k][assumed == testing::Assumed::kTruth ? 0 : 1] = std::move(kept);
    }
  });
  std::ofstream table("coverage.md");
  table
      << "| aircraft | flights | data yes | data and parameters yes | coverage, noise given | coverage, noise measured "
         "|\n|---|---|---|---|---|---|\n";
  Coverage all;
  for (std::size_t i = 0; i < aircraft.size(); ++i) {
    Coverage given, measured;
    for (std::size_t k = i; k < flights.size(); k += aircraft.size()) {
      given.add(flights[k][0]);
      measured.add(flights[k][1]);
      all.add(flights[k][0]);
    }
    table << fmt::format("| {} | {} | {} | {} | {:.1f} % of {} | {:.1f} % of {} |\n", aircraft[i], given.flights,
                         given.data_yes, given.both_yes, 100.0 * given.share(), given.confident,
                         100.0 * measured.share(), measured.confident);
    EXPECT_GE(given.share(), 0.9) << aircraft[i];
  }
  EXPECT_GE(static_cast<double>(all.data_yes), 0.95 * static_cast<double>(all.flights));
}

/// One manoeuvre of 20 s of each axis (multisines; 3-2-1-1 and doublets; multisine and 3-2-1-1), nothing held out.
FlightStudy single_manoeuvres(FlightStudy study, std::size_t which) {
  constexpr std::array<std::array<double, 2>, 3> kBegin{{{12, 62}, {43, 93}, {178, 228}}};
  const auto [longitudinal, lateral] = kBegin[which];
  study.segments.holdout = 0.0;
  study.segments.longitudinal = {{longitudinal, longitudinal + 20.0}};
  study.segments.lateral = {{lateral, lateral + 20.0}};
  return study;
}

// Intervals from one manoeuvre of each axis alone. Writes single_manoeuvres.md.
TEST(CampaignSoak, IntervalsOfSingleManoeuvresHoldTheTruth) {
  const std::vector<std::string> aircraft = builtin_subject_names();
  const std::vector<std::string> turbulence{"none", "low_light", "low_moderate"};
  constexpr std::size_t kSeeds = 9, kManoeuvres = 3;
  std::vector<std::array<test::Confidence, kManoeuvres>> found(aircraft.size() * kSeeds);
  numerics::parallel_for(found.size(), 0, [&](std::size_t k) {
    const std::size_t seed = k / aircraft.size();
    const FlightStudy study =
        campaign_flight(aircraft[k % aircraft.size()], seed + 1, 300.0, turbulence[seed % turbulence.size()]);
    for (std::size_t which = 0; which < kManoeuvres; ++which)
      found[k][which] = testing::identified(single_manoeuvres(study, which)).confidence;
  });
  std::ofstream table("single_manoeuvres.md");
  table << "| aircraft | multisines | 3-2-1-1, doublets | multisine, 3-2-1-1 | all |\n|---|---|---|---|---|\n";
  const auto share = [](std::size_t covered, std::size_t confident) {
    return fmt::format("{:.1f} % of {}", 100.0 * static_cast<double>(covered) / static_cast<double>(confident),
                       confident);
  };
  for (std::size_t i = 0; i < aircraft.size(); ++i) {
    std::array<std::size_t, kManoeuvres + 1> confident{}, covered{};
    for (std::size_t k = i; k < found.size(); k += aircraft.size()) {
      for (std::size_t which = 0; which < kManoeuvres; ++which) {
        for (const std::size_t column : {which, kManoeuvres}) {
          confident[column] += found[k][which].confident;
          covered[column] += found[k][which].covered;
        }
      }
    }
    table << fmt::format("| {} |", aircraft[i]);
    for (std::size_t column = 0; column <= kManoeuvres; ++column)
      table << fmt::format(" {} |", share(covered[column], confident[column]));
    table << "\n";
    const double all = static_cast<double>(covered.back()) / static_cast<double>(confident.back());
    EXPECT_GE(all, 0.90) << aircraft[i];
    EXPECT_LE(all, 0.985) << aircraft[i];
  }
}

// The short form of the campaign: one fault of each sensor in one flight.
TEST(Campaign, NamesWhatIsWrong) {
  const FlightStudy study = campaign_flight("unatrap", 1, 150.0);
  const Identified clean = testing::identified(study);
  ASSERT_FALSE(clean.refused) << clean.message;
  EXPECT_EQ(clean.analysis.estimate.judgement.data.grade, estimation::Grade::kYes);
  EXPECT_LE(clean.confidence.wrong.size(), 1u);
  EXPECT_GT(clean.confidence.confident, 10u);
  for (const char* name :
       {"accelerometer in g", "gyro x reversed", "gyro frozen for 10 %", "roll reversed", "velocity in knots",
        "alpha reversed", "deflections in degrees", "clock in ms taken for s"}) {
    const Trial trial = testing::try_fault(study, clean, testing::fault(name));
    EXPECT_EQ(trial.finding, Finding::kNamed) << name << ": " << to_string(trial.finding) << ", " << trial.reason;
  }
  // What no flight shows is said by a row.
  for (const char* name : {"elevator reversed", "mass 1.3 times"})
    EXPECT_EQ(testing::try_fault(study, clean, testing::fault(name)).finding, Finding::kNotVerified) << name;
}

}  // namespace
}  // namespace veridyn::aircraft
