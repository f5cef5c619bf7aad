#include "veridyn/core/file_lock.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn {
namespace {

TEST(FileLock, KeepsAFileAndItsContentToOneOwner) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "kept.log";
  write_file(path, "what is there");
  {
    const FileLock lock(path);
    try {
      const FileLock second(path);
      FAIL() << "two owners";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr("kept.log: is in use by another run"));
    }
  }
  EXPECT_NO_THROW(FileLock{path});
  EXPECT_EQ(read_file(path), "what is there");
}

TEST(FileLock, EndsWithAProcessThatWasKilled) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "kept.log";
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    const FileLock lock(path);
    if (write(ready[1], "x", 1) == 1) pause();
    _exit(1);
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  EXPECT_THROW(FileLock{path}, InputError);
  kill(child, SIGKILL);
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
  EXPECT_NO_THROW(FileLock{path});
}

TEST(FileLock, SaysWhyAFileCannotBeKept) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(FileLock{folder.path()}, InputError);
  EXPECT_THROW(FileLock{folder.path() / "no folder" / "kept.log"}, InputError);
}

}  // namespace
}  // namespace veridyn
