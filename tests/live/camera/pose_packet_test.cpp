#include "veridyn/live/camera/pose_packet.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "veridyn/numerics/random.hpp"

namespace veridyn::live {
namespace {

CameraPose some_pose() {
  CameraPose p{.sequence = 70000, .stamp = 123456789012345, .pose = {1.25, -0.5, 3.0}};
  p.covariance << 4e-6, 1e-6, 2e-7, 1e-6, 9e-6, -3e-7, 2e-7, -3e-7, 1e-4;
  return p;
}
std::string text_of(const PosePacket& bytes) { return {bytes.data(), bytes.size()}; }

TEST(CameraPose, ComesBackAsItWas) {
  const CameraPose p = some_pose();
  const std::string bytes = text_of(encode(p));
  ASSERT_EQ(bytes.size(), 92U);
  EXPECT_EQ(bytes.substr(0, 8), std::string("VCP1\x70\x11\x01\x00", 8));  // 70000 = 0x011170
  const auto back = decode_pose(bytes);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->sequence, p.sequence);
  EXPECT_EQ(back->stamp, p.stamp);
  EXPECT_EQ(back->pose, p.pose);
  EXPECT_EQ(back->covariance, p.covariance);
}

TEST(CameraPose, IsRefusedWhereAnyByteIsAnotherOne) {
  const std::string whole = text_of(encode(some_pose()));
  numerics::RandomStream random(1, "bytes");
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string bytes = whole;
    bytes[i] = static_cast<char>(bytes[i] ^ static_cast<char>(1 + random.index(255)));
    EXPECT_FALSE(decode_pose(bytes)) << i;
  }
  EXPECT_FALSE(decode_pose(whole.substr(1)));
  EXPECT_FALSE(decode_pose(whole + "x"));
}

TEST(CameraPose, IsRefusedWithoutACovarianceOrANumber) {
  CameraPose p = some_pose();
  p.covariance(2, 2) = 0.0;
  EXPECT_FALSE(decode_pose(text_of(encode(p))));
  p = some_pose();
  p.pose.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(decode_pose(text_of(encode(p))));
}

}  // namespace
}  // namespace veridyn::live
