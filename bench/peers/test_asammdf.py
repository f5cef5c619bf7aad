"""ASAM MDF through asammdf, which the program recommends where it refuses such a file: what asammdf exports from it
must be read with the values that asammdf finds in it."""

import numpy
import pytest
from asammdf import MDF, Signal

from logs import ChannelComparison, OurLog, to_si
from program import refusal

pytestmark = pytest.mark.peer("asammdf")

RATES_HZ = (100.0, 25.0)
BEGIN_S = 5.0
VERSIONS = ["3.30", "4.10", "4.20"]


def made(folder, version):
    """A measurement of two groups with stamps of their own: numbers of several kinds, with units and a conversion."""
    random = numpy.random.default_rng(3)
    mdf = MDF(version=version)
    fast = BEGIN_S + numpy.arange(400) / RATES_HZ[0]
    slow = BEGIN_S + 0.003 + numpy.arange(100) / RATES_HZ[1]
    counts = random.integers(-(2**15), 2**15, 400).astype("int16")
    mdf.append(
        [
            Signal(random.normal(20.0, 5.0, 400), fast, name="speed", unit="km/h"),
            Signal(random.normal(0.0, 0.3, 400).astype("float32"), fast, name="yaw_rate", unit="deg/s"),
            Signal(counts, fast, name="steering", unit="deg", conversion={"a": 0.1, "b": 2.0}),
        ]
    )
    mdf.append(
        [
            Signal(random.integers(0, 8, 100).astype("uint8"), slow, name="gear"),
            Signal(random.integers(0, 2**32, 100).astype("uint32"), slow, name="distance", unit="m"),
            Signal(random.normal(30.0, 10.0, 100), slow, name="temperature", unit="degC"),
        ]
    )
    return MDF(mdf.save(folder / f"made.{'mf4' if version >= '4' else 'mdf'}"))


@pytest.mark.parametrize("version", VERSIONS)
def test_a_measurement_is_refused_with_what_to_do(version, tmp_path):
    message = refusal("inspect", made(tmp_path, version).name)
    for words in ("ASAM MDF", "export its channels as CSV", "asammdf"):
        assert words in message


@pytest.mark.parametrize("version", VERSIONS)
def test_the_folder_of_its_groups_has_its_values(version, tmp_path, comparison):
    mdf = made(tmp_path, version)
    (tmp_path / "groups").mkdir()
    mdf.export("csv", tmp_path / "groups" / "log.csv", add_units=True, time_from_zero=False)
    ours = OurLog(tmp_path / "groups")
    channels = ChannelComparison(ours)
    for name in ("speed", "yaw_rate", "steering", "gear", "distance", "temperature"):
        theirs = mdf.get(name)
        channel = next(c for c in ours.units if c.endswith(f".{name}"))
        assert (ours.units[channel] or "1") == (theirs.unit or "1"), channel
        values = to_si(theirs.samples.astype(float), theirs.unit)
        channels.add(channel, ours.at(channel, theirs.timestamps), values)
    channels.finish(f"MDF {version}, CSV of each group", comparison)


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("form", ["csv", "mat 4", "mat 5"])
def test_its_export_to_one_time_base_has_its_values(form, version, tmp_path, comparison):
    mdf = made(tmp_path, version)
    file = tmp_path / f"log.{form[:3]}"
    options = {"add_units": True} if form == "csv" else {"format": form[4:]}
    mdf.export(form[:3], file, single_time_base=True, time_from_zero=False, **options)
    ours, theirs = OurLog(file), mdf.to_dataframe(time_from_zero=False)
    channels = ChannelComparison(ours)
    for name in theirs.columns:
        # MATLAB files have no units.
        unit = mdf.get(name).unit if form == "csv" else ""
        assert (ours.units[name] or "1") == (unit or "1"), name
        stamps = theirs.index.to_numpy()
        channels.add(name, ours.at(name, stamps), to_si(theirs[name].to_numpy(dtype=float), unit))
    channels.finish(f"MDF {version} as {form}", comparison)
