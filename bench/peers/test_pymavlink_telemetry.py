"""MAVLink telemetry against pymavlink, which packs the messages and reads the file back: every kind of message that the
program reads, with random values in every field.

pymavlink gives the numbers of the protocol and, from common.xml, their units; what these are in SI is written down
here, and so are the fields that common.xml keeps without a unit though it describes one."""

import collections

import numpy
import pytest
from pymavlink import mavutil

import made_logs
from logs import ChannelComparison, OurLog

pytestmark = pytest.mark.peer("pymavlink")

DEGREE = numpy.pi / 180.0
# By the units of common.xml.
FACTORS = {
    "rad": 1.0, "rad/s": 1.0, "m": 1.0, "m/s": 1.0, "m/s/s": 1.0, "deg": DEGREE, "cdeg": 1e-2 * DEGREE,
    "degE5": 1e-5 * DEGREE, "degE7": 1e-7 * DEGREE, "mm": 1e-3, "cm/s": 1e-2, "mm/s": 1e-3, "mG": 9.80665e-3,
    "mrad/s": 1e-3, "mgauss": 1e-7, "gauss": 1e-4, "hPa": 100.0, "%": 1e-2, "us": 1e-6, "ms": 1e-3, "cdegC": 1e-2,
    "degC": 1.0,
}  # fmt: skip
# Described in words there: hundredths, revolutions per minute.
DESCRIBED = {
    ("GPS_RAW_INT", "eph"): 1e-2,
    ("GPS_RAW_INT", "epv"): 1e-2,
    ("RPM", "rpm1"): 2.0 * numpy.pi / 60.0,
    ("RPM", "rpm2"): 2.0 * numpy.pi / 60.0,
}
CELSIUS = 273.15
# The rows' time, and what numbers sensors and ports: they are no channels.
STAMPS = {"time_boot_ms", "time_usec"}
INSTANCES = {"id", "port", "group_mlx"}
# Which fields common.xml keeps a value for "not known" of, all bits set.
NOT_KNOWN = {
    "GPS_RAW_INT": {"eph", "epv", "vel", "cog", "satellites_visible"},
    "GLOBAL_POSITION_INT": {"hdg"},
    "RC_CHANNELS": {"rssi", *(f"chan{i}_raw" for i in range(1, 19))},
}
INTEGERS_OF_BITS = {"uint8_t": 8, "uint16_t": 16, "uint32_t": 32, "uint64_t": 64}


def expected_si(message, field, numbers):
    """What a field of all messages of a kind is in SI."""
    kind = message.get_type()
    unit = message.fieldunits_by_name.get(field)
    values = numbers * DESCRIBED.get((kind, field), FACTORS[unit] if unit else 1.0)
    if unit in ("degC", "cdegC"):
        values = values + CELSIUS
    if field in NOT_KNOWN.get(kind, ()):
        bits = INTEGERS_OF_BITS[message.fieldtypes[message.fieldnames.index(field)]]
        values = numpy.where(numbers == 2**bits - 1, numpy.nan, values)
    return values


def read(path):
    """All messages of each kind, in the order of the file."""
    link = mavutil.mavlink_connection(str(path), dialect="ardupilotmega")
    messages = collections.defaultdict(list)
    while (message := link.recv_match()) is not None:
        messages[message.get_type()].append(message)
    return messages


def test_every_kind_of_message_has_pymavlinks_values(tmp_path, comparison):
    path = tmp_path / "made.tlog"
    path.write_bytes(made_logs.telemetry())
    ours, theirs = OurLog(path), read(path)
    assert set(made_logs.TELEMETRY) < set(theirs)
    channels = ChannelComparison(ours)
    for kind, messages in theirs.items():
        for field in set(messages[0].get_fieldnames()) - STAMPS - INSTANCES:
            values = numpy.array([getattr(m, field) for m in messages], dtype=float).reshape(len(messages), -1)
            for i in range(values.shape[1]):
                channel = f"{kind}.{field}[{i}]" if values.shape[1] > 1 else f"{kind}.{field}"
                assert channel in ours.units, f"{channel} is not read"
                expected = expected_si(messages[0], field, values[:, i])
                channels.add(channel, ours.in_order(channel, kind), expected)
    assert channels.missing >= 20, "values that are not known are among them"
    channels.finish("telemetry", comparison)


def test_stamps_are_the_vehicles_own(tmp_path, comparison):
    # Packets come with the moment at which they were logged, the vehicle's own times run alongside in whole
    # milliseconds: rows stand at that time from the first packet on.
    path = tmp_path / "made.tlog"
    path.write_bytes(made_logs.telemetry())
    ours, theirs = OurLog(path), read(path)
    begin = 1e-6 * made_logs.BEGIN_US
    stamps = numpy.array([m._timestamp for m in theirs["ATTITUDE"]]) - begin
    found = ours.stamps("ATTITUDE")
    comparison.within("telemetry: stamps [s]", numpy.abs(found - stamps).max(), 1e-3)
