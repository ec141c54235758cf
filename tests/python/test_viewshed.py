# SPDX-License-Identifier: MIT
"""Viewsheds against rational arithmetic (sight_oracle.py), all cells: no answer may differ."""

import copy
import math
import pickle
import warnings
from fractions import Fraction

import gnomon
import numpy as np
import pytest
import sight_oracle

STEP = 2.0**-10


def rasters():
    """Small rasters of whole steps: rough, gentle, of few levels (many ties), with holes, with a wall."""
    rng = np.random.default_rng(44)
    r, c = np.mgrid[0:9, 0:10]
    rough = rng.integers(-9000, 9000, (9, 10))
    gentle = np.round(4000 * np.sin(r / 3) * np.cos(c / 4)).astype(int)
    levels = rng.integers(0, 3, (9, 10)) * 1024
    holes = np.where(rng.random((9, 10)) < 0.25, np.nan, levels + rng.integers(-1, 2, (9, 10)))
    holes[5, 5:7] = holes[4:7, 6] = 1024  # where observers stand
    plane = 512 * r - 256 * c  # lines of sight along the ground
    wall = np.where(c == 7, 3_000_000, gentle)
    return {"rough": rough, "gentle": gentle, "levels": levels, "holes": holes, "plane": plane, "wall": wall}


RASTERS = rasters()
#: Columns, rows, steps above the ground (rounded up): at cells (once at a level, so that lines touch the ground), on
#: edges, inside squares, at the border.
PLACES = [
    (6, 5, 1), (6, 5, 1024), (0, 0, 1500), (9, 8, 700), (Fraction(25, 4), 5, 900), (Fraction(11, 2), Fraction(9, 2), 1),
    (Fraction(1405, 256), Fraction(1409, 256), 5000), (9, Fraction(7, 3), 300),
]  # fmt: skip


def as_rows(steps):
    return [[None if math.isnan(v) else int(v) for v in row] for row in np.asarray(steps, float)]


def ground_below(rows, column, row):
    """The height of the ground at a place, rounded up; None where there is none."""
    for corners in sight_oracle.simplices(rows):
        part = sight_oracle.clipped(corners, (column, row), (0, 0))
        if part is not None:
            return math.ceil(sight_oracle.height_over(corners, [rows[y][x] for x, y in corners], (column, row)))
    return None


def eye_of(rows, place):
    column, row = (Fraction(math.floor(Fraction(v) * 256 + Fraction(1, 2)), 256) for v in place[:2])
    ground = ground_below(rows, column, row)
    return None if ground is None else (column, row, ground + place[2])


def asked(steps, **arguments):
    """A raster of cells of 1, in metres, on a plane."""
    return gnomon.ViewshedGrid(np.asarray(steps, float) * STEP, cell=1, refraction=None, lattice=STEP, **arguments)


def at(place, rows):
    return [float(place[0]), rows - 1 - float(place[1])]


@pytest.mark.parametrize("dtype", [np.float32, np.float64, np.int16])
@pytest.mark.parametrize("shape", [(37, 53), (300, 421)])
def test_heights_are_rounded_once_to_the_nearest_step(dtype, shape):
    """In double, each operation by itself: by NumPy. Halves go up."""
    heights = np.random.default_rng(2).uniform(-900, 2000, shape).astype(dtype)
    heights[3, 4:9] += dtype(1) if dtype == np.int16 else np.array([0.5, 1.5, 2.5, -0.5, -1.5]) * STEP
    if dtype != np.int16:
        heights[::7, ::5] = np.nan
    x, y = 7e5 + 30.0 * np.arange(shape[1]), 5e6 - 20.0 * np.arange(shape[0])
    for refraction in (None, 1 / 7):
        ground = gnomon.ViewshedGrid(heights, x=x, y=y, refraction=refraction, lattice=STEP).ground
        bent = heights.astype(np.float64) - ground.base
        if refraction is not None:
            d2 = (x[None, :] - (x[0] + x[-1]) / 2) ** 2 + (y[:, None] - (y[0] + y[-1]) / 2) ** 2
            bent = bent - (1 - refraction) / (2 * gnomon.EARTH_RADIUS) * d2
        steps = np.floor(np.ldexp(bent, 10) + 0.5)
        there = np.isfinite(bent)
        assert (ground.is_absent == ~there).all() and (ground.steps[there] == steps[there]).all()
        assert (ground.steps[~there] == np.iinfo(np.int32).min).all()
        assert ground.largest_move == np.abs(np.ldexp(steps, -10) - bent)[there].max()


@pytest.mark.parametrize("target", [0, 700])
@pytest.mark.parametrize("name", RASTERS)
def test_every_cell_is_the_exact_answer(name, target):
    steps = RASTERS[name]
    rows, grid = as_rows(steps), asked(RASTERS[name])
    tried = 0
    for place in PLACES:
        eye = eye_of(rows, place)
        if eye is None:
            with pytest.raises(ValueError, match="observers: row 0 .* no data"):
                grid.viewshed([at(place, len(rows))])
            continue
        found = grid.viewshed([at(place, len(rows))], height=place[2] * STEP, target_height=target * STEP)
        expected = sight_oracle.seen(rows, eye, target)
        wrong = {cell for cell, is_seen in expected.items() if is_seen != (found.counts[cell] == 1)}
        assert not wrong, f"observer {place}: {sorted(wrong)}"
        assert (found.is_absent == np.isnan(np.asarray(steps, float))).all() and not found.counts[found.is_absent].any()
        tried += 1
    assert tried >= 4


@pytest.mark.parametrize("name", RASTERS)
def test_the_sweep_changes_no_answer(name):
    """The sweep is for large rasters, and these have 150 x 220 cells; without it each line is followed."""
    rng = np.random.default_rng(7)
    steps = np.tile(np.asarray(RASTERS[name], float), (20, 25))[:150, :220] + 40 * np.hypot(*np.mgrid[0:150, 0:220])
    steps = np.round(steps + rng.integers(0, 2000, steps.shape))
    grid = asked(steps)
    ground = grid._ground
    places = np.stack([rng.uniform(0, 219, 8), rng.uniform(0, 149, 8)], axis=1)
    places[:4] = np.round(places[:4])
    shares = []
    for i, place in enumerate(places):
        try:
            eyes, _ = ground.eyes(place[None], [1.0, 40.0][i % 2], [0, 3.0][i % 3 == 0])
        except ValueError:
            continue
        spans = ground.spans(place[None], None, (0, 150))
        swept, followed = (grid._device.call(grid._native.look, eyes, (0, 150), spans, s) for s in (True, False))
        assert (swept == followed).all(), f"{(swept != followed).sum()} cells of observer {place}"
        shares.append((followed == 1).mean())
    assert len(shares) >= 4 and 0.001 < np.mean(shares) < 0.999


def test_as_lamps_over_the_same_triangles():
    """Scene.lit() with a lamp at the eye decides the same where the raster has no holes: another program."""
    rng = np.random.default_rng(3)
    hills = 3000 * np.sin(np.arange(40) / 5)[:, None] * np.cos(np.arange(50) / 7)
    steps = np.round(hills + rng.integers(0, 900, (40, 50)))
    x, y = np.arange(50.0), np.arange(39.0, -1, -1)
    vertices = np.stack([*np.meshgrid(x, y), steps * STEP], axis=-1)
    nw = (np.arange(39)[:, None] * 50 + np.arange(49)).reshape(-1)
    faces = np.concatenate([np.stack([nw + 50, nw + 51, nw + 1], 1), np.stack([nw + 50, nw + 1, nw], 1)])
    scene = gnomon.Scene(vertices.reshape(-1, 3), faces, lattice=STEP)
    for place in ([20, 20], [3, 35], [49, 0]):
        found = asked(steps).viewshed([place], height=1.5)
        row = 39 - place[1]
        lamp = [*place, steps[row, place[0]] * STEP + 1.5]
        lit = scene.lit(vertices, position=lamp, side=gnomon.Side.vertices(up=(0, 0, 1))).values
        lit[row, place[0]] = True
        assert (lit == (found.counts == 1)).all()


def test_the_least_height_is_the_first_that_is_seen():
    rows = as_rows(RASTERS["holes"])
    grid = asked(RASTERS["holes"])
    place = (6, 5, 1500)
    eye = eye_of(rows, place)
    least = grid.least_heights(at(place, len(rows)), height=1500 * STEP)
    assert (np.isnan(least) == np.isnan(RASTERS["holes"])).all()
    raised = 0
    for cell in zip(*np.nonzero(np.isfinite(least)), strict=True):
        steps = round(float(least[cell]) / STEP)
        assert sight_oracle.seen(rows, eye, steps, {cell})[cell]
        if steps:
            assert not sight_oracle.seen(rows, eye, steps - 1, {cell})[cell]
            raised += 1
    assert raised > 10


def test_what_stands_where_there_is_no_data_is_undecided():
    """outside=: an answer is certain if it holds with anything up to that height there, undecided if not."""
    steps = np.asarray(RASTERS["holes"], float)
    grid, place = asked(steps), at((6, 5), 9)
    empty = grid.viewshed([place], height=2)
    assert not empty.undecided.any()
    for outside in (-5.0, 1.0, 1e9):
        found = grid.viewshed([place], height=2, outside=outside, bits=True)
        full = np.clip(np.nan_to_num(steps, nan=outside / STEP), None, 2**24)
        certain = asked(full).viewshed([place], height=2).counts * ~np.isnan(steps)
        assert (found.counts == certain).all() and (found.counts + found.undecided == empty.counts).all()
        assert (found.bits[0] == found.counts).all() and (found.undecided_bits[0] == found.undecided).all()
        assert found.undecided.any() == (outside > -5)


def test_many_observers_are_one_after_the_other():
    steps = np.round(RASTERS["gentle"])
    grid = asked(steps)
    rng = np.random.default_rng(5)
    places = np.stack([rng.uniform(0, 9, 40), rng.uniform(0, 8, 40)], axis=1)
    heights, distances = rng.uniform(0.5, 4, 40), rng.uniform(1, 14, 40)
    progress = []
    many = grid.viewshed(places, height=heights, distance=distances, bits=True, progress=progress.append)
    each = [grid.viewshed(p, height=h, distance=d).counts for p, h, d in zip(places, heights, distances, strict=True)]
    assert (many.counts == np.sum(each, axis=0)).all() and (many.seen() == np.array(each)).all()
    assert many.bits.shape == (2, 9, 10) and many.observer_count == 40 and progress[-1] == 1 and len(progress) == 40
    with pytest.raises(gnomon.Cancelled):
        grid.viewshed(places, progress=lambda done: done < 0.5)


def test_the_distance_is_a_circle_on_the_map():
    flat = gnomon.ViewshedGrid(np.zeros((41, 31)), cell=(3, 2), refraction=None)
    place = np.array([45.0, 40.0])
    found = flat.viewshed(place, distance=20).counts
    x, y = np.meshgrid(3.0 * np.arange(31), 2.0 * np.arange(40, -1, -1))
    assert (found == ((x - place[0]) ** 2 + (y - place[1]) ** 2 <= 400)).all() and 0 < found.sum() < found.size
    assert not flat.viewshed(place + 0.5, distance=0.25).counts.any(), "no cell's centre is so near"


def test_curvature_is_one_bending_for_all_observers():
    """From 2 m above a sea without waves the horizon is sqrt(2 R' h) away, whoever looks, wherever the centre lies."""
    for refraction in (0.0, 1 / 7):
        far = math.sqrt(2 * gnomon.EARTH_RADIUS / (1 - refraction) * 2.0)
        sea = gnomon.ViewshedGrid(np.zeros((2, 161)), cell=100, refraction=refraction, lattice=2**-14)
        assert sea.record["refraction"] == refraction
        for column in (0, 30, 160):
            seen = sea.viewshed([100.0 * column, 100.0]).counts[0] == 1
            away = 100.0 * np.abs(np.arange(161) - column)
            assert seen[away < far - 100].all() and not seen[away > far + 100].any() and not seen.all()


def test_rasters_in_any_order():
    steps = RASTERS["rough"] * STEP
    x, y = 7e5 + 30.0 * np.arange(10), 5e6 - 30.0 * np.arange(9)
    place = [x[4] + 3, y[6] - 2]
    found = gnomon.viewshed(steps, place, x=x, y=y).counts
    assert 5 < found.sum() < 80
    assert (gnomon.viewshed(steps[::-1], place, x=x, y=y[::-1]).counts == found[::-1]).all()
    assert (gnomon.viewshed(steps[:, ::-1], place, x=x[::-1], y=y).counts == found[:, ::-1]).all()
    masked = np.ma.MaskedArray(steps, steps > 8)
    assert (gnomon.viewshed(masked, place, x=x, y=y).is_absent == (steps > 8)).all()
    filled = np.where(steps > 8, -99.0, steps)
    assert (gnomon.viewshed(filled, place, x=x, y=y, nodata=-99).is_absent == (steps > 8)).all()


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"heights": np.zeros(5)}, "heights: shape"),
        ({"heights": np.full((4, 4), np.nan)}, "heights: there is none"),
        ({"heights": np.full((4, 4), 3.4028234663852886e38)}, "stands for no data"),
        ({"observers": [9, 9]}, r"observers: row 0 \[9.0, 9.0\] does not stand on the raster"),
        ({"observers": [[1, 1], [np.nan, 1]]}, "observers: row 1"),
        ({"observers": [1, 2, 3]}, "observers: shape"),
        ({"observers": np.zeros((0, 2))}, "observers: there is none"),
        ({"heights": np.eye(4) * -9999}, "row 0, column 0 is -9999, .*: say nodata=-9999.0"),
        ({"heights": np.full((4, 4), -32768, np.int16)}, "row 0, column 0 is -32768"),
        ({"heights": np.full((4, 4), 65535, np.uint16)}, "row 0, column 0 is 65535"),
        ({"height": 0}, "height: must be at least a step of heights, 0.000976562, and below 32768"),
        ({"heights": np.eye(4) * 1e12}, "height: must be at least a step of heights"),
        ({"distance": [-5]}, "distance: must be at least 0, not -5"),
        ({"height": [1, 2]}, "height: must be a number, or one for each"),
        ({"target_height": -1}, "target_height: must be at least 0"),
        ({"cell": None}, "x= and y="),
        ({"cell": 0}, "cell: must be above 0"),
        ({"lattice": 0.3}, "lattice: the step 0.3 is not a power of two"),
        ({"lattice": 2.0**-30, "heights": np.eye(4) * 1000}, "take larger ones"),
        ({"refraction": 1}, "refraction below 1"),
        ({"cell": None, "x": [0, 1, 2, 9], "y": [0, 1, 2, 3]}, "x: the cells' centres are not equally spaced"),
    ],
)
def test_wrong_arguments_are_named(arguments, text):
    given = {"heights": np.zeros((4, 4)), "observers": [1, 1], "cell": 1} | arguments
    with pytest.raises(ValueError, match=text):
        gnomon.viewshed(given.pop("heights"), given.pop("observers"), **given)


ARC_SECONDS = np.array([1, 1 / 3, 3, 30, 60]) / 3600


@pytest.mark.parametrize("seconds", ARC_SECONDS)
def test_degrees_are_refused(seconds):
    """Hills of 1 in 5 over cells in degrees, by their size and by their places."""
    rows, columns = np.mgrid[:40, :50]
    hills = 20 * 30.9 * 3600 * seconds * (np.sin(columns / 3) + np.cos(rows / 4))
    x, y = 10.5 + seconds * np.arange(50), 47.25 - seconds * np.arange(40)
    for place in ({"cell": seconds}, {"cell": (seconds, 0.7 * seconds)}, {"x": x, "y": y}):
        at = [x[5], y[5]] if "x" in place else [0, 0]
        with pytest.raises(ValueError, match="heights: the cells, .* look like degrees: warp .*are_metres=True"):
            gnomon.viewshed(hills, at, **place)
        with pytest.raises(ValueError, match="look like degrees"):
            gnomon.ViewshedGrid(hills, **place)
    small = gnomon.viewshed(hills * 1e-6, [0, 0], cell=seconds, height=1.0, are_metres=True, refraction=None)
    assert small.counts.sum() > 0


def test_steep_ground_is_no_degrees():
    heights = np.random.default_rng(7).uniform(0, 100, (30, 30))
    assert gnomon.viewshed(heights, [3, 3], cell=1).counts.sum() > 0


def test_infinite_heights_are_no_data():
    heights = np.zeros((4, 5))
    heights[1, 2:4] = np.inf, -np.inf
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert (gnomon.viewshed(heights, [0, 0], cell=1).is_absent == ~np.isfinite(heights)).all()


def test_a_grid_stays_in_its_process_and_looks_from_one_place():
    grid = gnomon.ViewshedGrid(np.zeros((4, 4)), cell=1)
    for leave in (copy.copy, copy.deepcopy, pickle.dumps):
        with pytest.raises(TypeError, match="ViewshedGrid lies on its device"):
            leave(grid)
    with pytest.raises(ValueError, match=r"observer: shape \(2, 2\) is not \(2,\)"):
        grid.least_heights([[0, 0], [1, 1]])


def test_a_mesh_is_seen_as_lamps_shine():
    """Scene.visible_from(): a wall of 3 m between an observer and a row of points; bits, counts, distance."""
    wall = np.array([[[5, -9, 0], [5, 9, 0], [5, 9, 3]], [[5, -9, 0], [5, 9, 3], [5, -9, 3]]], float)
    scene = gnomon.Scene(wall)
    points = np.stack([np.arange(11.0), np.zeros(11), np.zeros(11)], axis=1)
    observers = np.array([[0, 0, 0], [10, 0, 0], [10, 0, 2.5]])
    found = scene.visible_from(observers, points, height=2)
    # The line from 4.5 m at x = 10 to the ground at x = 0 passes the wall at 2.25 m.
    expected = np.stack([points[:, 0] <= 5, points[:, 0] >= 5, points[:, 0] >= 5], axis=1)
    assert (found.seen() == expected).all() and (found.counts == expected.sum(axis=1)).all()
    assert found.bits.shape == (11, 1) and found.observer_count == 3
    near = scene.visible_from(observers, points, height=2, distance=3)
    assert (near.seen() == expected & (np.abs(points[:, :1] - observers[:, 0]) <= 3)).all()
    above = scene.visible_from(observers[2:], points, height=2, target_height=3)
    assert above.seen()[:, 0].tolist() == [True] * 11
    with pytest.raises(ValueError, match="observers: there is none"):
        scene.visible_from(np.empty((0, 3)), points)
    with pytest.raises(ValueError, match="side: is for points on surfaces"):
        scene.visible_from(observers, points, target_height=1, side=gnomon.Side.vertices())


def test_a_scene_of_a_raster_is_its_viewshed():
    rng = np.random.default_rng(9)
    steps = rng.integers(0, 3000, (12, 14))
    x, y = np.meshgrid(np.arange(14.0), np.arange(11.0, -1, -1))
    vertices = np.stack([x, y, steps * STEP], axis=-1)
    nw = (np.arange(11)[:, None] * 14 + np.arange(13)).reshape(-1)
    faces = np.concatenate([np.stack([nw + 14, nw + 15, nw + 1], 1), np.stack([nw + 14, nw + 1, nw], 1)])
    scene = gnomon.Scene(vertices.reshape(-1, 3), faces, lattice=STEP)
    places = np.array([[3, 4], [9, 9], [13, 0]])
    feet = vertices[11 - places[:, 1], places[:, 0]]
    for target in (0, 1.25):
        side = gnomon.Side.vertices(up=(0, 0, 1)) if target == 0 else None
        found = scene.visible_from(feet, vertices, height=1.5, target_height=target, distance=9, side=side).seen()
        expected = asked(steps).viewshed(places, height=1.5, target_height=target, distance=9, bits=True).seen()
        found[11 - places[:, 1], places[:, 0], np.arange(3)] = True  # under their own eyes
        assert (np.moveaxis(found, -1, 0) == expected).all()
    assert scene.visible_from(feet, height=1.5).counts.shape == (len(faces), 3)


SPIKE = np.zeros((9, 9))
SPIKE[4, 4] = 5


def test_observers_of_tables_go_by_their_names():
    """In any order; by their places x and y would be exchanged."""
    pandas = pytest.importorskip("pandas")
    right = gnomon.viewshed(SPIKE, (0, 3), cell=1).counts
    table = pandas.DataFrame({"id": [7], "Y": [3.0], "X": [0.0]})
    records = np.array([(3.0, 0.0)], [("y", "f8"), ("x", "f8")])
    for observers in (table, records, {"y": 3, "x": 0}, pandas.Series({"y": 3, "x": 0})):
        assert (gnomon.viewshed(SPIKE, observers, cell=1).counts == right).all()
    for columns in (["lon", "lat"], ["x", "X"], ["x"], ["geometry"]):
        with pytest.raises(ValueError, match="observers: of the columns .* two must be x, y, each once"):
            gnomon.viewshed(SPIKE, pandas.DataFrame(np.zeros((1, len(columns))), columns=columns), cell=1)
    for name in ("z", "Height"):
        table = pandas.DataFrame({"x": [0.0], "y": [3.0], name: [20.0]})
        with pytest.raises(ValueError, match=f"the column '{name}' is not read: give observers=it.*, and height=it"):
            gnomon.viewshed(SPIKE, table, cell=1)
        found = gnomon.viewshed(SPIKE, table[["x", "y"]], height=table[name], cell=1)
        assert (found.counts == gnomon.viewshed(SPIKE, (0, 3), height=20, cell=1).counts).all()


def test_a_data_array_says_where_it_lies():
    """Its rows run northwards: by their places the observer would stand in the south."""
    xarray = pytest.importorskip("xarray")
    dem = xarray.DataArray(SPIKE, dims=("y", "x"), coords={"y": np.arange(9.0), "x": np.arange(9.0)})
    with pytest.raises(
        ValueError, match="heights: has coordinates of its own: give x=dem.x, y=dem.y in place of cell="
    ):
        gnomon.viewshed(dem, (0, 3), cell=1)
    right = gnomon.viewshed(SPIKE[::-1], (0, 3), cell=1).counts[::-1]
    assert (gnomon.viewshed(dem, (0, 3), x=dem.x, y=dem.y).counts == right).all()
    with pytest.raises(ValueError, match="heights: attrs..units.. is 'ft', which is not metres"):
        gnomon.viewshed(dem.assign_attrs(units="ft"), (0, 3), x=dem.x, y=dem.y)


#: Arguments that are no numbers, or not in metres; and what is said.
WRONG = {
    "height": ("tall", "height: must be a number, or one for each of the 1 observers, not 'tall'"),
    "distance": ("far", "distance: must be a number, or one for each"),
    "outside": (float("nan"), "outside: must be a finite number, not nan"),
    "refraction": ("on", "refraction: must be a finite number, not 'on'"),
    "radius": (6371, "radius: is in metres, and 6371 is the Earth's in km: give 6371000"),
    "nodata": ("-9999", "nodata: must be a finite number, not '-9999'"),
    "lattice": ("fine", "lattice: the step 'fine' is not a power of two"),
    "device": (0, "device: must be a gnomon.Device or a name, as of gnomon.devices.., not 0"),
    "x": (np.arange(9).astype("M8[D]"), "x: must be 9 finite numbers"),
}


@pytest.mark.parametrize("name", WRONG)
def test_arguments_that_are_no_numbers_are_named(name):
    value, text = WRONG[name]
    place = dict(x=value, y=np.arange(9)) if name == "x" else {"cell": 1, name: value}
    with pytest.raises((ValueError, TypeError), match=f"^{text}"):
        gnomon.viewshed(SPIKE, (0, 3), **place)


def test_what_observers_see_takes_a_height_and_a_distance_for_each():
    roof = gnomon.Scene([[[-9, -9, 2], [9, -9, 2], [0, 9, 2]]])
    observers, points = [[0, 0, 1.0], [0, 0, 1.0], [3, 0, 1.0]], [[0.5, 0, 0], [3, 0, 0]]
    seen = roof.visible_from(observers, points, height=[0, 5, 0], distance=[1, 9, np.inf]).seen()
    assert seen.tolist() == [[True, False, True], [False, False, True]]
    for wrong in (dict(height="2"), dict(height=[1, 2]), dict(distance=-5), dict(distance=np.nan), dict(height=np.nan),
                  dict(target_height=[1, 2, 3]), dict(distance="far")):  # fmt: skip
        (name,) = wrong
        with pytest.raises(ValueError, match=f"^{name}: must "):
            roof.visible_from(observers, points, **wrong)
