#pragma once

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace veridyn::live::testing {

/// A file that this program may not open while the object lives, the superuser's program neither: it acts for another
/// user until then.
class WithoutRights {
 public:
  explicit WithoutRights(const std::string& name) : path_(std::filesystem::temp_directory_path() / name) {
    std::ofstream(path_) << "text";
    ::chmod(path_.c_str(), 0);
    if (own_ == 0) lowered_ = ::seteuid(kNobody) == 0;
  }
  ~WithoutRights() {
    if (lowered_ && ::seteuid(own_) != 0) std::abort();
    std::filesystem::remove(path_);
  }
  WithoutRights(const WithoutRights&) = delete;
  WithoutRights& operator=(const WithoutRights&) = delete;

  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  static constexpr uid_t kNobody = 65534;
  std::filesystem::path path_;
  uid_t own_ = ::geteuid();
  bool lowered_ = false;
};

}  // namespace veridyn::live::testing
