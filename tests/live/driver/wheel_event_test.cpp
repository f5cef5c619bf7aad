#include "veridyn/live/driver/wheel_event.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/input.h>

#include <cstring>

#include "tests/live/driver/recorded_wheel.hpp"
#include "tests/live/driver/wheel_file.hpp"
#include "tests/support/refusal.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::live {
namespace {

using testing::RecordedWheel;
using testing::WheelFile;

RecordedWheel short_drive() {
  RecordedWheel wheel;
  wheel.axis(0, 32768).axis(2, 255).report().wait(8 * kMillisecond);
  wheel.axis(0, 30000).report().wait(8 * kMillisecond);
  wheel.axis(0, 20000).axis(2, 100).report();
  return wheel;
}

std::vector<WheelEvent> decoded(WheelEventDecoder& decoder, Bytes bytes) {
  std::vector<WheelEvent> events;
  while (const std::optional<WheelEvent> event = decoder.next(bytes)) events.push_back(*event);
  return events;
}

Bytes bytes_of(const std::string& text) { return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}; }

TEST(WheelEvent, HasTheKernelsNumbersAndLayout) {
  static_assert(kSyncEvent == EV_SYN && kKeyEvent == EV_KEY && kAxisEvent == EV_ABS);
  static_assert(kSyncReport == SYN_REPORT && kSyncDropped == SYN_DROPPED);
  static_assert(kAxisX == ABS_X && kAxisWheel == ABS_WHEEL && kAxisCodes == ABS_CNT);
  EXPECT_EQ(axis_code("ABS_X"), ABS_X);
  EXPECT_EQ(axis_code("ABS_RZ"), ABS_RZ);
  EXPECT_EQ(axis_code("ABS_GAS"), ABS_GAS);
  EXPECT_EQ(axis_code("ABS_BRAKE"), ABS_BRAKE);
  EXPECT_EQ(axis_code("ABS_MISC"), ABS_MISC);
  EXPECT_EQ(axis_code("ABS_63"), 63);
  for (const char* wrong : {"ABS_64", "ABS_-1", "ABS_", "ABS_1x", "X", "", "abs_x"})
    EXPECT_FALSE(axis_code(wrong)) << wrong;
  for (std::uint16_t code = 0; code < kAxisCodes; ++code) EXPECT_EQ(axis_code(axis_name(code)), code);

  if (sizeof(input_event) != WheelEventDecoder::kRecord) GTEST_SKIP() << "a machine with another struct input_event";
  input_event event = {};
  event.input_event_sec = 12;
  event.input_event_usec = 345'678;
  event.type = EV_ABS;
  event.code = ABS_WHEEL;
  event.value = -77;
  std::array<std::uint8_t, sizeof event> bytes;
  std::memcpy(bytes.data(), &event, sizeof event);
  WheelEventDecoder decoder;
  Bytes rest = bytes;
  EXPECT_EQ(decoder.next(rest), (WheelEvent{.time = 12'345'678'000, .type = 3, .code = 8, .value = -77}));
}

TEST(WheelEventDecoder, TakesChunksOfAnySize) {
  const RecordedWheel wheel = short_drive();
  const std::string bytes = wheel.bytes();
  for (std::size_t chunk = 1; chunk <= bytes.size(); ++chunk) {
    WheelEventDecoder decoder;
    std::vector<WheelEvent> events;
    for (std::size_t at = 0; at < bytes.size(); at += chunk) {
      for (const WheelEvent& event : decoded(decoder, bytes_of(bytes).subspan(at, std::min(chunk, bytes.size() - at))))
        events.push_back(event);
    }
    EXPECT_EQ(events, wheel.events) << chunk;
    EXPECT_EQ(decoder.pending(), 0U);
  }
}

TEST(WheelEventDecoder, StandsAnyBytes) {
  numerics::RandomStream random(1, "events");
  WheelEventDecoder decoder;
  WheelAxes axes;
  std::uint64_t events = 0, bytes = 0;
  for (int round = 0; round < 10'000; ++round) {
    std::vector<std::uint8_t> noise(random.index(100));
    // Small numbers in most places: else no time ever can be.
    for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random.index(4) == 0 ? random.index(256) : 0);
    bytes += noise.size();
    for (const WheelEvent& event : decoded(decoder, noise)) {
      axes.take(event);
      ASSERT_GE(event.time, 0);
      ++events;
    }
  }
  EXPECT_EQ(events + decoder.damaged(), bytes / WheelEventDecoder::kRecord);
  EXPECT_GT(events, 100U);
  EXPECT_GT(decoder.damaged(), 100U);
}

TEST(WheelEvents, OfARecordingAreReadOrRefusedByByte) {
  const RecordedWheel wheel = short_drive();
  const std::string bytes = wheel.bytes();
  {
    const WheelFile file(bytes);
    EXPECT_EQ(read_wheel_events(file.path()), wheel.events);
  }
  const auto refusal = [](const std::string& content) {
    const WheelFile file(content);
    const std::string message = why([&] { (void)read_wheel_events(file.path()); });
    return message.substr(std::min(message.size(), file.path().size()));
  };
  EXPECT_EQ(refusal(bytes + "abc"), ": byte 192: the last event is cut off: 3 of 24 bytes");
  std::string bad = bytes;
  bad[24 + 11] = 1;  // 2^24 more microseconds
  EXPECT_EQ(refusal(bad), ": byte 24: not an event of an input device: its time cannot be");
  RecordedWheel back = wheel;
  back.wait(-kSecond).report();
  EXPECT_EQ(refusal(back.bytes()), ": byte 192: an event before the one before it");
  EXPECT_EQ(refusal("time[s],steer[rad]\n0,0\n1,0\n"), ": byte 0: not an event of an input device: its time cannot be");
  EXPECT_THROW((void)read_wheel_events("no such file"), InputError);
  const WheelFile empty("");
  EXPECT_TRUE(read_wheel_events(empty.path()).empty());
}

TEST(WheelAxes, ChangeTogetherAtAReport) {
  WheelAxes axes;
  EXPECT_FALSE(axes.heard_of(0));
  const RecordedWheel wheel = short_drive();
  std::vector<std::pair<std::int32_t, std::int32_t>> seen;
  for (const WheelEvent& event : wheel.events) {
    if (axes.take(event)) seen.emplace_back(axes.value(0), axes.value(2));
  }
  EXPECT_THAT(seen, ::testing::ElementsAre(std::pair(32768, 255), std::pair(30000, 255), std::pair(20000, 100)));
  EXPECT_EQ(axes.time(), 100 * kSecond + 16 * kMillisecond);
  EXPECT_TRUE(axes.heard_of(2));
  EXPECT_FALSE(axes.heard_of(1));
  EXPECT_FALSE(axes.heard_of(64));
  // Keys and axes that no device has change nothing.
  axes.take({.type = kKeyEvent, .code = 0, .value = 1});
  axes.take({.type = kAxisEvent, .code = 500, .value = 1});
  axes.take({.type = kSyncEvent, .code = kSyncReport});
  EXPECT_EQ(axes.value(0), 20000);
}

TEST(WheelAxes, LeaveOutWhatIsHalfDropped) {
  WheelAxes axes;
  RecordedWheel wheel;
  wheel.axis(0, 1).report();
  wheel.axis(0, 2).event(kSyncEvent, kSyncDropped, 0).axis(0, 3).report();  // neither 2 nor 3 is whole
  for (const WheelEvent& event : wheel.events) axes.take(event);
  EXPECT_EQ(axes.value(0), 1);
  EXPECT_EQ(axes.dropped(), 1U);
  RecordedWheel().axis(2, 7).report().play([&](const WheelEvent& event) { axes.take(event); });
  EXPECT_EQ(axes.value(0), 1);
  RecordedWheel().axis(0, 4).report().play([&](const WheelEvent& event) { axes.take(event); });
  EXPECT_EQ(axes.value(0), 4);
}

}  // namespace
}  // namespace veridyn::live
