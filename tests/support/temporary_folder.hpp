#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace veridyn::test {

/// An empty folder of the test that is running, which goes when this does. No two are the same: the numbers of
/// processes come again, and what a killed test left is not for the next one to find.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    const ::testing::UnitTest& tests = *::testing::UnitTest::GetInstance();
    std::string name = "veridyn_";
    // Neither is known where a suite is set up outside of its tests.
    if (const ::testing::TestSuite* suite = tests.current_test_suite()) name += std::string(suite->name()) + "_";
    if (const ::testing::TestInfo* info = tests.current_test_info()) name += std::string(info->name()) + "_";
    std::replace(name.begin(), name.end(), '/', '_');
    std::string pattern = (std::filesystem::temp_directory_path() / (name + "XXXXXX")).string();
    if (::mkdtemp(pattern.data()) == nullptr)
      throw std::system_error(errno, std::generic_category(), "temporary folder " + pattern);
    path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace veridyn::test
