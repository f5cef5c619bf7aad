#include "veridyn/io/packets/packet_layout.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/refusal.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/io/packets/packet_decoder.hpp"

namespace veridyn::io {
namespace {

PacketLayout layout_of(const std::string& text) {
  return read_packet_layout(Study::parse(text, "rig.toml").root().table("data").table("packet"));
}

const std::string kTime = "[[data.packet.field]]\nname = \"time\"\noffset = 4\ntype = \"u32\"\nunit = \"ms\"\n";

TEST(PacketLayout, OfOnesOwnHasUnitsAndSigns) {
  const PacketLayout layout =
      layout_of("[data.packet]\nsize = 16\nbegins_with = \"RIG1\"\n" + kTime +
                "[[data.packet.field]]\nname = \"accel_x\"\noffset = 8\nunit = \"g\"\nfactor = -1\n"
                "[[data.packet.field]]\nname = \"wheel\"\noffset = 12\ntype = \"i16\"\nunit = "
                "\"deg\"\nfactor = 0.1\n");
  EXPECT_EQ(layout.size, 16U);
  EXPECT_EQ(layout.begins_with, "RIG1");
  ASSERT_EQ(layout.fields.size(), 3U);
  EXPECT_DOUBLE_EQ(layout.fields[0].factor, 1e-3);
  EXPECT_EQ(layout.fields[1].type, GatherType::kFloat);
  EXPECT_EQ(layout.fields[1].unit, "m/s^2");
  EXPECT_DOUBLE_EQ(layout.fields[1].factor, -kGravity);
  EXPECT_DOUBLE_EQ(layout.fields[2].factor, 0.1 * kDegree);
}

TEST(PacketLayout, WritesWhatItReads) {
  const PacketLayout layout = layout_of(
      "[data.packet]\nsize = 30\nbegins_with = \"RIG1\"\ngravity = \"out\"\n"
      "[[data.packet.field]]\nname = \"time\"\noffset = 4\ntype = \"u32\"\nunit = \"ms\"\n"
      "[[data.packet.field]]\nname = \"a\"\noffset = 8\ntype = \"i16\"\nunit = \"deg\"\nfactor = -0.1\n"
      "[[data.packet.field]]\nname = \"b\"\noffset = 12\ntype = \"f64\"\n"
      "[[data.packet.field]]\nname = \"c\"\noffset = 20\ntype = \"f32\"\nunit = \"g\"\n"
      "[[data.packet.field]]\nname = \"d\"\noffset = 24\ntype = \"u8\"\n");
  EXPECT_EQ(layout.gravity_in, false);
  const PacketDecoder decoder(layout);
  const std::vector<double> in = {12.345, -0.5, 1.0 / 3.0, 9.0, 200.0};
  std::vector<double> out(in.size());
  std::string packet(layout.size, 'x');
  encode(layout, in, packet);
  EXPECT_EQ(packet.substr(0, 4), "RIG1");
  EXPECT_EQ(packet.substr(25), std::string(5, '\0'));
  ASSERT_TRUE(decoder.decode(packet, out));
  EXPECT_NEAR(out[0], 12.345, 0.5e-3);
  EXPECT_NEAR(out[1], -0.5, 0.05 * kDegree);
  EXPECT_EQ(out[2], 1.0 / 3.0);
  EXPECT_NEAR(out[3], 9.0, 1e-6);
  EXPECT_EQ(out[4], 200.0);
  // What a number cannot hold becomes the nearest that it can; what is none becomes zero.
  encode(layout, std::vector<double>{-1.0, 1e6, 0.0, 0.0, std::nan("")}, packet);
  ASSERT_TRUE(decoder.decode(packet, out));
  EXPECT_EQ(out[0], 0.0);
  EXPECT_NEAR(out[1], 3276.8 * kDegree, 1e-9);
  EXPECT_EQ(out[4], 0.0);
}

TEST(PacketLayout, SaysWhatIsWrongAndWhere) {
  const auto wrong = [](const std::string& text, const std::string& message) {
    EXPECT_THAT(why([&] { static_cast<void>(layout_of(text)); }), ::testing::HasSubstr(message));
  };
  const auto field = [](const char* name, int offset, const char* type) {
    return "[[data.packet.field]]\nname = \"" + std::string(name) + "\"\noffset = " + std::to_string(offset) +
           "\ntype = \"" + type + "\"\n";
  };
  wrong("[data.packet]\nsize = 0\n", "rig.toml:2: data.packet.size: = 0 must be from 1 to 65507");
  wrong("[data.packet]\nsize = 16\n", "is missing: a packet has fields");
  wrong("[data.packet]\nsize = 16\n" + field("a", 0, "f32"), "without 'time'");
  wrong("[data.packet]\nsize = 16\n" + kTime + field("a", 6, "f32"), "'a' at 6 overlaps 'time'");
  wrong("[data.packet]\nsize = 16\n" + kTime + field("a", 13, "f32"), "'a' ends at 17, the packet at 16");
  wrong("[data.packet]\nsize = 16\n" + kTime + field("a", 16, "u8"), "'a' ends at 17, the packet at 16");
  wrong("[data.packet]\nsize = 16\n" + kTime + field("time", 8, "u8"), "'time' is there twice");
  wrong("[data.packet]\nsize = 16\n" + kTime + field("a", 8, "f16"), "'f16' is not one of f32, f64");
  wrong("[data.packet]\nsize = 16\nbegins_with = \"RIG-ONE\"\n" + kTime, "overlaps the first 7 bytes");
}

}  // namespace
}  // namespace veridyn::io
