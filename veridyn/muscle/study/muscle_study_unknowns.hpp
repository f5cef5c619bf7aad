#pragma once

#include <vector>

#include "veridyn/core/study.hpp"
#include "veridyn/muscle/identification/muscle_outputs.hpp"
#include "veridyn/muscle/identification/muscle_unknowns.hpp"
#include "veridyn/muscle/model/model.hpp"

namespace veridyn::muscle {

/// `[[parameter]]`.
[[nodiscard]] const KeyTable<MuscleUnknownSpec>& parameter_keys();
/// `[[output]]`.
[[nodiscard]] const KeyTable<MuscleOutput>& output_keys();

/// What a study estimates: `[[parameter]]`.
/// @throws InputError with file, line and key.
[[nodiscard]] std::vector<MuscleUnknown> read_unknowns(const StudyTable& root, const Model& model);

/// What a study compares with its recordings, `[[output]]`; empty: all coordinates.
/// @throws InputError with file, line and key.
[[nodiscard]] std::vector<MuscleOutput> read_outputs(const StudyTable& root, const Model& model);

}  // namespace veridyn::muscle
