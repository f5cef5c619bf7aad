#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/muscle/study/motion_table.hpp"

/// The parts that `read_study` reads one after the other, and what they share. Each throws InputError with file, line
/// and key. A part that takes a study looks at what was read of it before.
namespace veridyn::muscle::internal {

/// Index of a muscle or a coordinate that the key of a table names.
[[nodiscard]] std::size_t muscle_of(const StudyTable& table, const std::string& key, const std::string& name,
                                    const Model& model);
[[nodiscard]] std::size_t coordinate_of(const StudyTable& table, const std::string& key, const std::string& name,
                                        const Model& model);
/// The value of a coordinate, inside its range.
[[nodiscard]] double coordinate_value(const StudyTable& table, const std::string& key, const Coordinate& coordinate);
/// Refuses a coordinate that follows another one.
void check_not_coupled(const StudyTable& table, const std::string& key, std::size_t coordinate,
                       const MuscleSubject& subject);

/// A value, and what to remember of the files that it was read from.
template <typename Value>
struct ReadFromFiles {
  Value value;
  std::vector<std::filesystem::path> inputs = {};
  std::vector<std::string> warnings = {};
};

/// The value, where `subject` remembers the rest.
template <typename Value>
[[nodiscard]] Value remembered(ReadFromFiles<Value> read, MuscleSubject& subject) {
  subject.inputs.insert(subject.inputs.end(), read.inputs.begin(), read.inputs.end());
  subject.warnings.insert(subject.warnings.end(), read.warnings.begin(), read.warnings.end());
  return std::move(read.value);
}

/// Title and `[subject]` of a study: the model, its parameters, loads and paths, as a system.
[[nodiscard]] MuscleSubject read_subject(const StudyTable& root, Progress& progress);
/// `[motion.reserves]`, by coordinate; `otherwise` of those that it does not name.
[[nodiscard]] std::vector<double> read_reserves(const StudyTable& motion, double otherwise, const Model& model);
/// `external_loads`, `[[motion.external_load]]`; null: none. They cover the study's time.
[[nodiscard]] ReadFromFiles<std::shared_ptr<const ExternalLoads>> read_external_loads(const StudyTable& motion,
                                                                                      const MotionTable& keys,
                                                                                      const MuscleStudy& study);
/// A load as `[[subject.load]]` has it.
[[nodiscard]] HeldLoad read_load(const StudyTable& table, const Model& model);
/// Where the next ramp of a coordinate begins; view of the ramp before it.
struct RampOrigin {
  const Ramp* before = nullptr;  ///< of the same coordinate
  double rest = 0.0;             ///< without one: where the coordinate is [rad] or [m]
  bool rest_is_given = false;    ///< by the study, under this key:
  std::string rest_key = {};
  double begin = 0.0;  ///< of the motion [s]
};
/// A ramp as `[[motion.ramp]]` has it.
[[nodiscard]] Ramp read_ramp(const StudyTable& table, const Coordinate& coordinate, const RampOrigin& origin);
/// Excitations and reserves of a file; muscles without a column keep `otherwise`. `reserves` are the forces of their
/// actuators at control 1, by coordinate.
[[nodiscard]] MuscleControls controls_of(const SignalTable& signals, const MusculoskeletalSystem& system,
                                         std::span<const double> otherwise, Interpolation interpolation,
                                         std::span<const double> reserves);
/// `[motion.start]`, `[motion.start_speed]`.
[[nodiscard]] StartState read_start(const StudyTable& motion, const MuscleStudy& study);
/// `start_file`: states as `simulate` and OpenSim write them; the study's start where it has none.
[[nodiscard]] ReadFromFiles<StartState> read_start_file(const StudyTable& motion, const MotionTable& keys,
                                                        const MuscleStudy& study);
/// `[motion.excitation]`, `[[motion.excitation_step]]`, `excitation_file`.
[[nodiscard]] ReadFromFiles<MuscleControls> read_excitations(const StudyTable& motion, const MotionTable& keys,
                                                             const MuscleStudy& study);
/// A motion to follow, and the coordinates whose motion the study gives.
struct DesiredMotion {
  Motion motion;
  std::vector<std::string> coordinates;
};
/// The motion to follow: `file` (the study's, read before), `[[motion.ramp]]`, and rest for all other coordinates.
[[nodiscard]] DesiredMotion read_desired_motion(const StudyTable& motion, const MuscleStudy& study);

}  // namespace veridyn::muscle::internal
