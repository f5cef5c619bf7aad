#pragma once

#include <functional>
#include <thread>

#include "veridyn/live/rig/live_loop.hpp"

namespace veridyn::live {

/// The loop's thread while its operator's side runs. Where that ends early, by an exception too, the platform is led to
/// park first: the loop goes on until it is parked or stopped, and is joined then.
class RunningLoop {
 public:
  /// @param control of the loop, which outlives this @param body runs the loop until the control ends it
  /// @param longest that the way to park may take [s]
  RunningLoop(LiveControl& control, double longest, std::function<void()> body);
  ~RunningLoop();
  RunningLoop(const RunningLoop&) = delete;
  RunningLoop& operator=(const RunningLoop&) = delete;

  /// Ends the loop where the platform is now, and waits for its thread.
  void end();

 private:
  void park();

  LiveControl* control_;
  double longest_;
  std::thread thread_;
};

}  // namespace veridyn::live
