#include "veridyn/recording/sample_evidence.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::recording {
namespace {

using estimation::Evidence;
using estimation::Outcome;
using ::testing::HasSubstr;

const std::vector<SampledChannel> kChannels{
    {"gyro", "gyro"}, {"vane", "vane"}, {"speed", "speed"}, {"rudder", "rudder", Rest::kLongOnly}};
const std::vector<TimeSpan> kMinute{{0.0, 60.0}};

/// A gyro at 100 Hz, a vane in steps of 0.1 at 50 Hz, a speed at 5 Hz, a rudder that moves now and then.
Recording moving(std::uint64_t seed) {
  numerics::RandomStream random(seed, "samples");
  Recording recording;
  const auto add = [&](const char* name, double step, const std::function<double(double)>& value) {
    std::vector<double> t, v;
    for (double time = 0.0; time < 60.0; time += step) {
      t.push_back(time);
      v.push_back(value(time));
    }
    recording.add(make_channel(name, "1", make_time_base(std::move(t)), std::move(v)));
  };
  add("gyro", 0.01, [&](double t) { return std::sin(2.0 * t) + 0.01 * random.normal(); });
  add("vane", 0.02, [&](double t) { return 0.1 * std::round(10.0 * (std::sin(0.7 * t) + 0.2 * random.normal())); });
  add("speed", 0.2, [&](double t) { return 20.0 + std::sin(0.3 * t) + 0.05 * random.normal(); });
  add("rudder", 0.01, [&](double t) { return std::fmod(t, 20.0) < 1.0 ? std::sin(6.0 * t) : 0.2; });
  return recording;
}

std::vector<Evidence> after(const char* name, const std::function<double(double, double)>& change) {
  Recording recording = moving(1);
  Channel channel = recording.at(name);
  for (std::size_t i = 0; i < channel.size(); ++i) channel.value[i] = change(channel.times()[i], channel.value[i]);
  recording.set(std::move(channel));
  return sample_evidence(recording, kChannels, kMinute);
}

TEST(SampleEvidence, RaisesNoAlarmOverTwoHundredCleanRecordings) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const auto rows = sample_evidence(moving(seed), kChannels, kMinute);
    ASSERT_EQ(rows.size(), 1u) << says(rows.front());
    EXPECT_TRUE(rows.front().passed());
    EXPECT_THAT(says(rows.front()), HasSubstr("none of 4 channels"));
  }
}

/// The only row, which must be about the channel.
void expect(const std::vector<Evidence>& rows, const char* about, Outcome outcome, const char* text) {
  ASSERT_EQ(rows.size(), 1u) << about;
  EXPECT_EQ(rows.front().about, about);
  EXPECT_EQ(rows.front().outcome, outcome) << says(rows.front());
  EXPECT_THAT(says(rows.front()), HasSubstr(text));
  EXPECT_FALSE(advice_of(rows.front()).empty());
}

TEST(SampleEvidence, NamesASensorThatStandsStillWhileOthersMove) {
  double frozen = 0.0;
  expect(after("gyro",
               [&](double t, double v) {
                 if (t < 20.0) frozen = v;
                 return t > 20.0 && t < 25.0 ? frozen : v;
               }),
         "gyro", Outcome::kFailed, "gyro stands still from 20.0 s to 25.0 s");
}

TEST(SampleEvidence, NamesAControlOnlyAfterLong) {
  // It rests for 19 s of every 20 s as it is.
  numerics::RandomStream random(3, "rudder");
  expect(after("rudder", [&](double t, double) { return t > 21.0 ? 0.2 : random.normal(); }), "rudder",
         Outcome::kFailed, "rudder stands still");
}

TEST(SampleEvidence, ASpeedThatIsTheSameAllTheTimeIsNoFault) {
  expect(after("rudder", [](double, double) { return 0.2; }), "rudder", Outcome::kNotVerified,
         "rudder does not change");
}

TEST(SampleEvidence, LeavesTheRestOfAControlToThoseWhoKnowTheVehicle) {
  Recording recording = moving(3);
  Channel rudder = recording.at("rudder");
  for (std::size_t i = 0; i < rudder.size(); ++i)
    if (rudder.times()[i] > 21.0) rudder.value[i] = 0.2;
  recording.set(std::move(rudder));
  const auto rows = [&](Rest rest) {
    const std::vector<SampledChannel> channels{
        {"gyro", "gyro"}, {"vane", "vane"}, {"speed", "speed"}, {"rudder", "rudder", rest}};
    return sample_evidence(recording, channels, kMinute);
  };
  EXPECT_FALSE(rows(Rest::kLongOnly).front().passed());
  EXPECT_TRUE(rows(Rest::kNone).front().passed()) << says(rows(Rest::kNone).front());
}

TEST(SampleEvidence, NamesAValueThatIsHeld) {
  double held = 0.0, until = 0.0;
  expect(after("gyro",
               [&](double t, double v) {
                 if (t >= until) {
                   held = v;
                   until = t + 0.0999;
                 }
                 return held;
               }),
         "gyro", Outcome::kCare, "measured at 10 Hz and held: 10 samples");
}

TEST(SampleEvidence, NamesASensorThatIsClipped) {
  expect(after("gyro", [](double, double v) { return std::clamp(v, -0.9, 0.9); }), "gyro", Outcome::kFailed,
         "extreme value");
}

TEST(SampleEvidence, NamesStepsThatHideTheSignal) {
  expect(after("gyro", [](double, double v) { return std::round(v + 0.3); }), "gyro", Outcome::kCare, "steps of 1");
}

TEST(SampleEvidence, NamesSpikes) {
  int sample = 0;
  expect(after("gyro", [&](double, double v) { return ++sample % 500 == 250 ? v + 0.4 : v; }), "gyro", Outcome::kCare,
         "12 samples of gyro stand alone, far from both neighbours, the first at 2.49 s");
}

TEST(SampleEvidence, AHeadingThatPassesSouthHasNoSpikes) {
  numerics::RandomStream random(9, "heading");
  std::vector<double> t, heading;
  for (int i = 0; i < 6000; ++i) {
    t.push_back(0.01 * i);
    const double turned = kPi + 0.05 * std::sin(0.2 * t.back()) + 0.01 * random.normal();
    heading.push_back(turned > kPi ? turned - 2.0 * kPi : turned);
  }
  Recording recording;
  recording.add(make_channel("yaw", "rad", make_time_base(std::move(t)), std::move(heading)));
  const std::vector<SampledChannel> yaw{{"yaw", "attitude"}};
  for (const Evidence& row : sample_evidence(recording, yaw, kMinute)) EXPECT_TRUE(row.passed()) << says(row);
}

// Two are an accident, vibration that comes and goes and bumps of some samples are motion.
TEST(SampleEvidence, LetsAccidentsBumpsAndVibrationPass) {
  int sample = 0;
  const auto pass = [](const std::vector<Evidence>& rows) {
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_TRUE(rows.front().passed()) << says(rows.front());
  };
  pass(after("gyro", [&](double, double v) { return ++sample % 2500 == 1250 ? v + 1.0 : v; }));
  sample = 0;
  pass(after("gyro", [&](double, double v) { return ++sample % 500 < 3 ? v + 1.0 : v; }));
  numerics::RandomStream random(5, "vibration");
  pass(after("gyro", [&](double t, double v) { return std::fmod(t, 10.0) < 1.0 ? v + 0.5 * random.normal() : v; }));
}

// An aircraft in trim without noise stands still on all channels.
TEST(SampleEvidence, LetsAllSensorsRestTogether) {
  Recording recording = moving(1);
  for (const char* name : {"gyro", "vane", "speed"}) {
    Channel channel = recording.at(name);
    const double rest = channel.value.front() + 0.3;
    for (std::size_t i = 0; i < channel.size(); ++i)
      if (channel.times()[i] < 8.0) channel.value[i] = rest;
    recording.set(std::move(channel));
  }
  for (const Evidence& row : sample_evidence(recording, kChannels, kMinute)) EXPECT_TRUE(row.passed()) << says(row);
}

}  // namespace
}  // namespace veridyn::recording
