#pragma once

#include <vector>

#include "veridyn/estimation/regression/regression_data.hpp"
#include "veridyn/io/opensim/storage.hpp"
#include "veridyn/muscle/model/external_load.hpp"
#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"

namespace veridyn::muscle {

/// What the contacts of a model did along a motion, in the form in which force plates are recorded: force and point of
/// application in ground, contact by contact, as columns and as the loads that they are of another study.
struct ContactRecord {
  std::vector<ExternalLoadSource> sources;
  io::Storage storage;  ///< columns NAME_force_vx .. vz [N], NAME_force_px .. pz [m]
};

/// Of all contacts at the instants `time` of a motion (rows x coordinates). A half space that moves is pushed by loads
/// of its own, NAME_plane.
[[nodiscard]] ContactRecord record_contacts(const MusculoskeletalSystem& system, const std::vector<double>& time,
                                            const estimation::RowMatrix& q, const estimation::RowMatrix& qdot);

}  // namespace veridyn::muscle
