"""C_f, C_r and I_z of CommonRoad's cars: do the intervals of `veridyn identify` hold what is in these cars?

The default study, a minute of driving. `python commonroad_drives.py multi-body 1 2 3 ...` does more drives."""

import numpy
import pytest

from commonroad_drives import identified
from intervals import IntervalCount

pytestmark = pytest.mark.peer("commonroad-vehicle-models")


@pytest.mark.parametrize(
    "model, cars, half_width",
    # Half widths are about twice what such drives leave: intervals that are wide enough hold anything.
    [("drift", [1, 2], 0.4), ("without camber", [1], 0.5), ("multi-body", [2], 1.5)],
)
def test_intervals_hold_what_is_in_the_car(model, cars, half_width, tmp_path, comparison):
    count = IntervalCount()
    for number in cars:
        place = tmp_path / str(number)
        place.mkdir()
        count.add_estimate(*identified(model, number, 1, place))
    comparison.within(f"{model}: intervals that do not hold", count.intervals - count.held, 0)
    assert count.wrong == 0
    assert count.intervals == 3 * len(cars)
    comparison.within(f"{model}: half width of the intervals", numpy.median(count.widths), half_width)
