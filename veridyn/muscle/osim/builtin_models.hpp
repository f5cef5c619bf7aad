#pragma once

#include <span>
#include <string>

#include "veridyn/core/embedded_text.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {

/// Models that the program carries: `veridyn/muscle/models/*.osim`. "arm": shoulder and elbow, six muscles, a sphere,
/// an ellipsoid and a cylinder to wrap over.
[[nodiscard]] std::span<const EmbeddedText> builtin_models();

/// Reads a built-in model by its name, or a file by its path. @throws InputError naming what there is.
[[nodiscard]] OsimFile load_model(const std::string& name_or_path);

}  // namespace veridyn::muscle
