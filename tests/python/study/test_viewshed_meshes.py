# SPDX-License-Identifier: MIT
"""gnomon-study viewshed --mesh: raster and meshes together against both oracles, all cells: no answer may differ."""

import json
import re
from fractions import Fraction

import numpy as np
import oracle
import pytest
import rasterio
import sight_oracle
from gnomon.studies import open_study
from gnomon.studies.command import main
from made import write_raster

STEP, CELL, WEST, NORTH = 2.0**-10, 8.0, 512_000.0, 5_002_400.0
ROWS, COLUMNS = 9, 11
RNG = np.random.default_rng(440)
STEPS = RNG.integers(0, 6000, (ROWS, COLUMNS))
#: Columns, rows (in whole 1/256), metres above the ground.
PLACES = [(3, 4, 2.0), (7.5, 2.25, 1.0), (9 + 1 / 256, 6 + 129 / 256, 4.5)]


def world(column, row):
    return WEST + CELL * (column + 0.5), NORTH - CELL * (row + 0.5)


def triangles():
    """Columns, rows, steps: of few values, so that lines of sight meet edges and corners and run along planes."""
    found = np.stack([RNG.integers(0, 2 * COLUMNS, (24, 3)) / 2, RNG.integers(0, 2 * ROWS, (24, 3)) / 2,
                      RNG.integers(0, 5, (24, 3)) * 1536], axis=2)  # fmt: skip
    upright = [[(5, 1, 0), (5, 7, 0), (5, 7, 9000)], [(3, 4, 0), (9, 4, 0), (9, 4, 20_000)]]  # the latter edge-on
    return np.concatenate([found, upright])


TRIANGLES = triangles()


def write_obj(path, corners):
    """corners: (F, 3, 3) of columns, rows and steps."""
    lines = []
    for column, row, step in corners.reshape(-1, 3).tolist():
        x, y = world(column, row)
        lines.append(f"v {x!r} {y!r} {step * STEP!r}")
    path.write_text("\n".join(lines + [f"f {3 * i + 1} {3 * i + 2} {3 * i + 3}" for i in range(len(corners))]) + "\n")
    return path


@pytest.fixture
def raster(tmp_path):
    return write_raster(tmp_path / "dem.tif", STEPS * STEP, CELL, WEST, NORTH)


@pytest.fixture
def guards(tmp_path):
    lines = ["x,y,height", *(",".join(map(repr, (*world(c, r), h))) for c, r, h in PLACES)]
    (tmp_path / "guards.csv").write_text("\n".join(lines) + "\n")
    return tmp_path / "guards.csv"


def run(*words):
    return main(["viewshed", *map(str, words)])


def expected(target_steps):
    """(observers, R, C) by both oracles; and how many cells the triangles alone hide."""
    rows, result, hidden = STEPS.tolist(), np.zeros((len(PLACES), ROWS, COLUMNS), bool), 0
    for i, (column, row, height) in enumerate(PLACES):
        corners = next(s for s in sight_oracle.simplices(rows)
                       if sight_oracle.clipped(s, (Fraction(column), Fraction(row)), (0, 0)))  # fmt: skip
        ground = sight_oracle.height_over(corners, [rows[y][x] for x, y in corners], (Fraction(column), Fraction(row)))
        eye = Fraction(column), Fraction(row), -(-ground // 1) + round(height / STEP)
        for (r, c), is_seen in sight_oracle.seen(rows, eye, target_steps).items():
            point = (c, r, rows[r][c] + target_steps)
            is_met = any(oracle.met(t, point, [float(v) for v in eye], True) for t in TRIANGLES.tolist())
            result[i, r, c] = is_seen and not is_met
            hidden += is_seen and is_met
    return result, hidden


@pytest.mark.parametrize("target", [0, 2])
def test_raster_and_meshes_equal_both_oracles(target, raster, guards, tmp_path, capsys):
    one, two = (write_obj(tmp_path / f"{i}.obj", part) for i, part in enumerate((TRIANGLES[:9], TRIANGLES[9:])))
    folder = tmp_path / "kept"
    words = [raster, guards, tmp_path / "counts.tif", "--refraction", "plane", "--target-height", target]
    assert run(*words, "--mesh", one, "--mesh", two, "--bits", "--folder", folder, "--tile", 4) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["mesh_triangles"] == len(TRIANGLES)
    assert record["meshes_moved_by_cells"] == record["meshes_moved_by"] == record["observers_moved_by_cells"] == 0
    truth, hidden = expected(round(target / STEP))
    bits = open_study(folder).dataset().seen.to_numpy()[0]
    found = np.stack([bits >> np.uint32(i) & 1 for i in range(len(PLACES))]).astype(bool)
    assert hidden > 20 and truth.sum() > 20 and (found == truth).all()
    with rasterio.open(tmp_path / "counts.tif") as file:
        assert (file.read(1) == truth.sum(axis=0)).all()
    assert main(["verify", str(folder), "--share", "1", "--lines", "60"]) == 0
    assert "60 lines of sight in rational arithmetic: 0 differ" in capsys.readouterr().out


def test_verify_finds_a_mesh_that_was_not_there(raster, guards, tmp_path, capsys, monkeypatch):
    """Answers without the wall are wrong lines where the plan has it."""
    from gnomon.studies.obstacles import Obstacles

    folder, wall = tmp_path / "kept", write_obj(tmp_path / "wall.obj", TRIANGLES[:20])
    with monkeypatch.context() as without:
        without.setattr(Obstacles, "past", lambda self, found, *_: found)
        assert run(raster, guards, tmp_path / "x.tif", "--mesh", wall, "--bits", "--folder", folder, "--quiet") == 0
    assert main(["verify", str(folder), "--share", "0", "--lines", "200", "--seed", "1"]) == 1
    assert re.search(r"200 lines of sight in rational arithmetic: [1-9]\d* differ", capsys.readouterr().out)


def test_the_mesh_sinks_as_the_ground_does(tmp_path):
    """Eye 2 m, target 30 m high, 16 km apart, a wall between them. The ground sinks by 17.2 m there and by 4.3 m at the
    wall, so that the line passes 11.7 m above the wall's foot; on a plane 16 m."""
    raster = write_raster(tmp_path / "flat.tif", np.zeros((5, 17)), 1000.0)
    eye, far = 512_500.0, 16
    for height, refraction, is_seen in ((10, 1 / 7, True), (13, 1 / 7, False), (13, "plane", True)):
        x, y = eye + 8000, (5_002_400 - 4500, 5_002_400 - 500)
        (tmp_path / "wall.obj").write_text(
            f"v {x} {y[0]} 0\nv {x} {y[1]} 0\nv {x} {y[1]} {height}\nv {x} {y[0]} {height}\nf 1 2 3\nf 1 3 4\n"
        )
        words = ["--target-height", 30, "--quiet", "--refraction", refraction, "--mesh", tmp_path / "wall.obj"]
        assert run(raster, f"{eye},{5_002_400 - 2500}", tmp_path / "seen.tif", *words) == 0
        with rasterio.open(tmp_path / "seen.tif") as file:
            assert (file.read(1)[2, far] == 255) == is_seen, (height, refraction)


def test_what_is_not_known_stays_undecided_past_a_mesh(tmp_path):
    """Behind a hole where something may stand a cell is undecided, and hidden where a wall is before it as well."""
    heights = np.zeros((5, 9))
    heights[:, 3] = np.nan
    raster = write_raster(tmp_path / "holes.tif", heights, CELL, WEST, NORTH)
    wall = write_obj(tmp_path / "wall.obj", np.array([[(6, 1.5, -9), (6, 9, -9), (6, 1.5, 9e6)],
                                                      [(6, 9, -9), (6, 9, 9e6), (6, 1.5, 9e6)]]))  # fmt: skip
    place = ",".join(map(repr, world(0, 2)))
    assert run(raster, place, tmp_path / "seen.tif", "--outside", 50, "--mesh", wall, "--quiet") == 0
    with rasterio.open(tmp_path / "seen.tif") as file:
        values = file.read(1)
    assert (values[:, :2] == 255).all() and (values[:, 3] == 128).all() and (values[:, 4:6] == 127).all()
    assert (values[2:, 7:] == 0).all() and (values[0, 7:] == 127).all()


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--mesh", "none.obj"], "none.obj"),
        (["--mesh", "{wall}", "--what", "heights"], "mesh: is not for heights"),
        (["--mesh", "{wall}", "--mesh-offset", "9e9,0,0"], "mesh: triangle 0 reaches .* too far from the raster"),
        (["--mesh", "{broken}"], "broken.obj"),
    ],
)
def test_wrong_meshes_are_named(words, text, raster, tmp_path, capsys):
    wall = write_obj(tmp_path / "wall.obj", TRIANGLES[:2])
    (tmp_path / "broken.obj").write_text("v 0 0\nf 1 2 3\n")
    place = ",".join(map(repr, world(3, 4)))
    given = [word.format(wall=wall, broken=tmp_path / "broken.obj") for word in words]
    assert run(raster, place, tmp_path / "x.tif", *given) == 1
    said = capsys.readouterr().err
    assert re.search(text, said) and len(said.splitlines()) == 1 and not (tmp_path / "x.tif").exists()


def test_a_mesh_that_changed_is_another_study(raster, guards, tmp_path, capsys):
    wall = write_obj(tmp_path / "wall.obj", TRIANGLES[:2])
    words = [raster, guards, tmp_path / "x.tif", "--mesh", wall, "--folder", tmp_path / "kept", "--quiet"]
    assert run(*words) == 0 and run(*words) == 0
    write_obj(wall, TRIANGLES[:3])
    assert run(*words) == 1 and "a raster or mesh has changed" in capsys.readouterr().err
