#pragma once

#include <Eigen/Core>
#include <string>

#include "veridyn/muscle/model/model.hpp"
#include "veridyn/muscle/path/muscle_path.hpp"

namespace veridyn::muscle {

/// "shoulder = 31.3 deg, elbow = 0 deg": the coordinates that move a muscle's path at the pose q (all coordinates), for
/// messages.
[[nodiscard]] std::string pose_text(const Model& model, const MusclePaths& paths, int muscle, const Eigen::VectorXd& q);

}  // namespace veridyn::muscle
