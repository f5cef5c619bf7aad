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
rate = 200
reserve_force = 1
[motion.static_optimization]
formulation = "{formulation}"
[motion.reserves]
{reserves}
"""


def minimum_jerk(time):
    s = numpy.clip(time, 0.0, 1.0)
    return 10.0 * s**3 - 15.0 * s**4 + 6.0 * s**5


def ours(folder, path, reserves, formulation, paths):
    """Columns like OpenSim's: activations by muscle, reserves by coordinate [N m or N]."""
    lines = "\n".join(f"{c} = {force}" for c, force in reserves.items())
    out = run_study(STUDY.format(model=path, paths=paths, formulation=formulation, reserves=lines), folder)
    muscles, motion = read_csv(out / "muscles.csv"), read_csv(out / "motion.csv")
    columns = {n.removesuffix("_activation"): v for n, v in muscles.items() if n.endswith("_activation")}
    return columns | {n: v for n, v in motion.items() if n.endswith("_reserve") or n == "time"}


@pytest.mark.parametrize("physiology", [True, False])
def test_an_elbow_flexion_has_opensims_activations(physiology, tmp_path, comparison):
    # Both controls of 0..1 and reserves of 1 N m at control 1. OpenSim's optimiser ends at a change of 1e-8; at its own
    # paths a tenth of a thousandth is left of splines and optimum. Its reserves follow from finite differences.
    path = shared_file("data/opensim/arm26.osim")
    time = numpy.linspace(-0.5, 1.5, 401)
    shoulder, elbow = numpy.zeros_like(time), 0.5 * numpy.pi * minimum_jerk(time)
    write_motion(tmp_path / "motion.mot", {"time": time, "r_shoulder_elev": shoulder, "r_elbow_flex": elbow})
    reserves = {"r_shoulder_elev": 1.0, "r_elbow_flex": 1.0}
    theirs = static_optimization(path, tmp_path / "motion.mot", tmp_path, reserves, physiology)
    formulation = "as opensim" if physiology else "without physiology"
    for paths, tolerance in (("opensim", 1e-4), ("exact", 5e-3)):
        columns = ours(tmp_path, path, reserves, formulation, paths)
        numpy.testing.assert_allclose(columns["time"], theirs["time"], atol=1e-9)
        names = [name for name in theirs if name != "time"]
        assert len(names) == 8 and max(theirs[n].max() for n in names) > 0.1
        label = f"arm26, {formulation}, {paths} paths"
        comparison.within(f"{label}: activations", largest(columns, theirs, names), tolerance)


def largest(ours_, theirs, names):
    return max(numpy.abs(ours_[n] - theirs[n]).max() for n in names)


def test_a_swing_of_both_legs_has_opensims_activations(tmp_path, comparison):
    # 92 muscles, no wrapping. The pelvis hangs on reserves of 1000 N and N m, which cost nothing to speak of; those of
    # the joints are 10 N m. At begin and end the motion rests.
    path = shared_file("data/opensim/gait2392_thelen2003muscle.osim")
    model = OpenSimModel(path)
    time = numpy.linspace(-0.2, 1.2, 281)
    s = minimum_jerk(time)
    columns = {"time": time} | {c: numpy.full_like(time, value) for c, value in model.default_pose().items()}
    columns |= {"hip_flexion_r": 0.6 * s, "knee_angle_r": -0.2 - 0.6 * s, "ankle_angle_r": 0.2 * s}
    columns |= {"hip_flexion_l": -0.2 * s, "knee_angle_l": -0.3 - 0.2 * s}
    write_motion(tmp_path / "motion.mot", columns)
    reserves = {c: 1000.0 if c.startswith("pelvis") else 10.0 for c in model.names}
    theirs = static_optimization(path, tmp_path / "motion.mot", tmp_path, reserves)
    found = ours(tmp_path, path, reserves, "as opensim", "exact")
    names = [m.getName() for m in model.muscles]
    assert len(names) == 92 and max(theirs[n].max() for n in names) > 0.05
    comparison.within("gait2392: activations", largest(found, theirs, names), 1e-3)
