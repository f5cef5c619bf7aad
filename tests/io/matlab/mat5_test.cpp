#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include "tests/io/matlab/small_mat_log.hpp"
#include "tests/io/support.hpp"
#include "tests/support/synthetic_logs.hpp"
#include "veridyn/io/matlab/mat.hpp"

namespace veridyn::io {
namespace {

using testing::expect_small_mat;

TEST(Mat, ReadsCompressedVariables) {
  const std::string plain = testing::small_mat();
  std::string packed = plain.substr(0, 128);
  std::size_t at = 128;
  while (at < plain.size()) {
    std::uint32_t size = 0;
    std::memcpy(&size, plain.data() + at + 4, 4);
    uLongf length = compressBound(size + 8);
    std::string body(length, '\0');
    ASSERT_EQ(compress(reinterpret_cast<Bytef*>(body.data()), &length,
                       reinterpret_cast<const Bytef*>(plain.data() + at), size + 8),
              Z_OK);
    body.resize(length);
    packed += testing::pack(std::uint32_t{15}, static_cast<std::uint32_t>(length)) + body;
    at += 8 + size;
  }
  expect_small_mat(read_mat(packed, "packed.mat"));
}

std::string packed_variable(const std::string& plain) {
  uLongf length = compressBound(plain.size());
  std::string body(length, '\0');
  EXPECT_EQ(compress(reinterpret_cast<Bytef*>(body.data()), &length, reinterpret_cast<const Bytef*>(plain.data()),
                     plain.size()),
            Z_OK);
  body.resize(length);
  return testing::pack(std::uint32_t{15}, static_cast<std::uint32_t>(length)) + body;
}

TEST(Mat, RefusesAVariableThatExpandsToGigabytesBeforeItDoes) {
  const std::string head = testing::small_mat().substr(0, 128);
  const std::string tag = testing::pack(std::uint32_t{14}, std::uint32_t{0x7fffff00}) + std::string(1000, '\0');
  EXPECT_EQ(testing::message_of([&] { (void)read_mat(head + packed_variable(tag), "bomb.mat"); }),
            "bomb.mat: a variable takes 2048 MiB, more than the 384 MiB that one may: save it in parts");
  // What is cut short of the size that it says is damage.
  const std::string cut = testing::pack(std::uint32_t{14}, std::uint32_t{100000}) + std::string(1000, '\0');
  EXPECT_EQ(read_mat(head + packed_variable(cut), "cut.mat").damage.records_lost, 1U);
}

/// A variable of `count` zeros of one byte each, by its name.
std::string zeros(const char name, std::uint32_t count) {
  const std::string body = testing::pack(std::uint32_t{6}, std::uint32_t{8}, std::uint32_t{8}, std::uint32_t{0}) +
                           testing::pack(std::uint32_t{5}, std::uint32_t{8}, count, std::uint32_t{1}) +
                           testing::pack(std::uint32_t{1}, std::uint32_t{1}) + std::string(1, name) +
                           std::string(7, '\0') + testing::pack(std::uint32_t{1}, count) + std::string(count, '\0');
  return testing::pack(std::uint32_t{14}, static_cast<std::uint32_t>(body.size())) + body;
}

TEST(Mat, RefusesVariablesThatTogetherTakeMoreThanTheMemoryMayBeFilledWith) {
  const std::string head = testing::small_mat().substr(0, 128);
  constexpr std::uint32_t kEight = 1U << 20U;  // 8 MiB as doubles
  const std::string large = packed_variable(zeros('b', 33 * kEight));
  EXPECT_EQ(read_mat(head + packed_variable(zeros('a', 8)) + large, "one.mat").damage.records_lost, 0U);
  EXPECT_EQ(
      testing::message_of([&] { (void)read_mat(head + large + packed_variable(zeros('c', 32 * kEight)), "x.mat"); }),
      "x.mat: its variables take more than the 512 MiB that they may together, with 'c': save it in parts");
  std::string many;
  for (int i = 0; i < 200; ++i) many += packed_variable(zeros('d', kEight / 2));
  EXPECT_THAT(testing::message_of([&] { (void)read_mat(head + many, "many.mat"); }), ::testing::HasSubstr("512 MiB"));
}

TEST(Mat, RefusesCellsThatTakeMoreInMemoryThanInTheFile) {
  const std::string head = testing::small_mat().substr(0, 128);
  constexpr std::uint32_t kCells = 5'000'000;
  const std::string empty = testing::pack(std::uint32_t{14}, std::uint32_t{0});
  std::string items;
  for (std::uint32_t i = 0; i < kCells; ++i) items += empty;
  const std::string body = testing::pack(std::uint32_t{6}, std::uint32_t{8}, std::uint32_t{1}, std::uint32_t{0}) +
                           testing::pack(std::uint32_t{5}, std::uint32_t{8}, kCells, std::uint32_t{1}) +
                           testing::pack(std::uint32_t{1}, std::uint32_t{1}) + "c" + std::string(7, '\0') + items;
  const std::string cells = testing::pack(std::uint32_t{14}, static_cast<std::uint32_t>(body.size())) + body;
  EXPECT_THAT(testing::message_of([&] { (void)read_mat(head + packed_variable(cells), "cells.mat"); }),
              ::testing::HasSubstr("variable 'c' takes"));
}

TEST(Mat, LosesOnlyTheVariableThatIsDamaged) {
  std::string bytes = testing::small_mat();
  bytes[128 + 8] = 0x55;  // type of the first variable's flags
  const Log log = read_mat(bytes, "x.mat");
  EXPECT_EQ(log.damage.records_lost, 1U);
  EXPECT_EQ(log.find("flight"), nullptr);
  EXPECT_NE(log.find("")->find("table"), nullptr);
}

}  // namespace
}  // namespace veridyn::io
