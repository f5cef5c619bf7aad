"""Flights of JSBSim's own aircraft, and how many intervals of `veridyn identify` hold what JSBSim's tables hold.

An aircraft of the `jsbsim` package is trimmed over a flat planet and flown by a pilot of our own: 3-2-1-1 and doublets
of elevator, aileron and rudder in two legs with a turn between them, in calm air or in JSBSim's turbulence, which has
p_g, q_g and r_g (its q_g has the other sign than a gust that meets the nose first gives it). It is recorded by ordinary
sensors and identified by the study that a user writes who knows mass, inertia and geometry. JSBSim's
aerodynamic moments are about the centre of gravity, as ours. As a program, a table of all aircraft and airs:

    python jsbsim_truth.py SEED SEED ...            # -v: and every interval that does not hold
"""

import json
import pathlib
import sys
import tempfile

import numpy

from intervals import MEANT, IntervalCount
from jsbsim_modes import true_modes
from jsbsim_pilot import AIRCRAFT, AIRS, DEG, RECORDED, SURFACES, THRUST, body_of, fly, state_of, trimmed
from program import run_study, write_csv

IMU_ERROR_M = 0.03  # of its place
LONGITUDINAL, LATERAL = ["1", "alpha", "q_n", "de"], ["1", "beta", "p_n", "r_n", "da", "dr"]
MODEL = {
    "CL": LONGITUDINAL,
    "CD": ["1", "alpha", "alpha^2"],
    "CY": LATERAL,
    "Cl": LATERAL,
    "Cm": LONGITUDINAL,
    "Cn": LATERAL,
}


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
        "q_g": body["chord"] * half * (truth["q_air"] - truth["q"]),
    }


def parameter(coefficient, term):
    return coefficient + "_" + {"1": "0", "alpha^2": "alpha2"}.get(term, term.removesuffix("_n"))


def effective_truth(flight):
    """Each coefficient's derivatives by least squares on what JSBSim says itself, over the manoeuvres of its axis.
    JSBSim's alpha' is that of the aircraft's own motion, and so belongs to the terms by alpha and q; it follows q and
    not q + q_g, the difference of which has a column of its own."""
    found = {}
    coefficients, columns = coefficients_of(flight.truth, flight.body), variables_of(flight.truth, flight.body)
    for name, terms in MODEL.items():
        axis = "longitudinal" if "alpha" in terms else "lateral"
        time = flight.truth["time"]
        rows = numpy.any([(time > begin) & (time < end) for begin, end in flight.spans[axis]], axis=0)
        names = terms + (["q_g"] if "q_n" in terms and numpy.any(columns["q_g"][rows]) else [])
        theta = numpy.linalg.lstsq(numpy.column_stack([columns[n][rows] for n in names]), coefficients[name][rows])[0]
        found |= {parameter(name, t): v for t, v in zip(terms, theta, strict=False) if t != "1"}
    return found


def perturbed_truth(name):
    """The same by central differences of JSBSim's forces and moments about the state in which the flight begins, one
    variable after the other; alpha' of the aircraft's own motion follows alpha and q there. CD, which has two terms by
    one variable, is left out."""
    fdm = trimmed(name)
    start = {s: fdm[f"aero/{s}-rad"] for s in ("alpha", "beta")} | {"theta": fdm["attitude/theta-rad"]}
    speed, commands = fdm["velocities/vt-fps"], {c: fdm[f"fcs/{c}-cmd-norm"] for c in SURFACES}
    differences = []
    for what in ("alpha-rad", "beta-rad", "p-rad_sec", "q-rad_sec", "r-rad_sec", *SURFACES):
        states = []
        for sign in (1.0, -1.0):
            fdm["ic/vt-fps"] = speed
            for name_, value in start.items():
                fdm[f"ic/{name_}-rad"] = value
            for rate in "pqr":
                fdm[f"ic/{rate}-rad_sec"] = 0.0
            for c in SURFACES:
                fdm[f"fcs/{c}-cmd-norm"] = commands[c] + (0.02 * sign if c == what else 0.0)
            if what not in SURFACES:
                fdm[f"ic/{what}"] = start.get(what.removesuffix("-rad"), 0.0) + 0.01 * sign
            assert fdm.run_ic()
            states.append(state_of(fdm))
        differences.append(states)
    high, low = (dict(zip(RECORDED, numpy.array(side).T, strict=True)) for side in zip(*differences, strict=True))
    body, found = body_of(fdm), {}
    change = {key: v - variables_of(low, body)[key] for key, v in variables_of(high, body).items()}
    loads = {key: v - coefficients_of(low, body)[key] for key, v in coefficients_of(high, body).items()}
    for coefficient, terms in MODEL.items():
        if coefficient == "CD":
            continue
        X = numpy.column_stack([change[t] for t in terms if t != "1"])
        rows = numpy.abs(X).max(axis=1) > 1e-4
        theta = numpy.linalg.lstsq(X[rows], loads[coefficient][rows])[0]
        found |= {parameter(coefficient, t): v for t, v in zip([t for t in terms if t != "1"], theta, strict=True)}
    return found


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
[flying_qualities]
airspeed = {speed}
"""


UNITS = {"time": "s", "thrust": "N", "airspeed": "m/s", "static_pressure": "Pa", "air_temperature": "K"}
UNITS |= {f"accel_{axis}": "m/s^2" for axis in "xyz"} | {f"gyro_{axis}": "rad/s" for axis in "xyz"}
UNITS |= {f"vel_{axis}": "m/s" for axis in ("north", "east", "down")}


def with_units(columns):
    return {f"{name}[{UNITS.get(name, 'rad')}]": values for name, values in columns.items()}


def study_of(name, flight):
    model = "\n".join(f"{c} = {json.dumps(terms)}" for c, terms in MODEL.items())
    columns = [f"accel_{i}" for i in "xyz"] + [f"gyro_{i}" for i in "xyz"] + ["roll", "pitch", "yaw", "airspeed"]
    columns += ["alpha", "beta", "static_pressure", "air_temperature", *SURFACES, "thrust"]
    maps = [f'{c} = "flight.{c}"' for c in columns]
    maps += [f'{c} = "gps.{c}"' for c in ("vel_north", "vel_east", "vel_down")]
    down = float(numpy.mean(flight.truth["thrust_moment_y"] / flight.truth["thrust"]))
    values = {"name": name, "model": model, "map": "\n".join(maps), "imu": list(flight.imu), "thrust_down": down}
    values["speed"] = float(flight.truth["airspeed"][0])
    return STUDY.format(**flight.body, **values)


def identified(name, air, seed, folder):
    """The estimate of a flight, and the derivatives that its aircraft has in it."""
    flight = fly(name, air, seed)
    random = numpy.random.default_rng([seed, 2, list(AIRCRAFT).index(name), list(AIRS).index(air)])
    columns, gps = recorded(flight, random)
    write_csv(folder / "flight.csv", with_units(columns))
    write_csv(folder / "gps.csv", with_units(gps))
    out = run_study(study_of(name, flight), folder, "identify")
    return json.loads((out / "estimate.json").read_text()), effective_truth(flight)


def counted(flights, folder, say=lambda text: None):
    """Counts of (aircraft, air, seed), by "all", aircraft, air, coefficient, parameter and "graded yes", and of the
    natural modes by "modes" and each quantity of them."""
    counts = {}
    for name, air, seed in flights:
        place = pathlib.Path(folder) / f"{name}_{air}_{seed}"
        place.mkdir()
        estimate, truth = identified(name, air, seed, place)
        grades = estimate["grades"]
        yes = all(grades[of]["grade"] == "yes" for of in ("data", "parameters"))
        for p in estimate["parameters"]:
            if p["name"] not in truth:
                continue
            true = truth[p["name"]]
            keys = ["all", name, air, p["name"].split("_")[0], p["name"]] + (["graded yes"] if yes else [])
            for key in keys:
                counts.setdefault(key, IntervalCount(MEANT)).add(p, true)
            if not p["low95"] <= true <= p["high95"]:
                say(f"{name} {air} {seed}: {p['name']} {p['value']:.4g} in [{p['low95']:.4g}, {p['high95']:.4g}], "
                    f"true {true:.4g}, {p['status']}")
        modes = true_modes(name)
        for quantity in estimate.get("derived", []):
            if quantity["name"] not in modes or quantity["low95"] is None:
                continue
            true, what = modes[quantity["name"]], quantity["name"]
            ends = {"low95": quantity["low95"], "high95": quantity["high95"] or numpy.inf}
            for key in ("modes", what):
                counts.setdefault(key, IntervalCount(MEANT)).add(quantity | ends | {"status": "identified"}, true)
            if not ends["low95"] <= true <= ends["high95"]:
                say(f"{name} {air} {seed}: {what} {quantity['value']:.4g} in [{ends['low95']:.4g}, "
                    f"{ends['high95']:.4g}], true {true:.4g}")
    return counts


if __name__ == "__main__":
    seeds = [int(text) for text in sys.argv[1:] if text != "-v"]
    whole = [(name, air, seed) for seed in seeds for name in AIRCRAFT for air in AIRS]
    with tempfile.TemporaryDirectory() as name:
        table = counted(whole, name, print if "-v" in sys.argv else lambda text: None)
    for key, count in table.items():
        print(f"{key:12}", count)
