#pragma once

#include <vector>

#include "veridyn/core/study.hpp"
#include "veridyn/muscle/identification/muscle_outputs.hpp"
#include "veridyn/muscle/identification/muscle_unknowns.hpp"
#include "veridyn/muscle/model/model.hpp"

namespace veridyn::muscle {

/// What a study estimates:
///
///     [[parameter]]
///     name = "flexors' force"                         # "MUSCLE.FIELD" when left out
///     muscles = ["BIClong", "BICshort", "BRA"]        # ["all"]: every muscle
///     fields = ["max_isometric_force"]                # of `[subject.parameters]`; tendon_strain_factor,
///                                                     # excitation_gain, excitation_delay
///     factor = true                                   # one factor of the model's values; else one value for all
///     start = 1.05                                    # the model's value, or 1, when left out
///     bounds = "20 %"                                 # below and above the start; 50 % when left out
///     low = "-10 %"                                   # instead: each in percent of the start from there, or in units
///     high = 1.3
///     prior = "10 %"                                  # standard deviation, in percent of the start or in units
///     fixed = false
///
/// @throws InputError with file, line and key.
[[nodiscard]] std::vector<MuscleUnknown> read_unknowns(const StudyTable& root, const Model& model);

/// What a study compares with its recordings; empty: all coordinates.
///
///     [[output]]
///     name = "r_elbow_flex"      # COORDINATE, COORDINATE.speed, COORDINATE.moment, MUSCLE.fiber_length,
///                                # MUSCLE.tendon_force
///     noise = "0.06 deg"         # standard deviation of its measurement; estimated when left out
///
/// @throws InputError with file, line and key.
[[nodiscard]] std::vector<MuscleOutput> read_outputs(const StudyTable& root, const Model& model);

}  // namespace veridyn::muscle
