#pragma once

#include <string>

#include "apps/veridyn/options.hpp"

namespace veridyn::app {

/// `veridyn scale` of a vehicle study. Exit code.
[[nodiscard]] int scale_vehicle(const Study& study, const std::string& path, const CommonOptions& options,
                                const std::string& verb = "scale");

}  // namespace veridyn::app
