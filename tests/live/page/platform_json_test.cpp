// The reader of JSON is only there where the page is.
#ifdef VERIDYN_HAS_PAGE
#include "veridyn/live/page/platform_json.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace veridyn::live {
namespace {

TEST(PlatformJson, HoldsLegsAndRider) {
  const cueing::Platform& hexapod = cueing::built_in_platform("hexapod");
  const auto json = nlohmann::json::parse(platform_json(hexapod));
  ASSERT_EQ(json["feet"].size(), 6U);
  ASSERT_EQ(json["heads"].size(), 6U);
  for (std::size_t k = 0; k < 6; ++k) {
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(json["feet"][k][i], hexapod.legs->feet[k](i));
      EXPECT_EQ(json["heads"][k][i], hexapod.legs->heads[k](i));
    }
  }
  EXPECT_EQ(json["leg"]["lowest"], hexapod.legs->leg.lowest);
  EXPECT_EQ(json["leg"]["highest"], hexapod.legs->leg.highest);
  EXPECT_EQ(json["rider"][2], hexapod.rider.z());
}

TEST(PlatformJson, OfAPlatformWithoutLegsHasNone) {
  const auto json = nlohmann::json::parse(platform_json(cueing::built_in_platform("ideal")));
  EXPECT_TRUE(json["feet"].empty());
  EXPECT_TRUE(json["heads"].empty());
  EXPECT_FALSE(json.contains("leg"));
}

}  // namespace
}  // namespace veridyn::live
#endif
