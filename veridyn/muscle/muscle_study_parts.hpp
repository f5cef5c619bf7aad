#pragma once

#include <array>
#include <string>
#include <utility>

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
/// `[motion.start]`, `[motion.start_speed]`.
void read_start(const StudyTable& motion, MuscleStudy& study);
/// `start_file`: states as `simulate` and OpenSim write them.
void read_start_file(const StudyTable& motion, MuscleStudy& study);
/// `[motion.excitation]`, `[[motion.excitation_step]]`, `excitation_file`.
void read_excitations(const StudyTable& motion, MuscleStudy& study);
/// The motion to follow: `file` (read before), `[[motion.ramp]]`, and rest for all other coordinates.
void read_desired_motion(const StudyTable& motion, MuscleStudy& study);

}  // namespace veridyn::muscle::internal
