"""Names each test's peer with its version, and prints what was measured."""

import importlib.metadata

import pytest

from program import PROGRAM, veridyn

NAMES = {
    "opensim": "OpenSim",
    "jsbsim": "JSBSim",
    "pymavlink": "pymavlink",
    "pyulog": "pyulog",
    "commonroad-vehicle-models": "CommonRoad vehicle models",
    "mujoco": "MuJoCo",
    "asammdf": "asammdf",
    "casadi": "CasADi",
}
FIGURES = pytest.StashKey[list]()


def peer_of(item):
    package = item.get_closest_marker("peer").args[0]
    return f"{NAMES[package]} {importlib.metadata.version(package)}"


def pytest_configure(config):
    config.addinivalue_line("markers", "peer(package): the program that a test compares with, by its package's name")
    config.stash[FIGURES] = []
    if not PROGRAM.exists():
        raise pytest.UsageError(f"{PROGRAM} is not there: `make build`, or VERIDYN_PROGRAM=path")


def pytest_itemcollected(item):
    item.user_properties.append(("peer", peer_of(item)))


def pytest_report_teststatus(report):
    """PASSED (OpenSim 4.6): as pytest would say it, and the peer."""
    if report.passed and report.when != "call":
        return "", "", ""
    if hasattr(report, "wasxfail"):
        category = "xpassed" if report.passed else "xfailed"
    else:
        category = report.outcome if report.when == "call" or report.skipped else "error"
    return category, category[0].upper(), f"{category.upper()} ({dict(report.user_properties)['peer']})"


def pytest_report_header():
    return f"veridyn {veridyn('--version').strip()}: {PROGRAM}"


class Comparison:
    """What a test measured. A difference is checked where it is recorded, so that the table cannot show another one."""

    def __init__(self, item):
        self.item = item
        self.rows = item.config.stash[FIGURES]

    def within(self, what, difference, tolerance):
        """The difference must not be NaN and not beyond the tolerance."""
        self.rows.append((peer_of(self.item), what, difference, tolerance))
        assert difference <= tolerance, f"{what}: {difference:.3g}, tolerance {tolerance:.3g}"


@pytest.fixture
def comparison(request):
    return Comparison(request.node)


def pytest_terminal_summary(terminalreporter, config):
    rows = config.stash[FIGURES]
    if not rows:
        return
    terminalreporter.section("largest differences")
    width = max(len(row[1]) for row in rows)
    for peer, what, difference, tolerance in rows:
        terminalreporter.line(f"{peer:<32} {what:<{width}} {difference:9.2e}  tolerance {tolerance:.1e}")
