#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include "tests/io/matlab/small_mat_log.hpp"
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
