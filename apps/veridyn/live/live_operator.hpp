#pragma once

#include <memory>
#include <string>
#include <vector>

#include "apps/veridyn/run/command.hpp"
#include "veridyn/live/rig/live_loop.hpp"

namespace veridyn::app {

/// The page of a run, and what is asked there; nothing of a study without one.
class PageOfRun {
 public:
  /// @throws InputError as `live::LivePage`, and where the program was built without the page
  PageOfRun(const live::LiveStudy& study, const CommonOptions& options);
  ~PageOfRun();
  PageOfRun(const PageOfRun&) = delete;
  PageOfRun& operator=(const PageOfRun&) = delete;

  /// Shows the newest status, 20 times a second, and does what was asked for.
  void update(const live::RigStatus& status, const live::LiveStudy& study, live::LiveControl& control, double time,
              const std::string& message);

 private:
  struct Page;
  std::unique_ptr<Page> page_;
};

/// Signals while it lives: USR1 is an emergency stop, HUP parks and ends the run, and a pipe that nobody reads is no
/// reason to end. One at a time.
class LiveSignals {
 public:
  /// @param control outlives this
  explicit LiveSignals(live::LiveControl& control);
  ~LiveSignals();
  LiveSignals(const LiveSignals&) = delete;
  LiveSignals& operator=(const LiveSignals&) = delete;

  /// Whether the terminal was closed.
  [[nodiscard]] static bool hung_up();
};

/// How a run is led.
struct OperatorOptions {
  CommonOptions common;
  double length = 0.0;       ///< ends after that [s]; 0: never by itself
  bool start = false;        ///< begins to move as soon as all is ready
  live::Nanoseconds at = 0;  ///< the run's start
};

/// The operator's side of a run, until it is over: keys, signals, page, the check of the signs; at its end the platform
/// is parked. @return what the report has to say of it
[[nodiscard]] std::vector<std::string> lead_run(const OperatorOptions& options, const live::LiveStudy& study,
                                                live::LiveControl& control, const live::LiveRecorder& recorder,
                                                PageOfRun& page);

}  // namespace veridyn::app
