"""Forward simulations against OpenSim's Manager.

Both sides integrate far more closely than they are compared. With `paths = "opensim"` what remains is that OpenSim's
moment arms are not quite the slopes of its lengths; with taut paths the difference is that of the paths, known and
bounded (docs/muscle.md, sections 3 and 13)."""

import numpy
import pytest

from opensim_model import OpenSimModel, constant, held, simulate, sine, write_motion
from program import read_csv, run_study, shared_file

pytestmark = pytest.mark.peer("opensim")

MUSCLES = ["TRIlong", "TRIlat", "TRImed", "BIClong", "BICshort", "BRA"]
# Shoulder and elbow at the start [deg]: motions in which OpenSim's paths have no jumps, the shoulder stays between
# -16.4 and 29.5 deg.
STARTS = {"constant": (2.5, 30.0), "step": (10.0, 30.0), "sines": (0.0, 40.0)}
EXCITATION = 0.05
FROM_0_2_S = [0.05, 0.5, 0.5, 0.4, 0.4, 0.4]
MEANS, AMPLITUDE, FREQUENCIES_HZ = [0.08, 0.10, 0.25, 0.15, 0.20, 0.08], 0.04, [1.0, 1.3, 1.7, 2.1, 2.5, 3.1]
STUDY = """
[subject]
model = "{model}"
paths = "{paths}"
[motion]
method = "forward"
duration = 1
rate = 200
accuracy = 1e-8
{excitation}
[motion.start]
r_shoulder_elev = "{shoulder} deg"
r_elbow_flex = "{elbow} deg"
"""


def excitations(scenario, folder):
    """What [motion] of a study says of them, and the same as OpenSim's functions by muscle. A file has sines at steps
    of 0.25 ms, with lines between them: 1e-7 off at most."""
    text = f"excitation = {{default = {EXCITATION}}}\n"
    if scenario == "constant":
        return text, {name: constant(EXCITATION) for name in MUSCLES}
    if scenario == "step":
        after = dict(zip(MUSCLES, FROM_0_2_S, strict=True))
        values = ", ".join(f"{name} = {u}" for name, u in after.items())
        text += f'excitation_step = [{{time = "0.2 s", {values}}}]\n'
        return text, {name: held([(0.0, EXCITATION), (0.2, u)]) for name, u in after.items()}
    time = numpy.arange(4001) / 4000.0
    columns, functions = {"time": time}, {}
    for k, name in enumerate(MUSCLES):
        rate, phase = 2.0 * numpy.pi * FREQUENCIES_HZ[k], k * numpy.pi / 3.0
        columns[name] = MEANS[k] + AMPLITUDE * numpy.sin(rate * time + phase)
        functions[name] = sine(AMPLITUDE, rate, phase, MEANS[k])
    write_motion(folder / "excitations.sto", columns)
    return 'excitation_file = "excitations.sto"\n', functions


@pytest.mark.parametrize("scenario", STARTS)
@pytest.mark.parametrize("name", ["arm26", "arm26_millard"])
def test_an_arm_moves_as_in_opensim(name, scenario, tmp_path, comparison):
    path = shared_file(f"data/opensim/{name}.osim")
    shoulder, elbow = STARTS[scenario]
    text, functions = excitations(scenario, tmp_path)
    model = OpenSimModel(path)
    theirs = simulate(model, numpy.radians([shoulder, elbow]), functions, numpy.arange(201) / 200.0)
    for paths, angle_deg in (("opensim", 1e-3), ("exact", 0.5)):
        out = run_study(
            STUDY.format(model=path, paths=paths, shoulder=shoulder, elbow=elbow, excitation=text), tmp_path
        )
        motion, muscles = read_csv(out / "motion.csv"), read_csv(out / "muscles.csv")
        numpy.testing.assert_allclose(motion["time"], theirs["time"], atol=1e-9)
        label = f"{name}, {scenario}, {paths} paths"
        angles = [numpy.degrees(numpy.abs(motion[c] - theirs[c])).max() for c in model.names]
        assert numpy.ptp(motion["r_elbow_flex"]) > 0.1, "must have moved"
        comparison.within(f"{label}: angles [deg]", max(angles), angle_deg)
        if paths == "opensim":
            for what, tolerance in (("activation", 1e-6), ("fiber_length", 1e-6), ("tendon_force", 0.1)):
                columns = [f"{m}_{what}" for m in MUSCLES]
                difference = max(numpy.abs(muscles[c] - theirs[c]).max() for c in columns)
                comparison.within(f"{label}: {what} [SI]", difference, tolerance)


def test_a_body_of_92_muscles_falls_as_in_opensim(tmp_path, comparison):
    # gait2392 has joints of splines, moving points, limits and a free pelvis, and no wrapping: 0.2 s of falling with
    # all muscles at 0.1 from the default pose with bent knees.
    path = shared_file("data/opensim/gait2392_thelen2003muscle.osim")
    model = OpenSimModel(path)
    pose = model.default_pose() | {"knee_angle_r": -0.5, "knee_angle_l": -0.4, "hip_flexion_r": 0.4}
    names = [m.getName() for m in model.muscles]
    time = numpy.arange(41) / 200.0
    theirs = simulate(model, [pose[c] for c in model.names], {name: constant(0.1) for name in names}, time)
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
