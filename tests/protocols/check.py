#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Explores every order of steps of the protocols by Spin, and sees that planted faults are found.

usage: check.py     Exit status 77: there is no Spin or no C compiler here.

A model's lines `//= ...` are copied from the kernels and the host: the first ones name the files, the others must stand
there. So a changed line of a protocol fails here until its model was changed, too.
"""
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
MODELS = [
    ("append", {"BLOCK": 1, "MOST": 3}), ("append", {"BLOCK": 2, "MOST": 5}),
    ("queue", {}),
    ("shares", {"ITEMS": 2}), ("shares", {"ITEMS": 3, "MOST": 6}),
]
# Model, its sizes, the right text, the wrong one: each must break an assertion or leave an item waiting.
FAULTS = [
    ("append", {"BLOCK": 2, "MOST": 3}, "d_step { first = counter; counter = counter + BLOCK };",
     "first = counter; counter = first + BLOCK;"),
    ("append", {"BLOCK": 2, "MOST": 5}, "counter = counter - BLOCK", "skip"),
    ("append", {"BLOCK": 2, "MOST": 3}, "write(next, UNUSED); next++", "next++"),
    ("queue", {}, "d_step { slot = uncertain; uncertain++ };", "slot = uncertain; uncertain = slot + 1;"),
    ("queue", {}, "postponed = !has_room\n    ::", "skip\n    ::"),
    ("queue", {}, "uncertain > CAPACITY ->", "uncertain > CAPACITY + 1 ->"),
    ("shares", {"ITEMS": 2}, "i == ITEMS - 1 ->", "i == 0 ->"),
    ("shares", {"ITEMS": 2}, "runs_before = runs_before + ITEMS;", "runs_before = runs_before + ITEMS - 1;"),
]


def stale_lines(text):
    """The lines that the model quotes and no file of the project has."""
    quoted = re.findall(r"//= (.*)", text)
    files = [line for line in quoted if "/" in line and " " not in line]
    known = "".join((ROOT / file).read_text() for file in files)
    return [line for line in quoted if line not in files and line.strip() not in known]


def explore(text, sizes):
    """The number of states in which the model holds, or None if it does not."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "model.pml").write_text(text)

        def do(*command):
            return subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True).stdout

        do("spin", *(f"-D{name}={value}" for name, value in sizes.items()), "-a", "model.pml")
        do("cc", "-O2", "-DSAFETY", "-DCOLLAPSE", "-o", "pan", "pan.c")
        said = do("./pan", "-m100000", "-w22")
    if "max search depth too small" in said or not re.search(r"errors: \d+", said):
        sys.exit(f"the model was not explored to its end:\n{said}")
    return int(re.search(r"(\d+) states, stored", said).group(1)) if "errors: 0" in said else None


def main():
    if not shutil.which("spin") or not shutil.which("cc"):
        print("SKIPPED: no Spin or no C compiler")
        sys.exit(77)
    failed = False
    for name, sizes in MODELS:
        text = (HERE / f"{name}.pml").read_text()
        for line in stale_lines(text):
            failed = True
            print(f"{name}.pml quotes a line that its files do not have: {line}")
        states = explore(text, sizes)
        failed |= states is None
        print(f"{name} {sizes}: " + ("DOES NOT HOLD" if states is None else f"holds in {states} states"), flush=True)
    for name, sizes, right, wrong in FAULTS:
        text = (HERE / f"{name}.pml").read_text()
        if right not in text:
            sys.exit(f"{name}.pml has no '{right}'")
        found = explore(text.replace(right, wrong, 1), sizes) is None
        failed |= not found
        print(f"{name} {sizes} with '{wrong.strip()}': " + ("found" if found else "NOT FOUND"), flush=True)
    sys.exit(failed)


if __name__ == "__main__":
    main()
