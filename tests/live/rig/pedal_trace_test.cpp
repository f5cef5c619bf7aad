#include "veridyn/live/rig/pedal_trace.hpp"

#include <gtest/gtest.h>

#include <array>

#include "veridyn/live/teleoperation/car_command.hpp"

namespace veridyn::live {
namespace {

using Stage = PedalTrace::Stage;

/// Commands and reports of a made-up line, times in milliseconds.
class MadeUpLine {
 public:
  void command(std::uint32_t sequence, int sent, std::optional<int> moved = std::nullopt) {
    std::array<std::uint8_t, kCommandPayload> payload{};
    encode_command({}, payload);
    std::array<std::uint8_t, kLongestFrame> frame{};
    const std::size_t size = encode_frame({.kind = 1, .run = 7, .sequence = sequence}, payload, frame);
    trace.command(Bytes(frame).first(size), sent * kMillisecond,
                  moved ? std::optional<Nanoseconds>(*moved * kMillisecond) : std::nullopt);
  }
  /// @param made by the car's clock, in seconds
  void report(std::uint16_t echoed, int age, int arrived, int made) {
    ReceivedReport r;
    r.payload.echo = Echo{.run = 7, .sequence = echoed, .age = age * kMillisecond};
    r.arrived = arrived * kMillisecond;
    r.made = made * kSecond;
    trace.report(r);
  }
  PedalTrace trace;
};

double ms(const LatencyHistogram& h) { return 1e3 * h.mean(); }

TEST(PedalTrace, FollowsAMovementThroughAllStages) {
  MadeUpLine line;
  line.command(65535, 90);
  line.report(65535, 2, 98, 10);
  line.command(65536, 100, 97);                    // moved at 97, first known to this command, whose number goes round
  line.report(65535, 9, 105, 11);                  // made before it arrived
  line.report(0, 4, 112, 12);                      // 12 ms after: 4 of them at the car, 8 on the line
  line.trace.order(40, 11.5, 120 * kMillisecond);  // holds a motion of before
  line.trace.order(41, 12.1, 130 * kMillisecond);
  line.trace.answer(40, 131 * kMillisecond);
  line.trace.answer(41, 133 * kMillisecond);
  const PedalTrace::Result& r = line.trace.result();
  ASSERT_EQ(r.whole.count(), 1U);
  EXPECT_NEAR(ms(r[Stage::kInput]), 3.0, 1e-9);
  EXPECT_NEAR(ms(r[Stage::kLine]), 8.0, 1e-9);
  EXPECT_NEAR(ms(r[Stage::kCar]), 4.0, 1e-9);
  EXPECT_NEAR(ms(r[Stage::kMotion]), 18.0, 1e-9);
  EXPECT_NEAR(ms(r[Stage::kPlatform]), 3.0, 1e-9);
  EXPECT_NEAR(ms(r.whole), 36.0, 1e-9);
}

TEST(PedalTrace, CountsTheWaitForTheNextCommandWhereOneWasLost) {
  MadeUpLine line;
  line.command(5, 100, 100);
  line.command(6, 110);
  line.report(6, 3, 121, 20);  // 11 ms after the one that arrived: 8 on the line; the car knew 13 ms after the first
  line.trace.order(1, 20.0, 140 * kMillisecond);
  line.trace.answer(2, 141 * kMillisecond);  // the answer to the order was lost
  const PedalTrace::Result& r = line.trace.result();
  ASSERT_EQ(r.whole.count(), 1U);
  EXPECT_NEAR(ms(r[Stage::kLine]), 8.0, 1e-9);
  EXPECT_NEAR(ms(r[Stage::kCar]), 13.0, 1e-9);
  double sum = 0.0;
  for (const LatencyHistogram& stage : r.stages) sum += ms(stage);
  EXPECT_NEAR(sum, ms(r.whole), 1e-9);
}

TEST(PedalTrace, GivesUpWhatNoReportKnowsOf) {
  MadeUpLine line;
  line.command(1, 0, 0);
  line.command(2, 999, 998);
  EXPECT_EQ(line.trace.result().given_up, 0U);
  line.command(3, 1001, 1000);
  EXPECT_EQ(line.trace.result().given_up, 1U);
  line.report(3, 1, 1010, 5);
  line.trace.order(9, 5.0, 1020 * kMillisecond);
  line.trace.answer(9, 1021 * kMillisecond);
  EXPECT_EQ(line.trace.result().whole.count(), 1U);
  EXPECT_NEAR(ms(line.trace.result().whole), 21.0, 1e-9);
}

}  // namespace
}  // namespace veridyn::live
