#pragma once

#include <span>
#include <string>
#include <string_view>

#include "veridyn/muscle/osim_reader.hpp"

namespace veridyn::muscle {

struct BuiltinModel {
  std::string_view name;  ///< "arm"
  std::string_view text;  ///< its .osim file
};

/// Models that the program carries: `veridyn/muscle/models/*.osim`. "arm": shoulder and elbow, six muscles, a sphere,
/// an ellipsoid and a cylinder to wrap over.
[[nodiscard]] std::span<const BuiltinModel> builtin_models();

/// Reads a built-in model by its name, or a file by its path. @throws InputError naming what there is.
[[nodiscard]] OsimFile load_model(const std::string& name_or_path);

}  // namespace veridyn::muscle
