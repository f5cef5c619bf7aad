"""Runs the built program and reads what it writes. Numbers are SI and radians, as in all of its files."""

import csv
import io
import os
import pathlib
import subprocess

import numpy
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(os.environ.get("VERIDYN_PROGRAM", ROOT / "build/release/bin/veridyn"))
SHARED = ROOT.parent / "shared"


def veridyn(*arguments):
    """What the program prints on stdout; where it ends with another code than 0, its messages are the failure's."""
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"veridyn {' '.join(map(str, arguments))}\n{done.stderr}"
    return done.stdout


def refusal(*arguments):
    """What the program says on stderr where it must refuse its input, by exit code 2."""
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 2, f"veridyn {' '.join(map(str, arguments))} ended with {done.returncode}"
    return done.stderr


def run_study(text, folder, verb="simulate"):
    """Runs a study that is given as text in a folder; the folder of its results."""
    study = pathlib.Path(folder) / "study.toml"
    study.write_text(text)
    veridyn(verb, study, "--out", study.parent / "out", "--quiet")
    return study.parent / "out"


def columns_of(text):
    """Columns of CSV by the names in its first row, without their units: arrays, empty cells are NaN."""
    rows = csv.reader(io.StringIO("\n".join(line for line in text.splitlines() if not line.startswith("#"))))
    names = [name.split("[")[0] if name.endswith("]") else name for name in next(rows)]
    cells = numpy.array([[float(cell) if cell else numpy.nan for cell in row] for row in rows])
    return dict(zip(names, cells.T, strict=True))


def read_csv(path):
    return columns_of(pathlib.Path(path).read_text())


def write_csv(path, columns):
    """Columns with names and all digits."""
    table = numpy.column_stack(list(columns.values()))
    lines = [",".join(columns)] + [",".join(repr(float(value)) for value in row) for row in table]
    pathlib.Path(path).write_text("\n".join(lines) + "\n")


def shared_file(path):
    """A file of others' data, which are not part of the repository: the test is skipped where they are missing."""
    file = SHARED / path
    if not file.exists():
        pytest.skip(f"{path} is not in ../shared")
    return file
