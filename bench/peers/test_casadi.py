"""The optimum of static optimization against that which CasADi finds with IPOPT, much closer than OpenSim's optimiser
goes. Moment arms, strengths and the forces that the motion needs are the program's and the model file's: the optimum
alone is compared."""

import os
import re
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy
import pytest

from program import columns_of, read_csv, run_study, shared_file, veridyn, write_csv

pytestmark = pytest.mark.peer("casadi")

# A part of their strength, so that some muscles of the motion work at their limit.
STRENGTH = 0.1
LEAST_ACTIVATION = 0.01  # of this kind of muscle
RESERVES = {True: 1000.0, False: 0.3}  # of the pelvis, of the joints [N or N m]
STUDY = """
[subject]
model = "weak.osim"
[motion]
method = "static optimization"
file = "motion.csv"
begin = 0
duration = 1
rate = 20
[motion.static_optimization]
formulation = "without physiology"
exponent = {exponent}
[motion.reserves]
{reserves}
"""


def weak_model(folder):
    """gait2392 with weaker muscles; its coordinates, and the strengths of its muscles by name [N]."""
    text = shared_file("data/opensim/gait2392_thelen2003muscle.osim").read_text()
    force = re.compile(r"(<max_isometric_force>)\s*([0-9.eE+-]+)\s*(</max_isometric_force>)")
    text = force.sub(lambda m: f"{m[1]}{STRENGTH * float(m[2])!r}{m[3]}", text)
    (folder / "weak.osim").write_text(text)
    root = ElementTree.fromstring(text)
    muscles = [m for m in root.iter("Thelen2003Muscle") if m.find("max_isometric_force") is not None]
    coordinates = {c.get("name"): float(c.findtext("default_value")) for c in root.iter("Coordinate")}
    return coordinates, {m.get("name"): float(m.findtext("max_isometric_force")) for m in muscles}


def swing(coordinates):
    """A second of both legs."""
    time = numpy.linspace(-0.2, 1.2, 141)
    s = 0.5 - 0.5 * numpy.cos(numpy.pi * numpy.clip(time, 0.0, 1.0))
    motion = {"time": time} | {c: numpy.full_like(time, value) for c, value in coordinates.items()}
    motion |= {"hip_flexion_r": 0.6 * s, "knee_angle_r": -0.2 - 0.6 * s, "ankle_angle_r": 0.2 * s}
    return motion | {"hip_flexion_l": -0.2 * s, "knee_angle_l": -0.3 - 0.2 * s}


@pytest.mark.parametrize("exponent", [2, 3])
def test_activations_are_those_of_ipopt(exponent, tmp_path, comparison):
    coordinates, strength = weak_model(tmp_path)
    write_csv(tmp_path / "motion.csv", swing(coordinates))
    reserves = {c: RESERVES[c.startswith("pelvis")] for c in coordinates}
    lines = "\n".join(f"{c} = {force}" for c, force in reserves.items())
    out = run_study(STUDY.format(exponent=exponent, reserves=lines), tmp_path)
    motion, muscles = read_csv(out / "motion.csv"), read_csv(out / "muscles.csv")

    poses = {c: motion[c] for c in coordinates}
    write_csv(tmp_path / "poses.csv", poses)
    table = columns_of(veridyn("inspect", tmp_path / "weak.osim", "--pose", tmp_path / "poses.csv"))
    frames = len(motion["time"])
    matrix = numpy.zeros((frames, len(coordinates), len(strength) + len(coordinates)))
    for j, c in enumerate(coordinates):
        for i, m in enumerate(strength):
            matrix[:, j, i] = strength[m] * table.get(f"{m}.moment_arm.{c}", 0.0)
        matrix[:, j, len(strength) + j] = reserves[c]
    wanted = numpy.array([motion[f"{c}_force"] for c in coordinates]).T
    limits = {
        "low": [*[LEAST_ACTIVATION] * len(strength), *[-1e6] * len(reserves)],
        "high": [*[1.0] * len(strength), *[1e6] * len(reserves)],
    }
    numpy.savez(tmp_path / "problems.npz", matrix=matrix, wanted=wanted, exponent=exponent, **limits)
    script = Path(__file__).with_name("casadi_optimum.py")
    # OpenSim, where it is loaded, has put its own libraries before CasADi's.
    environment = {name: value for name, value in os.environ.items() if name != "LD_LIBRARY_PATH"}
    command = [sys.executable, script, tmp_path / "problems.npz", tmp_path / "results.npz"]
    subprocess.run(command, check=True, env=environment)
    theirs = numpy.load(tmp_path / "results.npz")["controls"]

    activations = numpy.array([muscles[f"{m}_activation"] for m in strength]).T
    controls = numpy.array([motion[f"{c}_reserve"] / reserves[c] for c in coordinates]).T
    ours = numpy.hstack([activations, controls])
    at_limits = [(numpy.abs(activations - x) < 1e-6).any(axis=1).sum() for x in (LEAST_ACTIVATION, 1.0)]
    assert min(at_limits) > frames / 4, at_limits
    label = f"gait2392, exponent {exponent}, {frames} frames"
    balance = numpy.abs(numpy.einsum("fij,fj->fi", matrix, ours) - wanted).max()
    comparison.within(f"{label}: balance of ours [N m, N]", balance, 1e-7)
    costs = [(numpy.abs(x) ** exponent).sum(axis=1) for x in (ours, theirs)]
    comparison.within(f"{label}: cost, relative", numpy.abs(costs[0] / costs[1] - 1.0).max(), 1e-7)
    comparison.within(f"{label}: controls", numpy.abs(ours - theirs).max(), 1e-7)
