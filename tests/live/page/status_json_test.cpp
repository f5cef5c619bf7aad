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
  set_axis(status.step.cueing.ordered, pitch,
           {.position = 0.75 * limits.lowest, .rate = -0.5 * limits.rate, .acceleration = 0.0});
  status.step.motion.emplace();
  status.step.motion->sample.frame = Frame::kFrd;
  status.step.motion->sample.force = recording::force_at_rest(Frame::kFrd);
  FeltNow felt(study.cueing);
  felt.update(status);
  const auto json = nlohmann::json::parse(status_json(status, study, felt, *design, 1.5, ""));
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
  const auto json = nlohmann::json::parse(status_json(status, study, FeltNow(study.cueing), *design, 1.5, "a message"));
  EXPECT_EQ(json["state"], "parked");
  EXPECT_EQ(json["readiness"], "no telemetry");
  EXPECT_EQ(json["axes"].size(), 3U);  // heave, roll, pitch
  for (const auto& axis : json["axes"]) {
    EXPECT_GT(axis["to_limit"], 0.0);
    EXPECT_EQ(axis["range_used"], 0.0);
    EXPECT_EQ(axis["rate_used"], 0.0);
  }
  EXPECT_FALSE(json.contains("felt"));  // no motion yet
  EXPECT_EQ(json["message"], "a message");
  EXPECT_FALSE(json.contains("car"));  // there is none
  EXPECT_EQ(json["latency"]["bins"].size(), 1U);
  EXPECT_EQ(json["packets"].size(), kPacketStatuses);
  EXPECT_EQ(json["knobs"].size(), knob_values(*design).size());
}

TEST(StatusJson, SaysHowTheCarIsReachedAndWhatItIsTold) {
  const LiveStudy study = test::rig_study();
  const auto design = study.cueing.algorithms.front().design->clone();
  RigStatus status;
  CarStatus& car = status.car.emplace();
  car.link.connected = true;
  car.link.commands_sent = 101;
  car.link.commands_arrived = 75;
  car.link.commands_lost = 25;
  car.link.round_trip_median = 4 * kMillisecond;
  car.command = {.steering = -0.2, .drive_force = 12.0, .brake = 0.25};
  const auto parsed = [&] {
    return nlohmann::json::parse(status_json(status, study, FeltNow(study.cueing), *design, 1.5, ""))["car"];
  };
  EXPECT_EQ(parsed()["state"], "not heard of");
  EXPECT_TRUE(parsed()["battery"].is_null());
  car.state = CarState::kBraking;
  car.battery = 7.4;
  const nlohmann::json json = parsed();
  EXPECT_EQ(json["state"], "braking by itself");
  EXPECT_EQ(json["battery"], 7.4);
  EXPECT_TRUE(json["connected"]);
  EXPECT_EQ(json["command_loss"], 0.25);  // of those that the car could have had
  EXPECT_EQ(json["round_trip_p50"], 0.004);
  EXPECT_TRUE(json["round_trip_p99"].is_null());
  EXPECT_EQ(json["steering"], -0.2);
  EXPECT_EQ(json["drive_force"], 12.0);
  EXPECT_EQ(json["brake"], 0.25);
}

}  // namespace
}  // namespace veridyn::live
#endif
