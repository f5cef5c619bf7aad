#include "veridyn/live/driver/driver_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/refusal.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/live/driver/driver_source.hpp"

namespace veridyn::live {
namespace {

using ::testing::HasSubstr;

class DriverTableTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::vector<WheelEvent> read(const std::string& text) const {
    write_file(path_, text);
    return read_driver_table(path_);
  }
  std::string refusal(const std::string& text) const {
    return why([&] { static_cast<void>(read(text)); });
  }
  veridyn::test::TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "driver.csv";
};

const std::string kTable = "time[s],steering[deg],throttle,brake,reverse\n0,0,0,0,0\n1,90,0.5,0,0\n2,90,0,1,1\n";

/// What the driver does at the end of the events that come by then.
DriverInput input_at(DriverSource& source, Nanoseconds now, WheelAxes& axes) {
  std::vector<std::uint8_t> bytes(std::size_t{1} << 16U);
  WheelEventDecoder decoder;
  Bytes records = Bytes(bytes).first(source.read(now, bytes));
  while (const auto event = decoder.next(records)) axes.take(*event);
  return table_calibration().input(axes).value_or(DriverInput{});
}

TEST_F(DriverTableTest, IsDrivenOnLinesBetweenItsRows) {
  const auto source = recorded_source(read(kTable), table_calibration().at_rest());
  WheelAxes axes;
  constexpr Nanoseconds kBegin = 5 * kSecond;
  EXPECT_EQ(source->due(), 0);
  EXPECT_EQ(input_at(*source, kBegin, axes), DriverInput{});
  EXPECT_FALSE(source->ended());
  EXPECT_EQ(source->due(), kBegin + kSecond / 100);
  const DriverInput half = input_at(*source, kBegin + kSecond / 2, axes);
  EXPECT_NEAR(half.steering, 0.25 * std::numbers::pi, 1e-5);
  EXPECT_NEAR(half.throttle, 0.25, 1e-5);
  EXPECT_EQ(axes.time(), kBegin + kSecond / 2);
  const DriverInput last = input_at(*source, kBegin + 3 * kSecond, axes);
  EXPECT_NEAR(last.steering, 0.5 * std::numbers::pi, 1e-5);
  EXPECT_EQ(last.throttle, 0.0);
  EXPECT_EQ(last.brake, 1.0);
  EXPECT_TRUE(source->ended());
  EXPECT_FALSE(source->due());
}

TEST_F(DriverTableTest, GearIsNeverBetweenTwo) {
  const auto source =
      recorded_source(read("time[s],steering[rad],throttle,brake,reverse\n0,0,0,0,0\n1,0,0,0,1\n2,0,0,0,1\n"),
                      table_calibration().at_rest());
  WheelAxes axes;
  static_cast<void>(input_at(*source, 0, axes));
  EXPECT_FALSE(input_at(*source, kSecond * 9 / 10, axes).reverse);
  EXPECT_TRUE(input_at(*source, kSecond * 11 / 10, axes).reverse);
}

TEST_F(DriverTableTest, RefusesInOneLineWithItsPlace) {
  EXPECT_THAT(refusal("time[s],steering[deg],throttle,brake\n0,0,0,0\n1,0,1.5,0\n"),
              HasSubstr(".csv:3: throttle is 1.5; takes 0 to 1"));
  EXPECT_THAT(refusal("time[s],steering[deg],throttle,brake\n0,0,0,0\n0,0,1,0\n"),
              HasSubstr(".csv:3: time is 0 s after 0 s; must grow"));
  EXPECT_THAT(refusal("time[s],steering[deg],throttle,brake\n0,,0,0\n1,0,0,0\n"), HasSubstr(".csv:2: steering is nan"));
  EXPECT_THAT(refusal("time[s],steering[deg],throttle\n0,0,0\n"), HasSubstr("brake"));
  EXPECT_THAT(why([] { static_cast<void>(read_driver_table("/no/such.csv")); }), HasSubstr("/no/such.csv"));
}

}  // namespace
}  // namespace veridyn::live
