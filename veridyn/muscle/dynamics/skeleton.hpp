#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "veridyn/muscle/dynamics/mechanism.hpp"
#include "veridyn/muscle/model/model.hpp"

namespace veridyn::muscle {

/// A line in space for a picture. [m], ground axes.
struct Polyline {
  std::string name;
  std::vector<Eigen::Vector3d> points;
};

/// Stick figure of a pose: from each body's joint centre to the centres of the joints it carries; a body that carries
/// none is drawn through its mass centre to twice its distance, where its far end may be. One line a stick, named by
/// its body. `kinematics` after `update_positions`.
[[nodiscard]] std::vector<Polyline> bones(const Model& model, const Mechanism& mechanism,
                                          const Kinematics<double>& kinematics);

}  // namespace veridyn::muscle
