#pragma once

#include "apps/veridyn/options.hpp"

namespace veridyn::app {

/// `veridyn identify` of what is measured on the ground: chosen by the table that the study holds. Exit code.
[[nodiscard]] bool is_ground_study(const Study& study);
[[nodiscard]] int identify_ground(const Study& study, const std::string& path, const CommonOptions& options);

}  // namespace veridyn::app
