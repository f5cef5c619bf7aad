#pragma once

#include <array>
#include <string>
#include <utility>

#include "veridyn/muscle/model/ramp.hpp"
#include "veridyn/muscle/muscle_study.hpp"

/// The parts that `read_study` reads one after the other, and what they share. Each throws InputError with file, line
/// and key.
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
                       const MuscleStudy& study);

/// What a study's words for an enumeration mean.
template <typename Value, std::size_t kWords>
using Words = std::array<std::pair<const char*, Value>, kWords>;

/// The value of an enumeration that a study names; the first when the key is left out.
template <typename Value, std::size_t kWords>
[[nodiscard]] Value word_or_first(const StudyTable& table, const std::string& key, const Words<Value, kWords>& words) {
  std::array<std::string, kWords> names;
  for (std::size_t i = 0; i < kWords; ++i) names[i] = words[i].first;
  const std::string word = table.choice_or(key, names, names.front());
  for (const auto& [name, value] : words) {
    if (word == name) return value;
  }
  return words.front().second;
}

/// `[subject]`: the model, its parameters, loads and paths, as a system.
void read_subject(const StudyTable& subject, MuscleStudy& study, Progress& progress);
/// A load as `[[subject.load]]` has it.
[[nodiscard]] HeldLoad read_load(const StudyTable& table, const Model& model);
/// Where the next ramp of a coordinate begins.
struct RampOrigin {
  const Ramp* before = nullptr;  ///< of the same coordinate
  double rest = 0.0;             ///< without one: where the coordinate is [rad] or [m]
  bool rest_is_given = false;    ///< by the study, under this key:
  std::string rest_key = {};
  double begin = 0.0;  ///< of the motion [s]
};
/// A ramp as `[[motion.ramp]]` has it.
[[nodiscard]] Ramp read_ramp(const StudyTable& table, const Coordinate& coordinate, const RampOrigin& origin);
/// `interpolation`, "linear" when left out.
[[nodiscard]] Interpolation read_interpolation(const StudyTable& table);
/// Excitations and reserves of a file; muscles without a column keep `otherwise`.
[[nodiscard]] MuscleControls controls_of(const SignalTable& signals, const MusculoskeletalSystem& system,
                                         std::span<const double> otherwise, Interpolation interpolation,
                                         double reserve_force);
/// Options of computed muscle control as `[motion.control]` has them: window, gains, least and greatest control.
[[nodiscard]] ControlOptions read_control_options(const StudyTable& table);
/// `[motion.start]`, `[motion.start_speed]`.
void read_start(const StudyTable& motion, MuscleStudy& study);
/// `start_file`: states as `simulate` and OpenSim write them.
void read_start_file(const StudyTable& motion, MuscleStudy& study);
/// `[motion.excitation]`, `[[motion.excitation_step]]`, `excitation_file`.
void read_excitations(const StudyTable& motion, MuscleStudy& study);
/// The motion to follow: `file` (read before), `[[motion.ramp]]`, and rest for all other coordinates.
void read_desired_motion(const StudyTable& motion, MuscleStudy& study);

}  // namespace veridyn::muscle::internal
