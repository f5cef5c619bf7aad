#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace veridyn {

/// The program as a process beside the test; killed where it still runs at the end.
class Process {
 public:
  /// What it says, stdout and stderr, goes to a file.
  Process(const std::vector<std::string>& arguments, const std::filesystem::path& says);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void signal(int number) const;
  /// Waits for its end. @return its exit code; -1 where a signal ended it
  int wait();
  [[nodiscard]] std::string said() const;
  /// Waits until it has said this. @return whether it has, within so many seconds
  [[nodiscard]] bool says(const std::string& text, double within) const;

 private:
  pid_t pid_ = -1;
  std::filesystem::path says_;
};

}  // namespace veridyn
