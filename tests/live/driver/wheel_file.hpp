#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace veridyn::live::testing {

/// A file of these bytes that goes when the test ends.
class WheelFile {
 public:
  explicit WheelFile(const std::string& content) : path_(path_of_test()) {
    std::ofstream(path_, std::ios::binary) << content;
  }
  ~WheelFile() { std::filesystem::remove(path_); }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  /// Tests run alongside each other, each in a process of its own.
  static std::string path_of_test() {
    static int count = 0;
    return fmt::format("{}wheel_{}_{}.events", ::testing::TempDir(),
                       ::testing::UnitTest::GetInstance()->current_test_info()->name(), count++);
  }
  std::string path_;
};

}  // namespace veridyn::live::testing
