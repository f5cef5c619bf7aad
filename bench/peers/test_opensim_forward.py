"""Forward simulations against OpenSim's Manager.

Both sides integrate far more closely than they are compared. With `paths = "opensim"` what remains is that OpenSim's
moment arms are not quite the slopes of its lengths; with taut paths the difference is that of the paths, known and
bounded (docs/muscle.md, sections 3 and 13)."""

import numpy
import pytest

from opensim_model import OpenSimModel, simulate
from program import read_csv, run_study, shared_file

pytestmark = pytest.mark.peer("opensim")

MUSCLES = ["TRIlong", "TRIlat", "TRImed", "BIClong", "BICshort", "BRA"]
# Shoulder and elbow at the start [deg], excitations, and of the second scenario those from 0.2 s on. Motions in which
# OpenSim's paths have no jumps: the shoulder stays between -16.4 and 29.5 deg.
SCENARIOS = {
    "constant": ((2.5, 30.0), [0.05] * 6, None),
    "step": ((10.0, 30.0), [0.05] * 6, [0.05, 0.5, 0.5, 0.4, 0.4, 0.4]),
}
STUDY = """
[subject]
model = "{model}"
paths = "{paths}"
[motion]
method = "forward"
duration = 1
rate = 200
accuracy = 1e-8
[motion.start]
r_shoulder_elev = "{shoulder} deg"
r_elbow_flex = "{elbow} deg"
[motion.excitation]
default = 0.05
"""


def step_of(excitations):
    values = "\n".join(f"{name} = {u}" for name, u in zip(MUSCLES, excitations, strict=True))
    return f'[[motion.excitation_step]]\ntime = "0.2 s"\n{values}\n'


@pytest.mark.parametrize("scenario", SCENARIOS)
@pytest.mark.parametrize("name", ["arm26", "arm26_millard"])
def test_an_arm_moves_as_in_opensim(name, scenario, tmp_path, comparison):
    path = shared_file(f"data/opensim/{name}.osim")
    (shoulder, elbow), before, after = SCENARIOS[scenario]
    steps = [(0.0, dict.fromkeys(MUSCLES, 0.05))] + ([(0.2, dict(zip(MUSCLES, after, strict=True)))] if after else [])
    assert before == [0.05] * 6
    model = OpenSimModel(path)
    theirs = simulate(model, numpy.radians([shoulder, elbow]), steps, numpy.arange(201) / 200.0)
    for paths, angle_deg in (("opensim", 1e-3), ("exact", 0.5)):
        study = STUDY.format(model=path, paths=paths, shoulder=shoulder, elbow=elbow)
        out = run_study(study + (step_of(after) if after else ""), tmp_path)
        motion, muscles = read_csv(out / "motion.csv"), read_csv(out / "muscles.csv")
        numpy.testing.assert_allclose(motion["time"], theirs["time"], atol=1e-9)
        label = f"{name}, {scenario}, {paths} paths"
        angles = [numpy.degrees(numpy.abs(motion[c] - theirs[c])).max() for c in model.names]
        assert numpy.ptp(motion["r_elbow_flex"]) > 0.15, "must have moved"
        comparison.within(f"{label}: angles [deg]", max(angles), angle_deg)
        if paths == "opensim":
            fibers = [numpy.abs(muscles[f"{m}_fiber_length"] - theirs[f"{m}_fiber_length"]).max() for m in MUSCLES]
            forces = [numpy.abs(muscles[f"{m}_tendon_force"] - theirs[f"{m}_tendon_force"]).max() for m in MUSCLES]
            comparison.within(f"{label}: fibre lengths [m]", max(fibers), 1e-6)
            comparison.within(f"{label}: tendon forces [N]", max(forces), 0.1)


def test_a_body_of_92_muscles_falls_as_in_opensim(tmp_path, comparison):
    # gait2392 has joints of splines, moving points, limits and a free pelvis, and no wrapping: 0.2 s of falling with
    # all muscles at 0.1 from the default pose with bent knees.
    path = shared_file("data/opensim/gait2392_thelen2003muscle.osim")
    model = OpenSimModel(path)
    pose = model.default_pose() | {"knee_angle_r": -0.5, "knee_angle_l": -0.4, "hip_flexion_r": 0.4}
    names = [m.getName() for m in model.muscles]
    time = numpy.arange(41) / 200.0
    theirs = simulate(model, [pose[c] for c in model.names], [(0.0, dict.fromkeys(names, 0.1))], time)
    start = "\n".join(f"{c} = {value!r}" for c, value in pose.items())
    study = f"""
[subject]
model = "{path}"
[motion]
method = "forward"
duration = 0.2
rate = 200
accuracy = 1e-8
[motion.start]
{start}
[motion.excitation]
default = 0.1
"""
    out = run_study(study, tmp_path)
    motion, muscles = read_csv(out / "motion.csv"), read_csv(out / "muscles.csv")
    difference = max(numpy.abs(motion[c] - theirs[c]).max() for c in model.names)
    assert max(numpy.ptp(motion[c]) for c in model.names) > 0.1, "must have moved"
    comparison.within("gait2392: coordinates [rad, m]", difference, 1e-5)
    forces = [numpy.abs(muscles[f"{m}_tendon_force"] - theirs[f"{m}_tendon_force"]).max() for m in names]
    comparison.within("gait2392: tendon forces [N]", max(forces), 0.1)
