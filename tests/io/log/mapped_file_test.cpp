#include "veridyn/io/log/mapped_file.hpp"

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
}

}  // namespace
}  // namespace veridyn::io
