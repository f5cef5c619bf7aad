#pragma once

#include <string>

#include "veridyn/vehicle/model/suspension.hpp"

namespace veridyn::vehicle {

/// Suspension and air as tables of a `[subject]`, to be read again: only what differs from none.
[[nodiscard]] std::string write_suspension_toml(const AxleSuspension& front, const AxleSuspension& rear,
                                                const AerodynamicLift& lift);

}  // namespace veridyn::vehicle
