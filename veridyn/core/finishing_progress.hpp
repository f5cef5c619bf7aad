#pragma once

#include <string_view>

#include "veridyn/core/progress.hpp"

namespace veridyn {

/// View of a progress for what is still to be done with what an interruption left: it shows its stages and goes on.
class FinishingProgress : public Progress {
 public:
  explicit FinishingProgress(Progress& whole) : whole_(whole) {}
  void stage(std::string_view name) override { whole_.stage(name); }
  [[nodiscard]] bool update(double fraction) override {
    static_cast<void>(whole_.update(fraction));
    return true;
  }
  [[nodiscard]] bool interrupted() const override { return false; }
  [[nodiscard]] int threads() const override { return whole_.threads(); }

 private:
  Progress& whole_;
};

}  // namespace veridyn
