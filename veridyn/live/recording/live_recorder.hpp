#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "veridyn/live/recording/live_file.hpp"

namespace veridyn::live {

/// Records a run while it goes. The loop's thread hands records over through a ring, without waiting, locking or
/// allocating; a thread of the recorder's own writes them in blocks, several in a second. What the ring cannot hold or
/// the disk does not take is counted, and the run goes on.
class LiveRecorder {
 public:
  /// Begins the file with its head.
  /// @throws InputError when it cannot be made
  LiveRecorder(const std::filesystem::path& path, const LiveHead& head);
  /// Writes what is left.
  ~LiveRecorder();
  LiveRecorder(const LiveRecorder&) = delete;
  LiveRecorder& operator=(const LiveRecorder&) = delete;

  /// From one thread only.
  void record(const LiveRecord& record);

  /// Records that were lost because the ring was full or the disk did not take them.
  [[nodiscard]] std::uint64_t lost() const;
  /// Why the disk last failed; empty where it did not. Safe from any thread.
  [[nodiscard]] std::string trouble() const;

 private:
  struct Shared;
  std::unique_ptr<Shared> shared_;
};

}  // namespace veridyn::live
