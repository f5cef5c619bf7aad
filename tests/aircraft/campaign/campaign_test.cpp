#include "tests/aircraft/campaign/campaign.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <mutex>

#include "tests/support/clean_recordings.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::aircraft {
namespace {

using aircraft::testing::campaign_flight;
using aircraft::testing::Fault;
using aircraft::testing::faults;
using aircraft::testing::Finding;
using aircraft::testing::Identified;
using aircraft::testing::Trial;
using estimation::Check;

/// All faults, or those whose name holds the text of VERIDYN_FAULTS.
std::vector<Fault> chosen_faults() {
  const char* text = std::getenv("VERIDYN_FAULTS");
  std::vector<Fault> chosen;
  for (const Fault& fault : faults())
    if (text == nullptr || fault.name.find(text) != std::string::npos) chosen.push_back(fault);
  return chosen;
}

// All faults in all built-in aircraft. Writes campaign.md (what became of each fault) and campaign.csv (every trial).
TEST(CampaignSoak, CatchesFaultsInAllBuiltInAircraft) {
  const std::vector<std::string> aircraft = builtin_subject_names();
  const std::vector<Fault> chosen = chosen_faults();
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
  std::vector<Trial> trials(aircraft.size() * chosen.size());
  std::mutex writing;
  numerics::parallel_for(trials.size(), 0, [&](std::size_t k) {
    const std::size_t i = k % aircraft.size();
    Trial trial = testing::try_fault(studies[i], clean[i], chosen[k / aircraft.size()]);
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
  std::vector<std::array<double, 2>> of_flights;  ///< confident and covered of each

  void add(const Identified& flight) {
    if (flight.refused) return;
    const estimation::Judgement& judgement = flight.analysis.estimate.judgement;
    const bool data = judgement.data.grade == estimation::Grade::kYes;
    ++flights;
    data_yes += data ? 1 : 0;
    both_yes += data && judgement.parameters.grade == estimation::Grade::kYes ? 1 : 0;
    confident += flight.confidence.confident;
    covered += flight.confidence.covered;
    of_flights.push_back(
        {static_cast<double>(flight.confidence.confident), static_cast<double>(flight.confidence.covered)});
  }
  [[nodiscard]] double share() const { return static_cast<double>(covered) / static_cast<double>(confident); }
  /// Standard error of the share: flights are independent, the parameters of one are not.
  [[nodiscard]] double sigma() const {
    double sum = 0.0;
    for (const auto& [of_flight, held] : of_flights) sum += std::pow(held - share() * of_flight, 2.0);
    return std::sqrt(sum) / static_cast<double>(confident);
  }
  [[nodiscard]] std::string text() const {
    return fmt::format("{:.1f} +- {:.1f} % of {}", 100.0 * share(), 100.0 * sigma(), confident);
  }
  /// 93 to 97 % cannot be excluded with a probability of 95 %.
  void expect_nominal(const std::string& name) const {
    EXPECT_GE(share() + 1.96 * sigma(), 0.93) << name << ": " << text();
    EXPECT_LE(share() - 1.96 * sigma(), 0.97) << name << ": " << text();
  }
};

/// What is counted; a hundred flights' signals take gigabytes. Texts of rows are left out.
Identified counted(const std::string& aircraft, std::uint64_t seed, testing::Assumed assumed) {
  static const std::vector<std::string> turbulence{"none", "low_light", "low_moderate"};
  Identified kept;
  try {
    const Identified flight = testing::identified(
        campaign_flight(aircraft, seed, 300.0, turbulence[(seed - 1) % turbulence.size()], assumed));
    kept.refused = flight.refused;
    kept.confidence = flight.confidence;
    kept.analysis.estimate.judgement = flight.analysis.estimate.judgement;
    for (const estimation::Evidence& row : flight.analysis.estimate.evidence)
      kept.analysis.estimate.evidence.push_back(
          {.check = row.check, .about = row.about, .outcome = row.outcome, .bears_on = row.bears_on});
  } catch (const InputError&) {
    // The pilot lost the aircraft: no flight to identify from.
    kept.refused = true;
  }
  return kept;
}

/// The largest share of clean flights in which a row may raise an alarm. Rows that judge prediction are no false alarms
/// where gusts, which a model is not given, cost it its lead, or where the values that the study gives are better: here
/// they are the truth. Rows of the recording are tested at the level of a few in a thousand, those of a coefficient six
/// times a flight.
double stated_rate(Check check) {
  switch (check) {
    case Check::kFlownOverHoldOut:
    case Check::kFlownAgainstLast:
    case Check::kCoefficientHoldOut:
    case Check::kHoldOutAgainstStart:
    case Check::kHoldOutBands:
      return 1.0;
    case Check::kPartsOfFlight:
      return 0.06;
    default:
      return 0.02;
  }
}

// Clean flights of all built-in aircraft, from calm to moderate turbulence. Writes coverage.md: what is graded yes,
// what intervals hold, and how often each row raises an alarm.
TEST(CampaignSoak, CleanFlightsAreGradedYesAndIntervalsHoldTheTruth) {
  const std::vector<std::string> aircraft = builtin_subject_names();
  constexpr std::size_t kSeeds = 25;
  std::vector<std::array<Identified, 2>> flights(aircraft.size() * kSeeds);
  numerics::parallel_for(flights.size(), 0, [&](std::size_t k) {
    const std::size_t seed = k / aircraft.size();
    flights[k] = {counted(aircraft[k % aircraft.size()], seed + 1, testing::Assumed::kTruth),
                  counted(aircraft[k % aircraft.size()], seed + 1, testing::Assumed::kNothing)};
  });
  std::ofstream table("coverage.md");
  table
      << "| aircraft | flights | data yes | data and parameters yes | coverage, noise given | coverage, noise measured "
         "|\n|---|---|---|---|---|---|\n";
  Coverage all;
  test::CleanRecordings clean;
  for (std::size_t i = 0; i < aircraft.size(); ++i) {
    Coverage given, measured;
    for (std::size_t k = i; k < flights.size(); k += aircraft.size()) {
      given.add(flights[k][0]);
      measured.add(flights[k][1]);
      all.add(flights[k][0]);
      if (flights[k][0].refused) {
        ++clean.refused;
        continue;
      }
      const auto& estimate = flights[k][0].analysis.estimate;
      clean.add(estimate.evidence, estimate.judgement);
    }
    table << fmt::format("| {} | {} | {} | {} | {} | {} |\n", aircraft[i], given.flights, given.data_yes,
                         given.both_yes, given.text(), measured.text());
    given.expect_nominal(aircraft[i] + ", noise given");
    measured.expect_nominal(aircraft[i] + ", noise measured");
  }
  const auto count = static_cast<double>(all.flights);
  table << fmt::format("\n{} data yes, {} data and parameters yes, of {}\n", all.data_yes, all.both_yes, all.flights);
  EXPECT_GE(static_cast<double>(all.data_yes), 0.95 * count);
  EXPECT_GE(static_cast<double>(all.both_yes) + std::sqrt(0.95 * 0.05 * count), 0.95 * count);
  table << clean.table();
  for (const auto& [check, n] : clean.alarms)
    EXPECT_LE(static_cast<double>(n.care + n.failed), stated_rate(check) * count) << to_string(check);
}

// The two aircraft whose coverage is furthest from 95 % over 25 flights, over 100 others. Writes coverage_of_two.md.
TEST(CampaignSoak, IntervalsOfUnatrapAndHcuavHoldTheTruthInAHundredFlights) {
  const std::vector<std::string> aircraft{"unatrap", "hcuav"};
  constexpr std::size_t kFlights = 100;
  std::vector<Identified> flights(aircraft.size() * kFlights);
  numerics::parallel_for(flights.size(), 0, [&](std::size_t k) {
    flights[k] = counted(aircraft[k % aircraft.size()], 26 + k / aircraft.size(), testing::Assumed::kTruth);
  });
  std::ofstream table("coverage_of_two.md");
  for (std::size_t i = 0; i < aircraft.size(); ++i) {
    Coverage given;
    for (std::size_t k = i; k < flights.size(); k += aircraft.size()) given.add(flights[k]);
    table << fmt::format("| {} | {} | {} | {} | {} |\n", aircraft[i], given.flights, given.data_yes, given.both_yes,
                         given.text());
    given.expect_nominal(aircraft[i]);
  }
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
