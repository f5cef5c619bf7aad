#include "veridyn/muscle/study/muscle_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/simulation/motion_analysis.hpp"
#include "veridyn/muscle/simulation/wrap_bands.hpp"

namespace veridyn::muscle {
namespace {

/// What joints transmit in the result's motion, with accelerations where it has them.
std::optional<JointReactions> reactions_of(const MuscleStudy& study, const MuscleTrajectory& t,
                                           const estimation::RowMatrix& qddot) {
  if (!study.reactions) return std::nullopt;
  const MovedModel moved{.time = t.time,
                         .q = t.q,
                         .qdot = t.qdot,
                         .qddot = qddot,
                         .tendon_force = t.tendon_force,
                         .reserve = t.reserve,
                         .external = study.motion.external.get(),
                         .passive = study.method != MuscleMethod::kInverseDynamics};
  return joint_reactions(*study.system, moved, *study.reactions);
}

/// What each force contributes to the accelerations of the result's motion.
std::optional<InducedAccelerations> induced_of(const MuscleStudy& study, const MuscleTrajectory& t) {
  if (!study.induced_accelerations) return std::nullopt;
  return induced_accelerations(*study.system, {.time = t.time,
                                               .q = t.q,
                                               .qdot = t.qdot,
                                               .qddot = {},
                                               .tendon_force = t.tendon_force,
                                               .reserve = t.reserve,
                                               .external = study.motion.external.get()});
}

/// Looks at the external loads of an analysed motion.
void check_loads(const MuscleStudy& study, const MotionAnalysis& analysis, MuscleResult& result) {
  if (!study.motion.external || analysis.interrupted) return;
  result.external_fit = external_load_fit(*study.system, analysis);
  for (std::string& warning : external_load_warnings(*study.system, *study.motion.external, analysis))
    result.warnings.push_back(std::move(warning));
}

MuscleResult forward(const MuscleStudy& study, Progress& progress) {
  progress.stage(fmt::format("simulating {:g} s of {}", study.end - study.begin, study.title));
  const ForwardOptions options{
      .begin = study.begin, .end = study.end, .rate_Hz = study.rate_Hz, .accuracy = study.accuracy};
  MuscleResult result;
  result.trajectory = simulate_forward(*study.system, study.start, study.controls, options, progress);
  if (std::string moved = assembly_text(*study.system, result.trajectory.assembly); !moved.empty())
    result.warnings.push_back(std::move(moved));
  result.controls = study.controls;
  result.reactions = reactions_of(study, result.trajectory, {});
  return result;
}

/// Whether a motion leaves the loops of its model open.
void check_loops(const MotionAnalysis::LoopGap& gap, MuscleResult& result) {
  if (gap.constraint.empty()) return;
  constexpr double kOpen = 1e-3;
  if (gap.error > kOpen)
    result.warnings.push_back(fmt::format("the motion does not close the model's loops: {} is open by {:.3g} at {:g} s",
                                          gap.constraint, gap.error, gap.time));
}

/// What is to be said of the loads of a model whose loops carry part of them.
void note_loops(const MotionAnalysis::LoopGap& gap, MuscleResult& result) {
  if (!gap.constraint.empty())
    result.warnings.emplace_back(
        "closed loops carry part of the loads: the generalised forces are the smallest ones that give the motion");
  check_loops(gap, result);
}

/// The rows of a prescribed motion as a result.
MuscleResult result_of(const MuscleStudy& study, MotionAnalysis&& analysis) {
  MuscleResult result;
  check_loads(study, analysis, result);
  note_loops(analysis.loop_gap, result);
  MuscleTrajectory& t = result.trajectory;
  t.time = std::move(analysis.time);
  t.q = std::move(analysis.q);
  t.qdot = std::move(analysis.qdot);
  t.path_length = std::move(analysis.path_length);
  t.end_time = t.time.back();
  if (analysis.interrupted) t.end = MotionEnd::kInterrupted;
  result.desired = t.q;
  result.generalized_force = std::move(analysis.moment);
  return result;
}

MuscleResult inverse(const MuscleStudy& study, Progress& progress) {
  progress.stage("inverse dynamics");
  MotionAnalysis analysis =
      analyse_motion(*study.system, study.motion, study.start.q, frame_times(study.begin, study.end, study.rate_Hz));
  const estimation::RowMatrix qddot = std::move(analysis.qddot);
  MuscleResult result = result_of(study, std::move(analysis));
  result.reactions = reactions_of(study, result.trajectory, qddot);
  return result;
}

MuscleResult optimise(const MuscleStudy& study, Progress& progress) {
  progress.stage("static optimization");
  MotionAnalysis analysis =
      optimise_motion(*study.system, study.motion, study.start.q, frame_times(study.begin, study.end, study.rate_Hz),
                      study.static_optimization, progress);
  estimation::RowMatrix activation = std::move(analysis.activation), force = std::move(analysis.force),
                        reserve = std::move(analysis.reserve);
  const estimation::RowMatrix qddot = std::move(analysis.qddot);
  const std::vector<std::size_t> infeasible = std::move(analysis.infeasible);
  MuscleResult result = result_of(study, std::move(analysis));
  MuscleTrajectory& t = result.trajectory;
  t.activation = std::move(activation);
  t.tendon_force = std::move(force);
  t.reserve = std::move(reserve);
  // The tendon is rigid here: the fibre has what it leaves of the path.
  t.fiber_length.resize(t.path_length.rows(), t.path_length.cols());
  for (Eigen::Index m = 0; m < t.path_length.cols(); ++m) {
    const MusculotendonParameters<double>& p =
        study.system->muscles().settings(static_cast<std::size_t>(m)).musculotendon;
    const double height = p.optimal_fiber_length * std::sin(p.pennation_angle_at_optimal);
    for (Eigen::Index i = 0; i < t.path_length.rows(); ++i)
      t.fiber_length(i, m) = std::hypot(std::max(0.0, t.path_length(i, m) - p.tendon_slack_length), height);
  }
  for (const std::size_t i : infeasible) result.overloaded.push_back(t.time[i]);
  if (!infeasible.empty()) {
    result.warnings.push_back(
        fmt::format("in {} of {} frames, the first at {:g} s, muscles and reserves could not make the forces that the "
                    "motion needs; what comes closest is given",
                    infeasible.size(), t.time.size(), result.overloaded.front()));
  }
  result.reactions = reactions_of(study, t, qddot);
  return result;
}

MuscleResult follow(const MuscleStudy& study, Progress& progress) {
  progress.stage(fmt::format("computed muscle control of {:g} s", study.end - study.begin));
  ControlResult found = computed_muscle_control(*study.system, study.motion, study.control, progress);
  MuscleResult result;
  if (study.motion.external || !study.system->loops().empty()) {
    const MotionAnalysis desired =
        analyse_motion(*study.system, study.motion, study.start.q, frame_times(study.begin, study.end, study.rate_Hz));
    check_loads(study, desired, result);
    check_loops(desired.loop_gap, result);
  }
  result.trajectory = std::move(found.trajectory);
  result.desired = std::move(found.desired);
  result.controls = std::move(found.controls);
  result.overloaded = std::move(found.overloaded);
  if (!result.overloaded.empty()) {
    result.warnings.push_back(fmt::format(
        "in {} of the windows, the first at {:g} s, the muscles could not make the desired acceleration and "
        "the reserves did more than their force",
        result.overloaded.size(), result.overloaded.front()));
  }
  result.reactions = reactions_of(study, result.trajectory, {});
  return result;
}

/// Whether lengths of muscles are extrapolated where a coordinate leaves its range, and a word about it.
std::string extrapolation(const MusculoskeletalSystem& system, int coordinate) {
  const auto depends = [&](const auto& path) {
    return path.function &&
           std::count(path.function->coordinates.begin(), path.function->coordinates.end(), coordinate);
  };
  const Model& model = system.model();
  if (std::any_of(model.muscles.begin(), model.muscles.end(), depends) ||
      std::any_of(model.passive_paths.begin(), model.passive_paths.end(), depends))
    return "; the model's functions of paths are extrapolated from there on";
  return system.path_source() == PathSource::kFitted ? "; fitted paths are extrapolated from there on" : "";
}

/// Warnings about coordinates that left their ranges in a simulation, where only forces keep them; of a given motion
/// where paths are extrapolated.
std::vector<std::string> range_warnings(const MuscleStudy& study, const MuscleTrajectory& t) {
  std::vector<std::string> warnings;
  const Model& model = study.system->model();
  const bool simulated = study.method == MuscleMethod::kForward || study.method == MuscleMethod::kComputedMuscleControl;
  for (const int c : study.system->reduction().free()) {
    const std::string extrapolated = extrapolation(*study.system, c);
    if (!simulated && (extrapolated.empty() || study.method == MuscleMethod::kInverseDynamics)) continue;
    const Coordinate& k = model.coordinates[c];
    const double slack = 1e-3 * (k.high - k.low);
    for (Eigen::Index i = 0; i < t.q.rows(); ++i) {
      if (t.q(i, c) >= k.low - slack && t.q(i, c) <= k.high + slack) continue;
      const bool angle = k.unit() == "rad";
      const double unit = angle ? 1.0 / kDegree : 1.0;
      warnings.push_back(fmt::format("'{}' leaves its range {:.4g} .. {:.4g} {} at {:.4g} s{}", k.name, unit * k.low,
                                     unit * k.high, angle ? "deg" : "m", t.time[i], extrapolated));
      break;
    }
  }
  return warnings;
}

/// What reactions lack of muscles that pull at no place.
void warn_of_reactions(const MuscleStudy& study, MuscleResult& result) {
  if (!result.reactions || study.method == MuscleMethod::kInverseDynamics) return;
  const std::vector<std::string> names = paths_without_place(*study.system);
  if (names.empty()) return;
  constexpr std::size_t kNamesShown = 3;
  result.warnings.push_back(
      fmt::format("joint reactions lack what {} of the paths ({}{}) press the bones together with: they are functions "
                  "of coordinates and pull at no place; only their moments are in the reactions",
                  names.size(), fmt::join(names.begin(), names.begin() + std::min(names.size(), kNamesShown), ", "),
                  names.size() > kNamesShown ? ", ..." : ""));
}

}  // namespace

double MuscleResult::tracking_error(std::size_t coordinate) const {
  if (desired.rows() == 0 || desired.rows() != trajectory.q.rows()) return 0.0;
  return (trajectory.q.col(coordinate) - desired.col(coordinate)).cwiseAbs().maxCoeff();
}

MuscleResult run_study(const MuscleStudy& study, Progress& progress) {
  MuscleResult result;
  switch (study.method) {
    case MuscleMethod::kForward:
      result = forward(study, progress);
      break;
    case MuscleMethod::kInverseDynamics:
      result = inverse(study, progress);
      break;
    case MuscleMethod::kStaticOptimization:
      result = optimise(study, progress);
      break;
    case MuscleMethod::kComputedMuscleControl:
      result = follow(study, progress);
      break;
  }
  result.induced = induced_of(study, result.trajectory);
  if (study.metabolic) result.metabolic = metabolic_cost(*study.system, result.trajectory, *study.metabolic);
  result.notes = study.system->notes();
  if (result.metabolic)
    result.notes.push_back(fmt::format("metabolic cost: {:.4g} J, of which the body at rest {:.4g} J",
                                       result.metabolic->energy,
                                       result.metabolic->basal * (result.trajectory.end_time - study.begin)));
  for (std::string& warning : range_warnings(study, result.trajectory)) result.warnings.push_back(std::move(warning));
  warn_of_reactions(study, result);
  std::string carried = lifting_reserve_warning(*study.system, result.trajectory.reserve);
  if (!carried.empty()) result.warnings.push_back(std::move(carried));
  for (const WrapBandVisit& visit : wrap_band_visits(*study.system, result.trajectory.time, result.trajectory.q))
    result.warnings.push_back(wrap_band_text(*study.system, visit));
  result.warnings.insert(result.warnings.begin(), study.warnings.begin(), study.warnings.end());
  return result;
}

}  // namespace veridyn::muscle
