"""Drives of CommonRoad's cars, and how many intervals of `veridyn identify` hold what is in these cars.

A car of CommonRoad follows a random steering angle of up to 0.5 g for a minute at about 18 m/s; recorded are what a logger
has: steering angle, speed, yaw rate and lateral acceleration of a body that leans, with ordinary noise. The study is
what a new user writes. As a program:

    python commonroad_drives.py MODEL SEED SEED ...        # a table of all intervals; MODEL: a key of MODELS
"""

import json
import math
import pathlib
import sys
import tempfile

import numpy
from intervals import IntervalCount, errors_in
from program import run_study, write_csv
from random_signals import smooth
from vehiclemodels.init_mb import init_mb
from vehiclemodels.init_std import init_std
from vehiclemodels.parameters_vehicle1 import parameters_vehicle1
from vehiclemodels.parameters_vehicle2 import parameters_vehicle2
from vehiclemodels.parameters_vehicle3 import parameters_vehicle3
from vehiclemodels.vehicle_dynamics_mb import vehicle_dynamics_mb
from vehiclemodels.vehicle_dynamics_std import vehicle_dynamics_std

GRAVITY = 9.81
CARS = {1: parameters_vehicle1, 2: parameters_vehicle2, 3: parameters_vehicle3}
STEP_S, STEPS_PER_ROW = 1e-3, 10
ROW_S = STEP_S * STEPS_PER_ROW
SETTLING_S, DURATION_S = 2.0, 60.0
NOISE = {"steer[rad]": 3e-4, "speed[m/s]": 0.03, "yaw_rate[rad/s]": 2e-3, "accel_y[m/s^2]": 0.06}

STUDY = """
[subject]
kind = "vehicle"
mass = {mass!r}
a = {a!r}
b = {b!r}
cg_height = {cg_height!r}
[data]
file = "drive.csv"
frame = "flu"
"""


class MultiBody:
    """CommonRoad's multi-body car without some coefficients of its tyres' side force by camber."""

    def __init__(self, number, without=()):
        self.car = CARS[number]()
        for name in without:
            setattr(self.car.tire, name, 0.0)

    def start(self, speed):
        return init_mb([0.0, 0.0, 0.0, speed, 0.0, 0.0, 0.0], self.car)

    def rate(self, state, inputs):
        return vehicle_dynamics_mb(list(state), inputs, self.car)

    def measured(self, state, rate):
        """Speed along the car, yaw rate, specific force to the left of the leaning body; roll is positive with the right
        side up."""
        return state[3], state[5], rate[10] + state[5] * state[3] - GRAVITY * math.sin(state[6])


class SingleTrackDrift:
    """CommonRoad's single-track car with Magic Formula tyres and wheels that spin."""

    def __init__(self, number):
        self.car = CARS[number]()

    def start(self, speed):
        return init_std([0.0, 0.0, 0.0, speed, 0.0, 0.0, 0.0], self.car)

    def rate(self, state, inputs):
        return vehicle_dynamics_std(list(state), inputs, self.car)

    def measured(self, state, rate):
        speed, slip = state[3], state[6]
        along, across = speed * math.cos(slip), speed * math.sin(slip)
        return along, state[5], rate[3] * math.sin(slip) + along * rate[6] + state[5] * along


# Its tyres shift at once by p_hy1 and p_vy1 as camber changes its sign, and by p_hy3 and p_vy3 in proportion to it.
JUMP, SLOPE = ("p_hy1", "p_vy1"), ("p_hy3", "p_vy3")
MODELS = {
    "multi-body": MultiBody,
    "without jump": lambda number: MultiBody(number, JUMP),
    "without camber": lambda number: MultiBody(number, JUMP + SLOPE),
    "drift": SingleTrackDrift,
}


def stiffnesses(car):
    """Of one tyre in front and rear [N/rad] under its static load: CommonRoad's K_y is in proportion to the load."""
    share = 0.5 * car.m * GRAVITY / (car.a + car.b)
    return -car.tire.p_ky1 * share * car.b, -car.tire.p_ky1 * share * car.a


def steering(random, car, speed, time):
    """Lane changes and bends of 1 to 4 s with quick corrections, at most what 0.5 g of a linear car takes [rad]."""
    C_f, C_r = stiffnesses(car)
    wheelbase = car.a + car.b
    understeer = 0.5 * car.m / wheelbase * (car.b / C_f - car.a / C_r)
    largest = 0.5 * GRAVITY * (wheelbase / speed**2 + understeer)
    wanted = 0.35 * smooth(random, time, 0.5) + 0.1 * smooth(random, time, 0.12)
    return largest * numpy.tanh(wanted)


def driven(model, random):
    """Columns of a drive without noise."""
    rows = round((SETTLING_S + DURATION_S) / ROW_S)
    time = ROW_S * numpy.arange(rows + 1)
    speed = random.uniform(14.0, 22.0)
    target = speed * (1.0 + 0.06 * smooth(random, time, 6.0))
    steer = steering(random, model.car, speed, time)
    state = numpy.array(model.start(float(speed)))
    out = numpy.empty((rows, 4))
    for i in range(rows):
        inputs = [(steer[i + 1] - steer[i]) / ROW_S, target[i] - state[3]]
        state[2] = steer[i]
        out[i] = steer[i], *model.measured(state, model.rate(state, inputs))
        for _ in range(STEPS_PER_ROW):
            middle = state + 0.5 * STEP_S * numpy.array(model.rate(state, inputs))
            state = state + STEP_S * numpy.array(model.rate(middle, inputs))
    return dict(zip(NOISE, out[round(SETTLING_S / ROW_S) :].T, strict=True))


def record(name, number, seed, folder):
    """A file of the drive; what is in the car."""
    model = MODELS[name](number)
    random, error = numpy.random.default_rng([seed, number, 0]), numpy.random.default_rng([seed, number, 1])
    drive = driven(model, random)
    rows = len(drive["steer[rad]"])
    noisy = {channel: drive[channel] + NOISE[channel] * error.standard_normal(rows) for channel in drive}
    write_csv(folder / "drive.csv", {"time[s]": ROW_S * numpy.arange(rows)} | noisy)
    C_f, C_r = stiffnesses(model.car)
    return {"C_f": C_f, "C_r": C_r, "I_z": model.car.I_z}, model.car


def identified(name, number, seed, folder):
    """The estimate of a drive, and what is in the car."""
    truth, car = record(name, number, seed, folder)
    text = STUDY.format(mass=float(car.m), a=float(car.a), b=float(car.b), cg_height=float(car.h_cg))
    out = run_study(text, folder, "identify")
    return json.loads((out / "estimate.json").read_text()), truth


if __name__ == "__main__":
    counts = IntervalCount()
    for seed in map(int, sys.argv[2:]):
        for number in CARS:
            with tempfile.TemporaryDirectory() as place:
                result, hidden = identified(sys.argv[1], number, seed, pathlib.Path(place))
            counts.add_estimate(result, hidden)
            print(f"car {number}, seed {seed}: {errors_in(result, hidden)}", flush=True)
    print(sys.argv[1], counts)
