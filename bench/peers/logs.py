"""A log as the program reads it, and as a peer does: values of every channel, row by row."""

import io
import json

import numpy
import pandas

from program import veridyn

# What a unit of the log is in SI: factor, and offset of temperatures. Units that are not here are SI already, or none.
SI = {
    "deg": numpy.pi / 180.0,
    "deg/s": numpy.pi / 180.0,
    "deg/s^2": numpy.pi / 180.0,
    "cm/s": 0.01,
    "ms": 1e-3,
    "us": 1e-6,
    "mG": 1e-7,
    "gauss": 1e-4,
    "mbar": 100.0,
    "rpm": 2.0 * numpy.pi / 60.0,
    "%": 0.01,
    "mA h": 3.6,
    "A h": 3600.0,
    "W h": 3600.0,
    "km/h": 1.0 / 3.6,
    "mm/s": 1e-3,
}
CELSIUS = 273.15


def to_si(values, unit):
    return values + CELSIUS if unit == "degC" else values * SI.get(unit, 1.0)


class OurLog:
    """Channels of a log by name: values at every stamp that the log has, and the units that the log gave them."""

    def __init__(self, path):
        text = veridyn("inspect", path, "--values")
        lines = text[text.index("time[s]") :]
        self.table = pandas.read_csv(io.StringIO(lines), low_memory=False)
        self.table.columns = [name[: name.rindex("[")] for name in self.table.columns]
        self.time = self.table["time"].to_numpy()
        summary = json.loads(veridyn("inspect", path, "--json"))
        self.units = {c["name"]: c["recorded_unit"] for c in summary["channels"]}
        self.samples = {c["name"]: c["samples"] for c in summary["channels"]}
        self.lost = summary["bytes_lost"] + summary["records_lost"]
        assert list(self.units) == list(self.table.columns)[1:]

    def at(self, name, stamps):
        """Values of a channel at the stamps of its topic [s], whose repeated ones are the rows that repeat them."""
        row = rows_of(self.time, stamps)
        return self.table[name].to_numpy()[row]

    def rows_with(self, topic):
        """Rows in which a topic has any number: its samples, unless one of them has none at all."""
        columns = [name for name in self.table.columns if name.startswith(topic + ".")]
        return self.table[columns].notna().any(axis=1).to_numpy()

    def in_order(self, name, topic):
        return self.table[name].to_numpy()[self.rows_with(topic)]

    def stamps(self, topic):
        return self.time[self.rows_with(topic)]


class ChannelComparison:
    """Every value of our channels against those of a peer."""

    def __init__(self, ours):
        self.ours = ours
        self.compared, self.worst, self.missing = set(), 0.0, 0

    def add(self, channel, found, expected):
        """Both in SI; samples that are no numbers are so in both."""
        expected = numpy.where(numpy.isfinite(expected), expected, numpy.nan)
        count = self.ours.samples[channel]
        assert count == len(expected), f"{channel}: {count} of {len(expected)} samples"
        assert (numpy.isnan(found) == numpy.isnan(expected)).all(), f"{channel}: other samples are numbers"
        self.missing += numpy.isnan(expected).sum()
        size = numpy.maximum(numpy.abs(expected), 1e-12)
        self.worst = max(self.worst, numpy.nanmax(numpy.abs(found - expected) / size, initial=0.0))
        self.compared.add(channel)

    def finish(self, name, comparison):
        """All channels were compared, and agree within two roundings of each product."""
        assert set(self.ours.units) - self.compared == set(), "channels that the peer does not have"
        samples = sum(self.ours.samples[c] for c in self.compared)
        assert samples > 0
        comparison.within(f"{name}: {len(self.compared)} channels, {samples} values, relative", self.worst, 5e-16)


def rows_of(time, stamps):
    """The rows of a table in which the stamps of one topic stand; both increase."""
    ticks, wanted = (numpy.rint(1e6 * numpy.asarray(t)).astype(numpy.int64) for t in (time, stamps))
    row = numpy.searchsorted(ticks, wanted, side="left") + repetition(wanted)
    assert (ticks[numpy.minimum(row, len(ticks) - 1)] == wanted).all(), "a stamp of the peer is missing"
    return row


def repetition(stamps):
    """How often each stamp stood before: 0, 1, ... of equal neighbours."""
    first = numpy.searchsorted(stamps, stamps, side="left")
    return numpy.arange(len(stamps)) - first
