#include "veridyn/core/recording.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/refusal.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn {
namespace {

Channel channel(std::string name, std::vector<double> times, std::vector<double> values) {
  return make_channel(std::move(name), "m/s", make_time_base(std::move(times)), std::move(values));
}

TEST(Channel, KnowsItsRateFromTheMedianInterval) {
  EXPECT_DOUBLE_EQ(channel("v", {0.0, 0.1, 0.2, 5.0, 5.1}, {1, 2, 3, 4, 5}).rate_Hz(), 10.0);
  EXPECT_EQ(channel("v", {0.0}, {1}).rate_Hz(), 0.0);
}

TEST(Channel, ReportsGapsInTimeAndRunsOfMissingValues) {
  const Channel in_time = channel("v", {0.0, 0.1, 0.2, 1.2, 1.3}, {1, 2, 3, 4, 5});
  EXPECT_EQ(in_time.gaps(), (std::vector<TimeSpan>{{0.2, 1.2}}));
  const Channel in_values = channel("v", {0, 1, 2, 3, 4, 5, 6, 7, 8}, {0, kNaN, kNaN, kNaN, kNaN, kNaN, 1, 1, 1});
  EXPECT_EQ(in_values.gaps(), (std::vector<TimeSpan>{{0, 6}}));
  EXPECT_TRUE(in_values.gaps(6.5).empty());
}

TEST(Recording, KeepsEachChannelOnItsOwnTimeBase) {
  Recording recording;
  recording.add(channel("a", {0, 1, 2}, {1, 2, 3}));
  recording.add(channel("b", {0.5, 3.5}, {1, 2}));
  EXPECT_EQ(recording.at("a").size(), 3u);
  EXPECT_EQ(recording.at("b").size(), 2u);
  EXPECT_EQ(recording.span(), (TimeSpan{0.0, 3.5}));
}

TEST(Recording, NamesTheMissingChannelAndWhatThereIsInstead) {
  Recording recording;
  recording.source = "flight.csv";
  recording.add(channel("airspeed", {0, 1}, {1, 2}));
  recording.add(channel("gyro_x", {0, 1}, {1, 2}));
  EXPECT_EQ(why([&] { static_cast<void>(recording.at("airspede")); }),
            "flight.csv: no channel 'airspede' (did you mean 'airspeed'?)");
  EXPECT_EQ(why([&] { static_cast<void>(recording.at("elevator")); }),
            "flight.csv: no channel 'elevator' (known: airspeed, gyro_x)");
}

TEST(Recording, RefusesChannelsThatContradictThemselves) {
  Recording recording;
  recording.source = "flight.csv";
  EXPECT_EQ(why([&] {
              recording.add(channel("v", {0, 2, 1}, {1, 2, 3}));
            }),
            "flight.csv: channel 'v': time goes backwards at sample 3: 1 s after 2 s");
  EXPECT_EQ(why([&] {
              recording.add(channel("v", {0, kNaN}, {1, 2}));
            }),
            "flight.csv: channel 'v': time stamp 2 is nan");
  EXPECT_EQ(why([&] {
              recording.add(channel("v", {0, 1}, {1}));
            }),
            "flight.csv: channel 'v': 2 time stamps for 1 values");
  recording.add(channel("v", {0}, {1}));
  EXPECT_EQ(why([&] { recording.add(channel("v", {0}, {1})); }), "flight.csv: channel 'v' appears twice");
  EXPECT_EQ(recording.channels().size(), 1u);
}

TEST(Recording, ReplacesAChannelInItsPlace) {
  Recording recording;
  recording.add(channel("a", {0}, {1}));
  recording.add(channel("b", {0}, {2}));
  recording.set(channel("a", {0, 1}, {3, 4}));
  EXPECT_EQ(recording.names(), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(recording.at("a").value, (std::vector<double>{3, 4}));
}

}  // namespace
}  // namespace veridyn
