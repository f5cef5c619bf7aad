#pragma once

#include <string>

#include "apps/veridyn/options.hpp"

namespace veridyn::app {

/// `veridyn simulate` of a musculoskeletal model: chosen by the key `model` in `[subject]`. Exit code.
[[nodiscard]] int simulate_muscle(const Study& study, const std::string& path, const CommonOptions& options,
                                  const std::string& verb = "simulate");

}  // namespace veridyn::app
