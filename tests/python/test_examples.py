# SPDX-License-Identifier: MIT
"""The programs of tests/consumer that the documents show. Each checks its own answer."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAMS = Path(__file__).parents[1] / "consumer"
NEEDS = {"lit_points": [], "on_device": ["pyopencl"], "sun_study": ["rasterio", "pvlib", "zarr", "dask", "matplotlib"]}


def run(name, folder, **environment):
    for needed in NEEDS[name]:
        pytest.importorskip(needed)
    return subprocess.run(
        [sys.executable, PROGRAMS / f"{name}.py"], cwd=folder, capture_output=True, text=True, timeout=600,
        env={**os.environ, **environment},
    )  # fmt: skip


def test_every_program_is_run():
    assert {path.stem for path in PROGRAMS.glob("*.py")} == set(NEEDS)


@pytest.mark.parametrize("name", NEEDS)
def test_it_finds_its_answer_right(name, tmp_path):
    done = run(name, tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout


def test_no_array_is_copied_to_the_host_or_from_it(tmp_path):
    done = run("on_device", tmp_path, GNOMON_TRACE="1")
    copied = [int(size) for size in re.findall(r"gnomon: trace: (?:reading|writing) +(\d+)", done.stdout + done.stderr)]
    assert 0 < sum(copied) < 256 * 256  # a quarter of the answers; points take twelve times as much
