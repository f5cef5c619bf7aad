"""Exported aircraft in JSBSim: loads at states of a simulated flight, and the flight itself with the same deflections.

The program flies a built-in aircraft with doublets of all surfaces (`simulate`; truth.csv has the states, deflections
and loads of every step) and exports it (`export --format jsbsim`). JSBSim loads the file and gets deflections and
throttle of every step. Servos are without lag, so that a commanded deflection is a deflection: truth.csv has no
commands, and so the file's servos are not compared; the rotor's lag is."""

import json
import subprocess
import sys

import numpy
import pytest

from jsbsim_aircraft import FOOT, LOADS, JsbsimAircraft
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


# What JSBSim says of a file that it does not like; it says so on a level of messages that it prints by default.
COMPLAINTS = ("warning", "in file", "ignored", "should have", "no thruster", "error", "deprecated", "not found")
LOAD = """
import jsbsim, sys
fdm = jsbsim.FGFDMExec(None)
fdm.set_aircraft_path(sys.argv[1])
sys.exit(0 if fdm.load_model("peer") else 1)
"""


def complaints(exported, folder):
    """Lines of both streams of a process that loads a file with JSBSim's own messages switched on."""
    home = folder / "loud" / "peer"
    home.mkdir(parents=True)
    (home / "peer.xml").write_bytes(exported.read_bytes())
    done = subprocess.run([sys.executable, "-c", LOAD, home.parent], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    lines = (done.stdout + done.stderr).splitlines()
    return [line for line in lines if any(word in line.lower() for word in COMPLAINTS)]


def test_jsbsim_complains_of_nothing_while_it_loads(flight, tmp_path):
    _, exported, _ = flight
    assert complaints(exported, tmp_path) == []


def trimmed(air, flown, mode):
    """The aircraft after `do_simple_trim` at the condition that the program has flown it in; raises where it fails."""
    air.fdm["ic/h-sl-ft"] = flown["altitude"] / FOOT
    air.fdm["ic/vt-fps"] = flown["airspeed"] / FOOT
    air.fdm["ic/gamma-deg"] = 0.0
    assert air.fdm.run_ic()
    air.fdm["simulation/do_simple_trim"] = mode
    return air.fdm


LONGITUDINAL, FULL = 0, 1


def check_trim(exported, summary, folder, comparison, name):
    """JSBSim's trims against the program's: its tolerances are 1e-3 ft/s^2 and 1e-4 rad/s^2."""
    flown = summary["jsbsim"]
    assert flown["trimmed"]
    fdm = trimmed(JsbsimAircraft(exported, folder / "longitudinal", STEP), flown, LONGITUDINAL)
    comparison.within(f"{name}: alpha of the trim [rad]", abs(fdm["aero/alpha-rad"] - flown["alpha"]), 1e-4)
    comparison.within(f"{name}: throttle of the trim", abs(fdm["fcs/throttle-pos-norm"] - flown["throttle"]), 1e-3)
    fdm = trimmed(JsbsimAircraft(exported, folder / "full", STEP), flown, FULL)
    speed = fdm["velocities/vt-fps"]
    for _ in range(int(5.0 / STEP)):
        assert fdm.run()
    comparison.within(f"{name}: airspeed lost in 5 s, relative", abs(fdm["velocities/vt-fps"] / speed - 1.0), 1e-3)


def test_jsbsim_trims_the_file_as_the_program_does(flight, tmp_path, comparison):
    name, _, _ = flight
    (tmp_path / "study.toml").write_text(STUDY.format(aircraft=name))
    summary = json.loads(
        veridyn("export", tmp_path / "study.toml", "--format", "jsbsim", "--out", tmp_path / "out", "--json", "--quiet")
    )
    if not summary["jsbsim"]["trimmed"]:
        pytest.skip(f"{name} does not fly level at {summary['jsbsim']['airspeed']} m/s, as the program says")
    check_trim(tmp_path / "out" / "jsbsim.xml", summary, tmp_path, comparison, name)


# An own aircraft without an engine, flown by the built-in one.
WITHOUT_THRUST = """
[subject]
name = "mine"
mass = 12.6
wing_area = 0.92
span = 2.72
chord = 0.34
inertia = { Jx = 0.8244, Jy = 1.135, Jz = 1.759, Jxz = 0.1204 }
[subject.model]
CL = ["1", "alpha", "q_n", "de"]
CD = ["1", "alpha", "alpha^2"]
CY = ["1", "beta", "p_n", "r_n", "da", "dr"]
Cl = ["1", "beta", "p_n", "r_n", "da", "dr"]
Cm = ["1", "alpha", "q_n", "de"]
Cn = ["1", "beta", "p_n", "r_n", "da", "dr"]
[data]
file = "out/recording.csv"
"""


def test_a_log_without_thrust_becomes_a_file_that_jsbsim_trims(tmp_path, comparison):
    run_study('seed = 1\n[subject]\nbuiltin = "unatrap"\n[flight]\nduration = 200\nairspeed = 20\n', tmp_path)
    (tmp_path / "own.toml").write_text(WITHOUT_THRUST)
    identified = tmp_path / "identified"
    veridyn("identify", tmp_path / "own.toml", "--out", identified, "--quiet")
    exported = tmp_path / "export"
    summary = json.loads(
        veridyn("export", identified / "subject.toml", "--format", "jsbsim", "--out", exported, "--json", "--quiet")
    )
    sources = summary["jsbsim"]["sources"]
    assert sources["CL_alpha"]["from"] == "the flight"
    assert sources["CD_alpha2"]["from"] == "an estimate"
    assert complaints(exported / "jsbsim.xml", tmp_path) == []
    check_trim(exported / "jsbsim.xml", summary, tmp_path, comparison, "log without thrust")
