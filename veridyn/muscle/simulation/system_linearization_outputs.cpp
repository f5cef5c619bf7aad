// What outputs other than states need of the linearisation.
#include <cmath>

#include "veridyn/core/index.hpp"
#include "veridyn/muscle/simulation/system_linearization.hpp"

namespace veridyn::muscle {
namespace {

void add_scaled_row(double factor, const double* from, std::size_t count, double* to) {
  for (std::size_t j = 0; j < count; ++j) to[j] += factor * from[j];
}

}  // namespace

void SystemLinearization::add_force_tangent(std::size_t muscle, const double* S, double factor, double* row) const {
  const StateLayout& layout = system_->layout();
  const MuscleSlots& slots = slots_[muscle];
  const std::size_t p = columns_;
  const int a = layout.activation[muscle], l = layout.fiber_length[muscle];
  for (std::size_t k = 0; k < free_; ++k) {
    const auto m = static_cast<Eigen::Index>(muscle), column = static_cast<Eigen::Index>(k);
    add_scaled_row(factor * force_z_(m, column), S + k * p, p, row);
    add_scaled_row(factor * force_zd_(m, column), S + (free_ + k) * p, p, row);
  }
  if (live(muscle)) add_scaled_row(factor * slots.force[kActivation], S + at(a) * p, p, row);
  if (l >= 0) add_scaled_row(factor * slots.force[kFiber], S + at(l) * p, p, row);
  for (const TangentForcing& f : forcings_) {
    if (f.muscle == muscle) row[f.column] += factor * f.weight * slots.force[kField + f.field];
  }
}

void SystemLinearization::tendon_force_row(std::size_t muscle, const double* S, double* row) const {
  std::fill(row, row + columns_, 0.0);
  add_force_tangent(muscle, S, 1.0, row);
}

double SystemLinearization::fiber_length(std::size_t muscle, const double* x) const {
  const int l = system_->layout().fiber_length[muscle];
  if (l >= 0) return x[l];
  const MusculotendonParameters<double>& p = parameters_[muscle];
  return std::hypot(std::max(0.0, paths_->length()[muscle] - p.tendon_slack_length),
                    p.optimal_fiber_length * std::sin(p.pennation_angle_at_optimal));
}

void SystemLinearization::fiber_length_row(std::size_t muscle, const double* S, double* row) const {
  const int l = system_->layout().fiber_length[muscle];
  if (l >= 0) {
    std::copy(S + at(l) * columns_, S + at(l + 1) * columns_, row);
    return;
  }
  std::fill(row, row + columns_, 0.0);
  const MusculotendonParameters<double>& p = parameters_[muscle];
  const double sine = std::sin(p.pennation_angle_at_optimal), height = p.optimal_fiber_length * sine;
  const double along = std::max(0.0, paths_->length()[muscle] - p.tendon_slack_length);
  const double length = std::hypot(along, height);
  if (!(length > 0.0)) return;
  const double by_along = along / length, by_height = height / length;
  for (std::size_t k = 0; k < free_; ++k) add_scaled_row(by_along * arm_(muscle, k), S + k * columns_, columns_, row);
  for (const TangentForcing& f : forcings_) {
    if (f.muscle != muscle) continue;
    if (f.field == 1) row[f.column] += f.weight * by_height * sine;
    if (f.field == 2 && along > 0.0) row[f.column] -= f.weight * by_along;
    if (f.field == 3)
      row[f.column] += f.weight * by_height * p.optimal_fiber_length * std::cos(p.pennation_angle_at_optimal);
  }
}

double SystemLinearization::muscle_moment(int coordinate) const {
  double moment = 0.0;
  const auto pairs = system_->pairs();
  for (std::size_t p = 0; p < pairs.size(); ++p)
    moment -= force_[pairs[p].muscle] * paths_->gradient()[p] *
              system_->reduction().share_in(pairs[p].coordinate, coordinate, reduced_.state().slope.data());
  return moment;
}

void SystemLinearization::muscle_moment_row(int coordinate, const double* S, double* row) const {
  std::fill(row, row + columns_, 0.0);
  const auto pairs = system_->pairs();
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const int c = pairs[p].coordinate;
    const double share = system_->reduction().share_in(c, coordinate, reduced_.state().slope.data());
    if (share == 0.0) continue;
    const double force = force_[pairs[p].muscle];
    add_force_tangent(at(pairs[p].muscle), S, -paths_->gradient()[p] * share, row);
    for (std::size_t k = 0; k < free_; ++k)
      add_scaled_row(-force * share * paths_->curvature()[p * free_ + k], S + k * columns_, columns_, row);
    // The slope of a coupler changes along the coordinate that it follows.
    const int root = system_->reduction().free_root(c);
    if (jets_ && c != coordinate && root >= 0)
      add_scaled_row(-force * paths_->gradient()[p] * unit_speed_.bias(c), S + at(root) * columns_, columns_, row);
  }
}

}  // namespace veridyn::muscle
