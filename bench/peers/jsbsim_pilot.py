"""Flights of JSBSim's own aircraft by a pilot of our own, and what JSBSim says of every moment.

An aircraft of the `jsbsim` package is trimmed over a flat planet; 3-2-1-1 and doublets of elevator, aileron and rudder
are flown in two legs with a turn between them, in calm air or in JSBSim's turbulence. Between manoeuvres pitch and
bank are held; during them hands are nearly off the controls of their axis."""

import dataclasses
import tempfile

import jsbsim
import numpy

from jsbsim_aircraft import FLAT_PLANET, FOOT, POUND

SLUG = POUND / FOOT
STEP_S, EVERY = 0.005, 4  # recorded at 50 Hz
DEG = numpy.pi / 180.0


@dataclasses.dataclass(frozen=True)
class Aircraft:
    """Where it is flown, and how far and long its pilot moves the controls (of full throw)."""

    altitude_m: float
    speed_kt: float  # calibrated
    pulse_s: float  # the shortest of a 3-2-1-1
    elevator: float
    aileron: float
    rudder: float
    imu: tuple = (0.3, 0.0, 0.1)  # from the centre of gravity [m]


AIRCRAFT = {
    "c172p": Aircraft(1500.0, 95.0, 0.4, 0.12, 0.35, 0.35),
    "J3Cub": Aircraft(800.0, 60.0, 0.4, 0.15, 0.3, 0.35),
    "OV10": Aircraft(2000.0, 160.0, 0.4, 0.12, 0.2, 0.3),
    "T37": Aircraft(3000.0, 200.0, 0.4, 0.12, 0.2, 0.3),
    "global5000": Aircraft(5000.0, 250.0, 0.6, 0.12, 0.2, 0.25, (2.0, 0.0, 0.5)),
    "B747": Aircraft(6000.0, 280.0, 0.8, 0.2, 0.25, 0.25, (10.0, 0.0, 1.0)),
}
# Wind at 20 ft [ft/s] by which JSBSim sizes the turbulence of MIL-F-8785C, and its severity above 2000 ft.
AIRS = {"calm": None, "light": (25.0, 3), "moderate": (50.0, 4)}
MILSPEC = 3

SURFACES = {
    "elevator": "fcs/elevator-pos-rad",
    "aileron": "fcs/left-aileron-pos-rad",
    "rudder": "fcs/rudder-pos-rad",
}
INERTIA = {"Jx": "xx", "Jy": "yy", "Jz": "zz", "Jxz": "xz"}
THRUST = ("thrust", "thrust_y", "thrust_z")
RECORDED = {
    "airspeed": ("velocities/vt-fps", FOOT),
    "alpha": ("aero/alpha-rad", 1.0),
    "beta": ("aero/beta-rad", 1.0),
    "p": ("velocities/p-rad_sec", 1.0),
    "q": ("velocities/q-rad_sec", 1.0),
    "r": ("velocities/r-rad_sec", 1.0),
    "p_air": ("velocities/p-aero-rad_sec", 1.0),
    "q_air": ("velocities/q-aero-rad_sec", 1.0),
    "r_air": ("velocities/r-aero-rad_sec", 1.0),
    "p_rate": ("accelerations/pdot-rad_sec2", 1.0),
    "q_rate": ("accelerations/qdot-rad_sec2", 1.0),
    "r_rate": ("accelerations/rdot-rad_sec2", 1.0),
    "roll": ("attitude/phi-rad", 1.0),
    "pitch": ("attitude/theta-rad", 1.0),
    "yaw": ("attitude/psi-rad", 1.0),
    "vel_north": ("velocities/v-north-fps", FOOT),
    "vel_east": ("velocities/v-east-fps", FOOT),
    "vel_down": ("velocities/v-down-fps", FOOT),
    "density": ("atmosphere/rho-slugs_ft3", SLUG / FOOT**3),
    "temperature": ("atmosphere/T-R", 5.0 / 9.0),
    "pressure": ("atmosphere/P-psf", POUND / FOOT**2),
    "force_x": ("forces/fbx-aero-lbs", POUND),
    "force_y": ("forces/fby-aero-lbs", POUND),
    "force_z": ("forces/fbz-aero-lbs", POUND),
    "moment_x": ("moments/l-aero-lbsft", POUND * FOOT),
    "moment_y": ("moments/m-aero-lbsft", POUND * FOOT),
    "moment_z": ("moments/n-aero-lbsft", POUND * FOOT),
    "thrust": ("forces/fbx-prop-lbs", POUND),
    "thrust_y": ("forces/fby-prop-lbs", POUND),
    "thrust_z": ("forces/fbz-prop-lbs", POUND),
    "thrust_moment_y": ("moments/m-prop-lbsft", POUND * FOOT),
} | {name: (property_, 1.0) for name, property_ in SURFACES.items()}


def smooth_step(time, at):
    """From 0 to 1 about `at`: a hand takes a fifth of a second."""
    x = numpy.clip((time - at) / 0.2 + 0.5, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


def pulses(time, start, durations):
    """Of alternating sign and unit height, one after the other."""
    value, at, sign = numpy.zeros_like(time), start, 1.0
    for duration in durations:
        value += sign * (smooth_step(time, at) - smooth_step(time, at + duration))
        at, sign = at + duration, -sign
    return value


@dataclasses.dataclass
class Plan:
    """What the pilot does: of each control its inputs [of full throw] and when hands are off it, and the bank."""

    time: numpy.ndarray
    inputs: dict
    busy: dict
    bank: numpy.ndarray
    spans: dict  # manoeuvres by axis [s]


def plan_of(aircraft):
    unit = aircraft.pulse_s
    long, short = [3 * unit, 2 * unit, unit, unit], [2 * unit, 2 * unit]
    size = {"elevator": aircraft.elevator, "aileron": aircraft.aileron, "rudder": aircraft.rudder}
    events = [("elevator", long, 1.0), ("elevator", short, -1.0), ("aileron", short, 1.0), ("rudder", long, 1.0)]
    events += [("aileron", long, -0.7), ("rudder", short, -1.0), ("elevator", long, -1.0)]
    rest, after = 8.0 + 6.0 * unit, 3.0 + 4.0 * unit
    schedule, start, turn = [], 5.0, 0.0
    for leg in range(2):
        for control, durations, sign in events:
            schedule.append((control, start, durations, sign * (1.0 if leg == 0 else -0.8)))
            start += sum(durations) + rest
        if leg == 0:
            turn, start = start, start + 30.0
    time = numpy.arange(0.0, start, STEP_S)
    inputs = {name: numpy.zeros_like(time) for name in SURFACES}
    busy = {name: numpy.zeros(len(time), bool) for name in SURFACES}
    spans = {"longitudinal": [], "lateral": []}
    for control, begin, durations, sign in schedule:
        inputs[control] += sign * size[control] * pulses(time, begin, durations)
        end = begin + sum(durations) + after
        lateral = control != "elevator"
        for name in ("aileron", "rudder") if lateral else ("elevator",):
            busy[name] |= (time > begin - 0.5) & (time < end)
        spans["lateral" if lateral else "longitudinal"].append((begin - 0.5, end))
    bank = 25.0 * DEG * (smooth_step(time, turn) - smooth_step(time, turn + 22.0))
    return Plan(time, inputs, busy, bank, spans)


def trimmed(name):
    """The aircraft in level flight, wheels up, engines running, no fuel burnt."""
    aircraft = AIRCRAFT[name]
    fdm = jsbsim.FGFDMExec(None)
    fdm.set_debug_level(0)
    # Some aircraft name a file of output, which is made as they are loaded.
    fdm.set_output_path(tempfile.gettempdir())
    assert fdm.load_planet(str(FLAT_PLANET), False) and fdm.load_model(name)
    fdm.disable_output()
    fdm.set_dt(STEP_S)
    fdm["ic/h-sl-ft"] = aircraft.altitude_m / FOOT
    fdm["ic/vc-kts"] = aircraft.speed_kt
    fdm["ic/psi-true-deg"] = 30.0
    fdm["gear/gear-cmd-norm"] = fdm["gear/gear-pos-norm"] = 0.0
    for i in range(fdm.get_propulsion().get_num_engines()):
        fdm[f"fcs/mixture-cmd-norm[{i}]"] = 0.9
        fdm[f"fcs/advance-cmd-norm[{i}]"] = 0.8
        fdm[f"fcs/throttle-cmd-norm[{i}]"] = 0.6
    assert fdm.run_ic()
    fdm["propulsion/set-running"] = -1
    fdm.do_trim(1)
    fdm["propulsion/fuel_freeze"] = 1
    return fdm


def body_of(fdm):
    """Mass, geometry and inertia; JSBSim's product of inertia has the other sign."""
    of = {j: fdm[f"inertia/i{k}-slugs_ft2"] * SLUG * FOOT**2 for j, k in INERTIA.items()}
    of["Jxz"] = -of["Jxz"]
    of["mass"] = fdm["inertia/mass-slugs"] * SLUG
    of["wing_area"] = fdm["metrics/Sw-sqft"] * FOOT**2
    of["span"], of["chord"] = fdm["metrics/bw-ft"] * FOOT, fdm["metrics/cbarw-ft"] * FOOT
    return of


def state_of(fdm):
    return [fdm[property_] * unit for property_, unit in RECORDED.values()]


@dataclasses.dataclass
class Flight:
    """What JSBSim says of the moments that are recorded, by the names of RECORDED, and `time`."""

    truth: dict
    spans: dict
    body: dict
    imu: tuple


def fly(name, air, seed):
    plan, fdm = plan_of(AIRCRAFT[name]), trimmed(name)
    if AIRS[air] is not None:
        heading = numpy.random.default_rng([seed, 1]).uniform(0.0, 2.0 * numpy.pi)
        fdm["atmosphere/wind-north-fps"] = 15.0 * numpy.cos(heading)
        fdm["atmosphere/wind-east-fps"] = 15.0 * numpy.sin(heading)
        fdm["atmosphere/randomseed"] = fdm["simulation/randomseed"] = seed
        fdm["atmosphere/turb-type"] = MILSPEC
        speed, severity = AIRS[air]
        fdm["atmosphere/turbulence/milspec/windspeed_at_20ft_AGL-fps"] = speed
        fdm["atmosphere/turbulence/milspec/severity"] = severity
    pitch = fdm["attitude/theta-rad"]
    start = {c: fdm[f"fcs/{c}-cmd-norm"] for c in SURFACES}
    rows = []
    for k in range(len(plan.time)):
        hold = {
            "elevator": 0.8 * (fdm["attitude/theta-rad"] - pitch) + 0.4 * fdm["velocities/q-rad_sec"],
            "aileron": 0.5 * (plan.bank[k] - fdm["attitude/phi-rad"]) - 0.2 * fdm["velocities/p-rad_sec"],
            "rudder": 0.0,
        }
        for c in SURFACES:
            gain = 0.05 if plan.busy[c][k] else 1.0
            fdm[f"fcs/{c}-cmd-norm"] = numpy.clip(start[c] + plan.inputs[c][k] + gain * hold[c], -1.0, 1.0)
        assert fdm.run()
        if k % EVERY == 0:
            rows.append(state_of(fdm))
    truth = dict(zip(RECORDED, numpy.array(rows).T, strict=True))
    truth["time"] = plan.time[::EVERY]
    return Flight(truth, plan.spans, body_of(fdm), AIRCRAFT[name].imu)
