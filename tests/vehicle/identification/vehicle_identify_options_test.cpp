#include <gtest/gtest.h>

#include <string>

#include "veridyn/core/error.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/vehicle/identification/vehicle_identification.hpp"

namespace veridyn::vehicle {
namespace {

TEST(VehicleIdentifyOptions, RefuseWhatMakesNoSense) {
  const auto message = [](const char* toml) -> std::string {
    try {
      const Study study = Study::parse(toml, "study.toml");
      static_cast<void>(VehicleIdentifyOptions::read(study.root().table("identify")));
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(message("[identify]\nestimate = [\"C_ff\"]\n").find("did you mean 'C_f'"), std::string::npos);
  EXPECT_NE(message("[identify]\nestimate = [\"mu\"]\n").find("linear tyres do not have"), std::string::npos);
  EXPECT_NE(message("[identify]\nsignal_to_noise = nan\n"), "");
  EXPECT_NE(message("[identify]\nsmoothing = -1\n").find(">= 0"), std::string::npos);
  EXPECT_NE(message("[identify]\nuncertainty = { mass = -1 }\n").find("standard deviation"), std::string::npos);
}

}  // namespace
}  // namespace veridyn::vehicle
