#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/apps/page_reader.hpp"
#include "tests/apps/process.hpp"
#include "tests/apps/program.hpp"
#include "tests/apps/udp_relay.hpp"
#include "tests/support/folders.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// The virtual rig, each part a process; ports of this test's own.
class LiveProgramTest : public ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    const int base = 20000 + 6 * (static_cast<int>(::getpid()) % 6000);
    base_ = base;
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
  /// @param more words of it
  [[nodiscard]] std::unique_ptr<Process> vehicle(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all = words({"rig", "vehicle", study_});
    all.insert(all.end(), more.begin(), more.end());
    return std::make_unique<Process>(all, folder_ / "vehicle.txt");
  }
  [[nodiscard]] std::unique_ptr<Process> platform() const {
    return std::make_unique<Process>(words({"rig", "platform", study_, "--json"}), folder_ / "platform.txt");
  }
  /// @param more words of it @param errors where its stderr goes instead
  [[nodiscard]] std::unique_ptr<Process> rig(const std::string& name = "rig", const std::vector<std::string>& more = {},
                                             const std::filesystem::path& errors = {}) const {
    std::vector<std::string> all = words({"cue", study_, "--live", "--start", "--out", (folder_ / name).string()});
    all.insert(all.end(), more.begin(), more.end());
    return std::make_unique<Process>(all, folder_ / (name + ".txt"), errors);
  }
  /// Says what no platform of ours may ever say.
  static void expect_within_limits(Process& platform) {
    platform.signal(SIGINT);
    EXPECT_EQ(platform.wait(), 0) << platform.said();
    for (const char* what : {"orders_outside_limits", "jumps", "orders_beyond_acceleration"})
      EXPECT_THAT(platform.said(), HasSubstr(fmt::format("\"{}\": 0", what)));
  }
  /// Resident memory of a process [bytes].
  static double memory_of(const Process& process) {
    std::ifstream status(fmt::format("/proc/{}/status", process.id()));
    std::string word;
    while (status >> word && word != "VmRSS:") continue;
    double kilobytes = 0.0;
    status >> kilobytes;
    return 1024.0 * kilobytes;
  }
  /// What a program printed with --json.
  static nlohmann::json json_of(const Process& process) {
    const std::string said = process.said();
    const std::size_t begin = said.find("\n{") == std::string::npos ? said.find('{') : said.find("\n{") + 1;
    return nlohmann::json::parse(said.substr(begin, said.rfind('}') + 1 - begin), nullptr, false);
  }
  [[nodiscard]] std::filesystem::path recording(const std::string& name = "rig") const {
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / name)) {
      if (entry.path().extension() == ".vlr") return entry.path();
    }
    return {};
  }
  /// Kills and stops parts of the rig again and again; the platform stays within its limits and the run comes back.
  void disturb(int times, std::uint64_t seed);
  /// A rig at 100 Hz with somebody at its page: nothing is lost, and after a while its memory does not grow.
  /// @param duration of the drive @param settled when memory is looked at first [s]
  void run_for(double duration, double settled);

  std::string study_;
  std::vector<std::string> sets_;
  int page_ = 0, base_ = 0;
};

void LiveProgramTest::disturb(int times, std::uint64_t seed) {
  numerics::RandomStream random(seed, "disturbances");
  const auto pause = [&](double from, double to) {
    std::this_thread::sleep_for(std::chrono::duration<double>(random.uniform(from, to)));
  };
  auto p = platform();
  ASSERT_TRUE(p->says("takes orders", 20.0)) << p->said();
  std::vector<std::string> runs = {"rig"};
  auto r = rig(runs.back());
  auto v = vehicle();
  ASSERT_TRUE(r->says("running", 20.0)) << r->said();
  for (int k = 0; k < times; ++k) {
    const double what = random.uniform();
    if (what < 0.08) {
      r.reset();  // SIGKILL: the platform leads itself to neutral, and takes orders of another run
      pause(0.05, 3.0);
      runs.push_back(fmt::format("rig{}", k));
      r = rig(runs.back());
    } else if (what < 0.16) {
      expect_within_limits(*p);
      pause(0.05, 2.0);
      p = platform();
    } else if (what < 0.3) {
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
  expect_within_limits(*p);
  // The recordings are whole, those of runs that were killed too.
  nlohmann::json json;
  for (const std::string& name : runs) {
    const std::filesystem::path file = recording(name);
    if (file.empty()) continue;  // killed before it began
    const auto summary =
        run("cue --replay " + file.string() + " --quiet --json --out " + (folder_ / "replay").string());
    if (name != runs.back() && summary.text.find("holds no steps") != std::string::npos) continue;
    ASSERT_EQ(summary.exit_code, 0) << name << ": " << summary.text;
    json = nlohmann::json::parse(summary.text);
    EXPECT_EQ(json["orders_outside_limits"], 0) << name;
    EXPECT_EQ(json["orders_different_when_replayed"], 0) << name;
  }
  // The last states: running, then the way to park that ended it.
  const auto& states = json["states"];
  ASSERT_GE(states.size(), 4U);
  EXPECT_EQ(states[states.size() - 3]["state"], "running") << states.dump();
}

TEST_F(LiveProgramTest, PlatformStaysWithinItsLimitsWhatIsKilledAndStopped) { disturb(10, 1); }

TEST_F(LiveProgramTest, SoakOfTwoHundredKillsAndStops) {
  const char* times = std::getenv("VERIDYN_SOAK_KILLS");
  disturb(times != nullptr ? std::stoi(times) : 200, 2);
}

TEST_F(LiveProgramTest, RecordingOfARigThatWasKilledIsReplayedToItsEnd) {
  auto p = platform();
  ASSERT_TRUE(p->says("takes orders", 20.0));
  auto r = rig();
  auto v = vehicle();
  ASSERT_TRUE(r->says("running", 20.0)) << r->said();
  std::this_thread::sleep_for(std::chrono::seconds(2));
  r.reset();  // SIGKILL
  // The same orders on one thread and on two.
  std::vector<std::string> fingerprints;
  for (const char* threads : {"1", "2"}) {
    const auto again = run("cue --replay " + recording().string() + " --quiet --json --threads " + threads + " --out " +
                           (folder_ / threads).string());
    ASSERT_EQ(again.exit_code, 0) << again.text;
    fingerprints.push_back(nlohmann::json::parse(again.text)["fingerprint"]);
  }
  EXPECT_EQ(fingerprints[0], fingerprints[1]);
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

TEST_F(LiveProgramTest, ComesBackFromANetworkThatWasPulled) {
  const auto telemetry = static_cast<std::uint16_t>(base_), platform_at = static_cast<std::uint16_t>(base_ + 1),
             far_telemetry = static_cast<std::uint16_t>(base_ + 3),
             far_platform = static_cast<std::uint16_t>(base_ + 4);
  UdpRelay to_rig(far_telemetry, telemetry), to_platform(far_platform, platform_at);
  const auto pull = [&](double time) {
    to_rig.cut(true);
    to_platform.cut(true);
    std::this_thread::sleep_for(std::chrono::duration<double>(time));
    to_rig.cut(false);
    to_platform.cut(false);
  };
  auto p = platform();
  ASSERT_TRUE(p->says("takes orders", 20.0)) << p->said();
  auto r = rig("rig", {"--set", fmt::format("live.platform=127.0.0.1:{}", far_platform), "--set", "live.hold=1.5",
                       "--set", "live.soft_start=0.5", "--set", "live.fade=0.5"});
  auto v = vehicle({"--set", fmt::format("live.telemetry=127.0.0.1:{}", far_telemetry)});
  ASSERT_TRUE(r->says("running", 20.0)) << r->said();
  std::size_t from = r->said().size();
  pull(0.05);
  std::this_thread::sleep_for(std::chrono::seconds(1));
  EXPECT_EQ(r->said().find("hold", from), std::string::npos) << "50 ms do not matter";
  pull(0.5);
  EXPECT_TRUE(r->says("hold", 5.0, from)) << r->said();
  EXPECT_TRUE(r->says("running", 10.0, from)) << r->said();
  EXPECT_EQ(r->said().find("fade", from), std::string::npos) << r->said();
  from = r->said().size();
  pull(5.0);
  EXPECT_TRUE(r->says("fade", 1.0, from)) << r->said();
  EXPECT_TRUE(r->says("parked", 5.0, from)) << r->said();
  EXPECT_TRUE(r->says("running", 10.0, from)) << r->said();
  r->signal(SIGINT);
  EXPECT_EQ(r->wait(), 0) << r->said();  // the replay does not differ in an order
  expect_within_limits(*p);
}

TEST_F(LiveProgramTest, GoesOnWhileTheDiskIsFullAndStopsOnAKey) {
  auto p = platform();
  ASSERT_TRUE(p->says("takes orders", 20.0)) << p->said();
  auto r = rig();
  auto v = vehicle();
  ASSERT_TRUE(r->says("running", 20.0)) << r->said();
  const rlimit full{std::filesystem::file_size(recording()), RLIM_INFINITY}, unlimited{RLIM_INFINITY, RLIM_INFINITY};
  ASSERT_EQ(::prlimit(r->id(), RLIMIT_FSIZE, &full, nullptr), 0);
  EXPECT_TRUE(r->says("the recording cannot be written: File too large", 5.0)) << r->said();
  std::this_thread::sleep_for(std::chrono::seconds(2));
  ASSERT_EQ(::prlimit(r->id(), RLIMIT_FSIZE, &unlimited, nullptr), 0);
  std::this_thread::sleep_for(std::chrono::seconds(1));
  EXPECT_EQ(r->said().find("hold"), std::string::npos) << r->said();
  r->press('e');
  EXPECT_TRUE(r->says("stopped", 2.0)) << r->said();
  r->press('r');
  EXPECT_TRUE(r->says("parked", 10.0, r->said().find("stopped"))) << r->said();
  // Before the rig ends: while it writes its report no orders come, on a busy machine for long enough to be a silence.
  expect_within_limits(*p);
  EXPECT_THAT(p->said(), HasSubstr("\"silences\": 0"));
  r->press('q');
  EXPECT_EQ(r->wait(), 1) << r->said();  // orders are missing in the recording
  EXPECT_TRUE(std::filesystem::exists(folder_ / "rig/report.html"));
  EXPECT_THAT(read_file(folder_ / "rig/report.html"), HasSubstr("the recording cannot be written: File too large"));
  const auto replay =
      run("cue --replay " + recording().string() + " --quiet --json --out " + (folder_ / "replay").string());
  EXPECT_EQ(replay.exit_code, 1) << replay.text;
  EXPECT_THAT(read_file(folder_ / "replay/report.html"), Not(HasSubstr("the recording is damaged")));
}

TEST_F(LiveProgramTest, LinesThatNobodyCanReadDoNotEndARunAndAClosedTerminalParksIt) {
  auto p = platform();
  ASSERT_TRUE(p->says("takes orders", 20.0)) << p->said();
  auto r = rig("rig", {"--json"}, "/dev/full");
  auto v = vehicle();
  std::this_thread::sleep_for(std::chrono::seconds(6));
  r->signal(SIGHUP);
  EXPECT_EQ(r->wait(), 0) << r->said();
  EXPECT_TRUE(std::filesystem::exists(folder_ / "rig/report.html"));
  const nlohmann::json json = json_of(*r);
  ASSERT_TRUE(json.is_object()) << r->said();
  ASSERT_GE(json["states"].size(), 2U) << r->said();
  EXPECT_EQ(json["states"].back()["state"], "parked");
  expect_within_limits(*p);
}

void LiveProgramTest::run_for(double duration, double settled) {
  const std::string token = file("token.txt", "0123456789abcdef0123456789abcdef\n");
  std::filesystem::permissions(token, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  const std::vector<std::string> evenly = {"--json",
                                           "--set",
                                           "live.rate=100",
                                           "--set",
                                           "live.vehicle.loss=0",
                                           "--set",
                                           "live.vehicle.clock_drift=300e-6",
                                           "--set",
                                           "live.page_token=" + token};
  auto p = platform();
  ASSERT_TRUE(p->says("takes orders", 20.0)) << p->said();
  auto r = rig("rig", evenly);
  ASSERT_TRUE(r->says("keys:", 20.0)) << r->said();
  EXPECT_THAT(r->said(), Not(HasSubstr("token:")));
  std::vector<std::string> driven = evenly;
  driven.insert(driven.end(), {"--seconds", fmt::format("{}", duration)});
  auto v = vehicle(driven);
  ASSERT_TRUE(r->says("running", 20.0)) << r->said();
  const PageReader events(page_, "GET /events HTTP/1.1\r\n");
  std::atomic<std::size_t> read{0};
  std::string last;
  std::thread reader([&] {
    constexpr std::size_t kKept = 20'000;
    for (std::string text = events.read(); !text.empty(); text = events.read()) {
      read += text.size();
      last += text;
      if (last.size() > kKept) last.erase(0, last.size() - kKept);
    }
  });
  std::this_thread::sleep_for(std::chrono::duration<double>(settled));
  const double before = memory_of(*r);
  EXPECT_EQ(v->wait(), 0) << v->said();
  const double growth = memory_of(*r) - before;
  EXPECT_GT(before, 1e6);
  EXPECT_LT(growth, 1024.0 * 1024.0) << "from " << before;
  EXPECT_TRUE(r->says("ppm fast against ours", 1.0)) << r->said();
  EXPECT_GT(static_cast<double>(read.load()), 1000.0 * duration);
  const std::string body = "{\"request\": \"park\"}";
  const PageReader control(page_, fmt::format("POST /control HTTP/1.1\r\nContent-Length: {}\r\nContent-Type: "
                                              "application/json\r\nConnection: close\r\nAuthorization: Bearer "
                                              "0123456789abcdef0123456789abcdef\r\n",
                                              body.size()));
  control.send(body);
  EXPECT_THAT(control.read(), HasSubstr("204"));
  r->signal(SIGINT);
  EXPECT_EQ(r->wait(), 0) << r->said();
  events.hang_up();
  reader.join();
  EXPECT_THAT(last, HasSubstr("ppm fast against ours"));
  const nlohmann::json rig_says = json_of(*r), vehicle_says = json_of(*v);
  ASSERT_TRUE(rig_says.is_object() && vehicle_says.is_object()) << r->said() << v->said();
  std::uint64_t all = 0;
  for (const auto& [fate, count] : rig_says["packets"].items()) all += count.get<std::uint64_t>();
  EXPECT_EQ(all, vehicle_says["packets_sent"].get<std::uint64_t>());
  EXPECT_GT(static_cast<double>(all), 95.0 * duration);
  EXPECT_EQ(rig_says["orders_different_when_replayed"], 0);
  EXPECT_GT(rig_says["wait_s"]["p99"].get<double>(), 0.0);
  EXPECT_GT(rig_says["work_s"]["p99"].get<double>(), 0.0);
  fmt::print("{} packets in {:g} s, all taken; memory {:.2f} MB, {:+.0f} kB in the end; {} bytes of the page read\n",
             all, duration, before / 1e6, growth / 1e3, read.load());
  expect_within_limits(*p);
}

TEST_F(LiveProgramTest, RunsHalfAMinuteWithSomebodyAtItsPageAndLosesNothing) { run_for(30.0, 12.0); }

/// As long as VERIDYN_SOAK_SECONDS says, an hour without.
TEST_F(LiveProgramTest, SoakOfAnHourAtAHundredHertz) {
  const char* seconds = std::getenv("VERIDYN_SOAK_SECONDS");
  run_for(seconds != nullptr ? std::stod(seconds) : 3600.0, 60.0);
}

TEST_F(LiveProgramTest, DashboardStopsARunThatStandsStillAndLosesDatagrams) {
  auto p = platform();
  auto r = rig();
  auto v = vehicle();
  ASSERT_TRUE(r->says("running", 20.0)) << r->said();
  const int port = base_ + 3;
  const std::string token = file("token", "a-token-of-this-test\n");
  std::filesystem::permissions(token, std::filesystem::perms::owner_read);
  Process serve(
      {"serve", (folder_ / "rig").string(), "--page", fmt::format("127.0.0.1:{}", port), "--token-file", token},
      folder_ / "serve.txt");
  const auto status_has = [&](const std::string& text, int tenths) {
    std::string all;
    for (int k = 0; k < tenths && all.find(text) == std::string::npos; ++k) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      const PageReader reader(port, "GET /status HTTP/1.1\r\nConnection: close\r\n");
      all.clear();
      for (std::string more = reader.read(); !more.empty(); more = reader.read()) all += more;
    }
    return all.find(text) != std::string::npos;
  };
  ASSERT_TRUE(status_has("\"state\":\"running\"", 200)) << serve.said();
  // It stands still until its recording no longer counts as growing, and its queue is full.
  r->signal(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds(2500));
  auto flood = live::UdpSocket::connected({0x7f000001, static_cast<std::uint16_t>(base_)}, "flood");
  for (int k = 0; k < 20000; ++k) static_cast<void>(flood.send(std::string(500, 'x')));
  const std::string body = "{\"request\": \"emergency\"}";
  const PageReader control(port, fmt::format("POST /control HTTP/1.1\r\nConnection: close\r\nContent-Length: {}\r\n"
                                             "Authorization: Bearer a-token-of-this-test\r\n",
                                             body.size()));
  control.send(body);
  EXPECT_THAT(control.read().substr(0, 20), HasSubstr(" 204 "));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  r->signal(SIGCONT);
  EXPECT_TRUE(status_has("\"state\":\"stopped\"", 200)) << serve.said();
}

TEST_F(LiveProgramTest, PlatformIsMeasuredByHandAndTheSecondProgramIsToldWhoCommandsIt) {
  auto p = platform();
  ASSERT_TRUE(p->says("takes orders", 20.0)) << p->said();
  const auto test_of = [&](const std::string& name, const std::string& more, const std::string& axis = "pitch") {
    std::string command =
        "rig test " + study_ + " --quiet --json --axis " + axis + " --out " + (folder_ / name).string() + more;
    for (const std::string& word : sets_) command += " " + word;
    return command;
  };
  auto r = rig();
  ASSERT_TRUE(r->says("listening", 20.0)) << r->said();
  ASSERT_TRUE(p->says("commands the platform", 10.0)) << p->said();
  const Outcome refused = run(test_of("refused", " --signal home --seconds 1"));
  EXPECT_EQ(refused.exit_code, 2) << refused.text;
  EXPECT_THAT(refused.text, ::testing::ContainsRegex("the program at 127.0.0.1:[0-9]+ commands the platform"));
  r.reset();
  const auto until_another_may_command = std::chrono::milliseconds(2500);
  std::this_thread::sleep_for(until_another_may_command);
  const Outcome sweep = run(test_of("sweep", " --signal sweep --seconds 8"));
  ASSERT_EQ(sweep.exit_code, 0) << sweep.text;
  const auto json = nlohmann::json::parse(sweep.text);
  const auto& pitch = json["axes"]["pitch"];
  EXPECT_NEAR(pitch["gain"]["value"].get<double>(), 1.0, 0.1) << sweep.text;
  EXPECT_NEAR(pitch["omega_rad_s"]["value"].get<double>(), 30.0, 9.0) << sweep.text;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "sweep/ordered_and_reached.csv"));
  // What was measured is read by the study that names the file, axis by axis; run.json says which file that was.
  const std::string measured = read_file(folder_ / "sweep/platform.toml");
  for (const char* key : {"pitch_omega = ", "pitch_zeta = ", "pitch_delay = ", "omega = 30.0"})
    EXPECT_THAT(measured, HasSubstr(key));
  const std::string tuned = (folder_ / "tuned.toml").string();
  std::ofstream(tuned) << "[cue]\nalgorithms = [\"classical\"]\n[platform]\nfile = "
                          "\"sweep/platform.toml\"\n[subject]\nkind = \"vehicle\"\nbuiltin = "
                          "\"reference\"\n[drive]\nmodel = \"four-wheel\"\nmanoeuvre = \"sine\"\nspeed = 20\n"
                          "amplitude = 0.02\nfrequency = 0.25\nduration = 8\n";
  const Outcome cued = run("cue " + tuned + " --quiet --out " + (folder_ / "tuned").string());
  ASSERT_EQ(cued.exit_code, 0) << cued.text;
  const auto record = nlohmann::json::parse(read_file(folder_ / "tuned/run.json"));
  ASSERT_EQ(record["inputs"].size(), 2U) << record.dump();  // and the study
  EXPECT_THAT(record["inputs"][0]["file"].get<std::string>(), HasSubstr("platform.toml"));
  EXPECT_EQ(record["inputs"][0]["sha1"].get<std::string>().size(), 40U);
  std::this_thread::sleep_for(until_another_may_command);
  const Outcome force = run(test_of("force", " --signal force --value 1m/s^2 --seconds 3"));
  ASSERT_EQ(force.exit_code, 0) << force.text;
  const std::string ordered = read_file(folder_ / "force/ordered_and_reached.csv");
  EXPECT_NEAR(std::stod(ordered.substr(ordered.rfind(',') + 1)), std::asin(1.0 / 9.80665), 1e-3);  // reached at last
  expect_refusal(test_of("wrong", " --signal pose --value 40deg"),
                 "takes pitch to 0.6981 rad; its range is -0.2618 to");
  expect_refusal(test_of("wrong", " --signal pose --value 40mm"), "--value: = '40mm' for pitch");
  expect_refusal(test_of("wrong", " --signal wave --value 4deg"), "is of `--signal pose` and `force` only");
  expect_refusal(test_of("wrong", "", "surge"), "'surge' is no axis of this platform");
  expect_within_limits(*p);
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
  expect_refusal("cue " + study_ + " --live --set live.rate=5" + out(), "live.rate: = 5 Hz must be from 20 to 4000 Hz");
  expect_refusal("cue " + study_ + " --live --set live.telemetry=8.8.8.8:4123" + out(),
                 "Cannot assign requested address");
  expect_refusal("cue " + study_ + " --live --set live.ratte=5" + out(), "did you mean 'rate'");
  expect_refusal("rig platform " + file("s.toml", "[cue]\n"), "the table [live] says where telemetry comes from");
  for (const char* command : {"rig platform ", "rig vehicle ", "rig test "})
    expect_refusal(command + study_ + " --set live.ratte=5", "did you mean 'rate'");
  expect_refusal("rig platform " + study_ + " --set live.format=flypt --set live.answers=false",
                 "is not read by the virtual platform");
  expect_refusal("rig platform " + file("no_limits.toml",
                                        "[cue]\nalgorithms = ['classical']\n[live]\n"
                                        "telemetry = '127.0.0.1:4123'\nplatform = '127.0.0.1:5123'\n"),
                 "platform: is missing: the limits of a platform that moves are not guessed");
}

}  // namespace
}  // namespace veridyn
