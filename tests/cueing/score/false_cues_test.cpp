#include "veridyn/cueing/score/false_cues.hpp"

#include <gtest/gtest.h>

namespace veridyn::cueing {
namespace {

constexpr double kThreshold = 0.2, kStep = 0.02;

std::vector<FalseCue> found(const std::vector<double>& vehicle, const std::vector<double>& platform) {
  return false_cues(Cue::kSway, vehicle, platform, kThreshold, 10.0, kStep);
}

/// 200 samples, a value in the middle ones.
std::vector<double> pulse(double value, std::size_t from = 50, std::size_t to = 100) {
  std::vector<double> s(200, 0.0);
  for (std::size_t k = from; k < to; ++k) s[k] = value;
  return s;
}

TEST(FalseCues, AreNamedByWhatIsWrong) {
  const std::vector<std::tuple<double, double, FalseCue::Kind>> cases = {{1.0, -0.5, FalseCue::Kind::kWrongSign},
                                                                         {0.3, 1.0, FalseCue::Kind::kTooStrong},
                                                                         {1.0, 0.1, FalseCue::Kind::kMissing},
                                                                         {-1.0, 0.3, FalseCue::Kind::kWrongSign}};
  for (const auto& [vehicle, platform, kind] : cases) {
    const std::vector<FalseCue> all = found(pulse(vehicle), pulse(platform));
    ASSERT_EQ(all.size(), 1u);
    EXPECT_EQ(all[0].kind, kind);
    EXPECT_NEAR(all[0].begin, 11.0, 1e-12);
    EXPECT_NEAR(all[0].end, 12.0, 1e-12);
    EXPECT_NEAR(all[0].size, std::abs(vehicle - platform), 1e-12);
  }
}

TEST(FalseCues, AWeakerCueOfTheRightSignIsNone) {
  EXPECT_TRUE(found(pulse(1.0), pulse(0.6)).empty());
  EXPECT_TRUE(found(pulse(0.3), pulse(-0.1)).size() == 0 ||
              found(pulse(0.3), pulse(-0.1))[0].kind != FalseCue::Kind::kWrongSign);
  EXPECT_TRUE(found(pulse(0.1), pulse(-0.05)).empty());
}

TEST(FalseCues, ShortOnesAreNoneAndNeighboursAreOne) {
  EXPECT_TRUE(found(pulse(1.0, 50, 54), pulse(-1.0, 50, 54)).empty());
  std::vector<double> vehicle = pulse(1.0, 50, 60), platform = pulse(-1.0, 50, 60);
  for (std::size_t k = 63; k < 75; ++k) {
    vehicle[k] = 1.0;
    platform[k] = -0.8;
  }
  EXPECT_EQ(found(vehicle, platform).size(), 1u);
}

}  // namespace
}  // namespace veridyn::cueing
