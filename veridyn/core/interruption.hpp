#pragma once

#include <atomic>
#include <memory>

namespace veridyn {

/// The user's request to end the work. All copies share one flag: the program makes one and hands copies to whatever
/// has to stop. One that nobody requests never stops anything.
class Interruption {
 public:
  /// Asks for the end. Safe in a signal handler.
  void request() { *requested_ = true; }
  [[nodiscard]] bool requested() const { return *requested_; }

 private:
  static_assert(std::atomic<bool>::is_always_lock_free);
  std::shared_ptr<std::atomic<bool>> requested_ = std::make_shared<std::atomic<bool>>(false);
};

/// From now on SIGINT (Ctrl-C) and SIGTERM request `interruption`; a second one ends the program at once.
void request_on_signals(const Interruption& interruption);

}  // namespace veridyn
