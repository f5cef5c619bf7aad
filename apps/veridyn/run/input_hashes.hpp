#pragma once

#include <atomic>
#include <filesystem>
#include <future>
#include <map>
#include <string>
#include <vector>

namespace veridyn::app {

/// Hashes of a run's inputs for run.json. Those of large recordings take as long as reading them: they can be found
/// beside the analysis.
class InputHashes {
 public:
  InputHashes() = default;
  /// Does not wait for what was begun.
  ~InputHashes();
  InputHashes(const InputHashes&) = delete;
  InputHashes& operator=(const InputHashes&) = delete;

  /// Begins to hash these files on a thread of its own. At most once.
  void begin(std::vector<std::filesystem::path> files);
  /// The SHA-1 of a file, from what was begun or at once. @throws InputError when it cannot be read.
  [[nodiscard]] std::string of(const std::filesystem::path& file);

 private:
  std::atomic<bool> stop_ = false;
  std::future<std::map<std::filesystem::path, std::string>> ahead_;
  std::map<std::filesystem::path, std::string> found_;
};

}  // namespace veridyn::app
