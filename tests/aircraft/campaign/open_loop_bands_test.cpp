// Open-loop bands over many made flights: a right model stays in them in calm air and in turbulence, a wrong structure
// does not.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "tests/aircraft/campaign/campaign.hpp"
#include "tests/aircraft/exact_sensors.hpp"
#include "veridyn/aircraft/identification/validation/open_loop.hpp"

namespace veridyn::aircraft {
namespace {

const std::vector<Coefficient> kAllSix{Coefficient::kCL, Coefficient::kCD, Coefficient::kCY,
                                       Coefficient::kCl, Coefficient::kCm, Coefficient::kCn};

/// Share of the samples of all states that are in their bands, and how many there are.
struct Inside {
  double inside = 0.0, count = 0.0;

  void add(const OpenLoop& flown) {
    for (const estimation::OpenLoopState& state : flown.states) {
      inside += state.inside * static_cast<double>(state.fit.count);
      count += static_cast<double>(state.fit.count);
    }
  }
  [[nodiscard]] double share() const { return inside / count; }
};

/// Without what damps pitch and yaw.
Subject undamped(Subject subject) {
  for (const auto& [coefficient, term] : {std::pair{Coefficient::kCm, "q_n"}, std::pair{Coefficient::kCn, "r_n"}}) {
    CoefficientModel& model = subject.model.at(coefficient);
    const std::vector<std::string> names = model.parameter_names();
    const auto at = std::ranges::find(names, parameter_name(coefficient, parse_term(term, "test"))) - names.begin();
    model.values[static_cast<std::size_t>(at)] = 0.0;
  }
  return subject;
}

/// Flies made flights of an aircraft in one kind of air by the model that each gives, the true one and a wrong one.
void expect_honest_bands(const std::string& aircraft, const std::string& turbulence, std::uint64_t flights) {
  Progress quiet;
  Inside identified, right, wrong;
  for (std::uint64_t seed = 1; seed <= flights; ++seed) {
    FlightStudy study = testing::with_exact_sensors(testing::campaign_flight(aircraft, seed, 240.0, turbulence));
    OpenLoopOptions& options = study.validate.open_loop;
    options.duration_s = 10.0;
    if (turbulence == "none") options.gusts = false;
    const testing::Identified flight = testing::identified(study);
    ASSERT_FALSE(flight.refused) << flight.message;
    identified.add(flight.analysis.open_loop);
    const auto fly = [&](const Subject& subject) {
      return fly_open_loop(flight.analysis.flights, RowUse::kHoldout, subject, kAllSix, {}, options, quiet);
    };
    right.add(fly(study.subject));
    if (seed == 1) wrong.add(fly(undamped(study.subject)));
  }
  const std::string what = fmt::format("{} in air {}: identified {:.3f}, true {:.3f}, undamped {:.3f}", aircraft,
                                       turbulence, identified.share(), right.share(), wrong.share());
  std::cout << what << "\n";
  EXPECT_GT(right.share(), 0.90) << what;
  EXPECT_LT(right.share(), 0.98) << what;
  EXPECT_GT(identified.share(), 0.90) << what;
  EXPECT_LT(identified.share(), 0.98) << what;
  EXPECT_LT(wrong.share(), 0.60) << what;
}

TEST(OpenLoopBandsCampaign, HoldARightModelInLightTurbulenceAndNotAWrongStructure) {
  expect_honest_bands("unatrap", "low_light", 1);
}

class OpenLoopBandsSoak : public ::testing::TestWithParam<const char*> {};

TEST_P(OpenLoopBandsSoak, HoldARightModelInAnyAirAndNotAWrongStructure) {
  for (const char* const turbulence : {"none", "low_light", "low_moderate"})
    expect_honest_bands(GetParam(), turbulence, 3);
}

INSTANTIATE_TEST_SUITE_P(Aircraft, OpenLoopBandsSoak, ::testing::Values("unatrap", "aerosonde", "skywalker_2013"));

}  // namespace
}  // namespace veridyn::aircraft
