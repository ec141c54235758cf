# SPDX-License-Identifier: MIT
"""Kinds of things that people hand in: the tests whose parameters are the members that were tried, at least ten each;
and where each of the inputs that once gave trouble is tried. A row that no test backs is an error."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]

#: Files of tests/python, and of them functions, whose cases are counted.
KINDS = {
    "processes": ["test_processes.py::test_a_child_answers_or_refuses_at_once", "test_processes.py::test_pools",
                  "test_processes.py::test_a_child_uses_what_it_inherited", "test_processes.py::test_scenes_travel",
                  "test_processes.py::test_the_interpreter_ends"],
    "one loader": ["test_gltf.py::test_made_files", "study/test_inputs.py::test_gltf",
                   "study/test_inputs.py::test_mesh_files", "study/test_inputs.py::test_cityjson"],
    "units and grids": ["study/test_inputs.py::test_units_of_heights",
                        "study/test_inputs.py::test_directions_on_the_map",
                        "study/test_inputs.py::test_grids_that_are_refused", "study/test_inputs.py::test_grids"],
    "absent values": ["test_absent.py::test_points", "test_absent.py::test_vertices",
                      "test_absent.py::test_numbers_that_mean_no_data", "study/test_absent_heights.py::test_declared",
                      "study/test_absent_heights.py::test_undeclared_is_one_sentence_and_its_remedy_helps"],
    "tables": ["study/test_sun_tables.py::test_tables_as_people_have_them",
               "study/test_sun_tables.py::test_tables_that_are_refused"],
    "precision": ["test_earth_size.py::test_it_is_exact_there", "test_precision.py"],
    "nothing grows": ["test_nothing_grows.py::test_nothing_grows"],
    "objects": ["test_objects.py::test_taken", "test_objects.py::test_not_taken_says_what_to_call",
                "test_objects.py::test_files_of_gltf", "test_objects.py::test_other_files_of_gltf",
                "study/test_file_names.py::test_names",
                "study/test_file_names.py::test_what_is_no_name_says_how_to_write_it"],
    "environment": ["test_environment.py::test_it_runs_without_a_cache", "test_environment.py"],
}  # fmt: skip

#: What gave trouble: a file of tests, and what stands in it.
INPUTS = {
    "a child of a process that used OpenCL": ("python/test_processes.py", "def test_a_child_answers_or_refuses"),
    "thirteen kinds of glTF in a study": ("python/study/test_inputs.py", "def test_gltf"),
    "heights in feet": ("python/study/test_inputs.py", "def test_units_of_heights"),
    "tables in any order": ("python/study/test_sun_tables.py", "def test_tables_as_people_have_them"),
    "a small decimal mesh": ("python/test_precision.py", "def test_a_small_decimal_mesh_over_wide_ground"),
    "undeclared nodata": ("python/study/test_absent_heights.py", "def test_undeclared_is_one_sentence"),
    "a polar night": ("python/study/test_sun_tables.py", "def test_a_polar_night_has_no_hours"),
    "a cache that cannot be written": ("python/test_environment.py", "def test_it_runs_without_a_cache"),
    "a place with a blank": ("command/command_test.cpp", '"78.2, 15.6"'),
    "a plate that the view does not show": ("rivals/shadow_map/moments_test.cpp", "ABlockerBeforeTheRange"),
}


@pytest.fixture(scope="module")
def counts():
    files = sorted({row.split("::")[0] for rows in KINDS.values() for row in rows})
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--collect-only", *files]
    said = subprocess.run(command, cwd=TESTS / "python", capture_output=True, text=True, timeout=120).stdout
    found: dict[str, int] = {}
    for file, function in re.findall(r"^(?:tests/python/)?([\w/]+\.py)::(\w+)", said, re.MULTILINE):
        for row in (file, f"{file}::{function}"):
            found[row] = found.get(row, 0) + 1
    return found


def test_each_kind_has_ten_members(counts):
    few = {kind: [(row, counts.get(row, 0)) for row in rows] for kind, rows in KINDS.items()
           if not all(row in counts for row in rows) or max(counts[row] for row in rows) < 10}  # fmt: skip
    if any(count == 0 for rows in few.values() for _, count in rows):
        pytest.importorskip("rasterio")
        pytest.importorskip("DracoPy")
    assert few == {}


@pytest.mark.parametrize("member", INPUTS)
def test_each_input_is_tried(member):
    file, text = INPUTS[member]
    assert text in (TESTS / file).read_text()
