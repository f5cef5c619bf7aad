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
