#include "tests/aircraft/campaign/campaign.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <mutex>

#include "veridyn/aircraft/model/builtin_subjects.hpp"
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
    for (const auto& [name, text] : clean[i].wrong) wrong += text + "; ";
    log << fmt::format("{},none,{} confident,{},{},\"{}\"\n", aircraft[i], clean[i].confident,
                       to_string(clean[i].analysis.estimate.judgement.data.grade),
                       to_string(clean[i].analysis.estimate.judgement.parameters.grade), wrong);
  }
  std::vector<Trial> trials(aircraft.size() * faults().size());
  std::mutex writing;
  numerics::parallel_for(trials.size(), 0, [&](std::size_t k) {
    const std::size_t i = k % aircraft.size();
    Trial trial = testing::try_fault(studies[i], clean[i], faults()[k / aircraft.size()]);
    trial.aircraft = aircraft[i];
    std::string reason = trial.reason;
    std::ranges::replace(reason, '"', '\'');
    const std::lock_guard lock(writing);
    log << fmt::format("{},{},{},{},{},\"{}\"\n", trial.aircraft, trial.fault, to_string(trial.finding), trial.data,
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

}  // namespace
}  // namespace veridyn::aircraft
