#include "veridyn/io/mavlink/mavlink_messages.hpp"

#include <gtest/gtest.h>

#include <array>

namespace veridyn::io {
namespace {

/// As MAVLink's generated headers list them (mavlink_get_msg_entry): id, CRC_EXTRA, length of version 1, whole length.
struct Entry {
  std::uint32_t id;
  unsigned crc_extra, least, most;
};
constexpr std::array kEntries{
    Entry{0, 50, 9, 9},      Entry{22, 220, 25, 25},  Entry{24, 24, 30, 52},   Entry{26, 170, 22, 24},
    Entry{27, 144, 26, 29},  Entry{29, 115, 14, 16},  Entry{30, 39, 28, 28},   Entry{31, 246, 32, 48},
    Entry{32, 185, 28, 28},  Entry{33, 104, 28, 28},  Entry{36, 222, 21, 37},  Entry{65, 118, 42, 42},
    Entry{74, 20, 20, 20},   Entry{105, 93, 62, 63},  Entry{116, 76, 22, 24},  Entry{129, 46, 22, 24},
    Entry{137, 195, 14, 16}, Entry{140, 181, 41, 41}, Entry{168, 1, 12, 12},   Entry{226, 207, 8, 8},
    Entry{231, 105, 40, 40}, Entry{253, 83, 51, 54},  Entry{295, 234, 12, 12}, Entry{375, 251, 140, 140}};

TEST(MavlinkMessages, HaveTheChecksAndLengthsOfTheGeneratedHeaders) {
  for (const Entry& entry : kEntries) {
    const MavlinkMessage* message = find_mavlink_message(entry.id);
    ASSERT_NE(message, nullptr) << entry.id;
    EXPECT_EQ(message->crc_extra, entry.crc_extra) << message->name;
    EXPECT_EQ(message->least_size, entry.least) << message->name;
    EXPECT_EQ(message->size, entry.most) << message->name;
  }
  EXPECT_EQ(find_mavlink_message(11'000), nullptr);
}

TEST(MavlinkMessages, LieInThePayloadTheLargestTypesFirstAndExtensionsLast) {
  const MavlinkMessage& gps = *find_mavlink_message(24);
  EXPECT_EQ(gps.find("time_usec")->offset, 0U);
  EXPECT_EQ(gps.find("lat")->offset, 8U);
  EXPECT_EQ(gps.find("vel")->offset, 24U);
  EXPECT_EQ(gps.find("fix_type")->offset, 28U);
  EXPECT_EQ(gps.find("alt_ellipsoid")->offset, 30U);
  EXPECT_EQ(gps.find("yaw")->offset, 50U);
  EXPECT_EQ(gps.find("nothing"), nullptr);
}

TEST(MavlinkMessages, AreCheckedByTheCrcOfX25) { EXPECT_EQ(mavlink_crc("123456789"), 0x6f91); }

}  // namespace
}  // namespace veridyn::io
