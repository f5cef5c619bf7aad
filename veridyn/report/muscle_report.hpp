#pragma once

#include <string>

#include "veridyn/muscle/study/muscle_run.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// A simulated musculoskeletal model: how it ended, pictures of the poses with muscle paths, angles with the desired
/// ones, excitations and activations, fibre lengths, tendon forces, generalised forces, a table of the muscles, events.
[[nodiscard]] Document muscle_report(const muscle::MuscleStudy& study, const muscle::MuscleResult& result,
                                     const std::string& program);

}  // namespace veridyn::report
