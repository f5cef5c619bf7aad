#include "veridyn/io/tables/npy.hpp"

#include <cstdint>
#include <vector>

#include "tests/io/support.hpp"
#include "tests/io/tables/npy_bytes.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::io {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::message_of;
using testing::npy;
using testing::npy_array;

template <typename Stored>
void expect_reads(const char* type) {
  const NpyArray read = read_npy(npy_array<Stored>(type, {1, 0, 3}, "(3,)"), "a.npy");
  ASSERT_EQ(read.columns.size(), 1U) << type;
  EXPECT_EQ(read.rows(), 3U);
  EXPECT_THAT(read.columns[0].numbers(), ElementsAre(1.0, 0.0, 3.0)) << type;
}

TEST(Npy, ReadsEveryTypeOfNumber) {
  expect_reads<double>("<f8");
  expect_reads<float>("<f4");
  expect_reads<std::int8_t>("|i1");
  expect_reads<std::uint8_t>("|u1");
  expect_reads<std::uint8_t>("|b1");
  expect_reads<std::int16_t>("<i2");
  expect_reads<std::uint16_t>("<u2");
  expect_reads<std::int32_t>("<i4");
  expect_reads<std::uint32_t>("<u4");
  expect_reads<std::int64_t>("<i8");
  expect_reads<std::uint64_t>("<u8");
  EXPECT_EQ(read_npy(npy_array<std::int16_t>("<i2", {-2}, "(1,)"), "a").columns[0].number(0), -2.0);
}

TEST(Npy, ReadsBothOrdersOfAMatrixInEveryVersion) {
  for (const int version : {1, 2, 3}) {
    const NpyArray rows = read_npy(npy_array<double>("<f8", {1, 2, 3, 4, 5, 6}, "(3, 2)", false, version), "a");
    EXPECT_THAT(rows.columns.at(0).numbers(), ElementsAre(1.0, 3.0, 5.0));
    EXPECT_THAT(rows.columns.at(1).numbers(), ElementsAre(2.0, 4.0, 6.0));
    const NpyArray columns = read_npy(npy_array<double>("<f8", {1, 2, 3, 4, 5, 6}, "(3, 2)", true, version), "a");
    EXPECT_THAT(columns.columns.at(0).numbers(), ElementsAre(1.0, 2.0, 3.0));
    EXPECT_THAT(columns.columns.at(1).numbers(), ElementsAre(4.0, 5.0, 6.0));
  }
}

TEST(Npy, RefusesWhatItDoesNotReadByName) {
  const auto refusal = [](const std::string& bytes) { return message_of([&] { (void)read_npy(bytes, "a.npy"); }); };
  const std::vector<double> two{1.0, 2.0};
  EXPECT_THAT(refusal(""), HasSubstr("a.npy: is no NumPy array file"));
  EXPECT_THAT(refusal("\x93NUMPY"), HasSubstr("is cut"));
  EXPECT_THAT(refusal(npy_array<double>(">f8", two, "(2,)")), HasSubstr("type '>f8' are not supported"));
  EXPECT_THAT(refusal(npy_array<double>("|O", two, "(2,)")), HasSubstr("type '|O' are not supported"));
  EXPECT_THAT(refusal(npy_array<double>("<c16", two, "(1,)")), HasSubstr("type '<c16'"));
  EXPECT_THAT(refusal(npy_array<double>("<U4", two, "(1,)")), HasSubstr("type '<U4'"));
  EXPECT_THAT(refusal(npy_array<double>("<f8", two, "()")), HasSubstr("has 0 dimensions"));
  EXPECT_THAT(refusal(npy_array<double>("<f8", two, "(1, 2, 1)")), HasSubstr("has 3 dimensions"));
  EXPECT_THAT(refusal(npy_array<double>("<f8", two, "(3,)")), HasSubstr("is cut: 2 numbers of 3 x 1"));
  EXPECT_THAT(refusal(npy_array<double>("<f8", two, "(1,)")), HasSubstr("holds 8 bytes more"));
  // Extents whose product wraps around.
  EXPECT_THAT(refusal(npy_array<double>("<f8", two, "(999999999999999, 999999999999999)")), HasSubstr("is cut"));
  EXPECT_THAT(refusal(npy_array<double>("<f8", two, "(-1,)")), HasSubstr("an extent expected"));
  EXPECT_THAT(refusal(npy_array<double>("<f8", two, "(99999999999999999999,)")), HasSubstr("NumPy header"));
  EXPECT_THAT(refusal(npy("{'descr': [('x', '<f8')], 'fortran_order': False, 'shape': (2,)}", "")),
              HasSubstr("records"));
  EXPECT_THAT(refusal(npy("{'descr': '<f8', 'shape': (2,)}", "")), HasSubstr("lacks"));
  EXPECT_THAT(refusal(npy("{'descr': '<f8', 'descr': '<f8', 'shape': (2,)}", "")), HasSubstr("there twice"));
  EXPECT_THAT(refusal(npy("{'descr': '<f8', 'fortran_order': 0, 'shape': (2,)}", "")), HasSubstr("True or False"));
  EXPECT_THAT(refusal(npy("__import__('os')", "")), HasSubstr("'{' expected"));
  EXPECT_THAT(refusal(npy_array<double>("<f8", two, "(2,)", false, 9)), HasSubstr("version 9.0"));
}

TEST(Npy, TakesFilesThatAreCutOrDamagedAnywhere) {
  const auto takes = [](const std::string& bytes) {
    try {
      const NpyArray read = read_npy(std::string(bytes.data(), bytes.size()), "fuzz");
      for (const Column& column : read.columns) EXPECT_EQ(column.size(), read.rows());
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  };
  numerics::RandomStream random(9, "npy");
  const std::string whole = npy_array<float>("<f4", {1, 2, 3, 4, 5, 6}, "(3, 2)", true, 2);
  for (std::size_t size = 0; size < whole.size(); ++size) takes(whole.substr(0, size));
  for (int n = 0; n < 10000; ++n) {
    std::string bytes = whole;
    for (std::uint64_t k = 0; k <= random.index(3); ++k)
      bytes[random.index(bytes.size())] = static_cast<char>(random.index(256));
    takes(bytes);
  }
}

}  // namespace
}  // namespace veridyn::io
