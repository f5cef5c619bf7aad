#include "veridyn/cueing/washout/shoarai_washout.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/folders.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::cueing {
namespace {

TEST(ShoaraiWashout, TakesTheProgramsOwnGoldenSteps) {
  const std::filesystem::path file = test::shared_folder() / "reference" / "cueing_reference.json";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is missing";
  const auto golden = nlohmann::json::parse(std::ifstream(file))["shoarai_washout_golden"]["steps"];
  ASSERT_EQ(golden.size(), 4U);
  ShoaraiSettings settings;
  settings.gravity_from_zero = true;
  ShoaraiWashout washout(settings);
  for (const auto& expected : golden) {
    const auto& pose = washout.step(1e-3 * Eigen::Vector3d(1.0, 2.0, 3.0), Eigen::Vector3d(4.0, 5.0, 6.0));
    for (Eigen::Index i = 0; i < 3; ++i) {
      EXPECT_NEAR(1e3 * pose.shift(i), expected[i].get<double>(), 1e-9);  // there in mm
      EXPECT_NEAR(pose.angle(i), expected[i + 3].get<double>(), 1e-9);
    }
  }
}

TEST(ShoaraiWashout, APlatformThatStandsDoesNotHeaveUnlessItsGravityStartsAtZero) {
  ShoaraiSettings settings;
  for (const bool as_there : {false, true}) {
    settings.gravity_from_zero = as_there;
    ShoaraiWashout washout(settings);
    double furthest = 0.0;
    for (int k = 0; k < 1000; ++k)
      furthest = std::max(furthest, std::abs(washout.step(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()).shift.z()));
    if (as_there) {
      EXPECT_GT(furthest, 1e-3);
    } else {
      EXPECT_EQ(furthest, 0.0);
    }
  }
}

TEST(ShoaraiWashout, ASettingOfZeroIsRefused) {
  ShoaraiSettings settings;
  settings.tilt_low_pass = 0.0;
  EXPECT_THROW(ShoaraiWashout{settings}, InputError);
}

}  // namespace
}  // namespace veridyn::cueing
