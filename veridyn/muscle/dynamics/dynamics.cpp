// Kinematics and dynamics in double, compiled once.
#include "veridyn/muscle/dynamics/dynamics.hpp"

#include "veridyn/muscle/dynamics/reduced_dynamics.hpp"

namespace veridyn::muscle {

template void update_positions(const Mechanism&, const double*, Kinematics<double>&);
template void update_velocities(const Mechanism&, const double*, Kinematics<double>&);
template class Dynamics<double>;
template class ReducedDynamics<double>;

}  // namespace veridyn::muscle
