#include "veridyn/muscle/simulation/metabolic_cost.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"

namespace veridyn::muscle {
namespace {

MetabolicRate umberger(const MusculotendonParameters<double>& muscle, const MuscleDetails& d, double u, double r,
                       double mass, double S) {
  const double a = d.activation, A = u > a ? u : 0.5 * (u + a);
  const double v = d.fiber_velocity / muscle.optimal_fiber_length / muscle.max_contraction_velocity;
  const bool stretched = d.fiber_length > muscle.optimal_fiber_length;
  const double FL = stretched ? d.active_length : 1.0;
  MetabolicRate rate;
  rate.activation_and_maintenance =
      mass * S * std::pow(A, 0.6) * (128.0 * (1.0 - r) + 25.0) * (stretched ? 0.4 + 0.6 * FL : 1.0);
  if (v <= 0.0) {
    rate.shortening = mass * S * A * A * FL * (std::min(-250.0 * v, 100.0) * r - 153.0 * v * (1.0 - r));
  } else {
    rate.shortening = mass * S * A * FL * 1000.0 * v;
  }
  return rate;
}

double maintenance_by_length(double l) {
  if (l <= 0.5) return 0.5;
  if (l <= 1.0) return l;
  return std::max(0.0, 3.0 - 2.0 * l);
}

MetabolicRate bhargava(const MusculotendonParameters<double>& muscle, const MuscleDetails& d, double u, double r,
                       double mass) {
  const double angle = 0.5 * kPi * u;
  const double slow = r * std::sin(angle), fast = (1.0 - r) * (1.0 - std::cos(angle));
  MetabolicRate rate;
  rate.activation_and_maintenance =
      mass * (40.0 * slow + 133.0 * fast +
              maintenance_by_length(d.fiber_length / muscle.optimal_fiber_length) * (74.0 * slow + 111.0 * fast));
  const double isometric = muscle.max_isometric_force * d.activation * d.active_length;
  const double constant = d.fiber_velocity <= 0.0 ? 0.16 * isometric + 0.18 * d.active_force : 0.157 * d.active_force;
  rate.shortening = -constant * d.fiber_velocity;
  return rate;
}

}  // namespace

double muscle_mass(const MusculotendonParameters<double>& muscle, const MetabolicOptions& options) {
  return options.density * muscle.max_isometric_force * muscle.optimal_fiber_length / options.specific_tension;
}

MetabolicRate metabolic_rate(const MusculotendonParameters<double>& muscle, const MuscleDetails& state,
                             double excitation, double slow_twitch, const MetabolicOptions& options) {
  const double mass = muscle_mass(muscle, options), u = std::clamp(excitation, 0.0, 1.0);
  MetabolicRate rate = options.model == MetabolicModel::kUmberger2003
                           ? umberger(muscle, state, u, slow_twitch, mass, options.aerobic_factor)
                           : bhargava(muscle, state, u, slow_twitch, mass);
  rate.work = -state.active_force * state.fiber_velocity;
  constexpr double kLeastHeat = 1.0;  // [W/kg], Umberger et al. (2003)
  const double heat = std::max(rate.activation_and_maintenance + rate.shortening, kLeastHeat * mass);
  rate.total = std::max(0.0, heat + rate.work);
  return rate;
}

MetabolicCost metabolic_cost(const MusculoskeletalSystem& system, const MuscleTrajectory& motion,
                             const MetabolicOptions& options) {
  MetabolicCost cost;
  const auto rows = motion.q.rows(), muscles = motion.activation.cols();
  cost.power.setZero(rows, muscles);
  for (const Body& body : system.model().bodies) cost.basal += options.basal_rate * body.mass;
  SystemEvaluator<double> evaluator(system);
  const bool excited = motion.excitation.rows() == rows;
  for (Eigen::Index row = 0; row < rows; ++row) {
    const Eigen::VectorXd q = motion.q.row(row), qdot = motion.qdot.row(row);
    evaluator.set_all(q.data(), qdot.data());
    for (Eigen::Index m = 0; m < muscles; ++m) {
      const double a = motion.activation(row, m), u = excited ? motion.excitation(row, m) : a;
      const MuscleDetails state = system.muscles().details(m, u, a, motion.fiber_length(row, m),
                                                           evaluator.path_length()[m], evaluator.path_speed()[m]);
      const double slow = options.slow_twitch.empty() ? 0.5 : options.slow_twitch[m];
      cost.power(row, m) = metabolic_rate(system.muscles().settings(m).musculotendon, state, u, slow, options).total;
    }
  }
  for (Eigen::Index row = 1; row < rows; ++row) {
    const double step = motion.time[row] - motion.time[row - 1];
    cost.energy += step * (cost.basal + 0.5 * (cost.power.row(row).sum() + cost.power.row(row - 1).sum()));
  }
  return cost;
}

}  // namespace veridyn::muscle
