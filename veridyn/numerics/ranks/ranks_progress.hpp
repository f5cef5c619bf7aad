#pragma once

#include "veridyn/core/progress.hpp"

namespace veridyn::numerics {

/// View of a progress that allows as many threads as all processes of a `SharedWork` have, for an algorithm whose
/// threads ask it for values.
class RanksProgress final : public Progress {
 public:
  RanksProgress(Progress& outer, int threads) : outer_(&outer), threads_(threads) {}
  void stage(std::string_view name) override { outer_->stage(name); }
  [[nodiscard]] bool update(double fraction) override { return outer_->update(fraction); }
  [[nodiscard]] bool interrupted() const override { return outer_->interrupted(); }
  [[nodiscard]] int threads() const override { return threads_; }

 private:
  Progress* outer_;
  int threads_;
};

}  // namespace veridyn::numerics
