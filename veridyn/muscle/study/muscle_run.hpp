#pragma once

#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/core/recording.hpp"
#include "veridyn/io/opensim/storage.hpp"
#include "veridyn/muscle/simulation/contact_record.hpp"
#include "veridyn/muscle/simulation/external_load_check.hpp"
#include "veridyn/muscle/simulation/induced_accelerations.hpp"
#include "veridyn/muscle/simulation/joint_reactions.hpp"
#include "veridyn/muscle/simulation/metabolic_cost.hpp"
#include "veridyn/muscle/study/motion_study.hpp"

namespace veridyn::muscle {

/// The result of a muscle study.
struct MuscleResult {
  /// Rows in time. Of inverse dynamics without excitations, activations, fibres and forces; of static optimization
  /// without excitations. Of a simulation that did not finish, the rows up to there.
  MuscleTrajectory trajectory;
  estimation::RowMatrix desired;  ///< the desired pose, rows as `trajectory`; empty of a forward simulation
  /// What the desired motion needs at each coordinate, of gravity and inertia less the external loads [N m or N];
  /// inverse dynamics and static optimization.
  estimation::RowMatrix generalized_force;
  /// Excitations and reserves that, from the first row's state on, repeat the motion.
  std::optional<MuscleControls> controls;
  /// What joints transmit, as the study asks for it.
  std::optional<JointReactions> reactions;
  std::optional<InducedAccelerations> induced;  ///< as the study asks for it
  std::optional<MetabolicCost> metabolic;       ///< as the study asks for it
  std::optional<ExternalLoadFit> external_fit;  ///< of a motion with external loads
  std::vector<double> overloaded;  ///< instants at which the muscles could not produce the desired motion [s]
  std::vector<std::string> notes;
  std::vector<std::string> warnings;

  [[nodiscard]] bool usable() const { return trajectory.usable(); }
  /// Largest |q - desired| of a coordinate [rad or m]; 0 without a desired motion.
  [[nodiscard]] double tracking_error(std::size_t coordinate) const;
};

/// Runs the study. Never throws for a simulation that diverges: the result says how it ended.
[[nodiscard]] MuscleResult run_study(const MuscleStudy& study, Progress& progress);

/// motion.csv: by coordinate value and speed, desired value, generalised force or reserve where there are any.
[[nodiscard]] Recording motion_table(const MuscleStudy& study, const MuscleResult& result);
/// muscles.csv: by muscle excitation, activation, fibre length, tendon force, path length, as far as the method has
/// them.
[[nodiscard]] Recording muscle_table(const MuscleStudy& study, const MuscleResult& result);
/// reactions.csv: by joint force on the child body and moment about the joint.
[[nodiscard]] Recording reaction_table(const MuscleStudy& study, const MuscleResult& result);
/// metabolics.csv: power by muscle, of the body at rest, and of all.
[[nodiscard]] Recording metabolic_table(const MuscleStudy& study, const MuscleResult& result);
/// induced_accelerations.csv: COORDINATE_by_SOURCE.
[[nodiscard]] Recording induced_table(const MuscleStudy& study, const MuscleResult& result);
/// contact_forces.sto and contact_loads.xml: what the model's contacts did in a simulation, as external loads of
/// another study. Nothing without contacts or where the motion was given.
[[nodiscard]] std::optional<ContactRecord> contact_record(const MuscleStudy& study, const MuscleResult& result);
/// states.sto by OpenSim's names: value and speed of each coordinate, activation and fibre length of muscles that have
/// them as states.
[[nodiscard]] io::Storage state_storage(const MuscleStudy& study, const MuscleResult& result);
/// controls.sto: excitations by muscle, reserves by COORDINATE_reserve in units of the reserve's force. A value that
/// holds until a jump is written twice, at its beginning and 1 ns before its end, so that held and linear interpolation
/// are the same signal.
[[nodiscard]] std::optional<io::Storage> control_storage(const MuscleStudy& study, const MuscleResult& result);

}  // namespace veridyn::muscle
