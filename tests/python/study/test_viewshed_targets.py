# SPDX-License-Identifier: MIT
"""gnomon-study viewshed --targets: points that observers see past meshes alone, against the oracle."""

import csv

import numpy as np
import oracle
import pytest
from gnomon.studies.command import main

RNG = np.random.default_rng(4410)
#: Of few values, so that lines of sight meet edges and corners and run along planes.
TRIANGLES = RNG.integers(0, 9, (30, 3, 3)) / 2
EYES = RNG.integers(-4, 12, (5, 3)) / 2
TARGETS = RNG.integers(-4, 12, (40, 3)) / 2


def write_table(path, names, rows):
    path.write_text("\n".join([names, *(",".join(map(repr, row)) for row in np.asarray(rows, float).tolist())]) + "\n")
    return path


def write_obj(path, triangles):
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in triangles.reshape(-1, 3).tolist()]
    path.write_text("\n".join(lines + [f"f {3 * i + 1} {3 * i + 2} {3 * i + 3}" for i in range(len(triangles))]) + "\n")
    return path


@pytest.fixture
def files(tmp_path):
    return [str(path) for path in (write_obj(tmp_path / "town.obj", TRIANGLES),
                                   write_table(tmp_path / "eyes.csv", "x,y,z", EYES),
                                   write_table(tmp_path / "targets.csv", "x,y,z", TARGETS))]  # fmt: skip


def seen(path, names=("x", "y", "z")):
    """(N, M) of the file's rows, which must have the targets' places and counts."""
    with path.open() as file:
        rows = list(csv.DictReader(file))
    assert [[float(row[name]) for name in names] for row in rows] == TARGETS.tolist()
    found = np.zeros((len(rows), len(EYES)), bool)
    for i, row in enumerate(rows):
        found[i, [int(k) for k in row["observers"].split()]] = True
    assert [int(row["count"]) for row in rows] == found.sum(axis=1).tolist()
    return found


@pytest.mark.parametrize(("height", "target_height"), [(0, 0), (1.5, 0), (0, 2.25), (1.5, 2.25)])
def test_lines_of_sight_are_those_of_exact_arithmetic(files, tmp_path, height, target_height):
    mesh, eyes, targets = files
    out = tmp_path / "seen.csv"
    assert main(["viewshed", mesh, eyes, str(out), "--targets", targets, "--height", str(height), "--target-height",
                 str(target_height)]) == 0  # fmt: skip
    expected = [oracle.lit(TRIANGLES, TARGETS + [0, 0, target_height], position=eye + [0, 0, height]) for eye in EYES]
    assert (seen(out) == np.transpose(expected)).all()
    assert 0.2 < np.mean(expected) < 0.95


def test_a_single_observer_a_distance_and_y_up(files, tmp_path):
    """The same mesh, moved and with y up, gives the same answers; targets beyond the distance are not seen."""
    mesh, _, targets = files
    out, turned = tmp_path / "seen.csv", tmp_path / "turned.obj"
    x, y, z = np.moveaxis(TRIANGLES, 2, 0)
    write_obj(turned, np.stack([x - 8, z, -(y + 16)], axis=2))
    x, y, z = EYES[0]
    assert main(["viewshed", str(turned), f"{x},{y},{z}", str(out), "--targets", targets, "--height", "0",
                 "--mesh-up", "y", "--mesh-offset=8,-16,0", "--distance", "3", "--quiet"]) == 0  # fmt: skip
    is_near = np.hypot(*(TARGETS - EYES[0])[:, :2].T) <= 3
    expected = oracle.lit(TRIANGLES, TARGETS, position=EYES[0]) & is_near
    assert (seen(out)[:, 0] == expected).all()
    assert 0 < expected.sum() < is_near.sum()


def test_targets_with_normals_lie_on_their_side(tmp_path):
    """A window in the middle of a wall is seen from its outside alone."""
    wall = np.array([[[0, 0, 0], [0, 4, 0], [0, 4, 4]], [[0, 0, 0], [0, 4, 4], [0, 0, 4]]], float)
    mesh = write_obj(tmp_path / "wall.obj", wall)
    eyes = write_table(tmp_path / "eyes.csv", "x,y,z", [[5, 2, 2], [-5, 2, 2]])
    windows = write_table(tmp_path / "windows.csv", "x,y,z,nx,ny,nz", [[0, 2, 1, 1, 0, 0], [0, 2, 1, -1, 0, 0]])
    out = tmp_path / "seen.csv"
    assert main(["viewshed", str(mesh), str(eyes), str(out), "--targets", str(windows), "--quiet"]) == 0
    assert [line.split(",")[3:] for line in out.read_text().splitlines()[1:]] == [["1", "0"], ["1", "1"]]
    assert main(["viewshed", str(mesh), str(eyes), str(out), "--targets", str(windows), "--target-height", "1"]) == 1


@pytest.mark.parametrize(("change", "words"), [
    ({2: "seen.tif"}, "seen.tif: past meshes alone a table is written: give a file that ends in .csv"),
    ({1: "1,2"}, "observers: '1,2' is neither x,y,z, such as 12.5,3,1.7, nor a file"),
    ({4: "--bits"}, "--bits: is of rasters: leave it out with --targets"),
    ({4: "--refraction=0.13"}, "--refraction: is of rasters: leave it out with --targets"),
    ({3: None}, "is a mesh (.obj): give --targets too, a table of what is looked at"),
])  # fmt: skip
def test_what_fits_no_mesh_is_said(files, tmp_path, monkeypatch, capsys, change, words):
    monkeypatch.chdir(tmp_path)
    mesh, eyes, targets = files
    given = {0: mesh, 1: eyes, 2: "seen.csv", 3: f"--targets={targets}", 4: "--refraction=plane"} | change
    assert main(["viewshed", *(argument for argument in given.values() if argument is not None)]) == 1
    assert words in capsys.readouterr().err
    assert not list(tmp_path.glob("seen*"))
