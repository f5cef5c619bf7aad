#pragma once

#include <string>

#include "veridyn/core/study.hpp"
#include "veridyn/vehicle/model/suspension.hpp"

namespace veridyn::vehicle {

/// What `[subject.suspension]` says of the axle whose keys end in 'f' or 'r': `roll_centre` [m], `roll_steer`
/// [rad/rad], `bump_steer` [rad/m], `compliance_steer` [rad/N], and a spring by the lists `travel` [m] and `force` [N].
/// What it does not say is as in `otherwise`.
/// @throws InputError with file, line and key.
[[nodiscard]] AxleSuspension read_axle_suspension(const StudyTable& suspension, char suffix,
                                                  const AxleSuspension& otherwise = {});

/// Suspension and air as tables of a `[subject]`, to be read again: only what differs from none.
[[nodiscard]] std::string write_suspension_toml(const AxleSuspension& front, const AxleSuspension& rear,
                                                const AerodynamicLift& lift);

}  // namespace veridyn::vehicle
