#ifdef VERIDYN_HAS_PAGE
#include "veridyn/live/page/live_page.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/refusal.hpp"

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
  for (const char* body :
       {"", "{", "[]", "{}", "{\"request\": \"fly\"}", "{\"request\": 3}", "{\"knob\": -1, \"value\": 1}",
        "{\"request\": \"park\", \"run\": -1}", "{\"knob\": 1}", "{\"knob\": 1, \"value\": \"a\"}"})
    EXPECT_EQ(control(body), 400) << body;
  EXPECT_EQ(control(std::string(100000, ' ')), 413);
  EXPECT_TRUE(page_.take_requests().empty());
}

/// A page that takes no more than this.
class PageWith {
 public:
  PageWith(std::uint16_t port, std::uint32_t address, PageControls controls, const std::string& token)
      : page_({.address = {address, port},
               .token = token,
               .controls = controls,
               .frames = [](std::size_t run, double from, double to) { return fmt::format("{} {} {}", run, from, to); },
               .platform = [](std::size_t run) { return fmt::format("platform {}", run); }}),
        client_("127.0.0.1", port) {}
  int control(const std::string& request) {
    const auto answer = client_.Post("/control", {{"Authorization", std::string("Bearer ") + kToken}},
                                     "{\"request\": \"" + request + "\", \"run\": 2}", "application/json");
    return answer ? answer->status : -1;
  }
  int status_of(const std::string& path) { return client_.Get(path)->status; }
  std::string get(const std::string& path) { return client_.Get(path)->body; }
  LivePage& page() { return page_; }

 private:
  LivePage page_;
  httplib::Client client_;
};

TEST_F(LivePageTest, ThatStopsOnlyRefusesAndCountsEverythingElse) {
  PageWith p(static_cast<std::uint16_t>(port_ - 20000), 0x7f000001, PageControls::kStop, kToken);
  EXPECT_EQ(p.control("emergency"), 204);
  EXPECT_EQ(p.control("start"), 403);
  EXPECT_EQ(p.control("release"), 403);
  const std::vector<PageRequest> requests = p.page().take_requests();
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_EQ(requests[0].request, OperatorRequest::kEmergency);
  EXPECT_EQ(requests[0].run, 2U);
  EXPECT_EQ(p.page().refused(), 2U);
}

TEST_F(LivePageTest, BeyondLoopbackWithoutATokenShowsAndRefusesEveryControl) {
  for (const char* token : {"", kToken}) {
    PageWith p(static_cast<std::uint16_t>(port_ - 20000), 0, PageControls::kNone, token);
    EXPECT_EQ(p.status_of("/status"), 200);
    EXPECT_EQ(p.control("emergency"), 403);
    EXPECT_EQ(p.page().refused(), 1U);
    EXPECT_TRUE(p.page().take_requests().empty());
  }
}

TEST_F(LivePageTest, HandsOutWhatIsKeptOfARun) {
  PageWith p(static_cast<std::uint16_t>(port_ - 20000), 0x7f000001, PageControls::kStop, kToken);
  EXPECT_EQ(p.get("/frames?run=1&from=2.5&to=4"), "1 2.5 4");
  EXPECT_EQ(p.get("/platform?run=3"), "platform 3");
  for (const char* path :
       {"/frames", "/frames?run=1&from=2", "/frames?run=-1&from=1&to=2", "/frames?run=1&from=x&to=2",
        "/frames?run=1&from=nan&to=2", "/frames?run=1e9&from=1&to=2", "/platform", "/platform?run=a"})
    EXPECT_EQ(p.status_of(path), 404) << path;
  EXPECT_EQ(client_.Get("/frames?run=0&from=0&to=1")->status, 404);  // of a page that keeps nothing
}

TEST_F(LivePageTest, IsRefusedAPortInUse) {
  EXPECT_THAT(why([&] {
                LivePage({.address = {0x7f000001, port_}, .token = kToken});
              }),
              HasSubstr("cannot be listened to: in use, or not ours"));
  EXPECT_THAT(why([&] { LivePage({.address = {0, port_}, .token = ""}); }), HasSubstr("that needs a token"));
}

}  // namespace
}  // namespace veridyn::live
#endif
