#pragma once

#include <algorithm>

#include "veridyn/muscle/dynamics/coordinate_forces.hpp"
#include "veridyn/muscle/dynamics/external_forces.hpp"
#include "veridyn/muscle/model/simulation_jet.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"

/// Definitions of `SystemEvaluator`, for the two sources that compile it.
namespace veridyn::muscle {

/// In actuator/muscle_group_derivatives.cpp.
extern template class MuscleGroup<SimulationJet>;

template <typename Scalar>
MuscleGroup<Scalar> SystemEvaluator<Scalar>::same_muscles(const MusculoskeletalSystem& system) {
  if constexpr (std::is_same_v<Scalar, double>) {
    return system.muscles();
  } else {
    std::vector<MusculotendonParameters<Scalar>> parameters;
    for (std::size_t m = 0; m < system.muscles().size(); ++m) {
      parameters.push_back(system.muscles().settings(m).musculotendon.template cast<Scalar>());
    }
    return system.muscles().template with<Scalar>(parameters);
  }
}

template <typename Scalar>
SystemEvaluator<Scalar>::SystemEvaluator(const MusculoskeletalSystem& system, MuscleGroup<Scalar> muscles)
    : system_(&system),
      muscles_(std::move(muscles)),
      reduced_(system.mechanism(), system.reduction(), &system.loops()),
      path_workspace_(system.paths()),
      passive_(system.passive().template workspace<Scalar>()),
      free_q_(system.layout().free),
      free_qdot_(system.layout().free),
      tau_(system.coordinates()),
      length_(muscles_.size()),
      speed_(muscles_.size()),
      gradient_(system.pairs().size()),
      excitation_(muscles_.size()),
      activation_(muscles_.size()),
      fiber_(muscles_.size()),
      activation_rate_(muscles_.size()),
      fiber_velocity_(muscles_.size()),
      force_(muscles_.size()),
      fiber_solver_(muscles_.size()) {
  for (const DrivenMotion<double>& motion : system.reduction().default_motion()) {
    driven_.push_back({Scalar(motion.value), Scalar(0.0), Scalar(0.0)});
  }
}

template <typename Scalar>
void SystemEvaluator<Scalar>::hold(const Scalar* q) {
  const std::span<const int> driven = system_->reduction().driven();
  for (std::size_t i = 0; i < driven.size(); ++i) driven_[i].value = q[driven[i]];
}

template <typename Scalar>
void SystemEvaluator<Scalar>::update_paths() {
  const MusclePaths& paths = system_->paths();
  if (const FittedPaths* fit = system_->fit()) {
    fit->evaluate(paths, reduced_.kinematics(), q_, path_workspace_, length_.data(), gradient_.data());
  } else {
    paths.evaluate(reduced_.kinematics(), q_, path_workspace_);
    std::copy(path_workspace_.length.begin(), path_workspace_.length.end(), length_.begin());
    std::copy(path_workspace_.gradient.begin(), path_workspace_.gradient.end(), gradient_.begin());
  }
  std::fill(speed_.begin(), speed_.end(), Scalar(0.0));
  const auto pairs = system_->pairs();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    speed_[pairs[i].muscle] += gradient_[i] * qdot_[pairs[i].coordinate];
  }
}

template <typename Scalar>
void SystemEvaluator<Scalar>::set_motion(const Scalar* z, const Scalar* zdot) {
  reduced_.set_state(z, zdot, driven_.data());
  q_ = reduced_.state().q.data();
  qdot_ = reduced_.state().qdot.data();
  update_paths();
}

template <typename Scalar>
void SystemEvaluator<Scalar>::set_pose(const Scalar* q, const Scalar* qdot) {
  const std::span<const int> free = system_->reduction().free();
  for (std::size_t i = 0; i < free.size(); ++i) {
    free_q_[i] = q[free[i]];
    free_qdot_[i] = qdot[free[i]];
  }
  hold(q);
  set_motion(free_q_.data(), free_qdot_.data());
}

template <typename Scalar>
void SystemEvaluator<Scalar>::set_all(const Scalar* q, const Scalar* qdot) {
  reduced_.dynamics().set_state(q, qdot);
  q_ = q;
  qdot_ = qdot;
  update_paths();
}

template <typename Scalar>
void SystemEvaluator<Scalar>::read_muscles(const Scalar* x, const SystemInputs& inputs) {
  const StateLayout& layout = system_->layout();
  for (std::size_t m = 0; m < muscles_.size(); ++m) {
    excitation_[m] = Scalar(inputs.excitation[m]);
    activation_[m] = layout.activation[m] >= 0 ? x[layout.activation[m]] : excitation_[m];
    if (layout.fiber_length[m] >= 0) fiber_[m] = x[layout.fiber_length[m]];
  }
}

template <typename Scalar>
void SystemEvaluator<Scalar>::add_passive_forces(Scalar* tau) {
  add_coordinate_forces<Scalar>(system_->model(), q_, qdot_, tau);
  if (!system_->passive().empty())
    system_->passive().add(system_->mechanism(), reduced_.kinematics(), q_, qdot_, passive_, tau);
}

template <typename Scalar>
void SystemEvaluator<Scalar>::add_external_forces(const ExternalLoads* loads, double time, Scalar* tau) {
  if (loads != nullptr) muscle::add_external_forces(*loads, time, system_->mechanism(), reduced_.kinematics(), tau);
}

template <typename Scalar>
bool SystemEvaluator<Scalar>::write_rates(const Scalar* x, const SystemInputs& inputs, Scalar* rate) {
  const StateLayout& layout = system_->layout();
  if (inputs.coordinate_force.empty()) {
    std::fill(tau_.begin(), tau_.end(), Scalar(0.0));
  } else {
    for (std::size_t c = 0; c < tau_.size(); ++c) tau_[c] = Scalar(inputs.coordinate_force[c]);
  }
  const auto pairs = system_->pairs();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    tau_[pairs[i].coordinate] -= force_[pairs[i].muscle] * gradient_[i];
  }
  add_passive_forces(tau_.data());
  add_external_forces(inputs.external, inputs.time, tau_.data());
  for (std::size_t i = 0; i < layout.free; ++i) rate[i] = x[layout.free + i];
  if (!reduced_.forward_dynamics(tau_.data(), nullptr, rate + layout.free).usable()) return false;
  for (std::size_t m = 0; m < muscles_.size(); ++m) {
    if (layout.activation[m] >= 0) rate[layout.activation[m]] = activation_rate_[m];
    if (layout.fiber_length[m] >= 0) rate[layout.fiber_length[m]] = fiber_velocity_[m];
  }
  return true;
}

template <typename Scalar>
bool SystemEvaluator<Scalar>::derivative(const Scalar* x, const SystemInputs& inputs, Scalar* rate) {
  ++evaluations_;
  set_motion(x, x + system_->layout().free);
  read_muscles(x, inputs);
  muscles_.rates({excitation_, activation_, fiber_, length_, speed_}, {activation_rate_, fiber_velocity_, force_});
  return write_rates(x, inputs, rate);
}

template <typename Scalar>
bool SystemEvaluator<Scalar>::stage(double step, double* x, const SystemInputs& inputs,
                                    double* rate) requires std::same_as<Scalar, double> {
  // clang 14 compiles constrained members of explicit instantiations too.
  if constexpr (std::same_as<Scalar, double>) {
    if (step == 0.0) return derivative(x, inputs, rate);
    ++evaluations_;
    const StateLayout& layout = system_->layout();
    set_motion(x, x + layout.free);
    read_muscles(x, inputs);
    if (!fiber_solver_.solve(muscles_, step, {excitation_, activation_, fiber_, length_, speed_}, fiber_,
                             {activation_rate_, fiber_velocity_, force_}))
      return false;
    for (std::size_t m = 0; m < muscles_.size(); ++m) {
      if (layout.fiber_length[m] >= 0) x[layout.fiber_length[m]] = fiber_[m];
    }
    return write_rates(x, inputs, rate);
  }
  return false;
}

template <typename Scalar>
void SystemEvaluator<Scalar>::start_muscles(const Scalar* activation, Scalar* x) {
  const StateLayout& layout = system_->layout();
  for (std::size_t m = 0; m < muscles_.size(); ++m) {
    // As the activation dynamics: never below the least, never above 1.
    const Scalar least(muscles_.settings(m).minimum_activation);
    activation_[m] = activation[m] < least ? least : (activation[m] > 1.0 ? Scalar(1.0) : activation[m]);
    if (layout.activation[m] >= 0) x[layout.activation[m]] = activation_[m];
  }
  muscles_.equilibrium(activation_, length_, fiber_);
  for (std::size_t m = 0; m < muscles_.size(); ++m) {
    if (layout.fiber_length[m] >= 0) x[layout.fiber_length[m]] = fiber_[m];
  }
}

}  // namespace veridyn::muscle
