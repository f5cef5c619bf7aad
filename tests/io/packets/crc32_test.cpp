#include "veridyn/io/packets/crc32.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "veridyn/numerics/random.hpp"

namespace veridyn::io {
namespace {

TEST(Crc32, IsThatOfEthernet) {
  EXPECT_EQ(crc32("123456789"), 0xcbf43926U);  // check value of the catalogue of CRCs
}

// The division by the polynomial, bit by bit.
TEST(Crc32, IsTheRemainderOfTheDivision) {
  numerics::RandomStream random(4, "crc");
  for (int length = 0; length < 64; ++length) {
    std::string bytes;
    for (int k = 0; k < length; ++k) bytes.push_back(static_cast<char>(random.index(256)));
    std::uint32_t remainder = 0xffffffffU;
    for (const char c : bytes) {
      remainder ^= static_cast<unsigned char>(c);
      for (int bit = 0; bit < 8; ++bit) remainder = (remainder >> 1U) ^ ((remainder & 1U) != 0U ? 0xedb88320U : 0U);
    }
    EXPECT_EQ(crc32(bytes), remainder ^ 0xffffffffU) << length;
  }
}

}  // namespace
}  // namespace veridyn::io
