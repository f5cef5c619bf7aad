#pragma once

#include <string>

#include "apps/veridyn/run/command.hpp"

namespace veridyn::app {

/// Whether `veridyn inspect` was given a model: an .osim file or the name of a built-in one.
[[nodiscard]] bool is_model(const std::string& file);

/// Describes a model, or with `pose` (a table of coordinates, or "name=value,...") prints lengths, moment arms and
/// generalised forces of each pose as CSV.
[[nodiscard]] int inspect_model(const std::string& file, const std::string& pose, bool as_opensim,
                                const CommonOptions& options);

}  // namespace veridyn::app
