"""Exported aircraft in JSBSim: loads at states of a simulated flight, and the flight itself with the same deflections.

The program flies a built-in aircraft with doublets of all surfaces (`simulate`; truth.csv has the states, deflections
and loads of every step) and exports it (`export --format jsbsim`). JSBSim loads the file and gets deflections and
throttle of every step. Servos are without lag, so that a commanded deflection is a deflection: truth.csv has no
commands, and so the file's servos are not compared; the rotor's lag is."""

import numpy
import pytest

from jsbsim_aircraft import LOADS, JsbsimAircraft
from program import read_csv, run_study, veridyn

pytestmark = pytest.mark.peer("jsbsim")

AIRCRAFT = ["aerosonde", "tut_airplane", "x8", "hcuav", "skywalker_2013", "thor", "unatrap"]
# JSBSim starts with a rotor that turns as its throttle says; in flight it lags behind.
WITH_ROTOR = {"unatrap"}
STEP = 0.0025
STUDY = """
[subject]
builtin = "{aircraft}"
[subject.actuators.elevator]
time_constant = 0
[subject.actuators.aileron]
time_constant = 0
[subject.actuators.rudder]
time_constant = 0
[flight]
duration = 8
altitude = 300
step = 0.0025
truth_rate = 400
[[flight.manoeuvre]]
kind = "doublet"
start = 1
surfaces = ["elevator"]
amplitude = "3 deg"
pulse = 0.5
[[flight.manoeuvre]]
kind = "doublet"
start = 4
surfaces = ["aileron", "rudder"]
amplitude = "4 deg"
pulse = 0.4
[sensors]
set = "perfect"
"""


@pytest.fixture(scope="module", params=AIRCRAFT)
def flight(request, tmp_path_factory):
    """Name, exported file, and truth.csv of a flight."""
    folder = tmp_path_factory.mktemp(request.param)
    study = STUDY.format(aircraft=request.param)
    exported = export(study, folder)
    return request.param, exported, read_csv(run_study(study, folder) / "truth.csv")


def export(study, folder):
    (folder / "study.toml").write_text(study)
    veridyn("export", folder / "study.toml", "--format", "jsbsim", "--out", folder / "export", "--quiet")
    return folder / "export" / "jsbsim.xml"


def rows_of(truth, parts=1):
    """Rows of truth.csv; with `parts` rows a step, between which all goes in straight lines, as the deflections do."""
    time = truth["time"]
    at = numpy.linspace(time[0], time[-1], (len(time) - 1) * parts + 1)
    columns = {name: numpy.interp(at, time, values) for name, values in truth.items()}
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def test_loads_of_the_file_are_those_of_the_flight(flight, tmp_path, comparison):
    # JSBSim's density is off by 1.1e-5 of itself (other constants of the standard atmosphere), and forces with it;
    # thrust does not follow density in every engine's law. The rest is 17 digits and units.
    name, exported, truth = flight
    air = JsbsimAircraft(exported, tmp_path, STEP)
    worst, density = {}, 0.0
    for row in rows_of(truth)[: 1 if name in WITH_ROTOR else None : 40]:
        air.start(row)
        loads, states = air.loads(), air.states()
        density = max(density, abs(states["air_density"] / row["air_density"] - 1.0))
        for load in LOADS:
            worst[load] = max(worst.get(load, 0.0), abs(loads[load] - row[load]))
    comparison.within(f"{name}: air density, relative", density, 1.2e-5)
    for kind in ("force", "moment"):
        axes = [f"{kind}_{axis}" for axis in "xyz"]
        size = max(numpy.abs(truth[axis]).max() for axis in axes)
        comparison.within(f"{name}: {kind}, relative", max(worst[axis] for axis in axes) / size, 1.2e-5)


ANGLES = ("alpha", "beta", "roll", "pitch")
RATES = ("gyro_x", "gyro_y", "gyro_z")
# JSBSim's integrators: Adams-Bashforth of order 4 for rates and positions; its own are of order 1 for rotations.
INTEGRATORS = [
    f"simulation/integrator/{what}/{of}" for what in ("rate", "position") for of in ("rotational", "translational")
]
ADAMS_BASHFORTH_4 = 5


def differences(flown, truth, parts, names):
    return max(numpy.abs(flown[name][::parts] - truth[name]).max() for name in names)


def test_a_flight_of_the_file_is_the_flight(flight, tmp_path, comparison):
    name, exported, truth = flight
    parts = 4
    air = JsbsimAircraft(exported, tmp_path, STEP / parts)
    for integrator in INTEGRATORS:
        air.fdm[integrator] = ADAMS_BASHFORTH_4
    flown = air.fly(rows_of(truth, parts))
    assert numpy.ptp(truth["pitch"]) > 0.02 and numpy.ptp(truth["roll"]) > 0.02, "must have moved"
    # Eight seconds with a density that is off by 1.1e-5: drag of 1e-5 g, lift of 1e-4 m/s^2. Rates follow deflections
    # that JSBSim holds over a step of 0.6 ms while they move in straight lines here.
    comparison.within(f"{name}: airspeed [m/s]", differences(flown, truth, parts, ["airspeed"]), 5e-4)
    comparison.within(f"{name}: angles [rad]", differences(flown, truth, parts, ANGLES), 5e-5)
    comparison.within(f"{name}: rates [rad/s]", differences(flown, truth, parts, RATES), 5e-4)


def test_jsbsims_own_integrators_come_to_the_same_flight(flight, tmp_path, comparison):
    # They are of the first order: a quarter of the step, a quarter of the difference.
    name, exported, truth = flight
    off = []
    for parts in (1, 4):
        air = JsbsimAircraft(exported, tmp_path / str(parts), STEP / parts)
        off.append(differences(air.fly(rows_of(truth, parts)), truth, parts, RATES))
    comparison.within(f"{name}: rates with steps of 2.5 ms [rad/s]", off[0], 0.2)
    comparison.within(f"{name}: of that left with steps of 0.6 ms", off[1] / off[0], 0.3)


def test_jsbsim_reads_the_file_without_a_word(flight, tmp_path, capfd):
    _, exported, _ = flight
    JsbsimAircraft(exported, tmp_path, STEP)
    captured = capfd.readouterr()
    assert "peer.xml" not in captured.out + captured.err
