// Systems with derivatives.
#include "veridyn/muscle/model/simulation_jet.hpp"
#include "veridyn/muscle/simulation/system_evaluator_definitions.hpp"

namespace veridyn::muscle {

template class SystemEvaluator<SimulationJet>;

}  // namespace veridyn::muscle
