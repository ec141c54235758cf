#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compares the processor time of six frames with that of the last release, by turns in one run, and fails where one
takes more than 8 % more. The release is built beside this tree, from ccache where it knows the files.

    speed_guard.py BENCH               BENCH: build/tools/bench of this tree
    speed_guard.py BENCH --base REV    another commit than the one in tools/speed_guard.txt

A change that is meant to cost time says so in tools/speed_guard.txt: the frame's name, the factor that is allowed on
top, and why; a release removes these lines. A shallow clone fetches the release's commit, whose whole name it needs;
where it gets none, it says that nothing was tested."""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LIMIT = 1.08

SPONZA, EMPIRE = f"{ROOT}/scenes/sponza.glb", f"{ROOT}/scenes/lost_empire.glb"
FRAMES = {
    "sponza animated": [SPONZA, "--mode", "animated"],
    "sponza static": [SPONZA, "--mode", "static"],
    "lost_empire animated": [EMPIRE, "--mode", "animated"],
    "lost_empire moving": [EMPIRE, "--mode", "moving"],
    "sponza 8 samples": [SPONZA, "--mode", "animated", "--samples", "8"],
    "sponza suns:40": [SPONZA, "--many-lights", "suns:40", "--points", "50000"],
}


def stated() -> tuple[str, dict[str, float]]:
    """The release's commit, and the factors that are allowed."""
    base, allowed = "", {}
    for line in (ROOT / "tools/speed_guard.txt").read_text().splitlines():
        words = [word.strip() for word in line.split("|")]
        if words[0] == "release":
            base = words[1]
        elif line and not line.startswith("#"):
            name, factor, reason = words
            if name not in FRAMES or not reason:
                sys.exit(f"tools/speed_guard.txt: {line!r} is not 'frame | factor | reason' of {', '.join(FRAMES)}")
            allowed[name] = float(factor)
    return base, allowed


def is_known(base: str) -> bool:
    """The clone has this commit."""
    command = ["git", "cat-file", "-e", f"{base}^{{commit}}"]
    return subprocess.run(command, cwd=ROOT, stderr=subprocess.DEVNULL, check=False).returncode == 0


def built(base: str, bench: Path) -> Path:
    """The benchmark of that commit, built as this tree's was."""
    commit = subprocess.check_output(["git", "rev-parse", f"{base}^{{commit}}"], cwd=ROOT, text=True).strip()
    folder = ROOT / "build" / "speed" / commit
    source = folder / "source"
    if not source.exists():
        begun = folder / "begun"
        begun.mkdir(parents=True, exist_ok=True)
        archive = subprocess.Popen(["git", "archive", commit], cwd=ROOT, stdout=subprocess.PIPE)
        subprocess.run(["tar", "-x", "-C", begun], stdin=archive.stdout, check=True)
        begun.rename(source)
    # A folder that lies in the source as CI's does, and its options: then ccache knows the files that did not change.
    build = source / "build"
    options = ["CMAKE_BUILD_TYPE=Release", "GNOMON_TOOLS=ON", "GNOMON_COMMAND=ON", "CMAKE_POSITION_INDEPENDENT_CODE=ON"]
    options += ["GNOMON_WERROR=ON"] if "GNOMON_WERROR:BOOL=ON" in (bench.parents[1] / "CMakeCache.txt").read_text() else []
    options += ["CMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
    environment = os.environ | {"CCACHE_BASEDIR": str(source), "CCACHE_NOHASHDIR": "1"}
    for command in (
        ["cmake", "-G", "Ninja", "-S", source, "-B", build, *(f"-D{option}" for option in options)],
        ["cmake", "--build", build, "--target", "bench"],
    ):
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=environment)
    return build / "tools/bench"


def processor_ms(bench: Path, frame: str) -> tuple[float, list[str]]:
    """The least processor time of a frame's parts, together, and the hashes of its results."""
    size = [] if "--many-lights" in FRAMES[frame] else ["--size", "960x540"]
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "rows.json"
        subprocess.run([bench, *FRAMES[frame], *size, "--json", file], check=True, stdout=subprocess.DEVNULL)
        rows = json.loads(file.read_text())["rows"]
    return sum(min(part["processor_ms"]) for row in rows for part in row["runs"].values()), [
        row["mask_hash"] for row in rows
    ]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bench", type=Path)
    parser.add_argument("--base")
    parser.add_argument("--rounds", type=int, default=3)
    asked = parser.parse_args()
    release, allowed = stated()
    base = asked.base or release
    if not is_known(base):  # a shallow clone: this commit alone, if its origin gives it
        subprocess.run(["git", "fetch", "--quiet", "--depth=1", "origin", base], cwd=ROOT, check=False)
    if not is_known(base):
        print(f"NOT TESTED: this clone has no commit {base} to compare with: git fetch --unshallow")
        return 0
    benches = {"release": built(base, asked.bench.resolve()), "now": asked.bench.resolve()}
    failed = False
    for frame in FRAMES:
        # The least of several: other processes only ever add. Where both seem to differ, there are more turns.
        least = dict.fromkeys(benches, float("inf"))
        limit = LIMIT * allowed.get(frame, 1.0)
        for turn in range(3 * asked.rounds):
            hashes = {}
            for which, bench in benches.items():
                spent, hashes[which] = processor_ms(bench, frame)
                least[which] = min(spent, least[which])
            ratio = least["now"] / least["release"]
            if turn + 1 >= asked.rounds and ratio <= limit:
                break
        failed |= ratio > limit
        verdict = "ok" if ratio <= limit else f"more than {limit:.2f} of the release's"
        same = "the same results" if hashes["now"] == hashes["release"] else "other results"
        print(f"{frame:22} {least['now']:8.1f} ms of processor, {ratio:.3f} of the release's, {same}: {verdict}")
    if failed:
        print(f"slower than {base}: mend it, or state it in tools/speed_guard.txt")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
