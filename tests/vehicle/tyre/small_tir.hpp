#pragma once

#include <string>

namespace veridyn::vehicle::testing {

/// A tyre file as small as one can be that uses all of the formula, in millimetres and degrees where it may.
inline std::string small_tir() {
  return R"($----------------------------------------units
[UNITS]
LENGTH = 'mm'
FORCE = 'newton'
ANGLE = 'degrees'  $ of the ranges
MASS = 'kg'
TIME = 'second'
! comment of the other kind
[MODEL]
PROPERTY_FILE_FORMAT = 'PAC2002'
USE_MODE = 4
TYRESIDE = 'RIGHT' $ a $ in a comment ! and more
COMMENT = 'a $ that is text'
[DIMENSION]
UNLOADED_RADIUS = 310.0
WIDTH = 195
[SHAPE]
{radial width}
1.0 0.0
0.9 1.0
[VERTICAL]
VERTICAL_STIFFNESS = +2.0E+2
VERTICAL_DAMPING = 0.5
FNOMIN = 4000
[VERTICAL_FORCE_RANGE]
FZMIN = 200
FZMAX = 9000
[SLIP_ANGLE_RANGE]
ALPMIN = -40
ALPMAX = 40
[SCALING_COEFFICIENTS]
LMUX = .9
LMUY = 0.95
[LONGITUDINAL_COEFFICIENTS]
PCX1 = 1.6
PDX1 = 1.15
PDX2 = -0.08
PEX1 = 0.4
PKX1 = 21.0
PKX3 = 0.2
PHX1 = 0.001
RBX1 = 12.5
RBX2 = -10.0
RCX1 = 1.1
[LATERAL_COEFFICIENTS]
PCY1 = 1.3
PDY1 = 1.0
PDY2 = -0.15
PEY1 = -0.7
PKY1 = -18.5
PKY2 = 1.8
PKY3 = 0.3
PHY1 = 0.0025
PHY3 = 0.03
PVY1 = 0.03
PVY3 = -0.3
RBY1 = 7.0
RBY2 = 2.5
RCY1 = 1.05
RVY1 = -0.03
RVY5 = 1.9
RVY6 = -10
)";
}

}  // namespace veridyn::vehicle::testing
