#include "veridyn/core/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "veridyn/core/stderr_text.hpp"

namespace veridyn {

void Progress::stage(std::string_view) {}
bool Progress::update(double) { return !interrupted(); }
bool Progress::interrupted() const { return false; }
int Progress::threads() const { return 0; }

TerminalProgress::TerminalProgress(bool quiet, int threads, Interruption interruption)
    : quiet_(quiet),
      terminal_(::isatty(STDERR_FILENO) == 1),
      threads_(threads),
      interruption_(std::move(interruption)),
      begun_(Clock::now()),
      shown_(begun_) {}

TerminalProgress::~TerminalProgress() { end_line(); }

void TerminalProgress::stage(std::string_view name) {
  end_line();
  stage_ = name;
  begun_ = shown_ = Clock::now();
  if (!quiet_ && !terminal_) print_to_stderr(stage_ + "\n");
}

bool TerminalProgress::update(double fraction) {
  const auto now = Clock::now();
  if (!quiet_ && terminal_ && now - shown_ >= std::chrono::milliseconds(100)) {
    shown_ = now;
    drawn_ = true;
    const double done = std::clamp(fraction, 0.0, 1.0);
    const double elapsed_s = std::chrono::duration<double>(now - begun_).count();
    const int cells = static_cast<int>(std::lround(24.0 * done));
    // A first guess of the remaining time from the very beginning would be noise.
    const std::string remaining = done > 0.02 ? duration_text(elapsed_s * (1.0 - done) / done) + " left" : "";
    print_to_stderr(fmt::format("\r\033[K{} [{:=<{}}{:<{}}] {:3.0f} % {}", stage_, "", cells, "", 24 - cells,
                                100.0 * done, remaining));
    std::fflush(stderr);
  }
  return !interrupted();
}

bool TerminalProgress::interrupted() const { return interruption_.requested(); }

int TerminalProgress::threads() const { return threads_; }

void TerminalProgress::end_line() {
  if (drawn_) print_to_stderr("\r\033[K");
  drawn_ = false;
}

std::string duration_text(double seconds) {
  const long total = std::lround(std::max(0.0, seconds));
  if (total < 60) return fmt::format("{} s", total);
  if (total < 3600) return fmt::format("{} min {:02} s", total / 60, total % 60);
  return fmt::format("{} h {:02} min", total / 3600, (total % 3600) / 60);
}

}  // namespace veridyn
