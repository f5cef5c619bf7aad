// The reader of JSON is only there where the page is.
#ifdef VERIDYN_HAS_PAGE
#include "veridyn/live/page/status_json.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/live/weaving_drive.hpp"

namespace veridyn::live {
namespace {

TEST(StatusJson, SaysHowMuchOfThePlatformIsUsedAndWhatIsFelt) {
  const LiveStudy study = test::rig_study();
  const auto design = study.cueing.algorithms.front().design->clone();
  RigStatus status;
  const auto pitch = cueing::PlatformAxis::kPitch;
  const cueing::AxisLimits& limits = study.cueing.platform.limits[pitch];
  set_axis(status.step.cueing.told, pitch,
           {.position = 0.75 * limits.lowest, .rate = -0.5 * limits.rate, .acceleration = 0.0});
  status.step.motion.emplace();
  status.step.motion->sample.frame = Frame::kFrd;
  status.step.motion->sample.force = recording::force_at_rest(Frame::kFrd);
  FeltNow felt(study.cueing);
  felt.update(status);
  const auto json = nlohmann::json::parse(status_json(status, study, felt, *design, 1.5, 0, ""));
  const auto& axis = json["axes"][2];
  ASSERT_EQ(axis["name"], "pitch");
  EXPECT_NEAR(axis["to_limit"].get<double>(), -0.25 * limits.lowest, 1e-12);
  EXPECT_NEAR(axis["range_used"].get<double>(), 0.75, 1e-12);
  EXPECT_NEAR(axis["rate_used"].get<double>(), 0.5, 1e-12);
  ASSERT_EQ(json["felt"].size(), cueing::kCues);
  EXPECT_EQ(json["felt"][0]["name"], "surge");
  EXPECT_NEAR(json["felt"][2]["vehicle"].get<double>(), 0.0, 1e-12);  // at rest nothing is felt
  EXPECT_EQ(json["felt"][3]["threshold"], study.cueing.thresholds.rate[0]);
}

TEST(StatusJson, HoldsWhatThePageDraws) {
  const LiveStudy study = test::rig_study();
  const auto design = study.cueing.algorithms.front().design->clone();
  RigStatus status;
  status.times.receive_to_send.add(kMillisecond);
  const auto json =
      nlohmann::json::parse(status_json(status, study, FeltNow(study.cueing), *design, 1.5, 2, "a message"));
  EXPECT_EQ(json["state"], "parked");
  EXPECT_EQ(json["readiness"], "no telemetry");
  EXPECT_EQ(json["axes"].size(), 3U);  // heave, roll, pitch
  for (const auto& axis : json["axes"]) {
    EXPECT_GT(axis["to_limit"], 0.0);
    EXPECT_EQ(axis["range_used"], 0.0);
    EXPECT_EQ(axis["rate_used"], 0.0);
  }
  EXPECT_FALSE(json.contains("felt"));  // no motion yet
  EXPECT_EQ(json["refused"], 2);
  EXPECT_EQ(json["latency"]["bins"].size(), 1U);
  EXPECT_EQ(json["packets"].size(), kPacketFates);
  EXPECT_EQ(json["knobs"].size(), knob_values(*design).size());
}

}  // namespace
}  // namespace veridyn::live
#endif
