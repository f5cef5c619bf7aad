#include "veridyn/aircraft/simulation/flight_plan.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

namespace veridyn::aircraft {
namespace {

TEST(Multisine, SignalsAreOrthogonalStartAtZeroAndHaveALowPeak) {
  const auto sines = make_multisines(3, 30.0, 0.1, 2.0);
  constexpr int kN = 6000;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = a; b < 3; ++b) {
      double dot = 0, largest = 0;
      for (int i = 0; i < kN; ++i) {
        const double t = 30.0 * i / kN;
        dot += sines[a].value(t) * sines[b].value(t) / kN;
        largest = std::max(largest, std::abs(sines[a].value(t)));
      }
      if (a != b) {
        EXPECT_NEAR(dot, 0.0, 1e-12);
      } else {
        EXPECT_NEAR(largest, 1.0, 0.01);
        // Relative peak factor: 1 for a single sine. Schroeder's phases alone reach about 1.2.
        EXPECT_LT(1.0 / std::sqrt(2.0 * dot), 1.2);
      }
    }
    EXPECT_NEAR(sines[a].value(0.0), 0.0, 1e-9);
  }
}

TEST(Excitation, HasTheShapesOfItsManoeuvres) {
  const Excitation e({{.kind = ManoeuvreKind::k3211,
                       .start = 10,
                       .surfaces = {Surface::kElevator, Surface::kRudder},
                       .amplitude = {0.1, 0.2},
                       .pulse = 0.5},
                      {.kind = ManoeuvreKind::kTurn, .start = 40, .duration = 5, .bank = 0.4}});
  EXPECT_EQ(e.at(9.9)[Surface::kElevator], 0.0);
  EXPECT_EQ(e.at(11.4)[Surface::kElevator], 0.1);
  EXPECT_EQ(e.at(11.6)[Surface::kElevator], -0.1);
  EXPECT_EQ(e.at(12.6)[Surface::kElevator], 0.1);
  EXPECT_EQ(e.at(13.1)[Surface::kElevator], -0.1);
  EXPECT_EQ(e.at(13.6)[Surface::kElevator], 0.0);
  EXPECT_EQ(e.at(15.6)[Surface::kRudder], 0.2);  // 3.5 s and a pause of 2 s later
  EXPECT_TRUE(e.excited(12.0)[Surface::kRudder]);
  EXPECT_FALSE(e.excited(12.0)[Surface::kAileron]);
  EXPECT_TRUE(std::isnan(e.bank(39.0)));
  EXPECT_EQ(e.bank(41.0), 0.4);
}

// A day of the default plan has a thousand multisines, all but two equal.
TEST(Excitation, DesignsEqualMultisinesOnce) {
  const auto begin = std::chrono::steady_clock::now();
  const Excitation day(default_plan(86400.0, {{0.1, 0.1, 0.1, 0.1}}));
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), 3.0);
  const Excitation one(default_plan(300.0, {{0.1, 0.1, 0.1, 0.1}}));
  EXPECT_EQ(day.at(20.0), one.at(20.0));
  EXPECT_EQ(day.at(16.0 * 300.0 + 20.0), one.at(20.0));
  EXPECT_NE(one.at(20.0)[Surface::kElevator], 0.0);
}

}  // namespace
}  // namespace veridyn::aircraft
