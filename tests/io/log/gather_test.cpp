#include "veridyn/io/log/gather.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>

namespace veridyn::io {
namespace {

template <typename T>
void append(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

TEST(Gather, TakesFieldsOfEveryTypeFromTheirPlaces) {
  // A record of 20 bytes: int16, uint32, double, text of 6.
  std::string bytes = "??";
  std::vector<std::uint64_t> records;
  for (int k = 0; k < 1200; ++k) {  // several blocks
    records.push_back(bytes.size());
    append(bytes, static_cast<std::int16_t>(-k));
    append(bytes, static_cast<std::uint32_t>(3000000000U + static_cast<unsigned>(k)));
    append(bytes, 0.25 * k);
    bytes += k % 2 == 0 ? std::string("even\0x", 6) : "is odd";
  }
  const std::vector<Column> columns =
      gather(bytes.data(), records,
             {{GatherType::kInt16, 0}, {GatherType::kUint32, 2}, {GatherType::kDouble, 6}, {GatherType::kText, 14, 6}});
  ASSERT_EQ(columns.size(), 4u);
  for (const std::size_t k : {std::size_t{0}, std::size_t{511}, std::size_t{512}, std::size_t{1199}}) {
    EXPECT_DOUBLE_EQ(columns[0].number(k), -static_cast<double>(k));
    EXPECT_DOUBLE_EQ(columns[1].number(k), 3e9 + static_cast<double>(k));
    EXPECT_DOUBLE_EQ(columns[2].number(k), 0.25 * static_cast<double>(k));
    EXPECT_EQ(columns[3].text(k), k % 2 == 0 ? "even" : "is odd");
  }
}

// Values of IEEE 754-2008, binary16.
TEST(Gather, ReadsHalfPrecision) {
  std::string bytes;
  std::vector<std::uint64_t> records;
  for (const unsigned half : {0x3c00U, 0xc000U, 0x7bffU, 0x0001U, 0x8000U, 0x7c00U, 0xfc00U, 0x7e00U}) {
    records.push_back(bytes.size());
    append(bytes, static_cast<std::uint16_t>(half));
  }
  const std::vector<Column> columns = gather(bytes.data(), records, {{GatherType::kHalf, 0}});
  const std::vector<double> values = columns.at(0).numbers();
  EXPECT_EQ(values[0], 1.0);
  EXPECT_EQ(values[1], -2.0);
  EXPECT_EQ(values[2], 65504.0);
  EXPECT_EQ(values[3], std::ldexp(1.0, -24));
  EXPECT_TRUE(columns.at(0).number(4) == 0.0 && std::signbit(columns.at(0).number(4)));
  EXPECT_EQ(values[5], INFINITY);
  EXPECT_EQ(values[6], -INFINITY);
  EXPECT_TRUE(std::isnan(values[7]));
}

TEST(Gather, GivesEmptyColumnsForNoRecords) {
  const std::vector<Column> columns = gather(nullptr, {}, {{GatherType::kFloat, 0}, {GatherType::kText, 4, 8}});
  EXPECT_EQ(columns.at(0).size(), 0u);
  EXPECT_EQ(columns.at(1).size(), 0u);
}

}  // namespace
}  // namespace veridyn::io
