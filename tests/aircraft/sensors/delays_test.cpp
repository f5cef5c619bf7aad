#include "veridyn/aircraft/sensors/delays.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <chrono>
#include <cmath>

#include "tests/aircraft/campaign/campaign.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kLate_s = 0.15;

double acceleration(double t) { return std::sin(0.9 * t) + std::sin(1.7 * t + 1.0) + std::sin(3.1 * t + 2.0); }
double velocity(double t) {
  return -std::cos(0.9 * t) / 0.9 - std::cos(1.7 * t + 1.0) / 1.7 - std::cos(3.1 * t + 2.0) / 3.1;
}

/// Level flight that is only accelerated forward; the GPS is late and `stamp_scale` times slower than it should be.
MappedRecording flight(double stamp_scale = 1.0, double late_s = kLate_s) {
  std::vector<double> fast, slow;
  for (int k = 0; k < 60 * 50; ++k) fast.push_back(0.02 * k);
  for (int k = 0; k < 60 * 5; ++k) slow.push_back(0.2 * k * stamp_scale);
  const TimeBase imu = make_time_base(fast), gps = make_time_base(slow);
  MappedRecording mapped;
  const auto add = [&](const char* name, const char* unit, const TimeBase& time, auto f) {
    std::vector<double> values;
    for (const double t : *time) values.push_back(f(t));
    mapped.recording.add(make_channel(name, unit, time, std::move(values)));
  };
  const auto zero = [](double) { return 0.0; };
  for (const char* name : {"gyro_x", "gyro_y", "gyro_z"}) add(name, "rad/s", imu, zero);
  for (const char* name : {"roll", "pitch", "yaw"}) add(name, "rad", imu, zero);
  add("accel_x", "m/s^2", imu, acceleration);
  add("accel_y", "m/s^2", imu, zero);
  add("accel_z", "m/s^2", imu, [](double) { return -9.80665; });
  add("vel_north", "m/s", gps, [&](double t) { return velocity(t / stamp_scale - late_s); });
  add("vel_east", "m/s", gps, zero);
  return mapped;
}

const DelayReport* find(const std::vector<DelayReport>& reports, const char* group) {
  for (const DelayReport& report : reports) {
    if (report.group == group) return &report;
  }
  return nullptr;
}

class Stopped : public Progress {
 public:
  bool update(double) override { return false; }
  [[nodiscard]] bool interrupted() const override { return true; }
};

TEST(AlignDelays, TakesTheLatenessOfTheGpsOffItsStamps) {
  const AlignedRecording aligned = align_delays(flight(), {});
  const DelayReport* gps = find(aligned.delays, "gps");
  ASSERT_NE(gps, nullptr);
  EXPECT_TRUE(gps->applied()) << recording::says(*gps);
  EXPECT_NEAR(gps->delay_s, kLate_s, 0.01);
  EXPECT_NEAR(aligned.mapped.recording.at("vel_north").times().front(), -kLate_s, 0.01);
}

// As of a receiver whose sentences come over a serial line; `max` is 0.3 s.
TEST(AlignDelays, SearchesFartherForALateGps) {
  for (const double late_s : {0.42, 0.8}) {
    const AlignedRecording aligned = align_delays(flight(1.0, late_s), {});
    const DelayReport* gps = find(aligned.delays, "gps");
    ASSERT_NE(gps, nullptr);
    EXPECT_TRUE(gps->applied()) << recording::says(*gps);
    EXPECT_NEAR(gps->delay_s, late_s, 0.01);
  }
}

// A gust moves the vane before the aircraft, and the pilot of this one reacts to it: what does not know that finds
// delays of 20 to 80 ms where there are none.
TEST(AlignDelays, FindsNoDelayInTurbulenceWhereThereIsNone) {
  for (const char* aircraft : {"tut_airplane", "aerosonde", "x8"}) {
    const FlightStudy study = aircraft::testing::campaign_flight(aircraft, 3, 150.0);
    for (const DelayReport& report : align_delays(study.mapped, {}).delays) {
      EXPECT_FALSE(report.applied()) << aircraft << " " << report.group << " " << report.delay_s;
      EXPECT_LT(std::abs(report.determined() ? report.delay_s : 0.0), 0.01) << aircraft << " " << report.group;
    }
  }
}

// In calm air lift, pitch rate and elevator move together, and two lags explain the vane nearly as well. Taken off,
// 84 and 88 ms made CL_alpha 50 % too large. The motion shows it.
TEST(AlignDelays, FindsNoDelayInCalmAirWhereByTheForceTwoFitAsWell) {
  for (const int seed : {5, 6}) {
    Progress silent;
    const FlightStudy study = read_study(
        Study::parse(
            fmt::format(
                "seed = {}\n[subject]\nbuiltin = \"unatrap\"\n[flight]\nduration = 300\naltitude = 100\n"
                "airspeed = 20\nwind = [4, -2, 0]\nwind_drift = 0.3\nturbulence = \"none\"\nplan = \"default\"\n"
                "[sensors]\nset = \"reference\"\n[sensors.gps_velocity]\ndelay = 0.1\n",
                seed),
            "calm.toml"),
        silent);
    const std::vector<DelayReport> reports = align_delays(study.mapped, {}).delays;
    const DelayReport* alpha = find(reports, "alpha");
    ASSERT_NE(alpha, nullptr);
    EXPECT_FALSE(alpha->applied()) << alpha->delay_s;
    EXPECT_EQ(alpha->finding, recording::DelayFinding::kSmall);
    EXPECT_EQ(alpha->reference, "gyro, accelerometer and attitude");
    EXPECT_LT(std::abs(alpha->delay_s), 0.005);
    const DelayReport* elevator = find(reports, "elevator");
    ASSERT_NE(elevator, nullptr);
    EXPECT_LT(std::abs(elevator->delay_s), 0.01);
  }
}

TEST(AlignDelays, FindsThoseOfVanesAndSurfacesInTurbulence) {
  FlightStudy study = aircraft::testing::campaign_flight("unatrap", 3, 150.0);
  recording::take_off_delay(study.mapped.recording, {"alpha"}, -0.08);
  recording::take_off_delay(study.mapped.recording, {"beta"}, -0.2);
  // A command whose surface follows late is stamped before its effect.
  recording::take_off_delay(study.mapped.recording, {"aileron"}, 0.06);
  const std::vector<DelayReport> reports = align_delays(study.mapped, {}).delays;
  for (const auto& [group, late_s] : {std::pair{"alpha", 0.08}, {"beta", 0.2}, {"aileron", 0.06}}) {
    const DelayReport* report = find(reports, group);
    ASSERT_NE(report, nullptr);
    EXPECT_TRUE(report->applied()) << group << ": " << recording::says(*report);
    EXPECT_NEAR(report->delay_s, late_s, 3.0 * report->sigma_s) << group;
    // How gusts turn the air about the aircraft leaves a delay by the side force in doubt.
    EXPECT_LT(report->sigma_s, report->group == "beta" ? 0.03 : 0.01) << group;
  }
}

TEST(AlignDelays, StampsInMillisecondsCalledSecondsCostNoTime) {
  // Five fixes a second become one in 200 s: the filter that they would need has millions of taps.
  const MappedRecording mapped = flight(1000.0);
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<DelayReport> reports = align_delays(mapped, {}).delays;
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), 5.0);
  const DelayReport* gps = find(reports, "gps");
  ASSERT_NE(gps, nullptr);
  EXPECT_FALSE(gps->applied());
  EXPECT_EQ(gps->finding, recording::DelayFinding::kSlow);
}

TEST(AlignDelays, StopsWhenItIsInterrupted) {
  Stopped progress;
  const AlignedRecording aligned = align_delays(flight(), {}, progress);
  EXPECT_THAT(aligned.delays, IsEmpty());
  EXPECT_EQ(aligned.mapped.recording.at("vel_north").times().front(), 0.0);
}

TEST(AlignDelays, GivenOnesAreAppliedAndNothingElseWithoutTheAutomatic) {
  const Study study = Study::parse("[delays]\nautomatic = false\ngps = '50 ms'\n", "study.toml", ".");
  const AlignedRecording aligned = align_delays(flight(), DelayAlignment::keys().read(study.root().table("delays")));
  ASSERT_EQ(aligned.delays.size(), 1u);
  EXPECT_EQ(aligned.delays[0].finding, recording::DelayFinding::kGiven);
  EXPECT_DOUBLE_EQ(aligned.mapped.recording.at("vel_east").times().front(), -0.05);
}

/// The surfaces are recorded before they move.
MappedRecording recorded_early(MappedRecording mapped, double aileron_s, double rudder_s) {
  for (const auto& [name, early] : {std::pair{"aileron", aileron_s}, {"rudder", rudder_s}})
    recording::take_off_delay(mapped.recording, {name}, early);
  return mapped;
}

// The default plan excites them with signals that are orthogonal.
TEST(AlignDelays, SurfacesThatMoveSeparatelyKeepDelaysOfTheirOwn) {
  const FlightStudy study = testing::campaign_flight("aerosonde", 1, 150.0);
  const std::vector<DelayReport> reports = align_delays(recorded_early(study.mapped, 0.08, 0.15), {}).delays;
  for (const auto& [name, truth] : {std::pair{"aileron", 0.08}, {"rudder", 0.15}}) {
    const DelayReport* report = find(reports, name);
    ASSERT_NE(report, nullptr);
    EXPECT_TRUE(report->applied()) << recording::says(*report);
    EXPECT_NEAR(report->delay_s, truth, 1.96 * report->sigma_s) << name;
    EXPECT_LT(report->sigma_s, 0.03);
    EXPECT_THAT(report->together, IsEmpty());
  }
  EXPECT_GT(find(reports, "rudder")->delay_s - find(reports, "aileron")->delay_s, 0.04);
}

// An autopilot's mix: the same multisine on both.
TEST(AlignDelays, SurfacesThatMoveTogetherGetOneDelay) {
  Progress silent;
  for (const char* aircraft : {"aerosonde", "unatrap"}) {
    const FlightStudy study = read_study(
        Study::parse(fmt::format("seed = 1\n[subject]\nbuiltin = \"{}\"\n[flight]\nduration = 140\naltitude = 300\n"
                                 "wind = [4, -3, 0]\nturbulence = \"low_light\"\n"
                                 "[[flight.manoeuvre]]\nkind = \"multisine\"\nstart = 5\nduration = 130\n"
                                 "surfaces = [\"aileron\"]\namplitude = \"6 deg\"\n"
                                 "[[flight.manoeuvre]]\nkind = \"multisine\"\nstart = 5\nduration = 130\n"
                                 "surfaces = [\"rudder\"]\namplitude = \"4 deg\"\n",
                                 aircraft),
                     "mix.toml"),
        silent);
    const AlignedRecording aligned = align_delays(recorded_early(study.mapped, 0.1, 0.1), {});
    const DelayReport *aileron = find(aligned.delays, "aileron"), *rudder = find(aligned.delays, "rudder");
    ASSERT_TRUE(aileron != nullptr && rudder != nullptr);
    EXPECT_EQ(aileron->delay_s, rudder->delay_s) << aircraft;
    EXPECT_NEAR(aileron->delay_s, 0.1, 1.96 * aileron->sigma_s) << aircraft;
    EXPECT_LT(aileron->sigma_s, 0.03);
    EXPECT_TRUE(aileron->applied() && rudder->applied());
    EXPECT_THAT(rudder->together, ::testing::ElementsAre("aileron", "rudder"));
    EXPECT_THAT(says(*rudder), HasSubstr("one delay for aileron and rudder"));
    // Both are taken off once.
    for (const char* name : {"aileron", "rudder"})
      EXPECT_NEAR(aligned.mapped.recording.at(name).times().front(),
                  study.mapped.recording.at(name).times().front() - 0.1 + aileron->delay_s, 1e-9);
    EXPECT_TRUE(find(aligned.delays, "elevator")->together.empty());
  }
}

// What the study gives is no part of a search.
TEST(AlignDelays, GivenOnesAreNotFoundTogetherWithOthers) {
  DelayAlignment given;
  given.given = {{"rudder", 0.0}};
  MappedRecording mapped = testing::campaign_flight("aerosonde", 1, 60.0).mapped;
  Channel copy = mapped.recording.at("aileron");
  copy.name = "rudder";
  mapped.recording.set(std::move(copy));
  const std::vector<DelayReport> reports = align_delays(mapped, given).delays;
  EXPECT_THAT(find(reports, "aileron")->together, IsEmpty());
  EXPECT_EQ(find(reports, "rudder")->finding, recording::DelayFinding::kGiven);
}

}  // namespace
}  // namespace veridyn::aircraft
