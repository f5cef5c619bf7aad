#include "veridyn/numerics/batches/block_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn::numerics {
namespace {

TEST(BlockFile, IsTextWithTheBitsOfEachValue) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "block";
  Block expected{.batch = "b", .fingerprint = 0xabc, .first = 10, .values = {0.0, 0.0}};
  EXPECT_EQ(read_block(path, expected), BlockState::kAbsent);
  write_block(path, {.batch = "b",
                     .fingerprint = 0xabc,
                     .first = 10,
                     .values = {0.01, std::numeric_limits<double>::quiet_NaN()},
                     .seconds = 0.25});
  EXPECT_EQ(read_file(path).substr(0, 122),
            "veridyn block 1\nbatch b, fingerprint 0000000000000abc\nitems 10 to 11\nseconds 0.25\n"
            "3f847ae147ae147b\n7ff8000000000000\ncheck ");
  EXPECT_EQ(read_block(path, expected), BlockState::kRead);
  EXPECT_EQ(expected.values[0], 0.01);
  EXPECT_TRUE(std::isnan(expected.values[1]));
  EXPECT_EQ(expected.seconds, 0.25);
  expected.first = 11;
  EXPECT_EQ(read_block(path, expected), BlockState::kOtherBatch);
}

}  // namespace
}  // namespace veridyn::numerics
