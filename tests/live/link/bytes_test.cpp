#include "veridyn/live/link/bytes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>

namespace veridyn::live {
namespace {

// Examples of the formats: IEEE 754 single 1.0 is 0x3f800000, double -2.0 is 0xc000000000000000.
TEST(Bytes, AreLeastSignificantFirst) {
  std::array<char, 24> bytes{};
  put_at(std::span(bytes), 0, std::uint32_t{0x01020304});
  put_at(std::span(bytes), 4, 1.0F);
  put_at(std::span(bytes), 8, -2.0);
  put_at(std::span(bytes), 16, std::int16_t{-2});
  enum class Kind : std::uint8_t { kThird = 3 };
  put_at(std::span(bytes), 18, Kind::kThird);
  const std::array<unsigned char, 19> expected = {4, 3, 2, 1, 0, 0,    0x80, 0x3f, 0, 0,
                                                  0, 0, 0, 0, 0, 0xc0, 0xfe, 0xff, 3};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(static_cast<unsigned char>(bytes[i]), expected[i]) << i;
}

TEST(Bytes, AreReadBackWhateverTheirNumber) {
  std::array<std::uint8_t, 8> bytes{};
  const auto check = [&]<typename T>(T value) {
    put_at(std::span(bytes), 0, value);
    EXPECT_EQ(number_at<T>(std::span<const std::uint8_t>(bytes), 0), value);
  };
  check(std::numeric_limits<std::int64_t>::min());
  check(std::numeric_limits<std::uint64_t>::max());
  check(std::numeric_limits<double>::denorm_min());
  check(-std::numeric_limits<double>::infinity());
  check(std::numeric_limits<float>::max());
  check(std::int8_t{-1});
  check(std::uint16_t{0xfffe});
}

}  // namespace
}  // namespace veridyn::live
