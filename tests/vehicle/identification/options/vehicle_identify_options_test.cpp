#include <gtest/gtest.h>

#include <string>

#include "veridyn/core/error.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/vehicle/identification/vehicle_identification.hpp"

namespace veridyn::vehicle {
namespace {

TEST(VehicleIdentifyOptions, RefuseWhatMakesNoSense) {
  const auto message = [](const char* toml) -> std::string {
    try {
      const Study study = Study::parse(toml, "study.toml");
      static_cast<void>(VehicleIdentifyOptions::keys().read(study.root().table("identify")));
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(message("[identify]\nestimate = [\"C_ff\"]\n").find("did you mean 'C_f'"), std::string::npos);
  EXPECT_NE(message("[identify]\nestimate = [\"mu\"]\n").find("linear tyres do not have"), std::string::npos);
  EXPECT_NE(message("[identify]\nsignal_to_noise = nan\n"), "");
  EXPECT_NE(message("[identify]\nsmoothing = -1\n").find(">= 0"), std::string::npos);
  EXPECT_NE(message("[identify]\neffects = [\"bank\"]\n").find("'bank', which is none of banked road, downforce"),
            std::string::npos);
  EXPECT_NE(message("[identify]\nestimate = [\"downforce_f\"]\n").find("identify.effects frees"), std::string::npos);
  EXPECT_NE(message("[identify]\nuncertainty = { mass = -1 }\n").find("must be >= 0"), std::string::npos);
}

TEST(VehicleIdentifyOptions, TakeEffectsByNameNoneOrThoseThatTheDriveTells) {
  const auto read = [](const char* toml) {
    const Study study = Study::parse(toml, "study.toml");
    return VehicleIdentifyOptions::keys().read(study.root().table("identify"));
  };
  EXPECT_FALSE(read("[identify]\n").effects.has_value());
  EXPECT_FALSE(read("[identify]\neffects = \"auto\"\n").effects.has_value());
  EXPECT_TRUE(read("[identify]\neffects = []\n").effects == DriveEffects{});
  const VehicleIdentifyOptions two = read("[identify]\neffects = [\"downforce\", \"banked road\"]\n");
  EXPECT_TRUE((two.effects == DriveEffects{true, true, false}));
  EXPECT_TRUE(two.model.effects == two.effects);
  EXPECT_TRUE(two.model.free[DriveUnknown::kDownforceR]);
  EXPECT_FALSE(two.model.free[DriveUnknown::kLoadSensitivity]);
}

}  // namespace
}  // namespace veridyn::vehicle
