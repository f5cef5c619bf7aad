#pragma once

#include <string>
#include <string_view>

#include "veridyn/muscle/model/model.hpp"

namespace veridyn::muscle {

/// What is compared with a recording.
enum class MuscleOutputKind {
  kValue,        ///< of a coordinate [rad or m]
  kSpeed,        ///< of a coordinate [1/s]
  kMoment,       ///< of all muscles about a coordinate, sum of force times moment arm [N m or N]
  kFiberLength,  ///< of a muscle [m]
  kTendonForce,  ///< of a muscle [N]
};

/// An output of a muscle model.
struct MuscleOutput {
  MuscleOutputKind kind = MuscleOutputKind::kValue;
  int index = 0;          ///< of the coordinate or muscle in the model
  double noise_sd = 0.0;  ///< of its measurement, in its unit; 0: not known
};

/// Reads "COORDINATE", "COORDINATE.speed", "COORDINATE.moment", "MUSCLE.fiber_length", "MUSCLE.tendon_force".
/// @throws InputError at `place` with the nearest name.
[[nodiscard]] MuscleOutput parse_output(const Model& model, std::string_view text, std::string_view place);
/// As `parse_output` reads it.
[[nodiscard]] std::string output_name(const Model& model, const MuscleOutput& output);
/// In SI.
[[nodiscard]] std::string output_unit(const Model& model, const MuscleOutput& output);

}  // namespace veridyn::muscle
