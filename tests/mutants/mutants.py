#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Plants the faults of mutants.txt in copies of the kernels, one at a time, and sees that the named check notices each.

usage: mutants.py BUILD [--turn N|git | --all [--table FILE]]     BUILD: a build folder with the tests
--turn N runs the ten faults whose turn it is (`git`: by the number of the commit), --all all of them, and --table
writes a row for each to FILE; else it only sees that each fault's text is still in the kernels. A fault that its check
does not notice is an error; so is a noticed one that the list calls equivalent, or says to survive: it is tried with
the first test that the list has for its file.
"""
import csv
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
AT_ONCE = 10


def read_list():
    lines = (Path(__file__).parent / "mutants.txt").read_text().splitlines()
    return [[part.strip() for part in line.split(" | ")] for line in lines if line and not line.startswith("#")]


def plant(fault, folder):
    """Copies the kernels and changes one; an error if the old text is not there."""
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(ROOT / "kernels", folder)
    file, old, new, _ = fault
    text = (folder / file).read_text()
    if old not in text:
        sys.exit(f"mutants.txt: kernels/{file} has no '{old}'")
    (folder / file).write_text(text.replace(old, new, 1))


def is_noticed(check, folder, build):
    """True if the check fails with the kernels in `folder`. (With the right ones it passes, or another test fails.)"""
    environment = {**os.environ, "GNOMON_KERNELS_DIR": str(folder), "GNOMON_PREDICATE_TRIALS": "20000",
                   "GNOMON_CACHE_DIR": os.environ.get("GNOMON_CACHE_DIR", str(build / "test_kernel_cache"))}
    if check[0] == "proof":
        command = [ROOT / "tests/proofs/expressions.py", ROOT / f"tests/proofs/{check[1]}.v"]
    else:
        command = [build / "tests" / check[0], f"--gtest_filter={check[1]}"]
    made = subprocess.run(command, env=environment, capture_output=True, text=True)
    if made.returncode == 77:
        return True
    return made.returncode != 0


def run(faults, build):
    """The number of faults with the wrong verdict, and a row for each."""
    survivors, rows = 0, []
    with tempfile.TemporaryDirectory() as made:
        for fault in faults:
            plant(fault, Path(made) / "kernels")
            file, old, new, check = fault
            began = time.monotonic()
            may_live = check.startswith(("equivalent", "survives"))
            checks = [f[3] for f in read_list() if f[0] == file and f[3].split()[0].endswith("_test")][:1] \
                if may_live else [check]
            noticed = any(is_noticed(c.split(), Path(made) / "kernels", build) for c in checks)
            survivors += noticed == may_live
            verdict = "noticed" if noticed else check if may_live else "SURVIVES"
            seconds = time.monotonic() - began
            print(f"{file}: '{old}' -> '{new}': {verdict} ({', '.join(checks)}; {seconds:.0f} s)", flush=True)
            stage, noticed_by = file.split("/")[0], checks[0] if noticed else verdict
            rows.append([f"{old} -> {new}", file, stage, noticed_by, f"{seconds:.1f}"])
    return survivors, rows


def write_table(rows, file):
    with Path(file).open("w", newline="") as table:
        writer = csv.writer(table, lineterminator="\n")
        writer.writerow(["mutant", "file", "stage", "noticed_by", "seconds"])
        writer.writerows(rows)


def main():
    faults, build = read_list(), Path(sys.argv[1]).resolve()
    if "--all" in sys.argv:
        chosen = faults
    elif "--turn" in sys.argv:
        turn = sys.argv[sys.argv.index("--turn") + 1]
        if turn == "git":
            turn = subprocess.run(["git", "rev-list", "--count", "HEAD"], cwd=ROOT, capture_output=True, text=True,
                                  check=False).stdout or "0"
        first = int(turn) * AT_ONCE
        chosen = [faults[(first + i) % len(faults)] for i in range(AT_ONCE)]
    else:
        with tempfile.TemporaryDirectory() as made:
            for fault in faults:
                plant(fault, Path(made) / "kernels")
        chosen = []
    survivors, rows = run(chosen, build)
    if "--table" in sys.argv:
        write_table(rows, sys.argv[sys.argv.index("--table") + 1])
    sys.exit(1 if survivors else 0)


if __name__ == "__main__":
    main()
