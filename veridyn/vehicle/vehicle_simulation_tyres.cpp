// The simulation loops for the tyres with a friction limit; a file of its own so that two compile side by side.
#include "veridyn/vehicle/fiala_tyre.hpp"
#include "veridyn/vehicle/magic_formula.hpp"
#include "veridyn/vehicle/simple_magic_formula.hpp"
#include "veridyn/vehicle/vehicle_simulation_loop.hpp"

namespace veridyn::vehicle {

template <typename Tyre>
using FourWheel = FourWheelModel<double, Tyre>;
template <typename Tyre>
using Bicycle = BicycleModel<double, Tyre>;

// One line a tyre, for each of the two models.
template VehicleTrajectory simulate(const FourWheel<FialaTyre<double>>&, Driver&, const Road*, const SimulationOptions&,
                                    Progress&);
template VehicleTrajectory simulate(const FourWheel<SimpleMagicFormulaTyre<double>>&, Driver&, const Road*,
                                    const SimulationOptions&, Progress&);
template VehicleTrajectory simulate(const FourWheel<MagicFormulaTyre<double>>&, Driver&, const Road*,
                                    const SimulationOptions&, Progress&);
template VehicleTrajectory simulate(const Bicycle<FialaTyre<double>>&, Driver&, const SimulationOptions&, Progress&);
template VehicleTrajectory simulate(const Bicycle<SimpleMagicFormulaTyre<double>>&, Driver&, const SimulationOptions&,
                                    Progress&);
template VehicleTrajectory simulate(const Bicycle<MagicFormulaTyre<double>>&, Driver&, const SimulationOptions&,
                                    Progress&);

}  // namespace veridyn::vehicle
