"""Derivatives of JSBSim's own aircraft from flights with ordinary sensors: do the intervals of `veridyn identify` hold?

Three of the six aircraft, each in three airs; `python jsbsim_truth.py 1 2 ...` does all of them with other seeds."""

import pytest

from jsbsim_pilot import AIRS, fly
from jsbsim_truth import counted, effective_truth, perturbed_truth

pytestmark = pytest.mark.peer("jsbsim")

AIRCRAFT = ["c172p", "OV10", "global5000"]


@pytest.mark.parametrize("name", ["c172p", "global5000", "B747"])
def test_two_ways_to_the_truth_agree(name, comparison):
    # Least squares over a calm flight, and central differences at trim: what is left is the tables' curvature, and side
    # force by sine and cosine of beta.
    flown, at_trim = effective_truth(fly(name, "calm", 1)), perturbed_truth(name)
    off = {key: abs(flown[key] - true) / max(abs(true), 0.1) for key, true in at_trim.items()}
    comparison.within(f"{name}: derivatives by two ways, relative", max(off.values()), 0.06)


def test_intervals_of_derivatives_hold_the_truth(tmp_path, comparison):
    counts = counted([(name, air, 1) for name in AIRCRAFT for air in AIRS], tmp_path)
    count, yes = counts["all"], counts["graded yes"]
    assert count.intervals > 160 and count.identified > 90
    comparison.within("intervals that do not hold, share", 1.0 - count.held / count.intervals, 0.1)
    comparison.within("identified, more than 10 % off and outside, share", count.wrong / count.identified, 0.01)
    comparison.within("of flights graded yes: intervals that do not hold, share", 1.0 - yes.held / yes.intervals, 0.07)
    comparison.within("half width over error, medians", count.width_over_error(), 4.5)
    # Short period, phugoid, Dutch roll, roll and spiral, by JSBSim's own linearisation.
    modes = counts["modes"]
    assert modes.intervals > 40
    comparison.within("natural modes: intervals that do not hold, share", 1.0 - modes.held / modes.intervals, 0.1)
    comparison.within("natural modes: half width over error, medians", modes.width_over_error(), 4.5)
