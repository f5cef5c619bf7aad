#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/muscle/simulation/forward_simulation.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"

namespace veridyn::muscle {

/// View of controls, which must outlive it: excitations u_m(t) = gain_m e_m(t - delay_m) of recorded ones e (from EMG,
/// say), and reserves as they are, at an instant. Held signals keep the value that `begin_piece` found until the piece
/// ends.
class ShapedControls {
 public:
  ShapedControls(const MuscleControls& controls, std::size_t coordinates, std::vector<double> gain,
                 std::vector<double> delay)
      : controls_(&controls),
        gain_(std::move(gain)),
        delay_(std::move(delay)),
        sample_(gain_.size(), 0),
        changed_(gain_.size(), 0),
        split_(gain_.size(), 0),
        excitation_(gain_.size()),
        raw_(gain_.size()),
        slope_(gain_.size()),
        reserve_(controls.reserve.size() > 0 ? coordinates : 0) {}

  /// Pieces end at the samples of this muscle's excitation also when it is not held: its derivative by the delay jumps
  /// there.
  void split_at_samples(std::size_t muscle) { split_[muscle] = 1; }
  /// A piece begins at `time`: held signals take their values there. Times must not decrease.
  void begin_piece(double time) {
    const std::span<const double> times = controls_->excitation.times();
    for (std::size_t m = 0; m < gain_.size(); ++m) {
      const std::size_t before = sample_[m];
      while (sample_[m] + 1 < times.size() && times[sample_[m] + 1] + delay_[m] <= time) ++sample_[m];
      changed_[m] = held() && sample_[m] != before;
      if (held()) set(m, controls_->excitation.row(sample_[m])[m], 0.0);
    }
    if (!reserve_.empty()) controls_->reserve.evaluate(time, reserve_.data());
  }
  /// The first instant after the piece's beginning at which a held signal jumps, or another is to be split; infinite
  /// when there is none.
  [[nodiscard]] double piece_end(double begin) const {
    double end = kInfinity;
    const std::span<const double> times = controls_->excitation.times();
    for (std::size_t m = 0; m < gain_.size(); ++m) {
      if (!held() && split_[m] == 0) continue;
      // A signal on lines has its first corner where it begins to change.
      std::size_t next = held() || times[0] + delay_[m] <= begin ? sample_[m] + 1 : 0;
      while (next < times.size() && times[next] + delay_[m] <= begin) ++next;
      if (next < times.size()) end = std::min(end, times[next] + delay_[m]);
    }
    if (!reserve_.empty() && controls_->reserve.interpolation() == Interpolation::kHold)
      end = std::min(end, controls_->reserve.next_break(begin));
    return end;
  }
  [[nodiscard]] SystemInputs at(double time) {
    for (std::size_t m = 0; m < gain_.size() && !held(); ++m) interpolate(m, time - delay_[m]);
    if (!reserve_.empty() && controls_->reserve.interpolation() == Interpolation::kLinear)
      controls_->reserve.evaluate(time, reserve_.data());
    return {excitation_, reserve_};
  }
  /// Whether `begin_piece` made the muscle's excitation jump.
  [[nodiscard]] bool jumped(std::size_t muscle) const { return changed_[muscle] != 0; }
  /// du/d(gain) and du/d(delay) at the instant of the last call of `at`.
  [[nodiscard]] double by_gain(std::size_t muscle) const { return raw_[muscle]; }
  [[nodiscard]] double by_delay(std::size_t muscle) const { return -gain_[muscle] * slope_[muscle]; }

 private:
  [[nodiscard]] bool held() const { return controls_->excitation.interpolation() == Interpolation::kHold; }
  void set(std::size_t m, double value, double slope) {
    raw_[m] = value;
    slope_[m] = slope;
    excitation_[m] = gain_[m] * value;
  }
  /// On the line between two samples; constant before the first and after the last.
  void interpolate(std::size_t m, double time) {
    const std::span<const double> times = controls_->excitation.times();
    std::size_t& i = sample_[m];
    while (i > 0 && time < times[i]) --i;
    while (i + 1 < times.size() && times[i + 1] <= time) ++i;
    const double a = controls_->excitation.row(i)[m];
    if (time < times[i] || i + 1 == times.size()) return set(m, a, 0.0);
    const double slope = (controls_->excitation.row(i + 1)[m] - a) / (times[i + 1] - times[i]);
    set(m, a + slope * (time - times[i]), slope);
  }

  const MuscleControls* controls_;
  std::vector<double> gain_, delay_;
  std::vector<std::size_t> sample_;
  std::vector<char> changed_, split_;
  std::vector<double> excitation_, raw_, slope_, reserve_;
};

}  // namespace veridyn::muscle
