"""Computed muscle control against OpenSim's CMCTool: excitations with which a simulation follows a motion.

Both go window by window, but not alike (docs/muscle.md, section 5): ours asks for the speed that a window lost in the
next one. The activations agree to a few thousandths, and ours tracks closer."""

import numpy
import pytest

from opensim_model import computed_muscle_control, write_motion
from program import read_csv, run_study, shared_file

pytestmark = pytest.mark.peer("opensim")

END = 0.5  # of a motion of 1 s: OpenSim takes half a minute for all of it
STUDY = """
[subject]
model = "{model}"
[motion]
method = "computed muscle control"
file = "motion.mot"
begin = 0
duration = {duration}
rate = 1000
reserve_force = 1
"""


def elbow_flexion(time):
    """90 deg in a second, with minimum jerk."""
    s = numpy.clip(time, 0.0, 1.0)
    return 0.5 * numpy.pi * s**3 * (10.0 - 15.0 * s + 6.0 * s**2)


def test_an_elbow_flexion_has_opensims_activations_and_is_tracked_closer(tmp_path, comparison):
    path = shared_file("data/opensim/arm26.osim")
    time = numpy.linspace(-0.5, 1.5, 401)
    columns = {"time": time, "r_shoulder_elev": numpy.zeros_like(time), "r_elbow_flex": elbow_flexion(time)}
    write_motion(tmp_path / "motion.mot", columns)
    theirs = computed_muscle_control(path, tmp_path / "motion.mot", tmp_path, END)
    out = run_study(STUDY.format(model=path, duration=END), tmp_path)
    motion, muscles = read_csv(out / "motion.csv"), read_csv(out / "muscles.csv")

    error = numpy.abs(motion["r_elbow_flex"] - elbow_flexion(motion["time"])).max()
    their_error = numpy.abs(theirs["/jointset/r_elbow/r_elbow_flex/value"] - elbow_flexion(theirs["time"])).max()
    comparison.within("arm26: tracking error [rad], tolerance OpenSim's", error, their_error)
    comparison.within("arm26: tracking error [rad]", error, 3e-3)

    rows = theirs["time"] <= END
    names = [name.removesuffix("_activation") for name in muscles if name.endswith("_activation")]
    means, largest = [], 0.0
    for name in names:
        activation = theirs[f"/forceset/{name}/activation"][rows]
        ours = numpy.interp(theirs["time"][rows], muscles["time"], muscles[f"{name}_activation"])
        means.append(numpy.abs(ours - activation).mean())
        largest = max(largest, activation.max())
    assert len(names) == 6 and largest > 0.1
    comparison.within("arm26: activations, mean difference of the worst muscle", max(means), 0.02)
