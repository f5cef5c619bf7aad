#include "veridyn/muscle/simulation/system_linearization.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/muscle/dynamics/coordinate_forces.hpp"

namespace veridyn::muscle {

/// The skeleton on jets, for joints of several axes and coupled coordinates.
struct SystemLinearization::JetSkeleton {
  explicit JetSkeleton(const MusculoskeletalSystem& system)
      : state(static_cast<int>(system.coordinates())),
        dynamics(system.mechanism()),
        z(system.reduction().free().size()),
        zdot(z.size()),
        qddot(system.coordinates()),
        tau(system.coordinates()),
        passive_tau(system.coordinates()),
        passive(system.passive().workspace<SimulationJet>()),
        ones(z.size(), 1.0) {
    for (const DrivenMotion<double>& m : system.reduction().default_motion())
      driven.push_back({SimulationJet(m.value), SimulationJet(0.0), SimulationJet(0.0)});
  }
  ExpandedState<SimulationJet> state;
  Dynamics<SimulationJet> dynamics;
  std::vector<SimulationJet> z, zdot, qddot, tau, passive_tau;
  PassiveWorkspace<SimulationJet> passive;
  std::vector<DrivenMotion<SimulationJet>> driven;
  std::vector<double> ones;
};

SystemLinearization::SystemLinearization(const MusculoskeletalSystem& system,
                                         std::span<const MusculotendonParameters<double>> parameters,
                                         std::vector<TangentForcing> forcings, std::size_t columns)
    : system_(&system),
      free_(system.layout().free),
      columns_(columns),
      forcings_(std::move(forcings)),
      parameters_(parameters.begin(), parameters.end()),
      reduced_(system.mechanism(), system.reduction()),
      unit_speed_(static_cast<int>(system.coordinates())),
      driven_(system.reduction().default_motion()),
      paths_(make_path_derivatives(system)),
      muscles_(system.muscles().with<double>(parameters)),
      fiber_solver_(muscles_.size()),
      passive_(system.passive().workspace<double>()) {
  system.refuse_loops("a simulation with derivatives (estimation)");
  const std::size_t muscles = system.muscles().size();
  if (InverseDynamicsDerivatives::available(system.mechanism()) && system.reduction().free_are_uncoupled() &&
      system.passive().empty()) {
    closed_form_.emplace(system.mechanism(), system.reduction().free());
  } else {
    jets_ = std::make_shared<JetSkeleton>(system);
  }
  live_activation_.assign(muscles, 0);
  for (const TangentForcing& f : forcings_) {
    const bool moves_activation = f.field == 5 || f.field == 6 || f.field == TangentForcing::kExcitation;
    if (moves_activation && system.layout().activation[f.muscle] >= 0) live_activation_[f.muscle] = 1;
  }
  make_passes(parameters_);
  for (auto* jets : {&in_activation_, &in_excitation_, &in_fiber_, &in_length_, &in_speed_, &out_activation_,
                     &out_velocity_, &out_force_}) {
    jets->resize(muscles);
  }
  slots_.resize(muscles);
  for (auto* values :
       {&activation_rate_, &fiber_velocity_, &force_, &path_speed_, &activation_, &fiber_, &solved_velocity_})
    values->resize(muscles);
  const auto n = static_cast<Eigen::Index>(free_), m = static_cast<Eigen::Index>(muscles);
  for (Matrix* matrix : {&arm_, &force_z_, &force_zd_, &speed_z_, &velocity_z_}) matrix->setZero(m, n);
  for (Matrix* matrix : {&mass_, &mass_inverse_, &r_z_, &r_zd_, &acc_z_, &acc_zd_}) matrix->setZero(n, n);
  acc_force_.setZero(n, m);
  const auto coordinates = static_cast<Eigen::Index>(system.coordinates());
  for (Eigen::VectorXd* vector : {&tau_, &residual_tau_, &qddot_}) vector->setZero(coordinates);
  for (Eigen::VectorXd* vector : {&residual_, &acceleration_}) vector->setZero(n);
}

void SystemLinearization::make_passes(std::span<const MusculotendonParameters<double>> parameters) {
  const std::size_t muscles = system_->muscles().size();
  std::vector<std::vector<std::size_t>> wanted(muscles);
  for (const TangentForcing& f : forcings_) {
    // Everything is proportional to F0, and an excitation without dynamics is the activation.
    if (f.field == 0 || (f.field == TangentForcing::kExcitation && system_->layout().activation[f.muscle] < 0))
      continue;
    auto& list = wanted[f.muscle];
    if (std::find(list.begin(), list.end(), f.field) == list.end()) list.push_back(f.field);
  }
  std::size_t count = 1;
  for (const auto& list : wanted) count = std::max(count, (list.size() + 2) / 3);
  for (std::size_t p = 0; p < count; ++p) {
    Pass pass;
    std::vector<MusculotendonParameters<SimulationJet>> jets;
    for (std::size_t m = 0; m < muscles; ++m) {
      jets.push_back(parameters[m].cast<SimulationJet>());
      std::array<std::size_t, 3> field{kNone, kNone, kNone};
      for (std::size_t i = 0; i < 3 && 3 * p + i < wanted[m].size(); ++i) {
        field[i] = wanted[m][3 * p + i];
        if (field[i] != TangentForcing::kExcitation) field_of(jets.back(), field[i]).v(3 + i) = 1.0;
      }
      pass.field.push_back(field);
    }
    pass.muscles = system_->muscles().with<SimulationJet>(jets);
    passes_.push_back(std::move(pass));
  }
}

void SystemLinearization::hold(const double* q) {
  const std::span<const int> driven = system_->reduction().driven();
  for (std::size_t i = 0; i < driven.size(); ++i) {
    driven_[i].value = q[driven[i]];
    if (jets_) jets_->driven[i].value = SimulationJet(q[driven[i]]);
  }
}

/// Path lengths, their derivatives, and speeds at the motion set.
void SystemLinearization::set_paths() {
  const ExpandedState<double>& s = reduced_.state();
  paths_->evaluate(s.q.data(), s.slope.data());
  arm_.setZero();
  speed_z_.setZero();
  std::fill(path_speed_.begin(), path_speed_.end(), 0.0);
  const auto pairs = system_->pairs();
  const std::span<const double> gradient = paths_->gradient(), curvature = paths_->curvature();
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const int m = pairs[p].muscle, c = pairs[p].coordinate;
    path_speed_[m] += gradient[p] * s.qdot(c);
    const int root = system_->reduction().free_root(c);
    if (root >= 0) arm_(m, root) += gradient[p] * s.slope(c);
    if (system_->muscles().has_fiber_state(at(m))) continue;
    for (std::size_t k = 0; k < free_; ++k) speed_z_(m, k) += curvature[p * free_ + k] * s.qdot(c);
    // A coupled coordinate's speed is slope(z) zdot.
    if (root >= 0 && jets_)
      speed_z_(m, root) += gradient[p] * unit_speed_.bias(c) * s.qdot(system_->reduction().free()[root]);
  }
}

void SystemLinearization::evaluate_muscles(const double* x, const SystemInputs& inputs) {
  const StateLayout& layout = system_->layout();
  const std::size_t muscles = force_.size();
  for (std::size_t m = 0; m < muscles; ++m) {
    in_excitation_[m] = SimulationJet(inputs.excitation[m]);
    in_activation_[m] = SimulationJet(layout.activation[m] >= 0 ? x[layout.activation[m]] : inputs.excitation[m], 0);
    if (layout.activation[m] < 0) in_excitation_[m] = in_activation_[m];
    in_length_[m] = SimulationJet(paths_->length()[m], 2);
    if (layout.fiber_length[m] >= 0) {
      in_fiber_[m] = SimulationJet(x[layout.fiber_length[m]], 1);
      in_speed_[m] = SimulationJet(0.0);
    } else {
      in_fiber_[m] = SimulationJet(0.0);
      in_speed_[m] = SimulationJet(path_speed_[m], 1);
    }
  }
  for (std::size_t p = 0; p < passes_.size(); ++p) {
    const Pass& pass = passes_[p];
    for (std::size_t m = 0; m < muscles; ++m) {
      if (layout.activation[m] < 0) continue;
      for (Eigen::Index i = 0; i < 3; ++i)
        in_excitation_[m].v(3 + i) = pass.field[m][i] == TangentForcing::kExcitation ? 1.0 : 0.0;
    }
    muscle_rates(pass.muscles, {in_excitation_, in_activation_, in_fiber_, in_length_, in_speed_},
                 {out_activation_, out_velocity_, out_force_});
    for (std::size_t m = 0; m < muscles; ++m) {
      MuscleSlots& slots = slots_[m];
      const auto take = [&](std::size_t slot, Eigen::Index direction) {
        slots.activation_rate[slot] = out_activation_[m].v(direction);
        slots.fiber_velocity[slot] = out_velocity_[m].v(direction);
        slots.force[slot] = out_force_[m].v(direction);
      };
      if (p == 0) {
        activation_rate_[m] = out_activation_[m].a;
        fiber_velocity_[m] = out_velocity_[m].a;
        force_[m] = out_force_[m].a;
        take(kActivation, 0);
        take(layout.fiber_length[m] >= 0 ? kFiber : kSpeed, 1);
        take(kPath, 2);
        slots.force[kField] = force_[m] / parameters_[m].max_isometric_force;
        if (layout.activation[m] < 0) slots.force[kField + TangentForcing::kExcitation] = slots.force[kActivation];
        if (layout.activation[m] < 0)
          slots.fiber_velocity[kField + TangentForcing::kExcitation] = slots.fiber_velocity[kActivation];
      }
      for (std::size_t i = 0; i < 3; ++i) {
        if (pass.field[m][i] != kNone) take(kField + pass.field[m][i], 3 + i);
      }
    }
  }
}

/// Accelerations: J' M J zddot = J' (tau - h - M bias).
bool SystemLinearization::evaluate_skeleton(const SystemInputs& inputs, double* acceleration) {
  VERIDYN_ASSERT(inputs.external == nullptr);  // their derivatives by the pose are not among the equations
  const CoordinateReduction& reduction = system_->reduction();
  const ExpandedState<double>& s = reduced_.state();
  Dynamics<double>& dynamics = reduced_.dynamics();
  const Mechanism& mechanism = system_->mechanism();
  for (Eigen::Index c = 0; c < tau_.size(); ++c)
    tau_(c) = inputs.coordinate_force.empty() ? 0.0 : inputs.coordinate_force[c];
  const auto pairs = system_->pairs();
  for (std::size_t p = 0; p < pairs.size(); ++p)
    tau_(pairs[p].coordinate) -= force_[pairs[p].muscle] * paths_->gradient()[p];
  add_coordinate_forces<double>(system_->model(), s.q.data(), s.qdot.data(), tau_.data());
  if (!system_->passive().empty())
    system_->passive().add(mechanism, dynamics.kinematics(), s.q.data(), s.qdot.data(), passive_, tau_.data());
  dynamics.inverse_dynamics(s.bias.data(), nullptr, residual_tau_.data());
  dynamics.update_mass_rows();
  mass_.setZero();
  residual_.setZero();
  for (int c = 0; c < mechanism.coordinates(); ++c) {
    const int i = reduction.free_root(c);
    if (i < 0) continue;
    residual_(i) += s.slope(c) * (tau_(c) - residual_tau_(c));
    const double* row = dynamics.mass_row(c);
    for (const int d : mechanism.chain(c)) {
      const double entry = *row++;
      const int j = reduction.free_root(d);
      if (j < 0) continue;
      const double value = s.slope(c) * s.slope(d) * entry;
      mass_(i, j) += value;
      if (c != d) mass_(j, i) += value;
    }
  }
  // Inverse by Gauss-Jordan steps on the diagonal: the matrix is positive definite.
  mass_inverse_ = mass_;
  const auto n = static_cast<Eigen::Index>(free_);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double pivot = mass_inverse_(k, k);
    if (!(pivot > Dynamics<double>::kSingularPivot * mass_(k, k))) return false;
    const double inverse = 1.0 / pivot;
    mass_inverse_(k, k) = 1.0;
    for (Eigen::Index j = 0; j < n; ++j) mass_inverse_(k, j) *= inverse;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (i == k) continue;
      const double factor = mass_inverse_(i, k);
      mass_inverse_(i, k) = 0.0;
      for (Eigen::Index j = 0; j < n; ++j) mass_inverse_(i, j) -= factor * mass_inverse_(k, j);
    }
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    double sum = 0.0;
    for (Eigen::Index j = 0; j < n; ++j) sum += mass_inverse_(i, j) * residual_(j);
    acceleration[i] = acceleration_(i) = sum;
  }
  qddot_ = s.bias;
  for (int c = 0; c < mechanism.coordinates(); ++c) {
    const int i = reduction.free_root(c);
    if (i >= 0) qddot_(c) += s.slope(c) * acceleration[i];
  }
  dynamics.inverse_dynamics(qddot_.data(), nullptr, residual_tau_.data());
  return true;
}

/// Derivatives of r_i = sum over coordinates c that follow i of slope_c (tau_c - (M qddot + h)_c), zddot held.
void SystemLinearization::differentiate_residual() {
  const CoordinateReduction& reduction = system_->reduction();
  const ExpandedState<double>& s = reduced_.state();
  r_z_.setZero();
  r_zd_.setZero();
  const auto n = static_cast<Eigen::Index>(free_);
  for (Eigen::Index m = 0; m < arm_.rows(); ++m) {
    const MuscleSlots& slots = slots_[m];
    for (Eigen::Index k = 0; k < n; ++k) {
      velocity_z_(m, k) = slots.fiber_velocity[kPath] * arm_(m, k);
      force_z_(m, k) = slots.force[kPath] * arm_(m, k) + slots.force[kSpeed] * speed_z_(m, k);
      force_zd_(m, k) = slots.force[kSpeed] * arm_(m, k);
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index k = 0; k < n; ++k) {
        r_z_(i, k) -= arm_(m, i) * force_z_(m, k);
        r_zd_(i, k) -= arm_(m, i) * force_zd_(m, k);
      }
    }
  }
  const auto pairs = system_->pairs();
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const int i = reduction.free_root(pairs[p].coordinate);
    if (i < 0) continue;
    const double factor = force_[pairs[p].muscle] * s.slope(pairs[p].coordinate);
    for (Eigen::Index k = 0; k < n; ++k) r_z_(i, k) -= factor * paths_->curvature()[p * free_ + k];
  }
  const auto add = [&](int c, const auto& force) {
    const int i = reduction.free_root(c);
    if (i < 0) return;
    const PathJet tau = force(PathJet(s.q(c), 0), PathJet(s.qdot(c), 1));
    const double zdot = s.qdot(reduction.free()[i]);
    const double speed_by_value = jets_ ? unit_speed_.bias(c) * zdot : 0.0;
    r_z_(i, i) += s.slope(c) * (tau.v(0) * s.slope(c) + tau.v(1) * speed_by_value);
    r_zd_(i, i) += s.slope(c) * tau.v(1) * s.slope(c);
  };
  for (const CoordinateLimitForce& limit : system_->model().limit_forces)
    add(limit.coordinate, [&](const PathJet& q, const PathJet& qdot) { return limit_force(limit, q, qdot); });
  for (const CoordinateSpring& spring : system_->model().coordinate_springs)
    add(spring.coordinate, [&](const PathJet& q, const PathJet& qdot) { return spring_force(spring, q, qdot); });
}

void SystemLinearization::differentiate_skeleton() {
  if (!closed_form_) return differentiate_skeleton_by_jets();
  closed_form_->evaluate(reduced_.dynamics());
  r_z_ -= closed_form_->by_value();
  r_zd_ -= closed_form_->by_speed();
}

void SystemLinearization::differentiate_skeleton_by_jets() {
  JetSkeleton& jets = *jets_;
  const CoordinateReduction& reduction = system_->reduction();
  const ExpandedState<double>& s = reduced_.state();
  constexpr auto kWidth = static_cast<std::size_t>(SimulationJet::DIMENSION);
  for (std::size_t first = 0; first < 2 * free_; first += kWidth) {
    const std::size_t count = std::min(kWidth, 2 * free_ - first);
    for (std::size_t i = 0; i < free_; ++i) {
      const int c = reduction.free()[i];
      jets.z[i] = SimulationJet(s.q(c));
      jets.zdot[i] = SimulationJet(s.qdot(c));
    }
    for (std::size_t j = 0; j < count; ++j) {
      const std::size_t k = first + j;
      (k < free_ ? jets.z[k] : jets.zdot[k - free_]).v(j) = 1.0;
    }
    expand(reduction, jets.z.data(), jets.zdot.data(), jets.driven.data(), jets.state);
    for (std::size_t c = 0; c < jets.qddot.size(); ++c) {
      const int i = reduction.free_root(static_cast<int>(c));
      jets.qddot[c] = jets.state.bias(c);
      if (i >= 0) jets.qddot[c] += jets.state.slope(c) * acceleration_(i);
    }
    jets.dynamics.set_state(jets.state.q.data(), jets.state.qdot.data());
    jets.dynamics.inverse_dynamics(jets.qddot.data(), nullptr, jets.tau.data());
    if (!system_->passive().empty()) {
      std::fill(jets.passive_tau.begin(), jets.passive_tau.end(), SimulationJet(0.0));
      system_->passive().add(system_->mechanism(), jets.dynamics.kinematics(), jets.state.q.data(),
                             jets.state.qdot.data(), jets.passive, jets.passive_tau.data());
      for (std::size_t c = 0; c < jets.tau.size(); ++c)
        jets.tau[c] -= jets.passive_tau[c] - SimulationJet(jets.passive_tau[c].a);  // its value is in tau_
    }
    for (std::size_t c = 0; c < jets.tau.size(); ++c) {
      const int i = reduction.free_root(static_cast<int>(c));
      if (i < 0) continue;
      // With what the coordinate's force leaves, which couplers carry: their slopes change too.
      const SimulationJet left = jets.state.slope(c) * (SimulationJet(tau_(c)) - jets.tau[c]);
      for (std::size_t j = 0; j < count; ++j) {
        const std::size_t k = first + j;
        const auto column = static_cast<Eigen::Index>(k % free_);
        (k < free_ ? r_z_ : r_zd_)(i, column) += left.v(j);
      }
    }
  }
}

void SystemLinearization::assemble() {
  const auto n = static_cast<Eigen::Index>(free_);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < n; ++k) {
      double by_value = 0.0, by_speed = 0.0;
      for (Eigen::Index j = 0; j < n; ++j) {
        by_value += mass_inverse_(i, j) * r_z_(j, k);
        by_speed += mass_inverse_(i, j) * r_zd_(j, k);
      }
      acc_z_(i, k) = by_value;
      acc_zd_(i, k) = by_speed;
    }
    for (Eigen::Index m = 0; m < arm_.rows(); ++m) {
      double sum = 0.0;
      for (Eigen::Index j = 0; j < n; ++j) sum -= mass_inverse_(i, j) * arm_(m, j);
      acc_force_(i, m) = sum;
    }
  }
}

void SystemLinearization::set_motion(const double* x) {
  if (jets_) expand(system_->reduction(), x, jets_->ones.data(), driven_.data(), unit_speed_);
  reduced_.set_state(x, x + free_, driven_.data());
  set_paths();
}

bool SystemLinearization::derivative(const double* x, const SystemInputs& inputs, double* rate) {
  set_motion(x);
  return linearise(x, inputs, rate);
}

bool SystemLinearization::stage(double step, double* x, const SystemInputs& inputs, double* rate) {
  if (step == 0.0) return derivative(x, inputs, rate);
  set_motion(x);
  if (!solve_fibers(step, x, inputs)) return false;
  if (!linearise(x, inputs, rate)) return false;
  // The velocities of the solution itself: those at its lengths have its rounding many times over.
  const StateLayout& layout = system_->layout();
  for (std::size_t m = 0; m < force_.size(); ++m) {
    if (layout.fiber_length[m] >= 0) rate[layout.fiber_length[m]] = solved_velocity_[m];
  }
  return true;
}

/// Fibre lengths in x, and their velocities at them.
bool SystemLinearization::solve_fibers(double step, double* x, const SystemInputs& inputs) {
  const StateLayout& layout = system_->layout();
  for (std::size_t m = 0; m < force_.size(); ++m) {
    activation_[m] = layout.activation[m] >= 0 ? x[layout.activation[m]] : inputs.excitation[m];
    if (layout.fiber_length[m] >= 0) fiber_[m] = x[layout.fiber_length[m]];
  }
  if (!fiber_solver_.solve(muscles_, step, {inputs.excitation, activation_, fiber_, paths_->length(), path_speed_},
                           fiber_, {activation_rate_, solved_velocity_, force_}))
    return false;
  for (std::size_t m = 0; m < force_.size(); ++m) {
    if (layout.fiber_length[m] >= 0) x[layout.fiber_length[m]] = fiber_[m];
  }
  return true;
}

bool SystemLinearization::linearise(const double* x, const SystemInputs& inputs, double* rate) {
  const StateLayout& layout = system_->layout();
  evaluate_muscles(x, inputs);
  for (std::size_t i = 0; i < free_; ++i) rate[i] = x[free_ + i];
  if (!evaluate_skeleton(inputs, rate + free_)) return false;
  for (std::size_t m = 0; m < force_.size(); ++m) {
    if (layout.activation[m] >= 0) rate[layout.activation[m]] = activation_rate_[m];
    if (layout.fiber_length[m] >= 0) rate[layout.fiber_length[m]] = fiber_velocity_[m];
  }
  differentiate_residual();
  differentiate_skeleton();
  assemble();
  return true;
}

}  // namespace veridyn::muscle
