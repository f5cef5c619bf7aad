#pragma once

#include <fstream>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace veridyn::live::testing {

/// A file of these bytes that goes when the test ends.
class WheelFile {
 public:
  explicit WheelFile(const std::string& content) { std::ofstream(path_, std::ios::binary) << content; }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  veridyn::test::TemporaryFolder folder_;
  std::string path_ = (folder_.path() / "wheel.events").string();
};

}  // namespace veridyn::live::testing
