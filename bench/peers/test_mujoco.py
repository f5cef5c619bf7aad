"""A tree of bodies with strings over a sphere and a cylinder against MuJoCo, for which it is written in its own format
(mujoco_tree.py). MuJoCo's strings are taut, as ours: lengths and moment arms agree where OpenSim's do not."""

import numpy
import pytest

from mujoco_tree import COORDINATES, STRINGS, MujocoTree, osim
from program import columns_of, read_csv, run_study, veridyn, write_csv

pytestmark = pytest.mark.peer("mujoco")

STATES = 300


@pytest.fixture
def path(tmp_path):
    (tmp_path / "tree.osim").write_text(osim())
    return tmp_path / "tree.osim"


def states():
    random = numpy.random.default_rng(11)
    shape = (STATES, len(COORDINATES))
    return random.uniform(-0.8, 0.8, shape), random.uniform(-4.0, 4.0, shape), random.uniform(-20.0, 20.0, shape)


def pose(path, q, qdot, qddot):
    table = {}
    for i, c in enumerate(COORDINATES):
        table |= {c: q[:, i], f"{c}.speed": qdot[:, i], f"{c}.acceleration": qddot[:, i]}
    write_csv(path.parent / "states.csv", table)
    return columns_of(veridyn("inspect", path, "--pose", path.parent / "states.csv"))


def test_forces_of_random_states_are_the_same(path, comparison):
    q, qdot, qddot = states()
    table = pose(path, q, qdot, qddot)
    ours = numpy.array([table[f"{c}.force"] for c in COORDINATES]).T
    tree = MujocoTree()
    theirs = numpy.array([tree.inverse_dynamics(*state) for state in zip(q, qdot, qddot, strict=True)])
    difference = (numpy.abs(ours - theirs) / numpy.abs(theirs).max(axis=0)).max()
    comparison.within("inverse dynamics, relative to the largest force", difference, 1e-13)


def test_taut_strings_are_as_long_and_have_the_same_arms(path, comparison):
    q, qdot, qddot = states()
    table = pose(path, q, qdot, qddot)
    tree = MujocoTree()
    found = [tree.strings(pose_) for pose_ in q]
    lengths, arms, touching = (numpy.array(part) for part in zip(*found, strict=True))
    nothing = numpy.zeros(STATES)
    for i, (name, _, object_) in enumerate(STRINGS):
        ours = numpy.array([table.get(f"{name}.moment_arm.{c}", nothing) for c in COORDINATES]).T
        touches = touching[:, i].sum()
        assert (STATES / 10 < touches < STATES) if object_ else touches == 0
        label = f"{name} ({touches} of {STATES} poses touch)"
        comparison.within(f"{label}: length [m]", numpy.abs(table[f"{name}.length"] - lengths[:, i]).max(), 1e-14)
        comparison.within(f"{label}: moment arms [m]", numpy.abs(ours - arms[:, i]).max(), 1e-13)


def test_the_tree_tumbles_as_in_mujoco(tmp_path, comparison):
    # MuJoCo integrates by Runge and Kutta's fourth order with steps of 1 ms, ours with error control.
    (tmp_path / "tree.osim").write_text(osim(strings=False))
    random = numpy.random.default_rng(12)
    q, qdot = random.uniform(-0.5, 0.5, len(COORDINATES)), random.uniform(-2.0, 2.0, len(COORDINATES))
    start = "".join(f"{c} = {float(value)!r}\n" for c, value in zip(COORDINATES, q, strict=True))
    speeds = "".join(f"{c} = {float(value)!r}\n" for c, value in zip(COORDINATES, qdot, strict=True))
    study = f"""
[subject]
model = "tree.osim"
[motion]
method = "forward"
duration = 1
rate = 1000
accuracy = 1e-10
[motion.start]
{start}[motion.start_speed]
{speeds}"""
    motion = read_csv(run_study(study, tmp_path) / "motion.csv")
    ours = numpy.array([motion[c] for c in COORDINATES]).T
    theirs = MujocoTree().moves(q, qdot, motion["time"])
    assert numpy.ptp(ours, axis=0).min() > 0.4, "must have moved"
    comparison.within("a second of tumbling [rad, m]", numpy.abs(ours - theirs).max(), 1e-9)
