#pragma once

#include <optional>
#include <string>
#include <vector>

#include "veridyn/estimation/regression/regression_data.hpp"
#include "veridyn/muscle/actuator/musculotendon.hpp"
#include "veridyn/muscle/simulation/forward_simulation.hpp"

namespace veridyn::muscle {

/// Whose account of the energy that muscles use.
enum class MetabolicModel {
  kUmberger2003,  ///< Umberger, Gerritsen & Martin 2003, Comput Methods Biomech Biomed Engin 6:99
  kBhargava2004,  ///< Bhargava, Pandy & Anderson 2004, J Biomech 37:81
};

/// What the accounts need to know of muscles that OpenSim's models of them do not say.
struct MetabolicOptions {
  MetabolicModel model = MetabolicModel::kUmberger2003;
  std::vector<double> slow_twitch{};  ///< share of slow fibres by muscle, 0..1; empty: 0.5 of all
  double specific_tension = 0.25e6;   ///< [N/m^2]; with F0, L0 and density it gives the muscle's mass
  double density = 1059.7;            ///< [kg/m^3]
  double aerobic_factor = 1.5;        ///< Umberger's S: 1.5 for long, 1 for short efforts
  double basal_rate = 1.2;            ///< of the whole body [W/kg]
};

/// One muscle's rates of energy in one state [W].
struct MetabolicRate {
  double activation_and_maintenance = 0.0;
  double shortening = 0.0;
  double work = 0.0;  ///< of the active fibre, negative while it lengthens
  /// Heat is at least 1 W a kilogram, heat and work together at least 0: what lengthening returns is lost.
  double total = 0.0;
};

/// Density F0 L0/specific_tension of a muscle [kg].
[[nodiscard]] double muscle_mass(const MusculotendonParameters<double>& muscle, const MetabolicOptions& options);

/// Rates for an excitation and a state of a muscle. With slow share r, v = vM/L0 [1/s], Vmax [1/s], FL = fL, u, a:
///
///     Umberger, W/kg: A = u if u > a, else (u + a)/2
///       activation and maintenance  S A^0.6 (128 (1 - r) + 25)                    times 0.4 + 0.6 FL beyond L0
///       shortening                  S A^2 (min(250 |v|/Vmax, 100) r + 153 |v|/Vmax (1 - r))    times FL beyond L0
///       lengthening                 S A 1000 v/Vmax                                            times FL beyond L0
///     Bhargava, W/kg: s = r sin(pi u/2), f = (1 - r)(1 - cos(pi u/2)), p(l) straight through (0.5, 0.5), (1, 1),
///     (1.5, 0)
///       activation 40 s + 133 f, maintenance p(lM/L0) (74 s + 111 f), in W
///       shortening (0.16 F0 a FL + 0.18 F) |vM|, lengthening -0.157 F vM, F the active force
[[nodiscard]] MetabolicRate metabolic_rate(const MusculotendonParameters<double>& muscle, const MuscleDetails& state,
                                           double excitation, double slow_twitch, const MetabolicOptions& options);

/// The energy that a motion costs. Rows are instants.
struct MetabolicCost {
  estimation::RowMatrix power;  ///< by muscle [W]
  double basal = 0.0;           ///< of the whole body [W]
  double energy = 0.0;          ///< of muscles and basal rate over the motion [J]
};

/// Of a motion with its muscles. Without excitations the activations stand for them.
[[nodiscard]] MetabolicCost metabolic_cost(const MusculoskeletalSystem& system, const MuscleTrajectory& motion,
                                           const MetabolicOptions& options);

}  // namespace veridyn::muscle
