#pragma once

#include "veridyn/core/progress.hpp"

namespace veridyn::vehicle::testing {

/// Stops the work at its n-th question whether to go on, and at every one after it.
class InterruptingProgress : public Progress {
 public:
  explicit InterruptingProgress(long n) : allowed_(n - 1) {}
  [[nodiscard]] bool update(double /*fraction*/) override { return !interrupted(); }
  [[nodiscard]] bool interrupted() const override { return ++questions_ > allowed_; }
  [[nodiscard]] long questions() const { return questions_; }

 private:
  long allowed_;
  mutable long questions_ = 0;
};

}  // namespace veridyn::vehicle::testing
