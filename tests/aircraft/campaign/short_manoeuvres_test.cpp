#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/aircraft/campaign/campaign.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Check;
using estimation::Evidence;
using estimation::Outcome;

/// One elevator 3-2-1-1 in calm air or light turbulence, without a fault.
FlightStudy one_3211(const char* aircraft, int seed, double duration_s, const char* turbulence) {
  Progress silent;
  const std::string text = fmt::format(
      "seed = {}\n[subject]\nbuiltin = \"{}\"\n[flight]\nduration = {}\naltitude = 300\nwind = [4, -3, 0]\n"
      "turbulence = \"{}\"\n[[flight.manoeuvre]]\nkind = \"3211\"\nstart = 1\npulse = {}\nsurfaces = [\"elevator\"]\n"
      "[reconstruct]\nsensors = \"reference\"\nturbulence = \"{}\"\n",
      seed, aircraft, duration_s, turbulence, duration_s < 8.0 ? 0.5 : 0.7, turbulence);
  return read_study(Study::parse(text, "short.toml"), silent);
}

// What did not move says nothing, and contradicts nothing.
TEST(ShortManoeuvres, DoNotContradictThemselves) {
  int contradicted = 0, flights = 0;
  std::string which;
  for (const double duration_s : {6.5, 10.0, 15.0}) {
    for (int seed = 41; seed < 51; ++seed) {
      const char* const turbulence = seed % 2 == 0 ? "none" : "low_light";
      const FlightStudy study = one_3211(seed % 3 == 0 ? "thor" : "unatrap", seed, duration_s, turbulence);
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

}  // namespace
}  // namespace veridyn::aircraft
