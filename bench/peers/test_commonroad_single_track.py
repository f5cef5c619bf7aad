"""The bicycle models against the single-track models of CommonRoad (parameters of its vehicle 2, a saloon of 1093 kg).

Angles and axes are the same (x forward, y left, positive to the left). CommonRoad steers by a rate; here its steering
angle is the one that the program wrote, at every moment. Its tyres are in proportion to the load, which in a bicycle
is constant without acceleration: C = mu C_S F_z. Its gravity is 9.81 m/s^2.
"""

import math

import numpy
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve
from vehiclemodels.init_std import init_std
from vehiclemodels.parameters_vehicle2 import parameters_vehicle2
from vehiclemodels.utils.vehicle_dynamics_ks_cog import vehicle_dynamics_ks_cog
from vehiclemodels.vehicle_dynamics_st import vehicle_dynamics_st
from vehiclemodels.vehicle_dynamics_std import vehicle_dynamics_std

from program import read_csv, run_study

pytestmark = pytest.mark.peer("commonroad-vehicle-models")

GRAVITY = 9.81
CAR = parameters_vehicle2()
STUDY = """
[subject]
kind = "vehicle"
mass = {mass!r}
a = {a!r}
b = {b!r}
I_z = {I_z!r}
C_f = {C_f!r}
C_r = {C_r!r}
{tyre}
[drive]
model = "{model}"
manoeuvre = "step steer"
speed = {speed!r}
amplitude = {amplitude!r}
start = 0.5
rise_time = 0.2
duration = {duration!r}
step = 0.001
gravity = 9.81
"""


def static_loads():
    """Of one tyre of the front and of the rear axle [N]."""
    share = 0.5 * CAR.m * GRAVITY / (CAR.a + CAR.b)
    return share * CAR.b, share * CAR.a


def stiffnesses():
    """Of one tyre in front and rear [N/rad]: its K_y is in proportion to the load."""
    return tuple(-CAR.tire.p_ky1 * load for load in static_loads())


def drive(folder, model, speed, amplitude, duration=4.0, tyre='tyre = "linear"'):
    C_f, C_r = stiffnesses()
    text = STUDY.format(
        mass=CAR.m, a=CAR.a, b=CAR.b, I_z=CAR.I_z, C_f=C_f, C_r=C_r, tyre=tyre, model=model, speed=speed,
        amplitude=amplitude, duration=duration,
    )  # fmt: skip
    return read_csv(run_study(text, folder) / "motion.csv")


def integrate(dynamics, start, motion):
    """A CommonRoad model from `start` along the steering angle of a motion; states by row of the motion."""

    def rate(t, x):
        x = list(x)
        x[2] = float(numpy.interp(t, motion["time"], motion["steer"]))
        f = dynamics(x, [0.0, 0.0], CAR)
        f[2] = 0.0
        return f

    # The corners of the steering ramp are never stepped over.
    end = motion["time"][-1]
    solution = solve_ivp(rate, (0.0, end), start, t_eval=motion["time"], rtol=1e-9, atol=1e-11, max_step=0.01)
    assert solution.success, solution.message
    return solution.y


@pytest.mark.parametrize("speed", [10.0, 30.0])
def test_linear_bicycle_is_the_single_track_model(speed, tmp_path, comparison):
    # The same linear equations in v = u beta and r: what is left is integration.
    motion = drive(tmp_path, "linear bicycle", speed, 0.02)
    theirs = integrate(vehicle_dynamics_st, [0.0, 0.0, 0.0, speed, 0.0, 0.0, 0.0], motion)
    assert numpy.abs(motion["yaw_rate"]).max() > 0.05
    label = f"single track, {speed:.0f} m/s"
    comparison.within(f"{label}: yaw rate [rad/s]", numpy.abs(motion["yaw_rate"] - theirs[5]).max(), 1e-6)
    slip = motion["lateral_velocity"] / speed
    comparison.within(f"{label}: slip angle [rad]", numpy.abs(slip - theirs[6]).max(), 1e-6)
