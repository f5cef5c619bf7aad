#pragma once

#include <array>
#include <span>
#include <vector>

#include "veridyn/muscle/actuator/muscle_group.hpp"
#include "veridyn/numerics/dormand_prince.hpp"

namespace veridyn::muscle {

/// Muscles without their skeleton over a short window of time, along path lengths that are known beforehand: which
/// force each can reach by its end, and which constant excitation reaches a desired one (steps 2 and 4 of computed
/// muscle control).
class MuscleWindow {
 public:
  /// Points in time of a window at which path lengths are given, its ends included.
  static constexpr std::size_t kNodes = 4;

  explicit MuscleWindow(MuscleGroup<double> muscles);

  /// A new window of length `duration` [s]. Path lengths [m] at evenly spaced nodes, muscles one after the other within
  /// a node; a cubic goes through them.
  void set_paths(double duration, const std::array<std::vector<double>, kNodes>& length);
  /// States at its beginning, by muscle.
  void set_states(std::span<const double> activation, std::span<const double> fiber_length);

  /// Tendon forces [N] at the window's end under constant excitations. False when the muscles could not be integrated.
  [[nodiscard]] bool end_forces(std::span<const double> excitation, double tolerance, std::span<double> force);

  /// Excitations between `low` and `high`, with end forces `force_low` and `force_high`, whose end forces are
  /// `desired`: regula falsi (Illinois), all muscles at once. A muscle whose end forces differ by less than 1 N keeps
  /// `low`.
  [[nodiscard]] bool find_excitations(std::span<const double> low, std::span<const double> high,
                                      std::span<const double> force_low, std::span<const double> force_high,
                                      std::span<const double> desired, double tolerance, std::span<double> excitation);

 private:
  void path_at(double time);

  MuscleGroup<double> muscles_;
  numerics::DormandPrince<double> stepper_;
  std::size_t n_;
  double duration_ = 0.0;
  std::vector<std::array<double, kNodes>> cubic_;  ///< by muscle, ascending powers of time
  std::vector<double> start_, state_, scales_;     ///< activations, fibre lengths
  std::vector<double> length_, speed_, activation_rate_, fiber_velocity_, scratch_force_;
  std::vector<double> a_, b_, fa_, fb_, trial_, trial_force_;
  std::vector<int> side_;
};

}  // namespace veridyn::muscle
