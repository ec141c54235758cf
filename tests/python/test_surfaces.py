# SPDX-License-Identifier: MIT
"""Lit shares of surfaces: closed forms, and random scenes against exact areas in rational numbers, at every depth."""

import os
from fractions import Fraction
from itertools import combinations, pairwise

import gnomon
import numpy as np
import pytest
from gnomon import surfaces

pytest.importorskip("mapbox_earcut")
LIMITS = [0, 1, 2, 3, 5, 8, 20, 1000]
#: CI's share of the 10^4 scenes that were run once (docs/shares.md).
SCENES = int(os.environ.get("GNOMON_TEST_SCENES", "1000"))


def rectangle(low, high, z):
    (x0, y0), (x1, y1) = low, high
    return np.array([(x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z)], float)


def two_triangles(quad):
    return np.array([quad[[0, 1, 2]], quad[[0, 2, 3]]])


def wall(x0, y0, x1, y1, low, high):
    """Its front is to the left of the way from the first end to the second, turned by a right angle clockwise."""
    return np.array([(x0, y0, low), (x1, y1, low), (x1, y1, high), (x0, y0, high)], float)


# ---- Exact areas -----------------------------------------------------------------------------------------------------


def dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def minus(a, b):
    return [x - y for x, y in zip(a, b, strict=True)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def above(triangle, height):
    """The part of a triangle whose height is positive, closed: a convex polygon, or nothing."""
    corners = []
    for a, b in zip(triangle, [*triangle[1:], triangle[0]], strict=True):
        h, k = height(a), height(b)
        if h >= 0:
            corners.append(a)
        if h * k < 0:
            corners.append([x + h / (h - k) * (y - x) for x, y in zip(a, b, strict=True)])
    return corners if any(height(c) > 0 for c in corners) else []


def span(polygon, x):
    """The lowest and the highest y of a convex polygon at x, or None."""
    ys = []
    for a, b in zip(polygon, [*polygon[1:], polygon[0]], strict=True):
        if a[0] == b[0]:
            ys += [a[1], b[1]] if a[0] == x else []
        elif min(a[0], b[0]) <= x <= max(a[0], b[0]):
            ys.append(a[1] + (x - a[0]) * (b[1] - a[1]) / (b[0] - a[0]))
    return (min(ys), max(ys)) if ys else None


def crossings(edges):
    for (a, b), (c, d) in combinations(edges, 2):
        r, s = minus(b, a), minus(d, c)
        turn = r[0] * s[1] - r[1] * s[0]
        if turn:
            t = ((c[0] - a[0]) * s[1] - (c[1] - a[1]) * s[0]) / turn
            if 0 <= t <= 1:
                yield a[0] + t * r[0]


def uncovered_share(polygon, covers):
    """Of the polygon's area: the exact integral of uncovered lengths, which are linear between crossings of edges."""
    shapes = [polygon, *covers]
    edges = [edge for shape in shapes for edge in zip(shape, [*shape[1:], shape[0]], strict=True)]
    left, right = min(c[0] for c in polygon), max(c[0] for c in polygon)
    ends = sorted({x for x in [*crossings(edges), *(c[0] for s in shapes for c in s)] if left <= x <= right})
    whole = free = Fraction(0)
    for x0, x1 in pairwise(ends):
        x = (x0 + x1) / 2
        low, high = span(polygon, x)
        whole += (x1 - x0) * (high - low)
        spans = sorted(s for s in (span(cover, x) for cover in covers) if s)
        at = low
        for bottom, top in spans:
            if bottom > at:
                free += (x1 - x0) * (min(bottom, high) - at) if at < high else 0
            at = max(at, min(top, high))
        free += (x1 - x0) * max(high - at, 0)
    return free / whole


def exact_share(triangles, faces, face, direction):
    """The lit share of a face of one triangle."""
    world = [[[Fraction(float(x)) for x in corner] for corner in triangle] for triangle in triangles]
    towards = [Fraction(float(x)) for x in -np.asarray(direction, np.float32)]
    own = world[list(faces).index(face)]
    normal = cross(minus(own[1], own[0]), minus(own[2], own[0]))
    if dot(normal, towards) <= 0:
        return Fraction(0)
    k = max(range(3), key=lambda c: abs(towards[c]))
    u, v = [c for c in range(3) if c != k]

    def projected(p):
        return [p[c] - p[k] * towards[c] / towards[k] for c in (u, v)]

    def height(p):
        return dot(normal, minus(p, own[0]))

    covers = [[projected(c) for c in above(t, height)] for t, f in zip(world, faces, strict=True) if f != face]
    return uncovered_share([projected(c) for c in own], [cover for cover in covers if cover])


def test_the_reference_knows_areas():
    square = [[Fraction(x), Fraction(y)] for x, y in ((0, 0), (4, 0), (4, 4), (0, 4))]
    left = [[Fraction(x), Fraction(y)] for x, y in ((-1, -1), (1, -1), (1, 9), (-1, 9))]
    corner = [[Fraction(x), Fraction(y)] for x, y in ((0, 0), (4, 0), (0, 4))]
    assert uncovered_share(square, []) == 1
    assert uncovered_share(square, [left]) == Fraction(3, 4)
    assert uncovered_share(square, [left, corner]) == Fraction(16 - 4 - Fraction(9, 2), 16)


@pytest.mark.parametrize("part", range(4))
def test_random_scenes_lie_inside_at_every_depth(part):
    rng = np.random.default_rng(part)
    widest, kinds = 0.0, set()
    for _ in range(SCENES // 4):
        size = int(rng.integers(2, 9))  # few values: shared edges and corners, coplanar and edge-on triangles
        triangles = rng.integers(-size, size + 1, (int(rng.integers(2, 6)), 3, 3)).astype(float)
        direction = rng.integers(-3, 4, 3).astype(float) if rng.random() < 0.7 else rng.normal(size=3)
        has_area = np.cross(triangles[0, 1] - triangles[0, 0], triangles[0, 2] - triangles[0, 0]).any()
        if not has_area or not direction.any():
            continue
        faces = np.r_[0, np.full(len(triangles) - 1, -1)]
        exact = exact_share(triangles, faces, 0, direction)
        kinds.add("dark" if exact == 0 else "lit" if exact == 1 else "partly")
        for limit in LIMITS:
            found = surfaces.lit_fractions(triangles, [direction], faces, within=1e-9, limit=limit, threads=1)
            low, high = float(found.low[0, 0]), float(found.high[0, 0])
            assert Fraction(low) <= exact <= Fraction(high), (triangles.tolist(), direction.tolist(), limit)
        widest = max(widest, high - low)
    assert kinds == {"dark", "lit", "partly"} and widest < 1e-6


@pytest.mark.parametrize("tiny", [6e-17, -6e-17, 1e-30, -1e-45])
def test_the_side_is_exact_for_any_direction(tiny):
    """An azimuth of 180 degrees leaves 1e-16 in x: the sun stands along the plane of all but that, or not at all."""
    upright = np.array([[(0, 0, 0), (0, 4, 0), (0, 0, 4)]], float)  # looks to +x
    steep = np.array([[(0, 0, 0), (3, 4, 0), (0, 0, 4)], [(-1, 0, 2), (0, 4, 2), (0, 0, 2)]], float)
    for triangles in (upright, steep):
        direction = (-tiny, -0.75, -1)
        faces = np.r_[0, np.full(len(triangles) - 1, -1)]
        exact = exact_share(triangles, faces, 0, direction)
        found = surfaces.lit_fractions(triangles, [direction], faces, within=1e-9)
        low, high = float(found.low[0, 0]), float(found.high[0, 0])
        assert low <= exact <= high and (high - low < 1e-6 or triangles is upright and exact > 0)


def test_points_agree():
    """gnomon's points on a face: their lit share is in the interval, up to what chance and points on edges allow."""
    rng = np.random.default_rng(8)
    triangles = rng.normal(size=(12, 3, 3)).astype(np.float32).astype(float)
    for direction in rng.normal(size=(6, 3)):
        found = surfaces.lit_fractions(triangles, [direction], within=1e-6)
        for face in range(12):
            a, b = np.sqrt(rng.random(4000)), rng.random(4000)
            weights = np.stack([1 - a, a * (1 - b), a * b], 1)
            points = weights @ triangles[face]
            lit = gnomon.Scene(triangles).lit(points, direction=direction, receivers=np.full(4000, face),
                                              side=gnomon.Side.front())  # fmt: skip
            assert found.low[face, 0] - 0.04 < lit.mean() < found.high[face, 0] + 0.04


# ---- Closed forms ----------------------------------------------------------------------------------------------------


def at_all_depths(shapes, direction, expected):
    """The share of face 0 lies inside at every depth, and is reached."""
    for limit in LIMITS:
        for within in (0.5, 0.1, 1e-9):
            found = surfaces.lit_fractions(shapes, [direction], within=within, limit=limit)
            assert found.low[0, 0] <= expected * (1 + 1e-15) and expected * (1 - 1e-15) <= found.high[0, 0], limit
    assert found.high[0, 0] - found.low[0, 0] < 1e-8
    return found


@pytest.mark.parametrize("slope", [0.0625, 0.25, 0.5, 1, 1.5, 4])
def test_two_parallel_rows(slope):
    """Rows that look south, 2.5 wide, 3 : 4 steep and 3 apart, under a sun in the south as steep as `slope`: the ray
    over the front row's upper edge (2, 1.5) meets the other one at a share s of its width. pvlib says the same."""
    shading = pytest.importorskip("pvlib.shading")
    shape = [(0, 0), (0, 0), (2, 1.5), (2, 1.5)]
    behind, front = (np.array([(x, y + at, z) for x, (y, z) in zip((-far, far, far, -far), shape, strict=True)])
                     for at, far in ((3, 32), (0, 64)))  # fmt: skip
    s = min(max((1.5 - slope) / (1.5 + 2 * slope), 0), 1)
    at_all_depths(surfaces.polygons([[behind], [front]]), (0, 1, -slope), 1 - s)
    theirs = shading.shaded_fraction1d(
        90 - np.degrees(np.arctan(slope)), 180, 90, np.degrees(np.arctan(0.75)), collector_width=2.5, pitch=3
    )
    assert np.isclose(theirs, s, rtol=0, atol=1e-12)


def test_a_canyon():
    """Its floor, 8 wide between walls 6 high, under a sun of 3 : 4 across: the shadow is 8 * 6 / 8 wide."""
    floor = rectangle((0, -64), (8, 64), 0)
    east = wall(8, -1024, 8, 1024, 0, 6)
    west = wall(0, -1024, 0, 1024, 0, 6)
    shapes = surfaces.polygons([[floor], [east], [west]])
    at_all_depths(shapes, (-0.5, 0, -1), 5 / 8)  # a shadow of 3
    at_all_depths(shapes, (-1, 0.25, -1), 1 / 4)  # of 6, also with the sun along the street
    at_all_depths(shapes, (1, 0, -0.5), 0)
    found = at_all_depths(shapes, (0, 0, -1), 1)
    assert (found.low[1:] == 0).all() and (found.high[1:] == 0).all()  # walls that the sun sees edge-on


def test_an_overhang():
    """A wall 3 high under a roof that sticks out by 1 and as far to both sides as needed."""
    facade = wall(-2, 0, 2, 0, 0, 3)
    roof = rectangle((-64, -1), (64, 0), 3)
    shapes = surfaces.polygons([[facade], [roof]])
    at_all_depths(shapes, (0, 1, -1), 2 / 3)
    at_all_depths(shapes, (0.5, 1, -2), 1 / 3)
    at_all_depths(shapes, (0, 1, -4), 0)
    at_all_depths(shapes, (0, -1, -1), 0)  # from behind


def test_overlapping_plates():
    """Two plates of 4 over a square of 16 that have 1 in common: 7 of 16 are dark, wherever the sun."""
    ground = rectangle((0, 0), (4, 4), 0)
    plates = [two_triangles(rectangle((0.5, 0.5), (2.5, 2.5), 1)), two_triangles(rectangle((1.5, 1.5), (3.5, 3.5), 1))]
    shapes = surfaces.polygons([[ground]], np.concatenate(plates))
    for direction in ((0, 0, -1), (0.25, 0.125, -1), (-0.5, 0.5, -1)):
        at_all_depths(shapes, direction, 9 / 16)
    above_one_another = [plates[0], plates[1] + [0, 0, 1]]
    shapes = surfaces.polygons([[ground]], np.concatenate(above_one_another))
    at_all_depths(shapes, (0, 0, -1), 9 / 16)


def test_an_edge_that_two_occluders_share_covers():
    """A roof of 8 triangles that meet in its middle leaves no slit: wholly dark, at a width of rounding alone."""
    rim = [(-1, -1), (0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0)]
    fan = [[(*a, 2), (*b, 2), (0.125, 0.0625, 2)] for a, b in zip(rim, rim[1:] + rim[:1], strict=True)]
    shapes = surfaces.polygons([[rectangle((-1, -1), (1, 1), 0)]], fan)
    found = at_all_depths(shapes, (0, 0, -1), 0)
    assert found.low[0, 0] == 0 and found.high[0, 0] < 1e-9


def test_what_lies_in_the_same_plane_shadows_nothing():
    shapes = surfaces.polygons([[rectangle((0, 0), (4, 4), 0)]], two_triangles(rectangle((1, 1), (3, 9), 0)))
    at_all_depths(shapes, (0.5, 0.25, -1), 1)


def test_a_window_in_a_wall_is_a_hole():
    front = wall(0, 0, 4, 0, 0, 4)
    window = wall(1, 0, 3, 0, 1, 3)[::-1]
    shapes = surfaces.polygons([[rectangle((0, 0), (4, 4), 0)], [front, window]])
    assert shapes.not_planar.size == 0
    at_all_depths(shapes, (0, 1, -1), 1 / 4)


def test_the_centroid_of_what_is_lit():
    shapes = surfaces.polygons([[rectangle((0, 0), (4, 2), 0)]], two_triangles(rectangle((-4, -4), (1, 4), 1)))
    found = surfaces.lit_fractions(shapes, [(0, 0, -1), (1, 0, -1), (0, 0, 1)], within=1e-6, centroids=True)
    assert np.allclose(found.centroid[0, :2], [(2.5, 1, 0), (3, 1, 0)], rtol=0, atol=1e-9)
    assert np.isnan(found.centroid[0, 2]).all() and np.allclose(found.low[0], [0.75, 0.5, 0])


def test_intervals_are_as_narrow_as_asked_for_or_say_it():
    rng = np.random.default_rng(5)
    triangles = rng.normal(size=(300, 3, 3))
    suns = rng.normal(size=(5, 3))
    for within in (0.3, 0.01):
        found = surfaces.lit_fractions(triangles, suns, within=within)
        assert ((found.high - found.low) < within + 1e-6).all()
    few = surfaces.lit_fractions(triangles, suns, within=0.01, limit=3)
    assert (few.high - few.low).max() > 0.1
    assert (few.low <= found.high).all() and (found.low <= few.high).all()
    one = surfaces.lit_fractions(triangles, suns, within=0.01, threads=1)
    assert (one.low == found.low).all() and (one.high == found.high).all()


# ---- Files and errors ------------------------------------------------------------------------------------------------


def test_tables(tmp_path):
    pandas = pytest.importorskip("pandas")
    shapes = surfaces.polygons([[rectangle((0, 0), (4, 2), 0)], [rectangle((-1, -1), (5, 3), 9)]])
    found = surfaces.lit_fractions(shapes, [(0, 0, -1), (0, 0, 1)])
    times = pandas.to_datetime(["2026-01-01 12:00", "2026-07-01 00:15"])
    found.write_table(tmp_path / "a.csv", ["floor", "roof"], times)
    rounding = repr(float(found.high[0, 0]))
    assert found.high[0, 0] < 1e-9
    assert (tmp_path / "a.csv").read_text() == (
        "time,floor low,floor high,roof low,roof high\n"
        f"2026-01-01 12:00:00,0,{rounding},1,1\n2026-07-01 00:15:00,0,0,0,0\n"
    )
    found.write_energyplus(tmp_path / "b.csv", ["FLOOR", "ROOF"], times)
    assert (tmp_path / "b.csv").read_text() == (
        "Surface Name,FLOOR,ROOF,\n 01/01 12:00,0.00000000,1.00000000,\n 07/01 00:15,0.00000000,0.00000000,\n"
    )
    assert np.allclose(found.shaded(), [[1, 1], [0, 1]], rtol=0, atol=1e-9)
    with pytest.raises(ValueError, match="1 names and 2 times for 2 faces and 2 suns"):
        found.write_table(tmp_path / "c.csv", ["floor"], times)
    with pytest.raises(ValueError, match="'a,b' is empty, or has a comma"):
        found.write_energyplus(tmp_path / "c.csv", ["a,b", "c"], times)


def test_what_is_not_flat_is_named():
    bent = rectangle((0, 0), (4, 4), 0)
    bent[2, 2] = 1e-3
    assert surfaces.polygons([[rectangle((0, 0), (4, 4), 0)], [bent]]).not_planar.tolist() == [1]


@pytest.mark.parametrize(
    "call, says",
    [
        (lambda: surfaces.polygons([[[(0, 0, 0), (1, 0, 0)]]]), "row 0 has a ring with fewer than three corners"),
        (lambda: surfaces.polygons([[[(0, 0, 0), (1, 0, 0), (2, 0, 0)]]]), "row 0 has no area"),
        (lambda: surfaces.lit_fractions(np.zeros((1, 3, 3)), [(0, 0, 1)]), "face 0 has no triangle with an area"),
        (lambda: surfaces.lit_fractions(np.eye(3)[None], [(0, 0, 0)]), "directions: row 0"),
        (lambda: surfaces.lit_fractions(np.eye(3)[None], [(0, 0)]), r"directions: shape \(1, 2\) is not \(M, 3\)"),
        (lambda: surfaces.lit_fractions(np.eye(3)[None], [(0, 0, 1)], [0.5]), "faces: must be 1 whole numbers"),
        (lambda: surfaces.lit_fractions(np.eye(3)[None], [(0, 0, 1)], [1]), "face 0 has no triangle"),
        (lambda: surfaces.lit_fractions(np.eye(3)[None], [(0, 0, 1)], within=0), "within: 0 is not above 0"),
        (lambda: surfaces.lit_fractions(np.eye(3)[None], [(0, 0, 1)], lattice=0.3), "lattice: the step 0.3"),
    ],
)
def test_what_is_wrong_is_named(call, says):
    with pytest.raises(ValueError, match=says):
        call()


PLATES = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 1], [1, 0, 1], [0, 1, 1]]], float)
RING = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]
LAST_IS = "must be a list of rings, each of numbers"
#: What lit_fractions() and polygons() refuse, and what is said.
WRONG = {
    "columns of other names": (dict(directions=("lon", "lat", "z")), "directions: of the columns"),
    "a direction of no data": (
        dict(directions=[[0, 0, -1], [0, -9999, -1]]),
        "directions: row 1 .* stands for no data",
    ),
    "a masked direction": (dict(directions=np.ma.masked_equal([[0, 5, -1]], 5)), "directions: row 0"),
    "words": (dict(directions=[["0", "0", "-1"]]), "directions: must be real numbers"),
    "masked faces": (dict(faces=np.ma.masked_equal([0, 1], 1)), "faces: row 1 is masked"),
    "faces below -1": (dict(faces=[-5, 0]), "faces: row 0 is -5: they count from 0 on"),
    "faces beyond all": (dict(faces=[0, 2**40]), "faces: face 1 has no triangle, and one is called 1099511627776"),
    "within": (dict(within="1%"), "within: must be a finite number, not '1%'"),
    "limit": (dict(limit=None), "limit: must be a finite number, at least 0, not None"),
    "threads": (dict(threads="2"), "threads: must be a finite number"),
    "a ring that is no list of rings": (dict(rings=[RING]), f"polygons: row 0 {LAST_IS}"),
    "two coordinates": (dict(rings=[[[[0, 0], [1, 0], [1, 1]]]]), f"polygons: row 0 {LAST_IS}"),
    "a polygon of shapely": (dict(rings=[object()]), f"polygons: row 0 {LAST_IS}"),
    "a corner of no data": (dict(rings=[[[[0, 0, 0], [1, 0, -9999], [1, 1, 0]]]]), "polygons: row 0: row 1 .* no data"),
    "a masked corner": (
        dict(rings=[[np.ma.masked_equal([[0, 0, 0], [1, 0, 7], [1, 1, 0]], 7)]]),
        "row 0 has a ring .* fin",
    ),
    "masked occluders": (dict(rings=[[RING]], occluders=np.ma.masked_equal(PLATES, 1)), "occluders: vertices: row 1"),
    "occluders of no data": (
        dict(rings=[[RING]], occluders=np.where(PLATES == 1, -9999, PLATES)),
        "occluders: .*no data",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_no_surface_or_sun_is_named(name):
    arguments, text = WRONG[name]
    if name == "columns of other names":
        pandas = pytest.importorskip("pandas")
        arguments = dict(directions=pandas.DataFrame([[0, 0, -1]], columns=["lon", "lat", "z"]))
    with pytest.raises((ValueError, TypeError), match=text):
        if "rings" in arguments:
            surfaces.polygons(**arguments)
        else:
            surfaces.lit_fractions(**(dict(triangles=PLATES, directions=[[0, 0, -1]]) | arguments))


def test_suns_of_a_table_and_meshes_of_other_packages():
    """z stands first; by their places the light would travel along x."""
    pandas, trimesh = pytest.importorskip("pandas"), pytest.importorskip("trimesh")
    suns = pandas.DataFrame([[-1.0, 0, 0]], columns=["z", "y", "x"])
    assert surfaces.lit_fractions(PLATES, suns).low.tolist() == [[0], [1]]
    corners = PLATES.reshape(-1, 3)
    mesh = trimesh.Trimesh(corners, np.arange(6).reshape(2, 3), process=False)
    assert surfaces.lit_fractions(mesh, suns).low.tolist() == [[0], [1]]
    roofed = surfaces.polygons([[RING]], occluders=trimesh.creation.box((9, 9, 1)).apply_translation([0, 0, 5]))
    assert surfaces.lit_fractions(roofed, suns).low.tolist() == [[0]]
