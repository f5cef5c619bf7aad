#pragma once

#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/regression/regression_data.hpp"
#include "veridyn/muscle/model/signals.hpp"
#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"
#include "veridyn/muscle/simulation/static_optimization.hpp"

namespace veridyn::muscle {

/// A prescribed motion, frame by frame: matrices are frames x coordinates or frames x muscles.
struct MotionAnalysis {
  std::vector<double> time;                       ///< [s]
  estimation::RowMatrix q, qdot, qddot;           ///< coordinates without a motion rest; coupled ones follow
  estimation::RowMatrix moment;                   ///< generalised forces that the motion needs [N m or N]
  estimation::RowMatrix external;                 ///< those of the surroundings, which `moment` is less; empty: none
  estimation::RowMatrix path_length, path_speed;  ///< [m], [m/s]
  // Of static optimisation; empty otherwise.
  estimation::RowMatrix activation;
  estimation::RowMatrix force;          ///< of each muscle, as the formulation counts it [N]
  estimation::RowMatrix reserve;        ///< generalised force of the reserves [N m or N]
  std::vector<std::size_t> infeasible;  ///< frames whose moments could not be produced
  /// How far the motion leaves a closed loop open, where it does so most.
  struct LoopGap {
    std::string constraint;  ///< empty: the model has no loops
    double error = 0.0;      ///< largest error of an equation of a loop [m or 1]
    double time = 0.0;       ///< [s]
  } loop_gap;
  bool interrupted = false;
};

/// By coordinate, at values `q` of all: dq over the free coordinate that it follows; 1 where it follows none.
[[nodiscard]] Eigen::VectorXd coupled_slopes(const Eigen::VectorXd& q, const CoordinateReduction& reduction);

/// Instants from `begin` to `end`, `rate_Hz` apart.
[[nodiscard]] std::vector<double> frame_times(double begin, double end, double rate_Hz);

/// Inverse dynamics of a motion: M qddot + h as in `inverse_dynamics`, for every coordinate, less what the motion's
/// external loads contribute. `rest` gives coordinates that are not in the motion. Of a model with closed loops less
/// what the loops' forces contribute: these are such that the generalised forces left of the free coordinates have the
/// least sum of squares, which no motion of the loops changes.
[[nodiscard]] MotionAnalysis analyse_motion(const MusculoskeletalSystem& system, const Motion& motion,
                                            const Eigen::VectorXd& rest, const std::vector<double>& time);

/// The same, and the muscles that produce these moments: static optimisation of every frame over the free coordinates
/// (moments of coupled coordinates count at the ones they follow; locked ones need none), along the motions that closed
/// loops allow. Limit forces of the model are subtracted first.
[[nodiscard]] MotionAnalysis optimise_motion(const MusculoskeletalSystem& system, const Motion& motion,
                                             const Eigen::VectorXd& rest, const std::vector<double>& time,
                                             const StaticOptimizationOptions& options, Progress& progress);

}  // namespace veridyn::muscle
