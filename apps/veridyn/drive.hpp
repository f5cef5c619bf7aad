#pragma once

#include <string>

#include "apps/veridyn/follow.hpp"
#include "apps/veridyn/options.hpp"

namespace veridyn::app {

// The verbs on the drive of a vehicle: chosen by `kind = "vehicle"` in `[subject]`. A study without `[data]` is driven
// first (`[drive]`, `[sensors]`), and its truth shown beside what is found. Exit codes.

[[nodiscard]] int identify_vehicle(const Study& study, const std::string& path, const CommonOptions& options,
                                   const std::string& verb = "identify");
[[nodiscard]] int validate_vehicle(const Study& study, const std::string& path, const std::string& estimate,
                                   const CommonOptions& options);
[[nodiscard]] int track_vehicle(const Study& study, const std::string& path, bool live, const FollowOptions& follow,
                                const CommonOptions& options);

}  // namespace veridyn::app
