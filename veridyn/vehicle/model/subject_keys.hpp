#pragma once

#include <vector>

#include "veridyn/core/study_keys.hpp"
#include "veridyn/vehicle/model/vehicle.hpp"

namespace veridyn::vehicle {

/// What a vehicle has beside the numbers of kVehicleFields, of `[subject]`.
[[nodiscard]] const KeyTable<Vehicle>& vehicle_keys();
/// `[subject.longitudinal]`
[[nodiscard]] const KeyTable<LongitudinalParameters>& longitudinal_keys();
/// `[subject.suspension]` of an axle: names end in `_f` or `_r`.
[[nodiscard]] KeyTable<AxleSuspension> suspension_keys(char suffix);

/// All tables of `[subject]`.
[[nodiscard]] std::vector<StudyKeys> subject_keys();

}  // namespace veridyn::vehicle
