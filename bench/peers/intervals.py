"""How many intervals of 95 % of `veridyn identify` hold what another program had in it."""

import dataclasses

import numpy


@dataclasses.dataclass
class IntervalCount:
    """Over recordings whose true parameters are known, by name; a true value of 0 is not counted."""

    held: int = 0
    wrong: int = 0  # identified, more than 10 % off and outside
    errors: list = dataclasses.field(default_factory=list)  # relative
    widths: list = dataclasses.field(default_factory=list)  # half of them, relative
    grades: list = dataclasses.field(default_factory=list)

    def add(self, estimate, truth):
        self.grades.append(estimate["grades"]["parameters"]["grade"])
        for p in estimate["parameters"]:
            true = truth.get(p["name"], 0.0)
            if true == 0.0:
                continue
            off, half = p["value"] - true, 0.5 * (p["high95"] - p["low95"])
            held = p["low95"] <= true <= p["high95"]
            self.held += held
            self.wrong += p["status"] == "identified" and not held and abs(off) > 0.1 * abs(true)
            self.errors.append(off / true)
            self.widths.append(half / abs(true))

    def __str__(self):
        text = f"{self.held} of {len(self.errors)} intervals hold, "
        text += f"median error {numpy.median(numpy.abs(self.errors)):.1%} (mean {numpy.mean(self.errors):+.1%}), "
        text += f"half width {numpy.median(self.widths):.1%}, {self.wrong} wrong"
        grades = {grade: self.grades.count(grade) for grade in sorted(set(self.grades))}
        return text + f", parameters {grades}"
