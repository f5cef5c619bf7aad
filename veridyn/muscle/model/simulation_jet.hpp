#pragma once

#include <ceres/jet.h>

namespace veridyn::muscle {

/// The scalar of simulations with derivatives with respect to six parameters at a time. Paths, dynamics and muscles are
/// compiled for it and for double, each in one place; their templates work with other scalars too.
using SimulationJet = ceres::Jet<double, 6>;

}  // namespace veridyn::muscle
