#pragma once

#include "veridyn/aircraft/simulation/simulation.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::aircraft {

/// Reads from the root of a study what `simulate` needs:
///
///     seed = 1                     # random numbers: same seed, same bytes
///
///     [subject]                    # see read_subject; builtin = "unatrap" is enough
///
///     [flight]
///     duration = 300               # [s] > 0, at most 86400
///     altitude = 100               # above sea level, kept by the pilot [m]
///     ground = 0                   # height of the ground above sea level [m], below altitude
///     airspeed = 20                # [m/s]; left out: where the lift coefficient is 0.5
///     heading = 0                  # at the start [rad]
///     step = 0.0025                # of the integration [s], at most 0.02
///     truth_rate = 100             # of the truth recording [Hz]
///     gravity = 9.80665            # [m/s^2]
///     wind = [3, -2, 0]            # where the air moves to: north, east, down [m/s]
///     wind_shear = 0.14            # exponent of the power law; 0: none
///     wind_shear_reference = 10    # height above ground where `wind` holds [m]
///     wind_drift = 0.3             # slow random change, standard deviation of each component [m/s]
///     wind_drift_time = 120        # its correlation time [s]
///     turbulence = "low_moderate"  # none, low_light, low_moderate, medium_light, medium_moderate, or
///                                  # { Lu = 200, Lv = 200, Lw = 50, sigma_u = 2.1, sigma_v = 2.1, sigma_w = 1.4 }
///     excitation_gain = 0.3        # share of its feedback that the pilot keeps on a surface while it is excited
///     plan = "default"             # "default" (see default_plan) or "none" (straight and level), when no
///     [[flight.manoeuvre]]         # manoeuvres are listed (see read_manoeuvres)
///     [[flight.change]]            # the aircraft changes in flight, in order of time; the autopilot keeps its gains
///     time = 300                   # [s]
///     parameters = { Cm_alpha = -0.35 }   # from then on; parameters of the subject's model, by name
///
///     [sensors]                    # see read_sensors; the reference set when left out
///
/// Other keys of the root are left to others; `Study::root().finish()` finds the misspelt ones.
/// @throws InputError with file, line and key.
[[nodiscard]] SimulationOptions read_simulation(const StudyTable& root);

/// Reads the study and flies it.
[[nodiscard]] SimulatedFlight simulate_study(const StudyTable& root, Progress& progress);

}  // namespace veridyn::aircraft
