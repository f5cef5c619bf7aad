#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "tests/aircraft/campaign/campaign.hpp"
#include "tests/support/clean_recordings.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Check;
using estimation::Evidence;
using estimation::Outcome;

/// One manoeuvre of one axis in calm air or light turbulence, without a fault.
struct ShortManoeuvre {
  std::string aircraft;
  std::size_t seed = 1;
  double duration_s = 10.0;
  std::string turbulence = "none";
  std::string kind = "3211";
  std::string surface = "elevator";

  [[nodiscard]] FlightStudy flown() const {
    Progress silent;
    const std::string text = fmt::format(
        "seed = {}\n[subject]\nbuiltin = \"{}\"\n[flight]\nduration = {}\naltitude = 300\nwind = [4, -3, 0]\n"
        "turbulence = \"{}\"\n[[flight.manoeuvre]]\nkind = \"{}\"\nstart = 1\npulse = {}\nsurfaces = [\"{}\"]\n"
        "[reconstruct]\nsensors = \"reference\"\nturbulence = \"{}\"\n",
        seed, aircraft, duration_s, turbulence, kind, duration_s < 8.0 ? 0.5 : 0.7, surface, turbulence);
    return read_study(Study::parse(text, "short.toml"), silent);
  }
};

// What did not move says nothing, and contradicts nothing.
TEST(ShortManoeuvres, DoNotContradictThemselves) {
  int contradicted = 0, flights = 0;
  std::string which;
  for (const double duration_s : {6.5, 10.0, 15.0}) {
    for (std::size_t seed = 41; seed < 51; ++seed) {
      const FlightStudy study = ShortManoeuvre{.aircraft = seed % 3 == 0 ? "thor" : "unatrap",
                                               .seed = seed,
                                               .duration_s = duration_s,
                                               .turbulence = seed % 2 == 0 ? "none" : "low_light"}
                                    .flown();
      Progress silent;
      const FlightAnalysis analysis = reconstruct(study, silent);
      ++flights;
      for (const Evidence& row : analysis.flights.front().recording_evidence) {
        EXPECT_FALSE(row.check == Check::kFlightLength && row.outcome == Outcome::kFailed);
        if (row.outcome != Outcome::kFailed) continue;
        ++contradicted;
        which += fmt::format("{} s, {}: {}: {}\n", duration_s, seed, name_of(row), says(row));
        break;
      }
    }
  }
  EXPECT_EQ(flights, 30);
  EXPECT_LE(contradicted, 1) << which;
}

/// Each number another aircraft, manoeuvre, axis, length, turbulence and noise.
ShortManoeuvre manoeuvre(std::size_t number) {
  constexpr std::array<double, 4> kDurations_s{6.5, 8.0, 10.0, 15.0};
  const std::vector<std::string> aircraft = builtin_subject_names(), surfaces{"elevator", "aileron", "rudder"};
  return {.aircraft = aircraft[number % aircraft.size()],
          .seed = 1000 + number,
          .duration_s = kDurations_s[number / 3 % kDurations_s.size()],
          .turbulence = number / 12 % 2 == 0 ? "none" : "low_light",
          .kind = number / 24 % 2 == 0 ? "3211" : "doublet",
          .surface = surfaces[number % surfaces.size()]};
}

// 200 manoeuvres of one axis, identified. Writes short_manoeuvres.md: alarms by row.
TEST(ShortManoeuvresSoak, AreGradedYes) {
  if (std::getenv("VERIDYN_SOAK") == nullptr) GTEST_SKIP() << "long-running test; set VERIDYN_SOAK=1 to run it";
  constexpr std::size_t kManoeuvres = 200;
  std::vector<testing::Identified> flights(kManoeuvres);
  numerics::parallel_for(kManoeuvres, 0, [&](std::size_t i) {
    try {
      testing::Identified flight = testing::identified(manoeuvre(i).flown());
      flights[i].refused = flight.refused;
      flights[i].message = flight.message;
      flights[i].analysis.estimate = std::move(flight.analysis.estimate);
    } catch (const InputError& e) {
      flights[i].refused = true;
      flights[i].message = e.what();
    }
  });
  test::CleanRecordings clean;
  std::vector<std::string> refusals;
  for (const testing::Identified& flight : flights) {
    clean.refused += flight.refused ? 1 : 0;
    if (flight.refused) refusals.push_back(flight.message);
    if (!flight.refused) clean.add(flight.analysis.estimate.evidence, flight.analysis.estimate.judgement);
  }
  std::ofstream("short_manoeuvres.md") << clean.table();
  EXPECT_EQ(clean.refused, 0u) << ::testing::PrintToString(refusals);
  EXPECT_GE(static_cast<double>(clean.data_yes), 0.97 * static_cast<double>(clean.count))
      << ::testing::PrintToString(clean.sentences);
}

}  // namespace
}  // namespace veridyn::aircraft
