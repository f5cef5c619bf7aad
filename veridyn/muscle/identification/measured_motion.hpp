#pragma once

#include <span>

#include "veridyn/muscle/identification/muscle_outputs.hpp"
#include "veridyn/muscle/tasks/task.hpp"

namespace veridyn::muscle {

/// Outputs as a file recorded them, one sample a row; an output without a column is NaN. A coordinate's column has its
/// name as OpenSim writes it, other outputs theirs: "MUSCLE.fiber_length", with '.', '_' or '/'; generalised forces as
/// OpenSim's inverse dynamics names them too: "COORDINATE_moment", of translations "COORDINATE_force".
/// @throws InputError naming file and column: no column of any output, fewer than two samples, a cell without a number,
/// a gap (five times the usual step, and more than 50 ms), no motion at all, degrees where radians are said.
[[nodiscard]] MeasuredMotion read_measured_motion(const SignalTable& table, const Model& model,
                                                  std::span<const MuscleOutput> outputs);

/// @throws InputError for fewer than two samples, and for a gap as above.
void check_times(const SignalTable& table);

/// @throws InputError for an angle of the table that is far outside its coordinate's range and, 57 times smaller, in
/// it: degrees taken for radians.
void refuse_degrees(const SignalTable& table, const Model& model);

}  // namespace veridyn::muscle
