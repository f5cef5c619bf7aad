#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"

namespace veridyn::muscle {

/// Poses at which lengths, moment arms and forces of a model are computed.
struct PoseTable {
  std::vector<double> time;                     ///< of the rows; empty: the poses have none [s]
  std::vector<Eigen::VectorXd> q, qdot, qddot;  ///< by row; all coordinates
  std::vector<std::string> warnings;            ///< values of coupled coordinates that are not their couplers'
};

/// Poses from a .csv, .mot or .sto file with columns named by coordinates (others rest at their default); columns
/// `NAME.speed` and `NAME.acceleration` where inverse dynamics should have them. Or one pose from a text
/// "elbow_flexion=90 deg, shoulder_flexion=0.3".
///
/// A coupled coordinate is where its coupler puts it. What a file says of it otherwise is a warning with the largest
/// difference; a text that says otherwise is refused.
/// @throws InputError naming coordinate and place: unknown names, values outside the coordinate's range, in a text a
/// value of a coupled coordinate that its coupler does not give.
[[nodiscard]] PoseTable read_poses(const Model& model, const std::string& file_or_text);

/// CSV, a row a pose: coordinates, `MUSCLE.length[m]`, `MUSCLE.moment_arm.COORDINATE[m]` (-dL/dq of the taut path,
/// along a coordinate's coupled ones for those that others follow) for every pair that can be other than zero, and
/// `COORDINATE.force` of inverse dynamics [N m or N].
[[nodiscard]] std::string pose_csv(const MusculoskeletalSystem& system, const PoseTable& poses);

}  // namespace veridyn::muscle
