#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/io/dataflash/small_recording.hpp"
#include "tests/support/synthetic_logs.hpp"
#include "veridyn/io/dataflash/dataflash.hpp"

namespace veridyn::io {
namespace {

using testing::DataFlashWriter;
using testing::small_dataflash_recording;

TEST(DataFlash, ReadsArraysTextsParametersModesAndMessages) {
  const Recording recording = small_dataflash_recording();
  EXPECT_DOUBLE_EQ(recording.at("ISBD.x[0]").value[0], -3.0);
  EXPECT_DOUBLE_EQ(recording.at("ISBD.x[31]").value[0], 28.0);
  EXPECT_DOUBLE_EQ(recording.parameters.at("SERVO1_TRIM"), 1500.0);
  EXPECT_EQ(recording.information.at("vehicle"), "ArduPlane");
  EXPECT_EQ(recording.information.at("firmware"), "ArduPlane V4.2.3 (abcdef01)");
  ASSERT_EQ(recording.events.size(), 2U);
  EXPECT_EQ(recording.events[1].kind, "mode");
  EXPECT_EQ(recording.events[1].text, "FBWA");
  EXPECT_TRUE(recording.warnings.empty());
}

TEST(DataFlash, TakesTheClockOfTheRecordBeforeForMessagesWithoutOne) {
  DataFlashWriter log;
  log.format(130, "ATT", "If", "TimeMS,Roll");
  log.format(131, "EV", "B", "Id");
  log.record("ATT", {5000.0, 1.0});
  log.record("EV", {10.0});
  log.record("ATT", {6000.0, 1.0});
  log.record("EV", {11.0});
  const Log result = read_dataflash(log.bytes(), "old.bin");
  EXPECT_THAT(*result.find("EV")->time, ::testing::ElementsAre(5.0, 6.0));
  ASSERT_EQ(result.events.size(), 2U);
  EXPECT_EQ(result.events[0].text, "armed");
  EXPECT_EQ(result.events[1].text, "disarmed");
}

}  // namespace
}  // namespace veridyn::io
