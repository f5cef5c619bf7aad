#include "veridyn/live/driver/driver_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/live/driver/recorded_wheel.hpp"
#include "tests/live/serial/without_rights.hpp"
#include "tests/support/refusal.hpp"
#include "veridyn/live/driver/wheel_device.hpp"

namespace veridyn::live {
namespace {

TEST(DriverSource, WritesTheRecordsThatADeviceDelivers) {
  testing::RecordedWheel wheel;
  wheel.axis(0, -5).report();
  std::array<std::uint8_t, WheelEventDecoder::kRecord> record{};
  std::string all;
  for (const WheelEvent& event : wheel.events) {
    encode_wheel_event(event, record);
    all.append(reinterpret_cast<const char*>(record.data()), record.size());
  }
  EXPECT_EQ(all, wheel.bytes());
}

TEST(DriverSource, PlaysARecordingInItsOwnTimeFromTheFirstReadingOn) {
  testing::RecordedWheel wheel;
  wheel.axis(0, 100).report().wait(kSecond).axis(0, 200).report();
  const std::array<WheelAxis, 1> at_rest = {{{.code = 9, .lowest = 0, .highest = 10, .value = 3}}};
  const auto source = recorded_source(wheel.events, at_rest);
  std::array<std::uint8_t, 1000> bytes{};
  WheelEventDecoder decoder;
  WheelAxes axes;
  const auto read = [&](Nanoseconds now) {
    Bytes records = Bytes(bytes).first(source->read(now, bytes));
    while (const auto event = decoder.next(records)) axes.take(*event);
  };
  read(7 * kSecond);
  EXPECT_EQ(axes.value(9), 3);
  EXPECT_EQ(axes.value(0), 100);
  EXPECT_EQ(axes.time(), 7 * kSecond);
  EXPECT_EQ(source->due(), 8 * kSecond);
  read(8 * kSecond - 1);
  EXPECT_EQ(axes.value(0), 100);
  read(8 * kSecond);
  EXPECT_EQ(axes.value(0), 200);
  EXPECT_TRUE(source->ended());
}

TEST(DriverSource, HandsOverWholeRecordsOnly) {
  testing::RecordedWheel wheel;
  for (int k = 0; k < 10; ++k) wheel.axis(0, k).report();
  const auto source = recorded_source(wheel.events, {});
  std::array<std::uint8_t, 3 * WheelEventDecoder::kRecord + 5> bytes{};
  EXPECT_EQ(source->read(0, bytes), 3 * WheelEventDecoder::kRecord);
}

TEST(DriverSource, SaysWhyADeviceIsNoWheel) {
  if (!has_wheel_devices()) GTEST_SKIP() << "built without libevdev";
  EXPECT_EQ(why([] { static_cast<void>(wheel_source("/dev/input/no-wheel")); }),
            "/dev/input/no-wheel: there is no such device; is it plugged in?");
  EXPECT_EQ(why([] { static_cast<void>(wheel_source("/dev/null")); }), "/dev/null: not an input device");
  const testing::WithoutRights closed;
  EXPECT_EQ(why([&] { static_cast<void>(wheel_source(closed.path())); }),
            closed.path() + ": no right to open it; members of the group 'input' have it");
}

}  // namespace
}  // namespace veridyn::live
