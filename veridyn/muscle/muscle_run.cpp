#include "veridyn/muscle/muscle_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/muscle/inverse_dynamics.hpp"
#include "veridyn/muscle/wished_motion.hpp"

namespace veridyn::muscle {
namespace {

std::vector<double> row_times(const MuscleStudy& study) {
  const double span = study.end - study.begin;
  const auto last = static_cast<std::size_t>(std::floor(span * study.rate_Hz * (1.0 + 1e-12) + 1e-9));
  std::vector<double> times;
  for (std::size_t i = 0; i <= last; ++i) times.push_back(study.begin + static_cast<double>(i) / study.rate_Hz);
  return times;
}

MuscleResult forward(const MuscleStudy& study, Progress& progress) {
  progress.stage(fmt::format("simulating {:g} s of {}", study.end - study.begin, study.title));
  const ForwardOptions options{
      .begin = study.begin, .end = study.end, .rate_Hz = study.rate_Hz, .accuracy = study.accuracy};
  MuscleResult result;
  result.trajectory = simulate_forward(*study.system, study.start, study.drive, options, progress);
  result.drive = study.drive;
  return result;
}

/// The wished motion row by row with path lengths and the forces it needs.
MuscleResult along_the_wish(const MuscleStudy& study, Progress& progress) {
  const MusculoskeletalSystem& system = *study.system;
  MuscleResult result;
  MuscleTrajectory& t = result.trajectory;
  t.time = row_times(study);
  const auto rows = static_cast<Eigen::Index>(t.time.size());
  const auto n = static_cast<Eigen::Index>(system.coordinates());
  t.q.resize(rows, n);
  t.qdot.resize(rows, n);
  t.path_length.resize(rows, static_cast<Eigen::Index>(system.muscles().size()));
  result.generalized_force.resize(rows, n);
  SystemEvaluator<double> evaluator(system);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const WishedState wish = evaluate_motion(system.reduction(), study.motion, t.time[static_cast<std::size_t>(i)]);
    t.q.row(i) = wish.q;
    t.qdot.row(i) = wish.qdot;
    result.generalized_force.row(i) = inverse_dynamics(system.mechanism(), wish.q, wish.qdot, wish.qddot);
    evaluator.set_all(wish.q.data(), wish.qdot.data());
    for (std::size_t m = 0; m < system.muscles().size(); ++m)
      t.path_length(i, static_cast<Eigen::Index>(m)) = evaluator.path_length()[m];
    if (!progress.update(static_cast<double>(i + 1) / static_cast<double>(rows))) {
      t.end = SimulationEnd::kInterrupted;
      break;
    }
  }
  t.end_time = t.time.back();
  result.wished = t.q;
  return result;
}

MuscleResult inverse(const MuscleStudy& study, Progress& progress) {
  progress.stage("inverse dynamics");
  return along_the_wish(study, progress);
}

MuscleResult follow(const MuscleStudy& study, Progress& progress) {
  progress.stage(fmt::format("computed muscle control of {:g} s", study.end - study.begin));
  ControlResult found = computed_muscle_control(*study.system, study.motion, study.control, progress);
  MuscleResult result;
  result.trajectory = std::move(found.trajectory);
  result.wished = std::move(found.wished);
  result.drive = std::move(found.drive);
  result.overloaded = std::move(found.overloaded);
  if (!result.overloaded.empty()) {
    result.warnings.push_back(
        fmt::format("in {} of the windows, the first at {:g} s, the muscles could not make the wished acceleration and "
                    "the reserves did more than their force",
                    result.overloaded.size(), result.overloaded.front()));
  }
  return result;
}

}  // namespace

double MuscleResult::tracking_error(std::size_t coordinate) const {
  if (wished.rows() == 0 || wished.rows() != trajectory.q.rows()) return 0.0;
  const auto c = static_cast<Eigen::Index>(coordinate);
  return (trajectory.q.col(c) - wished.col(c)).cwiseAbs().maxCoeff();
}

MuscleResult run_muscle_study(const MuscleStudy& study, Progress& progress) {
  MuscleResult result;
  switch (study.method) {
    case MuscleMethod::kForward:
      result = forward(study, progress);
      break;
    case MuscleMethod::kInverseDynamics:
      result = inverse(study, progress);
      break;
    case MuscleMethod::kStaticOptimization:
      throw InputError("motion.method", "static optimization is not there yet");
    case MuscleMethod::kComputedMuscleControl:
      result = follow(study, progress);
      break;
  }
  result.notes = study.system->notes();
  result.warnings.insert(result.warnings.begin(), study.warnings.begin(), study.warnings.end());
  return result;
}

}  // namespace veridyn::muscle
