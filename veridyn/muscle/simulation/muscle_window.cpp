#include "veridyn/muscle/simulation/muscle_window.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace veridyn::muscle {

MuscleWindow::MuscleWindow(MuscleGroup<double> muscles)
    : muscles_(std::move(muscles)),
      stepper_(2 * muscles_.size()),
      n_(muscles_.size()),
      cubic_(n_),
      start_(2 * n_),
      state_(2 * n_),
      scales_(2 * n_, 0.1),
      length_(n_),
      speed_(n_),
      activation_rate_(n_),
      fiber_velocity_(n_),
      scratch_force_(n_),
      a_(n_),
      b_(n_),
      fa_(n_),
      fb_(n_),
      trial_(n_),
      trial_force_(n_),
      side_(n_) {
  for (std::size_t m = 0; m < n_; ++m) scales_[n_ + m] = 0.1 * muscles_.settings(m).musculotendon.optimal_fiber_length;
}

void MuscleWindow::set_paths(double duration, const std::array<std::vector<double>, kNodes>& length) {
  duration_ = duration;
  const double h = duration / 3.0;
  for (std::size_t m = 0; m < n_; ++m) {
    // Newton's divided differences at 0, h, 2h, 3h, multiplied out.
    const double f0 = length[0][m], f1 = length[1][m], f2 = length[2][m], f3 = length[3][m];
    const double d1 = (f1 - f0) / h;
    const double d2 = (f2 - 2.0 * f1 + f0) / (2.0 * h * h);
    const double d3 = (f3 - 3.0 * f2 + 3.0 * f1 - f0) / (6.0 * h * h * h);
    cubic_[m] = {f0, d1 - h * d2 + 2.0 * h * h * d3, d2 - 3.0 * h * d3, d3};
  }
}

void MuscleWindow::set_states(std::span<const double> activation, std::span<const double> fiber_length) {
  std::copy(activation.begin(), activation.end(), start_.begin());
  std::copy(fiber_length.begin(), fiber_length.end(), start_.begin() + n_);
}

void MuscleWindow::path_at(double t) {
  for (std::size_t m = 0; m < n_; ++m) {
    const auto& c = cubic_[m];
    length_[m] = c[0] + t * (c[1] + t * (c[2] + t * c[3]));
    speed_[m] = c[1] + t * (2.0 * c[2] + t * 3.0 * c[3]);
  }
}

bool MuscleWindow::end_forces(std::span<const double> excitation, double tolerance, std::span<double> force) {
  const auto derivative = [&](double t, const double* x, double* rate) {
    path_at(t);
    muscles_.rates({excitation, {x, n_}, {x + n_, n_}, length_, speed_}, {{rate, n_}, {rate + n_, n_}, scratch_force_});
    return true;
  };
  state_ = start_;
  double t = 0.0;
  stepper_.restart(true);
  const numerics::IntegrationEnd end = stepper_.advance(
      derivative, t, state_.data(), duration_, scales_,
      {.tolerance = tolerance, .max_steps = stepper_.steps() + 100000}, [](double, double) { return true; });
  if (end != numerics::IntegrationEnd::kReached) return false;
  path_at(duration_);
  muscles_.tendon_forces({excitation, {state_.data(), n_}, {state_.data() + n_, n_}, length_, speed_}, force);
  return true;
}

bool MuscleWindow::find_excitations(std::span<const double> low, std::span<const double> high,
                                    std::span<const double> force_low, std::span<const double> force_high,
                                    std::span<const double> desired, double tolerance, std::span<double> excitation) {
  constexpr double kNarrow = 1.0;     // [N]
  constexpr double kRounding = 1e-7;  // of an excitation: far below what matters within a window of 10 ms
  constexpr int kMostIterations = 30;
  for (std::size_t m = 0; m < n_; ++m) {
    a_[m] = low[m];
    b_[m] = high[m];
    fa_[m] = force_low[m] - desired[m];
    fb_[m] = force_high[m] - desired[m];
    side_[m] = 0;
    excitation[m] = fa_[m] >= 0.0 || force_high[m] - force_low[m] < kNarrow ? low[m] : high[m];
    if (excitation[m] == low[m] || fb_[m] <= 0.0) a_[m] = b_[m] = excitation[m];
  }
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    bool open = false;
    for (std::size_t m = 0; m < n_; ++m) {
      trial_[m] = excitation[m];
      if (b_[m] - a_[m] <= kRounding) continue;
      open = true;
      trial_[m] = std::clamp((a_[m] * fb_[m] - b_[m] * fa_[m]) / (fb_[m] - fa_[m]), a_[m], b_[m]);
    }
    if (!open) break;
    if (!end_forces(trial_, tolerance, trial_force_)) return false;
    for (std::size_t m = 0; m < n_; ++m) {
      if (b_[m] - a_[m] <= kRounding) continue;
      const double error = trial_force_[m] - desired[m];
      excitation[m] = trial_[m];
      // A force within a millionth of the reachable range counts as the desired one.
      if (std::abs(error) <= 1e-6 * (force_high[m] - force_low[m])) {
        a_[m] = b_[m] = trial_[m];
      } else if (error < 0.0) {
        a_[m] = trial_[m];
        fa_[m] = error;
        if (side_[m] == -1) fb_[m] *= 0.5;
        side_[m] = -1;
      } else {
        b_[m] = trial_[m];
        fb_[m] = error;
        if (side_[m] == 1) fa_[m] *= 0.5;
        side_[m] = 1;
      }
    }
  }
  return true;
}

}  // namespace veridyn::muscle
