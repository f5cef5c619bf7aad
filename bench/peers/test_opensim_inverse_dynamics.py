"""Generalised forces that motions need, against OpenSim's InverseDynamicsSolver: the same states on both sides, no
force of the model but gravity (as OpenSim's tool has it, muscles and limits left out)."""

import numpy
import pytest

from opensim_model import OpenSimModel, random_states
from program import columns_of, shared_file, veridyn, write_csv

pytestmark = pytest.mark.peer("opensim")


@pytest.mark.parametrize("name", ["arm26", "leg6dof9musc", "gait2392_thelen2003muscle", "gait10dof18musc"])
@pytest.mark.parametrize("moving", [True, False], ids=["moving", "at rest"])
def test_forces_of_random_states_are_the_same(name, moving, tmp_path, comparison):
    path = shared_file(f"data/opensim/{name}.osim")
    model = OpenSimModel(path, without_forces=True)
    # The program moves coordinates that others lead as their couplers say.
    q, qdot, qddot = model.moving_with_couplers(*random_states(model, 50, seed=2))
    if not moving:
        qdot[:], qddot[:] = 0.0, 0.0
    states = {}
    for i, c in enumerate(model.names):
        states |= {c: q[:, i], f"{c}.speed": qdot[:, i], f"{c}.acceleration": qddot[:, i]}
    write_csv(tmp_path / "states.csv", states)
    table = columns_of(veridyn("inspect", path, "--pose", tmp_path / "states.csv"))
    ours = numpy.array([table[f"{c}.force"] for c in model.names]).T
    theirs = numpy.array([model.inverse_dynamics(*state) for state in zip(q, qdot, qddot, strict=True)])
    # Relative to the largest force of the coordinate, or 1e-3 N m where gravity has none: both are sums of the same
    # terms in another order.
    difference = (numpy.abs(ours - theirs) / numpy.maximum(numpy.abs(theirs).max(axis=0), 1e-3)).max()
    what = "inverse dynamics" if moving else "forces of gravity"
    comparison.within(f"{name}: {what}, relative", difference, 1e-12)
