#pragma once

#include <string>

#include "apps/veridyn/options.hpp"

namespace veridyn::app {

/// `veridyn simulate` of a vehicle: chosen by `kind = "vehicle"` in `[subject]`. Exit code.
[[nodiscard]] int simulate_vehicle(const Study& study, const std::string& path, const CommonOptions& options,
                                   const std::string& verb = "simulate");

}  // namespace veridyn::app
