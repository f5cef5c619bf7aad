#pragma once

#include <array>
#include <variant>

#include "veridyn/vehicle/model/rolling_bicycle.hpp"
#include "veridyn/vehicle/tyre/tyre_laws.hpp"

namespace veridyn::vehicle {

/// The rolling bicycle on tyres of one kind.
template <typename Tyre>
using RollingBicycleOn = RollingBicycle<double, Tyre>;

/// The rolling bicycle with any of the tyres that numbers describe, as those that a drive is identified with.
using AnyRollingBicycle = AllTyresByNumbers::Variant<RollingBicycleOn>;

/// What tyres of the same cornering stiffness C and no limit would push with, front and rear, at the slips at which
/// those of the vehicle push with `force` [N]: C alpha(F). Where slip is more than twice F/C it is taken as twice: it
/// says nothing of C any more.
/// @param shifted how much load has moved, as times that of steady cornering at 1 g times `gravity` and the roll
/// gradient: phi + 2 damping/frequency phi'
[[nodiscard]] std::array<double, 2> forces_without_limit(const AnyRollingBicycle& vehicle,
                                                         const std::array<double, 2>& force, double shifted);

/// Cornering stiffnesses of one tyre, front and rear [N/rad].
[[nodiscard]] std::array<double, 2> stiffnesses_of(const AnyRollingBicycle& vehicle);

/// Whether its tyres are linear, so that the two are the same.
[[nodiscard]] bool is_linear(const AnyRollingBicycle& vehicle);

}  // namespace veridyn::vehicle
