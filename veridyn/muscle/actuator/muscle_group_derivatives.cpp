// Muscles with derivatives, compiled once.
#include "veridyn/muscle/actuator/muscle_group.hpp"
#include "veridyn/muscle/model/simulation_jet.hpp"

namespace veridyn::muscle {

template class MuscleGroup<SimulationJet>;

// Flattened: jets are worth their price only without calls.
[[gnu::flatten]] void muscle_rates(const MuscleGroup<SimulationJet>& muscles, const MuscleInputs<SimulationJet>& in,
                                   const MuscleOutputs<SimulationJet>& out) {
  muscles.rates(in, out);
}

}  // namespace veridyn::muscle
