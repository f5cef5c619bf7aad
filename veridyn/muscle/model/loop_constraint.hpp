#pragma once

#include <string>

#include "veridyn/muscle/model/placement.hpp"

/// Constraints of a model that close loops in its tree of joints: `dynamics/loop_constraints.hpp` has their equations.
namespace veridyn::muscle {

/// What a constraint holds together.
enum class LoopKind {
  kPoint,        ///< a point of each body coincide (PointConstraint)
  kWeld,         ///< a frame of each body coincide (WeldConstraint)
  kDistance,     ///< a point of each body stay at a distance (ConstantDistanceConstraint)
  kPointOnLine,  ///< a point of body 2 stays on a line of body 1 (PointOnLineConstraint)
};

/// A constraint between two bodies. Points are the origins of the frames; the line is the x axis of `frame_1`.
struct LoopConstraint {
  std::string name;
  LoopKind kind = LoopKind::kPoint;
  int body_1 = 0, body_2 = 0;
  Placement frame_1{}, frame_2{};  ///< in their bodies
  double distance = 0.0;           ///< kDistance [m], > 0
};

/// "WeldConstraint 'foot'", for messages.
[[nodiscard]] std::string loop_text(const LoopConstraint& constraint);

}  // namespace veridyn::muscle
