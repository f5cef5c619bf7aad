"""Fibres in equilibrium with their tendons, against OpenSim's `equilibrateMuscles`: the first row of a simulation from
rest, in random poses and with random activations."""

import numpy
import pytest

from opensim_model import OpenSimModel
from program import read_csv, run_study, shared_file

pytestmark = pytest.mark.peer("opensim")

POSES = 40
STUDY = """
[subject]
model = "{model}"
paths = "opensim"
[motion]
method = "forward"
duration = 0.001
rate = 1000
excitation = {{{excitation}}}
start = {{{start}}}
"""


@pytest.mark.parametrize("name", ["arm26", "arm26_millard"])
def test_fibres_are_as_long_and_pull_as_hard(name, tmp_path, comparison):
    path = shared_file(f"data/opensim/{name}.osim")
    model = OpenSimModel(path)
    random = numpy.random.default_rng(9)
    force, length, compared = 0.0, 0.0, 0
    for _ in range(POSES):
        pose = [random.uniform(c.getRangeMin(), c.getRangeMax()) for c in model.coordinates]
        activations = [random.choice([0.01, 0.1, 0.3, 0.6, 1.0]) for _ in model.muscles]
        model.pose(pose)
        for muscle, activation in zip(model.muscles, activations, strict=True):
            muscle.setActivation(model.state, activation)
        model.model.equilibrateMuscles(model.state)
        model.model.realizeDynamics(model.state)
        excitation = ", ".join(f"{m.getName()} = {a}" for m, a in zip(model.muscles, activations, strict=True))
        start = ", ".join(f"{c} = {float(value)!r}" for c, value in zip(model.names, pose, strict=True))
        out = run_study(STUDY.format(model=path, excitation=excitation, start=start), tmp_path)
        found = {column: values[0] for column, values in read_csv(out / "muscles.csv").items()}
        for muscle, activation in zip(model.muscles, activations, strict=True):
            of = muscle.getName()
            assert found[f"{of}_activation"] == activation
            # Where the path is another one (test_opensim_paths.py), so is the fibre.
            if abs(found[f"{of}_path_length"] - muscle.getLength(model.state)) > 1e-12:
                continue
            compared += 1
            length = max(length, abs(found[f"{of}_fiber_length"] - muscle.getFiberLength(model.state)))
            difference = abs(found[f"{of}_tendon_force"] - muscle.getTendonForce(model.state))
            force = max(force, difference / muscle.getMaxIsometricForce())
    assert compared > 0.7 * POSES * len(model.muscles)
    comparison.within(f"{name}: fibres of {compared} equilibria [m]", length, 1e-7)
    comparison.within(f"{name}: their tendon forces, of the largest isometric", force, 1e-6)
