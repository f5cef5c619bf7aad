#pragma once

#include "veridyn/core/progress.hpp"

namespace veridyn {

/// View of a progress for a part of its work that says nothing of itself: it stops when the whole work should and uses
/// `threads` threads (0: as many as the machine has), 1 where many such parts go on at once.
class QuietProgress : public Progress {
 public:
  explicit QuietProgress(const Progress& whole, int threads = 1) : whole_(whole), threads_(threads) {}
  [[nodiscard]] bool update(double) override { return !whole_.interrupted(); }
  [[nodiscard]] bool interrupted() const override { return whole_.interrupted(); }
  [[nodiscard]] int threads() const override { return threads_; }

 private:
  const Progress& whole_;
  int threads_;
};

}  // namespace veridyn
