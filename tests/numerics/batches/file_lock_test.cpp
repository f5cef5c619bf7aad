#include "veridyn/numerics/batches/file_lock.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <stdexcept>
#include <string>

#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn::numerics {
namespace {

TEST(FileLock, IsHeldByOneAndFreeAfterwards) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("veridyn_file_lock_" + std::to_string(::getpid()));
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
  std::filesystem::remove(file);
  EXPECT_THROW(FileLock none(file / "no" / "folder"), std::runtime_error);
}

}  // namespace
}  // namespace veridyn::numerics
