"""Flights of JSBSim's own aircraft, and how many intervals of `veridyn identify` hold what JSBSim's tables hold.

An aircraft of the `jsbsim` package is trimmed over a flat planet and flown by a pilot of our own: 3-2-1-1 and doublets
of elevator, aileron and rudder in two legs with a turn between them, in calm air or in JSBSim's turbulence (MIL-F-8785C,
with p_g, q_g, r_g). It is recorded by ordinary sensors and identified by the study that a user writes who knows mass,
inertia and geometry. Forces are about the centre of gravity, as JSBSim's sums are. As a program:

    python jsbsim_truth.py SEED SEED ...            # a table of all aircraft and airs
    python jsbsim_truth.py --only c172p calm 1      # every interval of one flight
"""

import dataclasses
import json
import pathlib
import sys
import tempfile

import jsbsim
import numpy

from jsbsim_aircraft import FLAT_PLANET, FOOT, POUND
from program import run_study, write_csv

SLUG = POUND / FOOT
STEP_S, EVERY = 0.005, 4  # recorded at 50 Hz
KNOT = 1852.0 / 3600.0
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
LONGITUDINAL, LATERAL = ["1", "alpha", "q_n", "de"], ["1", "beta", "p_n", "r_n", "da", "dr"]
MODEL = {
    "CL": LONGITUDINAL,
    "CD": ["1", "alpha", "alpha^2"],
    "CY": LATERAL,
    "Cl": LATERAL,
    "Cm": LONGITUDINAL,
    "Cn": LATERAL,
}
RECORDED = {
    "airspeed": ("velocities/vt-fps", FOOT),
    "alpha": ("aero/alpha-rad", 1.0),
    "beta": ("aero/beta-rad", 1.0),
    "alpha_rate": ("aero/alphadot-rad_sec", 1.0),
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
    assert fdm.load_planet(str(FLAT_PLANET), False) and fdm.load_model(name)
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


def still_alpha_rate(truth, body):
    """alpha' of the aircraft's own motion, without that of gusts."""
    u, v, w = velocity_of(truth)
    specific = [(truth[f"force_{i}"] + truth[j]) / body["mass"] for i, j in zip("xyz", THRUST, strict=True)]
    pitch, roll, g = truth["pitch"], truth["roll"], 9.80665
    u_rate = specific[0] - g * numpy.sin(pitch) + truth["r"] * v - truth["q"] * w
    w_rate = specific[2] + g * numpy.cos(pitch) * numpy.cos(roll) + truth["q"] * u - truth["p"] * v
    return (u * w_rate - w * u_rate) / (u * u + w * w)


def velocity_of(truth):
    V, a, b = truth["airspeed"], truth["alpha"], truth["beta"]
    return V * numpy.cos(a) * numpy.cos(b), V * numpy.sin(b), V * numpy.sin(a) * numpy.cos(b)


def coefficients_of(truth, body):
    pressure = 0.5 * truth["density"] * truth["airspeed"] ** 2 * body["wing_area"]
    ca, sa = numpy.cos(truth["alpha"]), numpy.sin(truth["alpha"])
    x, z = truth["force_x"], truth["force_z"]
    return {
        "CL": (x * sa - z * ca) / pressure,
        "CD": -(x * ca + z * sa) / pressure,
        "CY": truth["force_y"] / pressure,
        "Cl": truth["moment_x"] / (pressure * body["span"]),
        "Cm": truth["moment_y"] / (pressure * body["chord"]),
        "Cn": truth["moment_z"] / (pressure * body["span"]),
    }


def variables_of(truth, body):
    """Columns by the names of the study's terms; rates are those against the air."""
    half = 0.5 / truth["airspeed"]
    return {
        "1": numpy.ones_like(truth["alpha"]),
        "alpha": truth["alpha"],
        "alpha^2": truth["alpha"] ** 2,
        "beta": truth["beta"],
        "p_n": body["span"] * half * truth["p_air"],
        "q_n": body["chord"] * half * truth["q_air"],
        "r_n": body["span"] * half * truth["r_air"],
        "de": truth["elevator"],
        "da": truth["aileron"],
        "dr": truth["rudder"],
        "gust": body["chord"] * half * (truth["q_air"] - truth["q"]),
    }


def parameter(coefficient, term):
    return coefficient + "_" + {"1": "0", "alpha^2": "alpha2"}.get(term, term.removesuffix("_n"))


def effective_truth(flight):
    """Each coefficient's derivatives by least squares on what JSBSim says itself, over the manoeuvres of its axis. What
    gusts do by way of alpha' is taken out: of the aircraft's own motion it belongs to the terms by alpha and q."""
    found, residual = {}, {}
    coefficients, columns = coefficients_of(flight.truth, flight.body), variables_of(flight.truth, flight.body)
    for name, terms in MODEL.items():
        axis = "longitudinal" if "alpha" in terms else "lateral"
        time = flight.truth["time"]
        rows = numpy.any([(time > begin) & (time < end) for begin, end in flight.spans[axis]], axis=0)
        gusts = axis == "longitudinal" and numpy.std(columns["gust"][rows]) > 1e-5
        names = terms + (["gust"] if gusts else [])
        X, z = numpy.column_stack([columns[n][rows] for n in names]), coefficients[name][rows]
        theta = numpy.linalg.lstsq(X, z)[0]
        found |= {parameter(name, t): v for t, v in zip(terms, theta, strict=False) if t != "1"}
        residual[name] = numpy.std(z - X @ theta) / numpy.std(z)
    return found, residual


def derivatives_at_trim(name):
    """The same by central differences of JSBSim's forces and moments at the state in which the flight begins, and how
    alpha' of the aircraft's own motion divides among the terms by alpha, q and de."""
    fdm = trimmed(name)
    rows = []
    steps = ["alpha-rad", "beta-rad", "p-rad_sec", "q-rad_sec", "r-rad_sec"]
    start = {s: fdm[f"aero/{s}" if s in steps[:2] else f"velocities/{s}"] for s in steps}
    commands = {c: fdm[f"fcs/{c}-cmd-norm"] for c in SURFACES}
    for what in [*steps, *SURFACES]:
        for sign in (-1.0, 1.0):
            moved = trimmed(name)
            if what in SURFACES:
                moved[f"fcs/{what}-cmd-norm"] = commands[what] + 0.05 * sign
            else:
                moved[f"ic/{what}"] = start[what] + 0.02 * sign
            rows.append((moved, what))
    return rows, start


def recorded(flight, random):
    """What ordinary sensors make of a flight: columns at 50 Hz, and those of a GPS at 10 Hz, with its latency."""
    truth, time = flight.truth, flight.truth["time"]
    rate = {axis: truth[f"{axis}_rate"] for axis in "pqr"}
    x, y, z = IMU_ERROR_M * random.standard_normal(3) + flight.imu
    p, q, r = truth["p"], truth["q"], truth["r"]
    force = [(truth[f"force_{i}"] + truth[j]) / flight.body["mass"] for i, j in zip("xyz", THRUST, strict=True)]
    arm = [
        rate["q"] * z - rate["r"] * y + q * (p * y - q * x) - r * (r * x - p * z),
        rate["r"] * x - rate["p"] * z + r * (q * z - r * y) - p * (p * y - q * x),
        rate["p"] * y - rate["q"] * x + p * (r * x - p * z) - q * (q * z - r * y),
    ]

    def noisy(values, noise, zero=0.0, scale=0.0, late=0.0):
        of_sensor = 1.0 + scale * random.standard_normal()
        off = zero * random.standard_normal()
        return numpy.interp(time - late, time, values) * of_sensor + off + noise * random.standard_normal(len(time))

    columns = {"time": time}
    for i, axis in enumerate("xyz"):
        columns[f"accel_{axis}"] = noisy(force[i] + arm[i], 0.05, 0.05)
        columns[f"gyro_{axis}"] = noisy(truth["pqr"[i]], 0.1 * DEG, 0.1 * DEG)
    columns["roll"] = noisy(truth["roll"], 0.1 * DEG, 0.3 * DEG)
    columns["pitch"] = noisy(truth["pitch"], 0.1 * DEG, 0.3 * DEG)
    columns["yaw"] = noisy(numpy.unwrap(truth["yaw"]), 0.2 * DEG, 1.0 * DEG)
    columns["airspeed"] = noisy(truth["airspeed"], 0.3, 0.0, 0.02)
    columns["alpha"] = noisy(truth["alpha"], 0.15 * DEG, 0.5 * DEG, 0.04, random.uniform(0.0, 0.03))
    columns["beta"] = noisy(truth["beta"], 0.15 * DEG, 0.5 * DEG, 0.04, random.uniform(0.0, 0.03))
    columns["static_pressure"] = noisy(truth["pressure"], 20.0)
    columns["air_temperature"] = noisy(truth["temperature"], 0.1, 1.0)
    for surface in SURFACES:
        columns[surface] = noisy(truth[surface], 0.05 * DEG)
    columns["thrust"] = noisy(truth["thrust"], 0.005 * numpy.mean(truth["thrust"]))
    late = random.uniform(0.05, 0.2)
    gps = {"time": time[::5]}
    for name in ("vel_north", "vel_east", "vel_down"):
        gps[name] = noisy(truth[name], 0.1, 0.0, 0.0, late)[::5]
    return columns, gps


STUDY = """
[subject]
name = "{name}"
mass = {mass}
wing_area = {wing_area}
span = {span}
chord = {chord}
sign_convention = "as JSBSim's positions"
imu_position = {imu}
inertia = {{ Jx = {Jx}, Jy = {Jy}, Jz = {Jz}, Jxz = {Jxz} }}
[subject.propulsion]
position = [0, 0, {thrust_down}]
[subject.model]
{model}
[data]
files = ["flight.csv", "gps.csv"]
[data.map]
{map}
[reconstruct]
airspeed_is = "true"
"""
IMU_ERROR_M = 0.03


UNITS = {"time": "s", "thrust": "N", "airspeed": "m/s", "static_pressure": "Pa", "air_temperature": "K"}
UNITS |= {name: unit for prefix, unit in (("accel", "m/s^2"), ("gyro", "rad/s")) for name in map(f"{prefix}_{{}}".format, "xyz")}


def with_units(columns):
    return {f"{name}[{UNITS.get(name, 'm/s' if name.startswith('vel') else 'rad')}]": values for name, values in columns.items()}


def study_of(name, flight):
    model = "\n".join(f"{c} = {json.dumps(terms)}" for c, terms in MODEL.items())
    columns = [f"accel_{i}" for i in "xyz"] + [f"gyro_{i}" for i in "xyz"] + ["roll", "pitch", "yaw", "airspeed"]
    columns += ["alpha", "beta", "static_pressure", "air_temperature", *SURFACES, "thrust"]
    maps = [f'{c} = "flight.{c}"' for c in columns] + [f'{c} = "gps.{c}"' for c in ("vel_north", "vel_east", "vel_down")]
    down = float(numpy.mean(flight.truth["thrust_moment_y"] / flight.truth["thrust"]))
    values = flight.body | {"name": name, "model": model, "map": "\n".join(maps), "imu": list(flight.imu), "thrust_down": down}
    return STUDY.format(**values)


def identified(name, air, seed, folder):
    """The estimate of a flight, and the derivatives that its aircraft has."""
    flight = fly(name, air, seed)
    truth, residual = effective_truth(flight)
    random = numpy.random.default_rng([seed, 2, list(AIRCRAFT).index(name), list(AIRS).index(air)])
    columns, gps = recorded(flight, random)
    write_csv(folder / "flight.csv", with_units(columns))
    write_csv(folder / "gps.csv", with_units(gps))
    out = run_study(study_of(name, flight), folder, "identify")
    return json.loads((out / "estimate.json").read_text()), truth, residual
