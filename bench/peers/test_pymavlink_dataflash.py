"""ArduPilot's DataFlash logs against pymavlink's DFReader: every topic, every field, every value.

pymavlink gives raw numbers, scaled only where the format's character says so (c, C, e, E, L). Multipliers of MULT and
FMTU are applied here from the log itself; units are those that the program says it read, converted by a table of this
folder. What is left is rounding of the products."""

import collections

import numpy
import pytest
from pymavlink import DFReader

import made_logs
from logs import ChannelComparison, OurLog, to_si
from program import shared_file

pytestmark = pytest.mark.peer("pymavlink")

# What describes the log itself makes no channels.
SCHEMA = {"FMT", "UNIT", "MULT", "FMTU", "PARM", "VER", "FILE"}
SCALED_BY_FORMAT = "cCeEL"
TEXTS = "nNZ"
# Stamps by the names of their columns; they are the rows' time and no channels.
STAMPS = {"TimeUS": 1e-6, "TimeMS": 1e-3}


class Topic:
    """All messages of a type that pymavlink gave out, by column."""

    def __init__(self, format_, instance):
        self.format = format_
        self.instance = instance  # the column that numbers instances, which stand in the names
        self.rows = []

    def column(self, i):
        return numpy.array([float(row[i]) for row in self.rows])


def instance_column(format_, unit_ids):
    """Which column numbers the instances: the one marked # by FMTU; in logs without, by its name."""
    if unit_ids:
        return unit_ids.index("#") if "#" in unit_ids else None
    for i, name in enumerate(format_.columns):
        if name in ("I", "Instance", "Inst") and format_.format[i] == "B":
            return i
    return None


def stamp_of(format_, values, before):
    """Of a message [s]; one without a stamp has that of the message before it."""
    for name, unit in STAMPS.items():
        if name in format_.columns:
            return unit * values[format_.columns.index(name)]
    return before


def read(path):
    """Topics by their names with instances, and by type the multiplier of each column."""
    log = DFReader.DFReader_binary(str(path))
    multipliers, formats, rows = {}, {}, collections.defaultdict(list)
    now = 0.0
    while (message := log.recv_msg()) is not None:
        kind = message.get_type()
        if kind == "MULT":
            # A factor of 0 stands for fields that have none.
            multipliers[chr(message.Id)] = float(f"{message.Mult:.7g}") or 1.0
        elif kind == "FMTU":
            formats[message.FmtType] = (message.UnitIds, message.MultIds)
        if kind not in SCHEMA:
            values = [getattr(message, name) for name in message.fmt.columns]
            rows[kind].append((message.fmt, values, now))
        now = stamp_of(message.fmt, [getattr(message, name) for name in message.fmt.columns], now)
    topics = {}
    for kind, messages in rows.items():
        for format_, values, time in messages:
            unit_ids, _ = formats.get(format_.type, ("", ""))
            i = instance_column(format_, unit_ids)
            number = values[i] if i is not None else 0
            name = f"{kind}[{number}]" if number else kind
            topics.setdefault(name, Topic(format_, i)).rows.append([stamp_of(format_, values, time), *values])
    scales = {type_: [multipliers.get(c, 1.0) for c in ids[1]] for type_, ids in formats.items()}
    return topics, scales


def compare(path, comparison):
    ours, (topics, scales) = OurLog(path), read(path)
    channels = ChannelComparison(ours)
    for name, topic in topics.items():
        stamps = topic.column(0)
        order = numpy.argsort(stamps, kind="stable")
        scale_of = scales.get(topic.format.type, [])
        for i, (field, character) in enumerate(zip(topic.format.columns, topic.format.format, strict=True)):
            channel = f"{name}.{field}"
            if character in TEXTS or field in STAMPS or i == topic.instance:
                continue
            assert channel in ours.units, f"{channel} is not read"
            values = topic.column(i + 1)[order]
            if i < len(scale_of) and character not in SCALED_BY_FORMAT:
                values = values * scale_of[i]
            channels.add(channel, ours.at(channel, stamps[order]), to_si(values, ours.units[channel]))
    channels.finish(path.name, comparison)


@pytest.mark.parametrize("name", ["center_0003.bin", "pymavlink_test.BIN", "test_log_pilot_position.BIN"])
def test_a_flight_has_pymavlinks_values(name, comparison):
    compare(shared_file(f"data/flight/ardupilot/{name}"), comparison)


def test_a_log_of_known_bytes_has_pymavlinks_values(tmp_path, comparison):
    # Written by this folder from the published layout, so that the comparison runs where there are no recordings.
    path = tmp_path / "made.bin"
    path.write_bytes(made_logs.dataflash())
    compare(path, comparison)
