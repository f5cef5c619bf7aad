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
  /// @param errors where its stderr goes instead; empty: to that file
  Process(const std::vector<std::string>& arguments, const std::filesystem::path& says,
          const std::filesystem::path& errors = {});
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void signal(int number) const;
  /// A key, as from a terminal that is a pipe.
  void press(char key) const;
  [[nodiscard]] pid_t id() const { return pid_; }
  /// Waits for its end. @return its exit code; -1 where a signal ended it
  int wait();
  [[nodiscard]] std::string said() const;
  /// Waits until it has said this. @param from where in what it said that is looked for
  /// @return whether it has, within so many seconds
  [[nodiscard]] bool says(const std::string& text, double within, std::size_t from = 0) const;

 private:
  pid_t pid_ = -1;
  int keys_ = -1;
  std::filesystem::path says_;
};

}  // namespace veridyn
