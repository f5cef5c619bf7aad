#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/live/page/felt_now.hpp"
#include "veridyn/live/page/page_json.hpp"
#include "veridyn/live/recording/growing_live_file.hpp"
#include "veridyn/live/rig/recorded_rig.hpp"

namespace veridyn::live {

/// A recorded run as a page shows it, also while its recording grows: its records are fed to a rig of its study, and
/// what the run's own page would have shown is kept, so that any moment can be looked at again.
///
/// `advance` and `shown` belong to one thread; `frames` and `platform` may be called by any.
class RecordedRun {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param rate of the statuses that are kept [Hz] @throws InputError as `GrowingLiveFile`
  RecordedRun(const std::filesystem::path& path, double rate);

  /// Reads on for about so long, or until all is read that there is. What cannot be read is said by `shown`.
  void advance(Clock::duration budget);
  /// How the run looks now. A recording grows by blocks of a quarter second: its page is shown that little later, so
  /// that it moves evenly.
  [[nodiscard]] ShownRun shown();
  /// Statuses from the one that held at `from` to `to` [s from the run's start], a JSON array of at most 200.
  [[nodiscard]] std::string frames(double from, double to) const;

  /// Its platform, as `platform_json`; "{}" before it is known.
  [[nodiscard]] std::string platform() const;

  /// Of the recording; nothing before its head is read.
  [[nodiscard]] const std::optional<LiveStudy>& study() const { return study_; }
  /// Whether it grew lately: a recorder writes four times a second. @param within [s]
  [[nodiscard]] bool grows(double within = 2.0) const;
  /// As far as it was read.
  [[nodiscard]] RigState state() const { return rig_ ? rig_->rig().state() : RigState::kParked; }
  /// Why it cannot be shown any further; empty where it can.
  [[nodiscard]] const std::string& trouble() const { return trouble_; }
  [[nodiscard]] const std::filesystem::path& path() const { return file_.path(); }

 private:
  struct Frame {
    double time = 0.0;
    std::string json;
  };
  void begin();
  void take(const LiveRecord& record);
  void keep(const RigStatus& status, double time);

  GrowingLiveFile file_;
  double apart_;  ///< between frames [s]
  std::optional<LiveStudy> study_;
  std::unique_ptr<RecordedRig> rig_;
  std::optional<FeltNow> felt_;
  std::string trouble_;
  bool caught_up_ = false;
  std::optional<Clock::time_point> grew_, looked_;
  double length_ = 0.0, felt_at_ = -1.0, shown_at_ = 0.0;  ///< [s]
  mutable std::mutex mutex_;                               ///< of what follows
  std::vector<Frame> frames_;
  std::string platform_ = "{}";
  std::size_t bytes_ = 0;
};

}  // namespace veridyn::live
