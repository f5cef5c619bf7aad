#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/io/log/log.hpp"

namespace veridyn::io {

/// Times go on so long after what came before, where a clock restarts and nothing says how long it stood [s]: a pause
/// that no filter bridges.
inline constexpr double kRestartPause_s = 60.0;

/// Where the clock of a vehicle, which counts from when it was switched on, starts again within a log: logs of several
/// flights that were put one after the other.
///
/// Takes all stamps in the order of the file. The clock has restarted where stamps lie more than 10 s before the
/// latest, 32 of them in a row that follow each other, and none of them on the old clock: a stamp or two that are off
/// are damage, and messages of another clock stand between those of this one. At the end of a log 8 are enough. Less
/// than 10 s back it goes unseen: no vehicle starts that soon.
class ClockRestarts {
 public:
  /// The next stamp [s], and where it stands in the file.
  void add(double stamp, std::uint64_t place) {
    if (stamp >= latest_ - kBack_s && stamp <= latest_ + kAhead_s) {
      latest_ = latest_ > stamp ? latest_ : stamp;
      away_ = {};
      return;
    }
    add_away(stamp, place);
  }
  /// Nothing comes after it.
  void finish();

  /// What is to be added to a stamp at this place [s].
  [[nodiscard]] double shift_at(std::uint64_t place) const;
  /// Adds it to stamps, each at a place of its own.
  void shift(std::span<double> stamps, std::span<const std::uint64_t> places) const;
  /// Notes the restarts in a log, and lists their moments there.
  void report_to(Log& log) const;

 private:
  static constexpr double kBack_s = 10.0, kAhead_s = 60.0;

  struct Restart {
    std::uint64_t place = 0;
    double first = 0.0;  // on its own clock
    double shift = 0.0;
  };
  // Stamps in a row that are far from the clock.
  struct Away {
    std::uint64_t place = 0;  // of the first
    double earliest = kInfinity;
    double latest = -kInfinity;  // of the last that follow each other
    int count = 0;               // of those
  };

  void add_away(double stamp, std::uint64_t place);
  void accept();

  double latest_ = kNaN;  // compares with nothing until the first stamps have followed each other
  Away away_;
  std::vector<Restart> restarts_;
};

}  // namespace veridyn::io
