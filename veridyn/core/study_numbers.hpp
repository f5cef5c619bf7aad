#pragma once

#include <cstddef>

#include "veridyn/core/study.hpp"

namespace veridyn {

/// A whole number of a study from `least` to ten millions; `otherwise` where the key is missing.
/// @throws InputError beyond that range
[[nodiscard]] std::size_t count_or(const StudyTable& table, const char* key, std::size_t otherwise, long long least);

/// A share of a study, above 0 and at most `most`: 0.05 or "5 %"; `otherwise` where the key is missing.
/// @throws InputError beyond that range
[[nodiscard]] double share_or(const StudyTable& table, const char* key, double otherwise, double most);

}  // namespace veridyn
