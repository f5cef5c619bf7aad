"""Static optimization against OpenSim's: both spline the samples of one file, and minimise the sum of squared
activations of muscles and reserves."""

import numpy
import pytest

from opensim_model import OpenSimModel, static_optimization, write_motion
from program import read_csv, run_study, shared_file

pytestmark = pytest.mark.peer("opensim")

STUDY = """
[subject]
model = "{model}"
paths = "{paths}"
[motion]
method = "static optimization"
file = "motion.mot"
begin = 0
duration = 1
rate = {rate}
reserve_force = 1
[motion.static_optimization]
formulation = "{formulation}"
[motion.reserves]
{reserves}
"""


def at_rest_at_both_ends(time):
    """From 0 to 1 in a second, with velocity, acceleration and jerk zero at the ends. A jerk that jumps there, as that
    of the minimum-jerk motion, is rounded in two ways by the two splines."""
    s = numpy.clip(time, 0.0, 1.0)
    return s**4 * (35.0 - 84.0 * s + 70.0 * s**2 - 20.0 * s**3)


def ours(folder, path, reserves, formulation, paths, rate):
    """Columns like OpenSim's: activations by muscle, reserves by coordinate [N m or N]."""
    lines = "\n".join(f"{c} = {force}" for c, force in reserves.items())
    out = run_study(STUDY.format(model=path, paths=paths, formulation=formulation, reserves=lines, rate=rate), folder)
    muscles, motion = read_csv(out / "muscles.csv"), read_csv(out / "motion.csv")
    columns = {n.removesuffix("_activation"): v for n, v in muscles.items() if n.endswith("_activation")}
    return columns | {n: v for n, v in motion.items() if n.endswith("_reserve") or n == "time"}


@pytest.mark.parametrize("physiology", [True, False])
def test_an_elbow_flexion_has_opensims_activations(physiology, tmp_path, comparison):
    # Activations of 0..1, reserves of 1 N m at control 1. OpenSim's optimiser ends at a change of 1e-8 of its cost,
    # whose square root is 1e-4 of an activation. Taut paths have other moment arms, by up to 0.4 mm in this motion.
    path = shared_file("data/opensim/arm26.osim")
    time = numpy.linspace(-0.5, 1.5, 401)
    shoulder, elbow = numpy.zeros_like(time), 0.5 * numpy.pi * at_rest_at_both_ends(time)
    write_motion(tmp_path / "motion.mot", {"time": time, "r_shoulder_elev": shoulder, "r_elbow_flex": elbow})
    reserves = {"r_shoulder_elev": 1.0, "r_elbow_flex": 1.0}
    theirs = static_optimization(path, tmp_path / "motion.mot", tmp_path, reserves, physiology)
    formulation = "as opensim" if physiology else "without physiology"
    for paths, tolerance in (("opensim", 1e-4), ("exact", 5e-3)):
        columns = ours(tmp_path, path, reserves, formulation, paths, 200)
        numpy.testing.assert_allclose(columns["time"], theirs["time"], atol=1e-9)
        names = [name for name in theirs if name != "time"]
        assert len(names) == 8 and max(theirs[n].max() for n in names) > 0.1
        label = f"arm26, {formulation}, {paths} paths"
        comparison.within(f"{label}: activations", largest(columns, theirs, names), tolerance)


def largest(ours_, theirs, names):
    return max(numpy.abs(ours_[n] - theirs[n]).max() for n in names)


def test_a_swing_of_both_legs_has_opensims_activations(tmp_path, comparison):
    # 92 muscles, no wrapping. The pelvis hangs on reserves of 1000 N and N m, which cost nothing to speak of; those of
    # the joints are 10 N m. Tolerance as above.
    path = shared_file("data/opensim/gait2392_thelen2003muscle.osim")
    model = OpenSimModel(path)
    time = numpy.linspace(-0.25, 1.25, 31)
    s = at_rest_at_both_ends(time)
    columns = {"time": time} | {c: numpy.full_like(time, value) for c, value in model.default_pose().items()}
    columns |= {"hip_flexion_r": 0.6 * s, "knee_angle_r": -0.2 - 0.6 * s, "ankle_angle_r": 0.2 * s}
    columns |= {"hip_flexion_l": -0.2 * s, "knee_angle_l": -0.3 - 0.2 * s}
    write_motion(tmp_path / "motion.mot", columns)
    reserves = {c: 1000.0 if c.startswith("pelvis") else 10.0 for c in model.names}
    theirs = static_optimization(path, tmp_path / "motion.mot", tmp_path, reserves)
    found = ours(tmp_path, path, reserves, "as opensim", "exact", 20)
    names = [m.getName() for m in model.muscles]
    assert len(names) == 92 and max(theirs[n].max() for n in names) > 0.05
    comparison.within("gait2392: activations", largest(found, theirs, names), 1e-4)
