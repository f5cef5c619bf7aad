"""PX4's ULog against pyulog: every topic and instance, every field, every value. pyulog gives raw numbers; units are
those that the program says it read (ULog holds none; they are PX4's), converted by a table of this folder."""

import collections

import numpy
import pytest
from pyulog import ULog

import made_logs
from logs import ChannelComparison, OurLog, to_si
from program import shared_file

pytestmark = pytest.mark.peer("pyulog")

# Integers of PX4 before 1.14 whose unit is not the one that the program names (PX4's messages, vehicle_gps_position).
SCALES = {"lat": 1e-7, "lon": 1e-7, "alt": 1e-3, "alt_ellipsoid": 1e-3}


# Rows that the program leaves out, and says so, since their stamps are off: here one of 1194 s in 27 s.
DROPPED = {("sample_log_small.ulg", "mission"): 1}


def scale_of(topic, field):
    return SCALES.get(field, 1.0) if topic in ("vehicle_gps_position", "sensor_gps") else 1.0


def compare(path, comparison):
    ours, theirs = OurLog(path), ULog(str(path))
    channels = ChannelComparison(ours)
    topics = collections.Counter(data.name for data in theirs.data_list)
    assert topics, "pyulog finds nothing"
    for data in theirs.data_list:
        prefix = f"{data.name}[{data.multi_id}]" if data.multi_id else data.name
        stamps = 1e-6 * data.data["timestamp"].astype(float)
        order = numpy.argsort(stamps, kind="stable")
        order = order[: len(order) - DROPPED.get((path.name, prefix), 0)]
        for field, raw in data.data.items():
            # The rows' time, and bytes that align the fields after them.
            if field == "timestamp" or "_padding" in field:
                continue
            channel = f"{prefix}.{field}"
            assert channel in ours.units, f"{channel} is not read"
            values = raw[order].astype(float) * scale_of(data.name, field)
            channels.add(channel, ours.at(channel, stamps[order]), to_si(values, ours.units[channel]))
    channels.finish(path.name, comparison)


@pytest.mark.parametrize("name", ["sample_log_small.ulg", "sample_appended_multiple.ulg"])
def test_a_flight_has_pyulogs_values(name, comparison):
    compare(shared_file(f"data/flight/px4/{name}"), comparison)


def test_a_log_of_known_bytes_has_pyulogs_values(tmp_path, comparison):
    # Written by this folder from the published layout, so that the comparison runs where there are no recordings.
    path = tmp_path / "made.ulg"
    path.write_bytes(made_logs.ulog())
    compare(path, comparison)
