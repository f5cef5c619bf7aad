#pragma once

#include <string>

#include "tests/muscle/dynamics/model_trees.hpp"

/// Models with loops that tests share.
namespace veridyn::muscle::test {

/// Four bars in a plane: crank 0.3 m and rocker 0.4 m on pins of the ground 0.6 m apart, coupler of 0.5 m on the
/// crank, whose end a PointConstraint holds to the rocker's. Coordinates: crank, coupler, rocker; all angles 0 is the
/// bars hanging down, the loop open.
[[nodiscard]] Model four_bar();

/// A random tree of free joints, a gimbal and a pin, with one of each kind of constraint between random bodies, all of
/// which hold at the default pose.
[[nodiscard]] Model random_loops(numerics::RandomStream& random);

}  // namespace veridyn::muscle::test
