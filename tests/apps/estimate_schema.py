#!/usr/bin/env python3
"""Holds the estimate.json of example studies to docs/estimate.schema.json, and the schema to files that are wrong.

usage: estimate_schema.py VERIDYN SOURCE_FOLDER; exit code 77 where Python's jsonschema is not installed.
"""
import copy
import json
import pathlib
import subprocess
import sys
import tempfile

try:
    from jsonschema import Draft202012Validator
except ImportError:
    print("skipped: needs Python's jsonschema")
    sys.exit(77)

# One of each domain and command that writes the file, quick ones.
EXAMPLES = [
    "identify examples/studies/simulated_flight.toml",
    "track examples/studies/iced_aircraft.toml",
    "identify examples/studies/swing_test/study.toml",
    "identify examples/studies/calibration/study.toml",
    "identify examples/studies/vehicle/identify_sweep.toml",
    "identify examples/studies/muscle/profile_arm.toml",
]


def spoiled(estimate):
    """Copies of an estimate with one thing wrong each, by what that is."""
    changes = {
        "no schema": lambda e: e.pop("schema"),
        "another schema": lambda e: e.update(schema=2),
        "an outcome that is none": lambda e: e["evidence"][0].update(outcome="fine"),
        "a cause that is none": lambda e: e["evidence"][0].update(cause="English"),
        "a row without a check": lambda e: e["evidence"][0].pop("check"),
        "a row without a sentence": lambda e: e["evidence"][0].update(text=""),
        "a limit that is a text": lambda e: e["evidence"][0].update(limit="0.3"),
        "a grade that is none": lambda e: e["grades"]["data"].update(grade="maybe"),
        "a status that is none": lambda e: e["parameters"][0].update(status="held by the prior"),
    }
    for name, change in changes.items():
        wrong = copy.deepcopy(estimate)
        change(wrong)
        yield name, wrong


def main(program, source):
    schema = json.loads((source / "docs/estimate.schema.json").read_text())
    Draft202012Validator.check_schema(schema)
    validator = Draft202012Validator(schema)
    wrong = []
    for example in EXAMPLES:
        with tempfile.TemporaryDirectory() as folder:
            command, study = example.split()
            run = subprocess.run([program, command, source / study, "--quiet", "--out", folder + "/out"],
                                 capture_output=True, text=True)
            file = pathlib.Path(folder) / "out" / "estimate.json"
            if not file.exists():
                wrong.append(f"{example}: no estimate.json: {run.stderr}")
                continue
            estimate = json.loads(file.read_text())
        if next(iter(estimate)) != "schema":
            wrong.append(f"{example}: does not begin with its schema")
        wrong += [f"{example}: {e.json_path}: {e.message}" for e in validator.iter_errors(estimate)]
        if not estimate["evidence"]:
            continue
        wrong += [f"{example}: {name} is not found" for name, bad in spoiled(estimate) if validator.is_valid(bad)]
    print("\n".join(wrong) or f"{len(EXAMPLES)} files are as the schema says")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], pathlib.Path(sys.argv[2])))
