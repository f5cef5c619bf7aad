#include "veridyn/io/log/log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/synthetic_logs.hpp"
#include "veridyn/io/dataflash/dataflash.hpp"

namespace veridyn::io {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;

TEST(ToRecording, CarriesTheDamageIntoTheWarnings) {
  const std::string bytes = testing::small_dataflash() + std::string(50, 'x');
  const Recording recording = to_recording(read_dataflash(bytes, "x.bin"));
  EXPECT_THAT(recording.warnings, Contains("damaged: 50 bytes and at least 1 records lost"));
}

TEST(ToRecording, TellsTwoDefinitionsOfOneNameApart) {
  testing::DataFlashWriter log;
  log.format(130, "ATT", "Qf", "TimeUS,Roll");
  log.record("ATT", {1e6, 1.0});
  log.format(131, "ATT", "Qff", "TimeUS,Roll,Pitch");
  log.record("ATT", {2e6, 1.0, 2.0});
  const Recording recording = to_recording(read_dataflash(log.bytes(), "x.bin"));
  EXPECT_THAT(recording.names(), ElementsAre("ATT.Roll", "ATT~2.Roll", "ATT~2.Pitch"));
}

}  // namespace
}  // namespace veridyn::io
