#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/apps/process.hpp"
#include "tests/apps/program.hpp"
#include "tests/support/folders.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn {
namespace {

using ::testing::HasSubstr;

/// The virtual rig, each part a process; ports of this test's own.
class LiveProgramTest : public ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    const int base = 20000 + 4 * (static_cast<int>(::getpid()) % 10000);
    study_ = (test::source_folder() / "examples/studies/cueing/live.toml").string();
    page_ = base + 2;
    sets_ = {"--set", fmt::format("live.page=127.0.0.1:{}", page_),
             "--set", fmt::format("live.telemetry=127.0.0.1:{}", base),
             "--set", fmt::format("live.platform=127.0.0.1:{}", base + 1),
             "--set", "live.soft_start=1",
             "--set", "live.fade=1",
             "--set", "live.signs=while",
             "--set", "live.rate=500",
             "--set", "drive.duration=25"};
  }

  [[nodiscard]] std::vector<std::string> words(std::vector<std::string> command) const {
    command.insert(command.end(), sets_.begin(), sets_.end());
    return command;
  }
  [[nodiscard]] std::unique_ptr<Process> vehicle() const {
    return std::make_unique<Process>(words({"rig", "vehicle", study_}), folder_ / "vehicle.txt");
  }
  [[nodiscard]] std::unique_ptr<Process> platform() const {
    return std::make_unique<Process>(words({"rig", "platform", study_, "--json"}), folder_ / "platform.txt");
  }
  [[nodiscard]] std::unique_ptr<Process> rig(const std::string& name = "rig") const {
    return std::make_unique<Process>(words({"cue", study_, "--live", "--start", "--out", (folder_ / name).string()}),
                                     folder_ / (name + ".txt"));
  }
  [[nodiscard]] std::filesystem::path recording(const std::string& name = "rig") const {
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / name)) {
      if (entry.path().extension() == ".vlr") return entry.path();
    }
    return {};
  }
  /// Kills and stops parts of the rig again and again; the platform stays within its limits and the run comes back.
  void disturb(int times, std::uint64_t seed);

  std::string study_;
  std::vector<std::string> sets_;
  int page_ = 0;
};

void LiveProgramTest::disturb(int times, std::uint64_t seed) {
  numerics::RandomStream random(seed, "disturbances");
  const auto pause = [&](double from, double to) {
    std::this_thread::sleep_for(std::chrono::duration<double>(random.uniform(from, to)));
  };
  auto p = platform();
  ASSERT_TRUE(p->says("takes orders", 20.0)) << p->said();
  auto r = rig();
  auto v = vehicle();
  ASSERT_TRUE(r->says("running", 20.0)) << r->said();
  for (int k = 0; k < times; ++k) {
    const double what = random.uniform();
    if (what < 0.3) {
      v->signal(SIGSTOP);
      pause(0.05, 3.0);
      v->signal(SIGCONT);
    } else if (what < 0.5) {
      v.reset();
      pause(0.05, 2.0);
      v = vehicle();
    } else if (what < 0.7) {
      p->signal(SIGSTOP);
      pause(0.05, 2.0);
      p->signal(SIGCONT);
    } else {
      r->signal(SIGSTOP);
      pause(0.05, 2.0);
      r->signal(SIGCONT);
    }
    pause(0.1, 2.0);
  }
  // Undisturbed it runs again.
  std::this_thread::sleep_for(std::chrono::seconds(8));
  r->signal(SIGINT);
  EXPECT_EQ(r->wait(), 0) << r->said();
  p->signal(SIGINT);
  EXPECT_EQ(p->wait(), 0) << p->said();
  EXPECT_THAT(p->said(), HasSubstr("\"orders_outside_limits\": 0"));
  EXPECT_THAT(p->said(), HasSubstr("\"jumps\": 0"));
  const auto summary =
      run("cue --replay " + recording().string() + " --quiet --json --out " + (folder_ / "replay").string());
  ASSERT_EQ(summary.exit_code, 0) << summary.text;
  const auto json = nlohmann::json::parse(summary.text);
  EXPECT_EQ(json["orders_outside_limits"], 0);
  EXPECT_EQ(json["orders_different_when_replayed"], 0);
  // The last states: running, then the way to park that ended it.
  const auto& states = json["states"];
  ASSERT_GE(states.size(), 4U);
  EXPECT_EQ(states[states.size() - 3]["state"], "running") << states.dump();
}

TEST_F(LiveProgramTest, PlatformStaysWithinItsLimitsWhatIsKilledAndStopped) { disturb(6, 1); }

TEST_F(LiveProgramTest, SoakOfTwoHundredKillsAndStops) { disturb(200, 2); }

TEST_F(LiveProgramTest, RecordingOfARigThatWasKilledIsReplayedToItsEnd) {
  auto p = platform();
  ASSERT_TRUE(p->says("takes orders", 20.0));
  auto r = rig();
  auto v = vehicle();
  ASSERT_TRUE(r->says("running", 20.0)) << r->said();
  std::this_thread::sleep_for(std::chrono::seconds(2));
  r.reset();  // SIGKILL
  const auto replay = run("cue --replay " + recording().string() + " --out " + (folder_ / "replay").string());
  EXPECT_EQ(replay.exit_code, 0) << replay.text;
  EXPECT_THAT(replay.text, HasSubstr("0 beyond limits, 0 different when replayed"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "replay/report.html"));
}

TEST_F(LiveProgramTest, StopsOnASignal) {
  auto p = platform();
  ASSERT_TRUE(p->says("takes orders", 20.0));
  auto r = rig();
  auto v = vehicle();
  ASSERT_TRUE(r->says("running", 20.0)) << r->said();
  r->signal(SIGUSR1);
  EXPECT_TRUE(r->says("stopped", 2.0)) << r->said();
  r->signal(SIGINT);
  EXPECT_EQ(r->wait(), 0) << r->said();
}

TEST_F(LiveProgramTest, SecondProgramAtTheSamePortIsRefusedAndTheFirstGoesOn) {
  auto p = platform();
  ASSERT_TRUE(p->says("takes orders", 20.0));
  auto r = rig();
  ASSERT_TRUE(r->says("listening", 20.0));
  auto second = rig("second");
  EXPECT_EQ(second->wait(), 2) << second->said();
  EXPECT_THAT(second->said(), HasSubstr("cannot be listened to: Address already in use"));
  auto other = platform();
  EXPECT_EQ(other->wait(), 2) << other->said();
}

TEST_F(LiveProgramTest, RefusesInOneLine) {
  expect_refusal("cue" + out(), "takes a study, or --replay and a recorded run");
  expect_refusal("cue " + study_ + " --replay x.vlr" + out(), "either, not both");
  expect_refusal("cue --replay " + file("no.vlr", "nothing") + out(), "is no recording of a live run");
  expect_refusal("cue " + study_ + " --live --set live.rate=5" + out(), "live.rate: is 5 Hz; takes 20 to 4000 Hz");
  expect_refusal("cue " + study_ + " --live --set live.telemetry=8.8.8.8:4123" + out(),
                 "Cannot assign requested address");
  expect_refusal("cue " + study_ + " --live --set live.ratte=5" + out(), "did you mean 'rate'");
  expect_refusal("rig platform " + file("s.toml", "[cue]\n"), "the table [live] says where telemetry comes from");
}

}  // namespace
}  // namespace veridyn
