#pragma once

#include <ceres/jet.h>

namespace veridyn::muscle {

/// The scalar of simulations with derivatives with respect to six parameters at a time. Paths, dynamics and muscles are
/// compiled for it and for double, each in one place; their templates work with other scalars too.
using SimulationJet = ceres::Jet<double, 6>;

/// The scalar of path lengths and their derivatives with respect to two coordinates at a time, for models with no more
/// that move: a third of the work. Paths are compiled for it too.
using PathJet = ceres::Jet<double, 2>;

}  // namespace veridyn::muscle
