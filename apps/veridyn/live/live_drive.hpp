#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "veridyn/live/rig/live_replay.hpp"

namespace veridyn::app {

/// drive_live.csv: what the car's sensors say, written in whole lines while it drives, for `veridyn track --live`.
class LiveDrive {
 public:
  /// @param folder where it is written; nothing is written where the study has no car
  LiveDrive(const live::LiveStudy& study, const std::filesystem::path& folder);
  ~LiveDrive();
  LiveDrive(const LiveDrive&) = delete;
  LiveDrive& operator=(const LiveDrive&) = delete;

  /// Adds reports; four times a second the lines that there are go to the file. @param time of the run [s]
  void add(const std::vector<live::Telemetry>& motions, double time);
  /// Why no more could be written; empty where all was.
  [[nodiscard]] const std::string& trouble() const { return trouble_; }

 private:
  void write(const std::string& text);

  live::DriveTable table_;
  int file_ = -1;
  double written_ = 0.0;
  std::string trouble_;
};

/// delays.toml: what of the way from pedal to motion was measured in a run with a car.
[[nodiscard]] std::string delays_toml(const live::LiveReplay& run);

}  // namespace veridyn::app
