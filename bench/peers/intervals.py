"""How many intervals of 95 % of `veridyn identify` hold what another program had in it."""

import dataclasses

import numpy

MEANT = ("identified", "insignificant", "weak")  # statuses whose interval is claimed


@dataclasses.dataclass
class IntervalCount:
    """Over parameters whose true values are known."""

    statuses: tuple = ()  # of the parameters that are counted, others are refused; none: all are counted
    held: int = 0
    intervals: int = 0
    identified: int = 0
    wrong: int = 0  # identified, more than 10 % off and outside
    refused: int = 0
    errors: list = dataclasses.field(default_factory=list)  # relative, of values that are not about zero
    widths: list = dataclasses.field(default_factory=list)  # half of them, relative
    grades: list = dataclasses.field(default_factory=list)

    def add(self, parameter, true):
        if self.statuses and parameter["status"] not in self.statuses:
            self.refused += 1
            return
        off, half = parameter["value"] - true, 0.5 * (parameter["high95"] - parameter["low95"])
        held = parameter["low95"] <= true <= parameter["high95"]
        self.intervals += 1
        self.held += held
        if parameter["status"] == "identified":
            self.identified += 1
            self.wrong += not held and abs(off) > 0.1 * abs(true)
        if abs(true) > 1e-3:
            self.errors.append(off / abs(true))
            self.widths.append(half / abs(true))

    def add_estimate(self, estimate, truth):
        """Of the parameters in `truth` those that are not 0."""
        self.grades.append(estimate["grades"]["parameters"]["grade"])
        for p in estimate["parameters"]:
            if truth.get(p["name"], 0.0) != 0.0:
                self.add(p, truth[p["name"]])

    def median_error(self):
        return numpy.median(numpy.abs(self.errors))

    def width_over_error(self):
        return numpy.median(self.widths) / self.median_error()

    def __str__(self):
        text = f"{self.held} of {self.intervals} hold ({self.held / max(1, self.intervals):.0%}); "
        text += f"{self.wrong} of {self.identified} identified are wrong"
        if self.errors:
            text += f"; median error {self.median_error():.1%} (mean {numpy.mean(self.errors):+.1%})"
            text += f", half width {numpy.median(self.widths):.1%}"
        if self.statuses:
            text += f"; refused {self.refused}"
        if self.grades:
            text += f"; parameters {({grade: self.grades.count(grade) for grade in sorted(set(self.grades))})}"
        return text


def errors_in(estimate, truth):
    """The relative errors of an estimate with half widths and statuses, and its grades, on one line."""
    parts = []
    for p in estimate["parameters"]:
        if (true := truth.get(p["name"], 0.0)) != 0.0:
            half = 0.5 * (p["high95"] - p["low95"]) / true
            parts.append(f"{p['name']} {p['value'] / true - 1.0:+.1%} ±{half:.1%} {p['status']}")
    return "; ".join(parts) + f"; {({purpose: of['grade'] for purpose, of in estimate['grades'].items()})}"
