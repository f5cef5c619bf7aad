// The reader of JSON is only there where the page is.
#ifdef VERIDYN_HAS_PAGE
#include "veridyn/live/page/page_json.hpp"

#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>

namespace veridyn::live {
namespace {

TEST(PageJson, HoldsRunsWorkAndWhatMayBeAskedFor) {
  const std::array runs = {
      ShownRun{
          .name = "a \"run\" \xff", .status = R"({"state":"parked"})", .length = 2.5, .grows = false, .kept = true},
      ShownRun{.trouble = "no head"}};
  const std::array<std::string, 1> work = {R"({"stage":"output error"})"};
  const auto json = nlohmann::json::parse(page_json(runs, work, PageControls::kStop, 3));
  ASSERT_EQ(json["runs"].size(), 2U);
  EXPECT_EQ(json["runs"][0]["name"], "a \"run\" \xEF\xBF\xBD");  // what is no text is replaced
  EXPECT_EQ(json["runs"][0]["status"]["state"], "parked");
  EXPECT_EQ(json["runs"][0]["length"], 2.5);
  EXPECT_EQ(json["runs"][0]["grows"], false);
  EXPECT_EQ(json["runs"][0]["kept"], true);
  EXPECT_TRUE(json["runs"][1]["status"].is_null());
  EXPECT_EQ(json["runs"][1]["trouble"], "no head");
  EXPECT_EQ(json["work"][0]["stage"], "output error");
  EXPECT_EQ(json["controls"], "stop");
  EXPECT_EQ(json["refused"], 3);
  EXPECT_EQ(nlohmann::json::parse(page_json({}, {}, PageControls::kAll, 0))["controls"], "all");
  EXPECT_EQ(nlohmann::json::parse(page_json({}, {}, PageControls::kNone, 0))["controls"], "none");
}

}  // namespace
}  // namespace veridyn::live
#endif
