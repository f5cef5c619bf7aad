#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "veridyn/aircraft/model/subject.hpp"

namespace veridyn::aircraft {

/// Names of the built-in subjects.
[[nodiscard]] std::vector<std::string> builtin_subject_names();

/// A built-in subject.
/// @throws InputError naming the nearest one.
[[nodiscard]] Subject builtin_subject(std::string_view name, std::string_view place = "subject.builtin");

}  // namespace veridyn::aircraft
