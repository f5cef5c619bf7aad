#include "veridyn/core/bytes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>

namespace veridyn {
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

TEST(Bytes, AreLoadedFromAnywhereInEitherOrder) {
  const char bytes[] = {9, 4, 3, 2, 1, 0, 0, static_cast<char>(0x80), 0x3f};
  EXPECT_EQ(load_number<std::uint32_t>(bytes + 1), 0x01020304U);
  EXPECT_EQ(load_number<std::uint32_t>(bytes + 1, true), 0x04030201U);
  EXPECT_EQ(load_number<float>(bytes + 5), 1.0F);
}

TEST(ByteReader, GoesFromFrontToBack) {
  ByteReader reader(std::string_view("\x02\0abc\x01\xff", 7));
  EXPECT_EQ(reader.text<std::uint16_t>(), "ab");
  EXPECT_EQ(reader.bytes(1), "c");
  EXPECT_FALSE(reader.ended());
  EXPECT_EQ(reader.number<std::int16_t>(), -255);
  EXPECT_TRUE(reader.ended());
  EXPECT_FALSE(reader.failed());
}

TEST(ByteReader, ReadsNothingPastTheEnd) {
  ByteReader number("abc");
  EXPECT_EQ(number.number<std::uint32_t>(), 0U);
  EXPECT_TRUE(number.failed());
  EXPECT_EQ(number.number<std::uint8_t>(), 0U) << "nor what would still fit";
  ByteReader run("abc");
  EXPECT_EQ(run.bytes(UINT64_MAX), "abc") << "what is left";
  EXPECT_TRUE(run.failed());
}

}  // namespace
}  // namespace veridyn
