#include "veridyn/io/mavlink/mavlink_packet.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "tests/support/synthetic_logs.hpp"
#include "tests/support/tlog_writer.hpp"

namespace veridyn::io {
namespace {

using testing::pack;
using testing::TlogWriter;

/// The bytes of one packet, without its stamp.
std::string bytes_of(const std::function<void(TlogWriter&)>& write) {
  TlogWriter writer;
  write(writer);
  return writer.bytes().substr(8);
}

TEST(MavlinkPacket, IsReadInBothVersionsAndSigned) {
  const std::string wind = pack(90.0F, 5.0F, 0.5F);
  const std::string one = bytes_of([&](TlogWriter& w) { w.packet1(0, 168, 1, wind, {3, 4}); });
  const std::string two = bytes_of([&](TlogWriter& w) { w.packet(0, 168, 1, wind, {3, 4}); });
  const std::string with_signature = bytes_of([&](TlogWriter& w) { w.signed_packet(0, 168, 1, wind, {3, 4}); });
  for (const std::string& bytes : {one, two, with_signature}) {
    const std::string more = bytes + "what follows";
    const auto packet = mavlink_packet(more);
    ASSERT_TRUE(packet.has_value());
    EXPECT_EQ(packet->message, 168U);
    EXPECT_EQ(packet->system, 3);
    EXPECT_EQ(packet->component, 4);
    EXPECT_EQ(packet->size, bytes.size());
    EXPECT_EQ(packet->payload, wind);
    EXPECT_EQ(packet->sound, true);
    EXPECT_FALSE(mavlink_packet(std::string_view(bytes).substr(0, bytes.size() - 1)).has_value()) << "cut";
  }
}

TEST(MavlinkPacket, IsNotSoundWithAnyOtherByte) {
  const std::string bytes = bytes_of([](TlogWriter& w) { w.packet(0, 168, 1, pack(90.0F, 5.0F, 0.5F)); });
  for (std::size_t at = 4; at < bytes.size(); ++at) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    const auto packet = mavlink_packet(damaged);
    EXPECT_FALSE(packet.has_value() && packet->sound == true) << at;
  }
}

TEST(MavlinkPacket, OfAnUnknownMessageCannotBeChecked) {
  const std::string bytes = bytes_of([](TlogWriter& w) { w.packet(0, 70'000, 9, "anything"); });
  const auto packet = mavlink_packet(bytes);
  ASSERT_TRUE(packet.has_value());
  EXPECT_EQ(packet->message, 70'000U);
  EXPECT_FALSE(packet->sound.has_value());
}

}  // namespace
}  // namespace veridyn::io
