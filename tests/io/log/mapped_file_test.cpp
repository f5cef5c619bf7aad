#include "veridyn/io/log/mapped_file.hpp"

#include <sys/stat.h>

#include "tests/io/support.hpp"

namespace veridyn::io {
namespace {

using ::testing::HasSubstr;
using testing::message_of;

TEST(MappedFile, HoldsTheBytesOfAFile) {
  const testing::TemporaryFolder folder;
  const std::string content = std::string("a\0b", 3) + std::string(100000, 'x');
  const MappedFile file(folder.write("log.bin", content));
  EXPECT_EQ(file.bytes(), content);
}

TEST(MappedFile, RefusesWhatIsNoFileWithBytes) {
  const testing::TemporaryFolder folder;
  const auto refused = [](const std::filesystem::path& path) {
    return message_of([&] { const MappedFile file(path); });
  };
  EXPECT_THAT(refused(folder.path() / "missing.bin"), HasSubstr("missing.bin: no such file"));
  EXPECT_THAT(refused(folder.path()), HasSubstr("is a directory, expected a file"));
  EXPECT_THAT(refused(folder.write("empty.bin", "")), HasSubstr("empty.bin: the file is empty"));
  // A pipe into which nobody writes would be waited for, a device has no end.
  const std::filesystem::path pipe = folder.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THAT(refused(pipe), HasSubstr("is a device or a pipe, which has no end"));
  for (const char* device : {"/dev/zero", "/dev/urandom"})
    EXPECT_THAT(refused(device), HasSubstr("is a device or a pipe, which has no end"));
}

}  // namespace
}  // namespace veridyn::io
