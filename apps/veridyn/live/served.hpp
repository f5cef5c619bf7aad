#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/live/page/recorded_run.hpp"

namespace veridyn::app {

/// What a dashboard shows: recordings of runs that were named, and of folders that were named, and those in them, the
/// newest recording of each and the work that goes on there.
///
/// One thread looks, advances and shows; `frames` and `platform` may be called by any.
class Served {
 public:
  /// @param rate of the dashboard [Hz]
  /// @throws InputError for what does not exist and files that are no recordings
  Served(const std::vector<std::string>& what, double rate);

  /// Looks for recordings and work that are new.
  void look();
  /// Reads on for about so long.
  void advance(std::chrono::nanoseconds budget);
  [[nodiscard]] std::vector<live::ShownRun> runs();
  [[nodiscard]] std::string frames(std::size_t run, double from, double to) const;
  [[nodiscard]] std::string platform(std::size_t run) const;
  /// Work in the folders, each as JSON.
  [[nodiscard]] const std::vector<std::string>& work() const { return work_; }
  /// Asks a run to stop at once, as anybody may: by a datagram to where it listens, and by another whenever `runs` is
  /// called, until it has stopped or half a minute has passed. @return whether it could be asked
  bool stop(std::size_t run);

 private:
  using Clock = std::chrono::steady_clock;
  /// A recording that was named, or the newest of a folder.
  struct Slot {
    std::filesystem::path folder;            ///< empty of a recording that was named
    std::shared_ptr<live::RecordedRun> run;  ///< nothing: the folder has none yet
    std::optional<Clock::time_point> asked;  ///< to stop, which it has not yet
  };
  [[nodiscard]] std::shared_ptr<live::RecordedRun> run_at(std::size_t run) const;
  static bool ask_to_stop(const Slot& slot);
  void look_into(const std::filesystem::path& folder);
  void serve(const std::filesystem::path& recording, const std::filesystem::path& folder);

  std::vector<std::filesystem::path> folders_;
  double rate_;
  mutable std::mutex mutex_;  ///< of the slots
  std::vector<Slot> slots_;
  std::vector<std::string> work_;
  std::map<std::filesystem::path, std::string> said_;  ///< of each folder's work
};

}  // namespace veridyn::app
