#include "veridyn/numerics/batches/file_lock.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn::numerics {
namespace {

TEST(FileLock, IsHeldByOneAndFreeAfterwards) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "lock";
  write_file(file, "kept");
  {
    const FileLock first(file);
    try {
      const FileLock second(file);
      FAIL() << "both hold it";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), ::testing::StartsWith(file.string()));
    }
  }
  EXPECT_NO_THROW(FileLock third(file));
  EXPECT_EQ(read_file(file), "kept");
  EXPECT_THROW(FileLock none(file / "no" / "folder"), std::runtime_error);
}

}  // namespace
}  // namespace veridyn::numerics
