#pragma once

#include "veridyn/core/recording.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::aircraft {

/// Takes rows out of a recording, as a logger loses them that cannot keep up: what channels have at the same stamp is a
/// row, and each is lost with probability `share`, whatever became of others.
void lose_rows(Recording& recording, double share, numerics::RandomStream random);

}  // namespace veridyn::aircraft
