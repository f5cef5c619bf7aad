"""Recordings with EMG made in OpenSim, and how many intervals of `veridyn identify` hold what was hidden in them.

The arm26 model's elbow is moved by a prescribed function at six shoulder angles while random excitations drive its
muscles; recorded are angles, the muscles' moment (tensions times OpenSim's moment arms) and envelopes, which are the
excitations in units of hidden gains, ahead of them by a hidden delay, with errors. As a program:

    python opensim_emg.py CASE SEED SEED ...        # a table of all intervals; CASE: a key of CASES
"""

import dataclasses
import json
import pathlib
import sys
import tempfile

import numpy
import opensim

from intervals import IntervalCount, errors_in
from opensim_model import OpenSimModel, prescribe
from program import run_study, shared_file, write_csv
from random_signals import smooth

MUSCLES = ["TRIlong", "TRIlat", "TRImed", "BIClong", "BICshort", "BRA"]
GROUPS = {"triceps": MUSCLES[:3], "biceps": MUSCLES[3:5], "brachialis": MUSCLES[5:]}
# Shoulder angles at which OpenSim's paths neither jump nor differ from taut strings (test_opensim_paths.py).
SHOULDERS_DEG = [-60.0, -45.0, -30.0, -10.0, 5.0, 20.0]
DURATION_S, AROUND_S, RATE_HZ = 3.0, 0.2, 100.0
MOMENT_NOISE = 0.2  # N m

STUDY = """
[subject]
model = "{model}"
paths = "fitted"
[emg]
noise = "{noise} %"
[emg.columns]
{columns}
[[output]]
name = "r_elbow_flex.moment"
noise = 0.2
{parameters}
{tasks}
"""


@dataclasses.dataclass(frozen=True)
class Case:
    """What is recorded of whom. Relative errors of the envelopes have the correlation times 0.3 to 1 s."""

    model: str = "arm26"
    relative: float = 0.1
    late: bool = True
    stated: float = 10.0  # of the EMG's error, in percent


CASES = {
    "exact": Case(relative=0.0, late=False, stated=0.0),
    "exact_said_10": Case(relative=0.0, late=False),
    "errors": Case(),
    "millard": Case(model="arm26_millard"),
    "millard_exact": Case(model="arm26_millard", relative=0.0, late=False, stated=0.0),
}


def spline(time, values):
    function = opensim.GCVSpline()
    function.setDegree(5)
    for t, value in zip(time, values, strict=True):
        function.addPoint(float(t), float(value))
    return function


def excited(random, time):
    """Excitations of 0.03 to 0.7 that come and go within some tenths of a second."""
    return 0.03 + 0.67 / (1.0 + numpy.exp(1.2 - 1.3 * smooth(random, time, 0.25)))


def smooth_corners(values):
    """A mean over a fifth of a second, so that accelerations do not jump."""
    return numpy.convolve(numpy.pad(values, 10, "edge"), numpy.hanning(23)[1:-1] / 11.0, "valid")


def moved(path, shoulder_deg, around, elbow, drive, time):
    """Moment about the elbow [N m] at `time`, of muscles along a prescribed motion; elbow angle and excitations by
    group at the times `around`, on splines."""
    model = OpenSimModel(path)
    angles = opensim.Constant(float(numpy.radians(shoulder_deg))), spline(around, elbow)
    for c, function in zip(model.coordinates, angles, strict=True):
        c.setPrescribedFunction(function)
        c.setDefaultIsPrescribed(True)
    group = {name: spline(around, values) for name, values in drive.items()}
    excitations = {m: group[name] for name, muscles in GROUPS.items() for m in muscles}
    prescribe(model, excitations)
    state = model.state
    for muscle in model.muscles:
        muscle.setActivation(state, excitations[muscle.getName()].calcValue(opensim.Vector(1, 0.0)))
    model.model.assemble(state)
    model.model.equilibrateMuscles(state)
    manager = opensim.Manager(model.model)
    manager.setIntegratorAccuracy(1e-6)
    manager.initialize(state)
    moment = []
    for t in time:
        if t > 0.0:
            state = manager.integrate(float(t))
        model.model.realizeDynamics(state)
        arm = [m.computeMomentArm(state, model.coordinates[1]) for m in model.muscles]
        moment.append(sum(m.getTendonForce(state) * r for m, r in zip(model.muscles, arm, strict=True)))
    return numpy.array(moment)


def record(case, seed, folder):
    """Files of six tasks; what is hidden: the gain of each electrode and the delay [s]."""
    random, error = numpy.random.default_rng([seed, 0]), numpy.random.default_rng([seed, 1])
    gain = {name: error.uniform(0.75, 1.25) for name in GROUPS}
    delay = error.uniform(0.02, 0.06) if case.late else 0.0
    path = shared_file(f"data/opensim/{case.model}.osim")
    time = numpy.arange(0.0, DURATION_S + 0.5 / RATE_HZ, 1.0 / RATE_HZ)
    around = numpy.arange(-AROUND_S, DURATION_S + AROUND_S, 1.0 / RATE_HZ)
    for i, shoulder in enumerate(SHOULDERS_DEG):
        drive = {name: excited(random, around) for name in GROUPS}
        swing = numpy.clip(smooth(random, around, random.uniform(0.3, 0.6)), -2.2, 2.2)
        elbow = numpy.radians(65.0 + 22.0 * smooth_corners(swing))
        moment = moved(path, shoulder, around, elbow, drive, time)
        moment += MOMENT_NOISE * error.standard_normal(len(time))
        write_csv(folder / f"moment{i}.csv", {"time": time, "r_elbow_flex_moment": moment})
        angles = {"r_shoulder_elev": numpy.full_like(around, numpy.radians(shoulder)), "r_elbow_flex": elbow}
        write_csv(folder / f"angle{i}.csv", {"time": around} | angles)
        emg = {"time": around - delay}
        for name in GROUPS:
            wrong = 1.0 + case.relative * smooth(error, around, error.uniform(0.3, 1.0))
            emg[name] = numpy.clip(drive[name] / gain[name] * wrong, 0.0, 1.0)
        write_csv(folder / f"emg{i}.csv", emg)
    return gain | {"EMG delay": delay}


def study_of(case, folder):
    columns = "\n".join(f'{m} = "{name}"' for name, muscles in GROUPS.items() for m in muscles)
    parameters = "".join(
        f'[[parameter]]\nname = "{name}"\nmuscles = {json.dumps(muscles)}\n'
        'fields = ["excitation_gain"]\nbounds = "60 %"\n'
        for name, muscles in GROUPS.items()
    )
    tasks = "".join(
        f'[[task]]\nname = "{i}"\nangles = "angle{i}.csv"\nmoments = "moment{i}.csv"\nemg = "emg{i}.csv"\n'
        for i in range(len(SHOULDERS_DEG))
    )
    model = shared_file("data/opensim/arm26.osim")
    return STUDY.format(model=model, noise=case.stated, columns=columns, parameters=parameters, tasks=tasks)


def identified(case, seed, folder):
    """The estimate of a recording, and what was hidden."""
    truth = record(case, seed, folder)
    out = run_study(study_of(case, folder), folder, "identify")
    return json.loads((out / "estimate.json").read_text()), truth


@dataclasses.dataclass
class EmgCount(IntervalCount):
    """And what the moments leave."""

    nrmse: list = dataclasses.field(default_factory=list)

    def add_estimate(self, estimate, truth):
        super().add_estimate(estimate, truth)
        self.nrmse.append(estimate["fit"]["nrmse_trained"])

    def __str__(self):
        return super().__str__() + f"; NRMSE {numpy.mean(self.nrmse):.1%}"


if __name__ == "__main__":
    counts = EmgCount()
    for number in map(int, sys.argv[2:]):
        with tempfile.TemporaryDirectory() as name:
            estimate, truth = identified(CASES[sys.argv[1]], number, pathlib.Path(name))
        counts.add_estimate(estimate, truth)
        row = next(r for r in estimate["evidence"] if r["check"] == "size of the EMG's error")
        print(f"{number}: {errors_in(estimate, truth)}; error of the EMG {row['value'] or 0.0:.2f} {row['outcome']}", flush=True)
    print(sys.argv[1], counts)
