#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <string_view>

#include "veridyn/core/interruption.hpp"

namespace veridyn {

/// Where long work says how far it is, and learns whether to go on and on how many threads.
///
/// Work is a sequence of named stages. Implementations are cheap to call (they rate-limit themselves). The base class
/// shows nothing, never interrupts and allows all threads: pass it where nobody watches.
class Progress {
 public:
  virtual ~Progress() = default;
  /// A new stage begins: "smoothing 312 s of flight".
  virtual void stage(std::string_view name);
  /// The stage is done to `fraction` in [0, 1]. False when the work should stop: the caller then leaves everything that
  /// it has finished, and nothing half-written.
  [[nodiscard]] virtual bool update(double fraction);
  /// Whether the work should stop.
  [[nodiscard]] virtual bool interrupted() const;
  /// How many threads the work may use; 0: as many as the machine has. Results do not depend on it.
  [[nodiscard]] virtual int threads() const;
};

/// Shows a bar with the remaining time on stderr when that is a terminal, one line a stage when it is not; nothing when
/// quiet. Stops the work when `interruption` is requested.
class TerminalProgress : public Progress {
 public:
  explicit TerminalProgress(bool quiet, int threads = 0, Interruption interruption = {});
  ~TerminalProgress() override;
  TerminalProgress(const TerminalProgress&) = delete;
  TerminalProgress& operator=(const TerminalProgress&) = delete;

  void stage(std::string_view name) override;
  [[nodiscard]] bool update(double fraction) override;
  [[nodiscard]] bool interrupted() const override;
  [[nodiscard]] int threads() const override;

 private:
  void end_line();

  using Clock = std::chrono::steady_clock;
  bool quiet_;
  bool terminal_;
  int threads_;
  Interruption interruption_;
  bool drawn_ = false;
  std::string stage_;
  Clock::time_point begun_;
  Clock::time_point shown_;
};

/// Remaining time in words: "3 s", "2 min 10 s", "1 h 05 min".
[[nodiscard]] std::string duration_text(double seconds);

}  // namespace veridyn
