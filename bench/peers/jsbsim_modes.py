"""The natural modes of JSBSim's own aircraft, by JSBSim's linearisation at the trim in which our pilot's flights begin."""

import jsbsim
import numpy

from jsbsim_pilot import trimmed

# Their yaw dampers are in JSBSim's linearisation, where the controls are not held.
AUGMENTED = ("global5000", "B747")
LONGITUDINAL, LATERAL = ("Vt", "Alpha", "Q", "Theta"), ("Beta", "P", "R", "Phi")


def roots_of(linear, names):
    """Of some states alone, the larger first."""
    at = [list(linear.x_names).index(name) for name in names]
    return sorted(numpy.linalg.eigvals(numpy.array(linear.system_matrix)[numpy.ix_(at, at)]), key=lambda z: -abs(z))


def oscillation(name, first, second):
    frequency = numpy.sqrt((first * second).real)
    return {f"{name}.frequency": frequency, f"{name}.damping": -(first + second).real / (2.0 * frequency)}


def true_modes(name):
    """By the names of estimate.json; height, heading, place and engine speed are held."""
    linear = jsbsim.FGLinearization(trimmed(name))
    found = oscillation("short_period", *(roots := roots_of(linear, LONGITUDINAL))[:2])
    found |= oscillation("phugoid", *roots[2:])
    if name in AUGMENTED:
        return found
    roots = roots_of(linear, LATERAL)
    pair, real = [z for z in roots if z.imag != 0.0], [z.real for z in roots if z.imag == 0.0]
    found |= oscillation("dutch_roll", *pair)
    found["roll.time_to_half"] = numpy.log(2.0) / -real[0]
    found["spiral.time_to_half" if real[1] < 0.0 else "spiral.time_to_double"] = numpy.log(2.0) / abs(real[1])
    return found
