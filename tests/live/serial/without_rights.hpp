#pragma once

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace veridyn::live::testing {

/// A file that this program may not open while the object lives, the superuser's program neither: it acts for another
/// user until then.
class WithoutRights {
 public:
  WithoutRights() {
    // Of the file alone: its folder is open to everybody.
    std::filesystem::permissions(folder_.path(), std::filesystem::perms(0755));
    std::ofstream(path_) << "text";
    ::chmod(path_.c_str(), 0);
    if (own_ == 0) lowered_ = ::seteuid(kNobody) == 0;
  }
  ~WithoutRights() {
    if (lowered_ && ::seteuid(own_) != 0) std::abort();
  }
  WithoutRights(const WithoutRights&) = delete;
  WithoutRights& operator=(const WithoutRights&) = delete;

  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  static constexpr uid_t kNobody = 65534;
  veridyn::test::TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "closed";
  uid_t own_ = ::geteuid();
  bool lowered_ = false;
};

}  // namespace veridyn::live::testing
