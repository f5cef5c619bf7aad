// Products of the linearisation with tangents, and the tangents that a simulation starts with.
#include <algorithm>
#include <vector>

#include "veridyn/core/index.hpp"
#include "veridyn/muscle/simulation/system_linearization.hpp"

namespace veridyn::muscle {
namespace {

void add_row(double factor, const double* from, std::size_t count, double* to) {
  for (std::size_t j = 0; j < count; ++j) to[j] += factor * from[j];
}

}  // namespace

void SystemLinearization::tangent_rate(double step, double* S, double* rate) const {
  const StateLayout& layout = system_->layout();
  const std::size_t p = columns_;
  const auto row = [&](std::size_t state) { return S + state * p; };
  // Muscles first: the skeleton sees the fibres at the end of the stage.
  for (std::size_t m = 0; m < force_.size(); ++m) {
    const MuscleSlots& slots = slots_[m];
    const int a = layout.activation[m], l = layout.fiber_length[m];
    if (live(m)) {
      double* const to = rate + at(a) * p;
      for (std::size_t j = 0; j < p; ++j) to[j] = slots.activation_rate[kActivation] * row(at(a))[j];
    }
    if (l < 0) continue;
    double* const to = rate + at(l) * p;
    for (std::size_t j = 0; j < p; ++j) to[j] = slots.fiber_velocity[kFiber] * row(at(l))[j];
    for (std::size_t k = 0; k < free_; ++k) add_row(velocity_z_(m, k), row(k), p, to);
    if (live(m)) add_row(slots.fiber_velocity[kActivation], row(at(a)), p, to);
  }
  for (const TangentForcing& f : forcings_) {
    const std::size_t slot = kField + f.field;
    const int a = layout.activation[f.muscle], l = layout.fiber_length[f.muscle];
    if (a >= 0 && live(f.muscle)) rate[a * p + f.column] += f.weight * slots_[f.muscle].activation_rate[slot];
    if (l >= 0) rate[l * p + f.column] += f.weight * slots_[f.muscle].fiber_velocity[slot];
  }
  // S_l = base + step (l'_l S_l + what does not depend on it).
  for (std::size_t m = 0; m < force_.size() && step > 0.0; ++m) {
    const int l = layout.fiber_length[m];
    if (l < 0) continue;
    const double share = 1.0 / (1.0 - step * slots_[m].fiber_velocity[kFiber]);
    double *const to = rate + at(l) * p, *const S_l = row(at(l));
    for (std::size_t j = 0; j < p; ++j) {
      to[j] *= share;
      S_l[j] += step * to[j];
    }
  }
  std::copy(row(free_), row(2 * free_), rate);
  double* const accelerations = rate + free_ * p;
  std::fill(accelerations, accelerations + free_ * p, 0.0);
  for (std::size_t i = 0; i < free_; ++i) {
    double* const to = accelerations + i * p;
    for (std::size_t k = 0; k < free_; ++k) {
      add_row(acc_z_(i, k), row(k), p, to);
      add_row(acc_zd_(i, k), row(free_ + k), p, to);
    }
    for (std::size_t m = 0; m < force_.size(); ++m) {
      const double factor = acc_force_(i, m);
      if (live(m)) add_row(factor * slots_[m].force[kActivation], row(at(layout.activation[m])), p, to);
      const int l = layout.fiber_length[m];
      if (l >= 0) add_row(factor * slots_[m].force[kFiber], row(at(l)), p, to);
    }
    for (const TangentForcing& f : forcings_)
      to[f.column] += acc_force_(i, f.muscle) * f.weight * slots_[f.muscle].force[kField + f.field];
  }
}

void SystemLinearization::start_muscles(const double* start, bool follows_excitation, double* x, double* S) {
  const StateLayout& layout = system_->layout();
  const std::size_t muscles = force_.size(), p = columns_;
  set_motion(x);
  std::vector<char> limited(muscles);
  for (std::size_t m = 0; m < muscles; ++m) {
    const double least = system_->muscles().settings(m).minimum_activation;
    const double a = std::clamp(start[m], least, 1.0);
    limited[m] = a != start[m];
    in_activation_[m] = SimulationJet(a, 0);
    in_length_[m] = SimulationJet(paths_->length()[m], 2);
    if (layout.activation[m] < 0) continue;
    x[layout.activation[m]] = a;
    std::fill(S + at(layout.activation[m]) * p, S + at(layout.activation[m] + 1) * p, 0.0);
  }
  const auto starts_with = [&](const TangentForcing& f) {
    return f.field == TangentForcing::kExcitation && limited[f.muscle] == 0 &&
           (follows_excitation || layout.activation[f.muscle] < 0);
  };
  for (const TangentForcing& f : forcings_) {
    const int a = layout.activation[f.muscle];
    if (starts_with(f) && a >= 0) S[a * p + f.column] += f.weight;
  }
  for (std::size_t q = 0; q < passes_.size(); ++q) {
    const Pass& pass = passes_[q];
    pass.muscles.equilibrium(in_activation_, in_length_, out_velocity_);
    for (std::size_t m = 0; m < muscles; ++m) {
      const int l = layout.fiber_length[m];
      if (l < 0) continue;
      const SimulationJet& fiber = out_velocity_[m];
      double* const to = S + at(l) * p;
      if (q == 0) {
        x[l] = fiber.a;
        std::fill(to, to + p, 0.0);
        for (std::size_t k = 0; k < free_; ++k) add_row(fiber.v(2) * arm_(m, k), S + k * p, p, to);
        for (const TangentForcing& f : forcings_) {
          if (f.muscle == m && starts_with(f)) to[f.column] += fiber.v(0) * f.weight;
        }
      }
      for (const TangentForcing& f : forcings_) {
        if (f.muscle != m || f.field == TangentForcing::kExcitation) continue;
        for (std::size_t i = 0; i < 3; ++i) {
          if (pass.field[m][i] == f.field) to[f.column] += f.weight * fiber.v(3 + i);
        }
      }
    }
  }
}

}  // namespace veridyn::muscle
