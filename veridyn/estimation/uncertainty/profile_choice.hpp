#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/core/study.hpp"

namespace veridyn::estimation {

/// Whose profile likelihood a study asks for, with the key `profiles`: `["C_f", ...]`, or `true` for all of `free`;
/// none without it.
/// @param free  names of the unknowns that are estimated
/// @throws InputError with file, line and key for a name that is none of these or comes twice.
[[nodiscard]] std::vector<std::string> read_profiles(const StudyTable& table, std::span<const std::string> free);

}  // namespace veridyn::estimation
