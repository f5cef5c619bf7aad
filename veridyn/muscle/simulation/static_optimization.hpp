#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "veridyn/muscle/actuator/muscle_group.hpp"

namespace veridyn::muscle {

/// How a muscle's force follows from its activation in static optimisation. The tendon is rigid in all of them, so that
/// length and velocity of the fibre follow from the path.
enum class StaticForce {
  kAsOpenSim,    ///< a times the active force at full activation: passive force is left out, and Vmax is that of a = 1
  kWithPassive,  ///< the muscle's own force at activation a, passive force and a's effect on velocity included
  kIsometric,    ///< a F0 ("without muscle physiology")
};

/// Objective, reserves and accuracy of `StaticOptimizer`.
struct StaticOptimizationOptions {
  double exponent = 2.0;  ///< p > 1 of the sum of |a|^p over muscles and |c|^p over reserves
  StaticForce force = StaticForce::kAsOpenSim;
  /// Generalised force of a reserve actuator of each coordinate at control 1 [N m] or [N]; 0: none; empty: none at all.
  std::vector<double> reserve{};
  double reserve_bound = 1e300;  ///< greatest |control| of a reserve
  /// Unbalanced generalised force that counts as none, of 1 + the greatest required one.
  double tolerance = 1e-9;

  /// @throws InputError naming the option.
  void validate() const;
};

/// How a frame ended.
enum class StaticEnd {
  kBalanced,    ///< optimal, and forces balance to the tolerance
  kInfeasible,  ///< bounds leave no balance: the controls with the least sum of squares of what stays unbalanced
  kIterations,  ///< not finished in 200 iterations (not observed; a defect or NaN in the input)
};

/// The controls of one frame and how good they are.
struct StaticOptimizationFrame {
  Eigen::VectorXd activation;  ///< of each muscle
  Eigen::VectorXd force;       ///< of each muscle, as the formulation counts it [N]
  Eigen::VectorXd reserve;     ///< control of each coordinate's reserve; 0 without one
  Eigen::VectorXd unbalanced;  ///< required less achieved generalised force, less what loops carry
  Eigen::VectorXd multiplier;  ///< of each coordinate's balance: what one unit more would cost
  double cost = 0.0;
  int iterations = 0;
  StaticEnd end = StaticEnd::kIterations;
  [[nodiscard]] bool usable() const { return end == StaticEnd::kBalanced; }
};

/// Static optimisation, frame by frame: least sum of |control|^p of muscles and reserves such that
/// sum_m arm_mj F_m(a_m) + reserve_j c_j = tau_j for every coordinate j, min_control <= a <= max_control.
///
/// Solved through its dual: as many unknowns as there are coordinates, a concave function whose Newton steps end after
/// finitely many for p = 2 (it then is a quadratic programme, solved exactly) and converge quadratically otherwise;
/// where the required forces cannot be had it still has one solution, the least squares of what is missing. With
/// passive forces a muscle's force is not linear in a (Thelen): it is linearised again until it settles. Frames start
/// from the multipliers of the last one.
class StaticOptimizer {
 public:
  /// @throws InputError for wrong options or muscles, or bounds of a control that contradict each other.
  StaticOptimizer(std::span<const MuscleParameters> muscles, StaticOptimizationOptions options);
  ~StaticOptimizer();
  StaticOptimizer(StaticOptimizer&&) noexcept;
  StaticOptimizer& operator=(StaticOptimizer&&) noexcept;

  [[nodiscard]] const StaticOptimizationOptions& options() const { return options_; }

  /// `moment_arms`: muscles x coordinates, -d lMT/d q [m]; path lengths [m] and speeds [m/s] of the muscles; `required`
  /// generalised forces [N m]. With `directions` (orthonormal columns over the coordinates: the motions that closed
  /// loops allow) forces balance along these alone; what is across them the loops carry. Writes into `frame`, whose
  /// memory is reused.
  void solve(const Eigen::MatrixXd& moment_arms, const Eigen::VectorXd& path_length, const Eigen::VectorXd& path_speed,
             const Eigen::VectorXd& required, StaticOptimizationFrame& frame,
             const Eigen::MatrixXd* directions = nullptr);

  /// Forgets the last frame.
  void restart();

 private:
  struct Work;
  struct Balance {
    bool balanced = false;
    bool settled = false;  ///< activations have settled
  };
  void bound_controls(Eigen::Index muscles, const Eigen::MatrixXd* directions, Eigen::Index balances);
  [[nodiscard]] bool balance(const Eigen::MatrixXd& arms, const Eigen::VectorXd& required, double tolerance);
  [[nodiscard]] Balance balance_with_passive(const Eigen::MatrixXd& arms, std::span<const double> length,
                                             std::span<const double> speed, const Eigen::VectorXd& required,
                                             double tolerance, const Eigen::VectorXd& start);
  void fill(const Eigen::MatrixXd& arms, const Eigen::VectorXd& required, const Eigen::MatrixXd* directions,
            StaticOptimizationFrame& frame);

  StaticOptimizationOptions options_;
  std::unique_ptr<Work> work_;
};

}  // namespace veridyn::muscle
