#include "veridyn/core/files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>

#include "tests/support/refusal.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn {
namespace {

namespace fs = std::filesystem;

class Files : public testing::Test {
 protected:
  test::TemporaryFolder temporary_;
  const fs::path& folder_ = temporary_.path();
};

TEST_F(Files, ReadBackWhatWasWritten) {
  const std::string content("a\0b\n", 4);
  write_file(folder_ / "x", content);
  EXPECT_EQ(read_file(folder_ / "x"), content);
  write_file(folder_ / "x", "");
  EXPECT_EQ(read_file(folder_ / "x"), "");
}

TEST_F(Files, LeaveNothingBesideTheFile) {
  write_file(folder_ / "x", "1");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator{}), 1);
}

TEST_F(Files, RefuseMissingFilesAndDirectories) {
  EXPECT_EQ(why([&] { static_cast<void>(read_file("missing.bin")); }), "missing.bin: no such file");
  EXPECT_EQ(why([&] { static_cast<void>(read_file("")); }), "file: its name is empty");
  EXPECT_EQ(why([&] { static_cast<void>(read_file(folder_)); }),
            folder_.string() + ": is a directory, expected a file");
}

TEST_F(Files, RefuseAFolderThatIsNotThereOrAFile) {
  EXPECT_THAT(why([&] { write_file(folder_ / "no" / "x", "1"); }),
              testing::HasSubstr("cannot be written: No such file"));
  write_file(folder_ / "x", "old");
  EXPECT_THAT(why([&] { make_folder(folder_ / "x"); }), testing::HasSubstr("x: is a file, expected a folder"));
  EXPECT_THAT(why([&] { make_folder(folder_ / "x" / "y"); }), testing::HasSubstr("y: cannot be made: Not a directory"));
  fs::create_directory(folder_ / "d");
  EXPECT_THAT(why([&] { write_file(folder_ / "d", "1"); }), testing::HasSubstr("cannot be written"));
  EXPECT_EQ(read_file(folder_ / "x"), "old");
}

// A limit of size stands for the full disk: the choice of the file was not wrong.
TEST_F(Files, AFullDiskIsNoWrongInput) {
  EXPECT_EXIT(
      {
        std::signal(SIGXFSZ, SIG_IGN);
        rlimit limit = {};
        limit.rlim_cur = limit.rlim_max = 4096;
        if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) std::exit(9);
        try {
          write_file(folder_ / "x", std::string(100000, 'x'), "the file");
        } catch (const InputError&) {
          std::exit(2);
        } catch (const std::runtime_error& error) {
          const bool clean = fs::is_empty(folder_);
          std::exit(clean && std::string(error.what()) == "the file: cannot be written: File too large" ? 0 : 3);
        }
        std::exit(4);
      },
      testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace veridyn
