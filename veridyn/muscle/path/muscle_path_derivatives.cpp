// Paths with derivatives.
#include "veridyn/muscle/model/simulation_jet.hpp"
#include "veridyn/muscle/path/muscle_path_evaluation.hpp"

namespace veridyn::muscle {

template struct PathWorkspace<SimulationJet>;
template void MusclePaths::lengths(const Kinematics<SimulationJet>&, const SimulationJet*,
                                   PathWorkspace<SimulationJet>&) const;
template void MusclePaths::evaluate(const Kinematics<SimulationJet>&, const SimulationJet*,
                                    PathWorkspace<SimulationJet>&) const;
template void MusclePaths::evaluate(const Kinematics<SimulationJet>&, const SimulationJet*,
                                    PathWorkspace<SimulationJet>&, std::span<const std::uint8_t>) const;
template void MusclePaths::speeds(const PathWorkspace<SimulationJet>&, const SimulationJet*, SimulationJet*) const;

template struct PathWorkspace<PathJet>;
template void MusclePaths::evaluate(const Kinematics<PathJet>&, const PathJet*, PathWorkspace<PathJet>&) const;
template void MusclePaths::evaluate(const Kinematics<PathJet>&, const PathJet*, PathWorkspace<PathJet>&,
                                    std::span<const std::uint8_t>) const;

}  // namespace veridyn::muscle
