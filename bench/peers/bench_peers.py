"""Times of the peers and ours in one run: a Markdown table, and JSON in the file that the argument names.

Processor time, medians of several runs. Ours is all of the program: from its start and reading the files to results
written, reports included. Theirs is the work in a Python process that runs already, reading of the files included,
without the import of the package. Both sides did the same task, which the comparisons check; accuracies are the same
number, which each integrator means in its own way."""

import contextlib
import importlib.metadata
import json
import os
import pathlib
import platform
import resource
import statistics
import sys
import tempfile
import time

import numpy
from pymavlink import DFReader
from pyulog import ULog

import test_commonroad_multi_body as multi_body
import test_commonroad_single_track as single_track
import test_jsbsim_flight as jsbsim_flight
import test_opensim_forward as forward
import test_opensim_static_optimization as static
from jsbsim_aircraft import JsbsimAircraft
from opensim_model import OpenSimModel, constant, random_states, simulate, static_optimization, write_motion
from program import SHARED, read_csv, run_study, veridyn, write_csv

RUNS = 5
OPENSIM = SHARED / "data/opensim"
FLIGHT = SHARED / "data/flight"


def theirs(work):
    """Median processor time of a call [s]."""
    times = []
    for _ in range(RUNS):
        begin = time.process_time()
        work()
        times.append(time.process_time() - begin)
    return statistics.median(times)


def ours(work):
    """Median processor time of the programs that a call starts [s]."""
    times = []
    for _ in range(RUNS):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        work()
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        times.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return statistics.median(times)


def poses(name, count, folder):
    """Lengths, all moment arms and inverse dynamics of random states."""
    path = OPENSIM / f"{name}.osim"
    q, qdot, qddot = random_states(OpenSimModel(path, without_forces=True), count, seed=3)
    states = {}
    for i, c in enumerate(OpenSimModel(path).names):
        states |= {c: q[:, i], f"{c}.speed": qdot[:, i], f"{c}.acceleration": qddot[:, i]}
    write_csv(folder / "states.csv", states)

    def peer():
        model = OpenSimModel(path, without_forces=True)
        for state in zip(q, qdot, qddot, strict=True):
            model.inverse_dynamics(*state)
            model.lengths()
            model.moment_arms()

    return theirs(peer), ours(lambda: veridyn("inspect", path, "--pose", folder / "states.csv"))


def forward_arm(folder):
    path = OPENSIM / "arm26.osim"
    shoulder, elbow = forward.STARTS["step"]
    rows = numpy.arange(201) / 200.0
    text, _ = forward.excitations("step", folder)
    study = forward.STUDY.format(model=path, paths="exact", shoulder=shoulder, elbow=elbow, excitation=text)
    study = study.replace("accuracy = 1e-8", "accuracy = 1e-5")

    def peer():
        _, functions = forward.excitations("step", folder)
        simulate(OpenSimModel(path), numpy.radians([shoulder, elbow]), functions, rows, accuracy=1e-5)

    return theirs(peer), ours(lambda: run_study(study, folder))


def forward_gait(folder):
    path = OPENSIM / "gait2392_thelen2003muscle.osim"
    model = OpenSimModel(path)
    excitations = {m.getName(): constant(0.1) for m in model.muscles}
    rows = numpy.arange(41) / 200.0
    study = f"""
[subject]
model = "{path}"
[motion]
method = "forward"
duration = 0.2
accuracy = 1e-5
[motion.excitation]
default = 0.1
"""

    def peer():
        simulate(OpenSimModel(path), list(model.default_pose().values()), excitations, rows, accuracy=1e-5)

    return theirs(peer), ours(lambda: run_study(study, folder))


def static_arm(folder):
    path = OPENSIM / "arm26.osim"
    moment = numpy.linspace(-0.5, 1.5, 401)
    elbow = 0.5 * numpy.pi * static.at_rest_at_both_ends(moment)
    motion = {"time": moment, "r_shoulder_elev": numpy.zeros_like(moment), "r_elbow_flex": elbow}
    write_motion(folder / "motion.mot", motion)
    reserves = {"r_shoulder_elev": 1.0, "r_elbow_flex": 1.0}
    return (
        theirs(lambda: static_optimization(path, folder / "motion.mot", folder, reserves)),
        ours(lambda: static.ours(folder, path, reserves, "as opensim", "exact", 200)),
    )


def dataflash(_):
    path = FLIGHT / "ardupilot/test_log_pilot_position.BIN"

    def peer():
        log = DFReader.DFReader_binary(str(path))
        while (message := log.recv_msg()) is not None:
            message.to_dict()

    return theirs(peer), ours(lambda: veridyn("inspect", path, "--json"))


def ulog(_):
    path = FLIGHT / "px4/sample_log_small.ulg"
    return theirs(lambda: ULog(str(path))), ours(lambda: veridyn("inspect", path, "--json"))


def flight(folder):
    study = jsbsim_flight.STUDY.format(aircraft="aerosonde")
    exported = jsbsim_flight.export(study, folder)
    rows = jsbsim_flight.rows_of(read_csv(run_study(study, folder) / "truth.csv"))
    places = iter(range(RUNS))

    def peer():
        JsbsimAircraft(exported, folder / str(next(places)), jsbsim_flight.STEP).fly(rows)

    return theirs(peer), ours(lambda: run_study(study, folder))


def step_of_bicycle(folder):
    motion = single_track.drive(folder, "linear bicycle", 20.0, 0.02)
    start = [0.0, 0.0, 0.0, 20.0, 0.0, 0.0, 0.0]
    return (
        theirs(lambda: single_track.integrate(single_track.vehicle_dynamics_st, start, motion)),
        ours(lambda: single_track.drive(folder, "linear bicycle", 20.0, 0.02)),
    )


def step_of_four_wheels(folder):
    text = "\n".join(f"{k} = {float(v)!r}" for k, v in multi_body.numbers().items())
    study = multi_body.STUDY.format(steer=0.02, numbers=text)
    return (
        theirs(lambda: multi_body.steady_multi_body(multi_body.CAR, 0.02)),
        ours(lambda: run_study(study, folder)),
    )


# Package of the peer, task, what runs it, and the file of others' data that it needs.
TASKS = [
    ("opensim", "arm26: lengths, 12 arms, inverse dynamics, 2000 states", lambda f: poses("arm26", 2000, f), OPENSIM),
    (
        "opensim",
        "gait2392: 92 lengths, all arms, inverse dynamics, 20 states",
        lambda f: poses("gait2392_thelen2003muscle", 20, f),
        OPENSIM,
    ),
    ("opensim", "arm26: forward, 1 s, accuracy 1e-5", forward_arm, OPENSIM),
    ("opensim", "gait2392: forward, 0.2 s, accuracy 1e-5", forward_gait, OPENSIM),
    ("opensim", "arm26: static optimization, 201 frames", static_arm, OPENSIM),
    ("jsbsim", "8 s of flight, steps of 2.5 ms", flight, None),
    ("pymavlink", "DataFlash of 2.1 MB, every message", dataflash, FLIGHT),
    ("pyulog", "ULog of 0.9 MB, every message", ulog, FLIGHT),
    ("commonroad-vehicle-models", "single track, step steer, 4 s (scipy's RK45)", step_of_bicycle, None),
    (
        "commonroad-vehicle-models",
        "multi-body and four-wheel, step steer, 8 s (scipy's BDF)",
        step_of_four_wheels,
        None,
    ),
]


def main(target):
    rows = []
    print("| task | peer | its processor time [s] | ours [s] | ratio |\n|---|---|---|---|---|")
    for package, task, measure, data in TASKS:
        if data is not None and not data.exists():
            print(f"{task}: {data.name} is not in ../shared", file=sys.stderr)
            continue
        # JSBSim greets on stdout from C++, which would stand between the rows.
        with tempfile.TemporaryDirectory() as folder, silent():
            peer, own = measure(pathlib.Path(folder))
        version = importlib.metadata.version(package)
        rows.append({"task": task, "peer": package, "version": version, "theirs_s": peer, "ours_s": own, "runs": RUNS})
        print(f"| {task} | {package} {version} | {peer:.3g} | {own:.3g} | {peer / own:.3g} |", flush=True)
    machine = {"system": platform.platform(), "processors": os.cpu_count(), "load": os.getloadavg()[0]}
    version, start = veridyn("--version").strip(), ours(lambda: veridyn("--version"))
    results = {"program": version, "start_s": start, "machine": machine, "rows": rows}
    target.write_text(json.dumps(results, indent=1) + "\n")
    print(f"\nveridyn {version}, of whose times {start:.3g} s are its start; load of the machine {machine['load']:.1f}")


@contextlib.contextmanager
def silent():
    """Nothing on stdout, not even from libraries in C++."""
    sys.stdout.flush()
    kept = os.dup(1)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        sys.stdout.flush()
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
