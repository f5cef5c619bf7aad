#pragma once

#include "veridyn/core/progress.hpp"

namespace veridyn {

/// View of a progress for one of many parts of its work that go on at once: the part says nothing of itself, uses
/// `threads` threads and stops when the whole work should.
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
