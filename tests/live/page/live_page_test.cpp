#ifdef VERIDYN_HAS_PAGE
#include "veridyn/live/page/live_page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/live/weaving_drive.hpp"
#include "tests/support/refusal.hpp"
#include "veridyn/live/page/page_token.hpp"
#include "veridyn/live/page/status_json.hpp"

namespace veridyn::live {
namespace {

using ::testing::HasSubstr;

constexpr const char* kToken = "0123456789abcdef";

class LivePageTest : public ::testing::Test {
 protected:
  LivePageTest()
      : port_(static_cast<std::uint16_t>(40000 + ::getpid() % 20000)),
        page_({.address = {0x7f000001, port_}, .token = kToken}),
        client_("127.0.0.1", port_) {}

  int control(const std::string& body,
              const httplib::Headers& headers = {{"Authorization", std::string("Bearer ") + kToken}}) {
    const auto answer = client_.Post("/control", headers, body, "application/json");
    return answer ? answer->status : -1;
  }

  std::uint16_t port_;
  LivePage page_;
  httplib::Client client_;
};

TEST_F(LivePageTest, ShowsItselfAndTheNewestStatus) {
  const auto html = client_.Get("/");
  ASSERT_TRUE(html);
  EXPECT_THAT(html->body, HasSubstr("EMERGENCY STOP"));
  EXPECT_THAT(html->get_header_value("Content-Security-Policy"), HasSubstr("connect-src 'self'"));
  page_.show("{\"state\": \"parked\"}");
  EXPECT_EQ(client_.Get("/status")->body, "{\"state\": \"parked\"}");
}

TEST_F(LivePageTest, SendsWhatIsShownAsEventsAndASlowReaderDelaysNobody) {
  std::string got;
  std::thread reader([&] {
    httplib::Client slow("127.0.0.1", port_);
    slow.Get("/events", [&](const char* data, std::size_t size) {
      got.append(data, size);
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
      return got.find("last") == std::string::npos;
    });
  });
  const auto begin = std::chrono::steady_clock::now();
  for (int k = 0; k < 1000; ++k) page_.show(fmt::format("{{\"k\": {}}}", k));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2));
  page_.show("{\"k\": \"last\"}");
  reader.join();
  EXPECT_THAT(got, HasSubstr("data: {\"k\": \"last\"}\n\n"));
}

TEST_F(LivePageTest, TakesControlsFromWhoeverHasTheToken) {
  EXPECT_EQ(control("{\"request\": \"park\"}"), 204);
  EXPECT_EQ(control("{\"request\": \"emergency\"}"), 204);
  EXPECT_EQ(control("{\"knob\": 3, \"value\": 0.7}"), 204);
  EXPECT_EQ(control("{\"undo\": true}"), 204);
  const std::vector<PageRequest> requests = page_.take_requests();
  ASSERT_EQ(requests.size(), 4U);
  EXPECT_EQ(requests[0].request, OperatorRequest::kPark);
  EXPECT_EQ(requests[1].request, OperatorRequest::kEmergency);
  EXPECT_EQ(requests[2].kind, PageRequest::Kind::kKnob);
  EXPECT_EQ(requests[2].knob, 3U);
  EXPECT_EQ(requests[2].value, 0.7);
  EXPECT_EQ(requests[3].kind, PageRequest::Kind::kUndo);
  EXPECT_TRUE(page_.take_requests().empty());
  EXPECT_EQ(page_.refused(), 0U);
}

TEST_F(LivePageTest, RefusesAndCountsControlsWithoutTheRightToken) {
  const std::string park = "{\"request\": \"park\"}";
  EXPECT_EQ(control(park, {}), 401);
  EXPECT_EQ(control(park, {{"Authorization", kToken}}), 401);
  EXPECT_EQ(control(park, {{"Authorization", "Bearer 0123456789abcdee"}}), 403);
  EXPECT_EQ(control(park, {{"Authorization", "Bearer "}}), 401);
  EXPECT_EQ(client_.Post(std::string("/control?token=") + kToken, park, "application/json")->status, 401);
  // A foreign page in the operator's browser, by another name for this address.
  const std::string bearer = std::string("Bearer ") + kToken;
  EXPECT_EQ(control(park, {{"Authorization", bearer}, {"Host", "evil.example"}}), 403);
  EXPECT_EQ(control(park, {{"Authorization", bearer}, {"Origin", "http://evil.example"}}), 403);
  EXPECT_EQ(page_.refused(), 7U);
  EXPECT_TRUE(page_.take_requests().empty());
}

TEST_F(LivePageTest, RefusesWhatIsNoRequest) {
  for (const char* body : {"", "{", "[]", "{}", "{\"request\": \"fly\"}", "{\"request\": 3}",
                           "{\"knob\": -1, \"value\": 1}", "{\"knob\": 1}", "{\"knob\": 1, \"value\": \"a\"}"})
    EXPECT_EQ(control(body), 400) << body;
  EXPECT_EQ(control(std::string(100000, ' ')), 413);
  EXPECT_TRUE(page_.take_requests().empty());
}

TEST_F(LivePageTest, IsRefusedAPortInUse) {
  EXPECT_THAT(why([&] {
                LivePage({.address = {0x7f000001, port_}, .token = kToken});
              }),
              HasSubstr("cannot be listened to: in use, or not ours"));
  EXPECT_THAT(why([&] { LivePage({.address = {0, port_}, .token = ""}); }), HasSubstr("that needs a token"));
}

TEST(PageToken, OfAFileThatOthersCanReadIsRefused) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / fmt::format("veridyn_token_{}", ::getpid());
  std::ofstream(file) << "  0123456789abcdef  \n";
  ::chmod(file.c_str(), 0600);
  EXPECT_EQ(read_token_file(file), "0123456789abcdef");
  ::chmod(file.c_str(), 0640);
  EXPECT_THAT(why([&] { static_cast<void>(read_token_file(file)); }), HasSubstr("can be read by others"));
  ::chmod(file.c_str(), 0600);
  std::ofstream(file) << "short\n";
  EXPECT_THAT(why([&] { static_cast<void>(read_token_file(file)); }), HasSubstr("a token of 5 characters"));
  std::filesystem::remove(file);
  EXPECT_THROW(static_cast<void>(read_token_file(file)), InputError);
}

TEST(PageToken, IsComparedWhole) {
  EXPECT_TRUE(equal_in_constant_time("abc", "abc"));
  for (const char* other : {"", "ab", "abcd", "abd", "Abc", "abcabc"})
    EXPECT_FALSE(equal_in_constant_time("abc", other)) << other;
  EXPECT_FALSE(equal_in_constant_time("", ""));
  EXPECT_FALSE(equal_in_constant_time("", "a"));
  EXPECT_NE(random_token(), random_token());
  EXPECT_EQ(random_token().size(), 32U);
}

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
