# SPDX-License-Identifier: MIT
"""Points at the vertices of a mesh: facing by the triangles around them, against rational arithmetic."""

import hashlib

import gnomon
import numpy as np
import oracle
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from meshes import box, grid

STEP = 2.0**-10
FAR = np.array([4_500_000.0, 6_000_000.0, 0.0])
UP = (0, 0, 1)


def raster(heights, cell=1.0):
    """The triangles of a height field of cells; those with a NaN corner are left out. And its vertices."""
    rows, columns = heights.shape
    x, y = np.meshgrid(cell * np.arange(rows), cell * np.arange(columns), indexing="ij")
    vertices = np.stack([x, y, heights], axis=-1).reshape(-1, 3)
    a = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).reshape(-1)
    faces = np.concatenate([np.stack([a, a + columns, a + columns + 1], 1), np.stack([a, a + columns + 1, a + 1], 1)])
    triangles = vertices[faces]
    used = np.isfinite(triangles).all(axis=(1, 2))
    return triangles[used], vertices[np.unique(faces[used])]


def slope(rise):
    return np.tile(rise * np.arange(6.0), (5, 1)).T  # rises with x


PIT = np.array([[3, 3, 3, 3, 3], [3, 1, 1, 1, 3], [3, 1, 0, 1, 3], [3, 1, 1, 1, 3], [3, 3, 3, 3, 3]], float)
RIDGE = np.array([[0, 1, 2, 1, 0]] * 5, float)
WITH_NODATA = np.where(np.arange(30).reshape(6, 5) % 7 == 4, np.nan, slope(0.5))
SUNS = [(0, 0, -1), (1, 0, -0.5), (-1, 0, -0.5), (2, 0, 1), (-2, 0, -1), (0, 1, -1), (0, -1, -1), (1, 1, -1),
        (-1, 2, -0.5), (1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, 0, 1), (-2, 1, 0.25), (3, -1, -0.125)]  # fmt: skip


@pytest.mark.parametrize("heights", [slope(0.5), slope(-0.5), PIT, -PIT, RIDGE, -RIDGE, RIDGE.T, WITH_NODATA, 0 * PIT])
def test_height_fields_equal_the_oracle(heights):
    triangles, vertices = raster(heights)
    scene = gnomon.Scene(triangles)
    for sun in SUNS:
        expected, extended = oracle.lit_at_vertices(triangles, vertices, sun)
        found = scene.lit(vertices, direction=sun, side=gnomon.Side.vertices(UP))
        assert found.values.tolist() == expected.tolist(), sun
        assert found.extended == extended
    if np.isnan(heights).any():
        assert found.open.size > 20


def test_a_slope_at_the_last_column_and_beside_nodata():
    """A slope that falls away from the sun is dark up to its border and up to its holes; without the fans it is lit."""
    heights = slope(1.0)
    heights[2, 2] = np.nan
    triangles, vertices = raster(heights)
    scene = gnomon.Scene(triangles)
    from_behind = (-1, 0, -0.5)  # the sun stands at x = +infinity, lower than the slope
    assert scene.lit(vertices, direction=from_behind).all(), "no triangle blocks what lies on its plane"
    behind = scene.lit(vertices, direction=from_behind, side=gnomon.Side.vertices(UP))
    assert not behind.values.any() and behind.extended > 0
    assert scene.lit(vertices, direction=(1, 0, -0.5), side=gnomon.Side.vertices(UP)).values.all()
    in_its_plane = (-1, 0, -1)
    assert not scene.lit(vertices, direction=in_its_plane, side=gnomon.Side.vertices(UP)).values.any()
    assert scene.lit(vertices, direction=(-1, 0, -1.0000001), side=gnomon.Side.vertices(UP)).values.all()


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.integers(-3, 3), min_size=25, max_size=25),
    st.tuples(st.integers(-3, 3), st.integers(-3, 3), st.integers(-4, 2)).filter(any),
)
def test_random_height_fields_equal_the_oracle(heights, sun):
    triangles, vertices = raster(np.array(heights, float).reshape(5, 5))
    scene = gnomon.Scene(triangles)
    expected, _ = oracle.lit_at_vertices(triangles, vertices, sun)
    found = scene.lit(vertices, direction=sun, side=gnomon.Side.vertices(UP))
    assert found.values.tolist() == expected.tolist()
    # Where the triangles close around a vertex, their winding says the same as the direction up.
    inside = np.delete(np.arange(25), found.open)
    assert inside.size == 9
    by_winding = scene.lit(vertices, direction=sun, side=gnomon.Side.vertices()).values
    assert by_winding[inside].tolist() == expected[inside].tolist()
    turned = gnomon.Scene(triangles[:, ::-1])
    assert turned.lit(vertices, direction=sun, side=gnomon.Side.vertices(UP)).values.tolist() == expected.tolist()


def test_solids():
    """The corners of two boxes that share no vertex: lit where the sun is on the outside."""
    triangles = np.concatenate([box(0, 0, 4, 4, 4), box(10, 0, 4, 4, 8)])
    corners = np.unique(triangles.reshape(-1, 3), axis=0)
    scene = gnomon.Scene(triangles)
    low, opened, _, extended = scene.lit(corners, direction=(1, 2, -3), side=gnomon.Side.vertices())
    # From the faces that look at the sun (x = 0, y = 0, z = top), less those corners whose other faces hide it.
    assert opened.size == 0 and extended == 0
    for corner, is_lit in zip(corners, low, strict=True):
        x, y, z = corner - (0 if corner[0] < 9 else 10, 0, 0)
        faces = [n for at, n in [(x == 0, (-1, 0, 0)), (x == 4, (1, 0, 0)), (y == 0, (0, -1, 0)), (y == 4, (0, 1, 0)),
                                 (z == 0, (0, 0, -1)), (z in (4, 8), (0, 0, 1))] if at]  # fmt: skip
        assert is_lit == any(np.dot(n, (-1, -2, 3)) > 0 for n in faces), corner  # convex: before any face
    inside_out = gnomon.Scene(triangles[:, ::-1])
    assert not inside_out.lit(corners[:1], direction=(-1, -1, -1), side=gnomon.Side.vertices()).values[0]


def roofs():
    """A roof z = .37 x of two triangles, and a neighbour whose vertex (3.3, 0, 1.221) lies on the roof's long edge."""

    def at(x, y):
        return [x, y, 0.37 * x]

    return np.array([
        [at(0, 0), at(10, 0), at(10, 5)], [at(0, 0), at(10, 5), at(0, 5)],
        [at(0, 0), at(0, -5), at(3.3, 0)], [at(3.3, 0), at(0, -5), at(10, -5)], [at(3.3, 0), at(10, -5), at(10, 0)],
    ])  # fmt: skip


def test_a_vertex_on_its_neighbours_edge_is_found_and_lifted():
    triangles = roofs()
    scene = gnomon.Scene(triangles, lattice=STEP)
    x, y, z = np.array(scene.lattice.snap(np.array([[3.3, 0, 1.221]]), "p")[0] + scene.lattice.origin) / STEP
    corners = scene.triangles[0].astype(float) + scene.lattice.origin
    n = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    below = n @ (np.array([x, y, z]) - corners[0] / STEP) / np.linalg.norm(n)
    assert -0.3 < below < -0.25, "the vertex snaps under the plane of the triangle that lacks it"
    touched = scene.lattice.touched
    assert {(int(t), int(c)) for t, c in np.argwhere(touched >= 0)} == {(2, 2), (3, 0), (4, 0)}
    assert set(touched[touched >= 0]) == {0}
    vertices = np.unique(triangles.reshape(-1, 3), axis=0)
    for sun in [(0, 0, -1), (1, -0.2, 0.05), (-1, -3, -1), (0.5, 2, -0.1), (0.5, -2, -0.1)]:
        above = np.dot((-0.37, 0, 1), sun) < 0
        for up in (None, UP):
            found = scene.lit(vertices, direction=sun, side=gnomon.Side.vertices(up))
            assert (found.values == above).all(), (sun, up)
            assert vertices[found.touching].tolist() == [[3.3, 0, 0.37 * 3.3]]
        turned = gnomon.Scene(triangles[:, ::-1], lattice=STEP)
        assert (turned.lit(vertices, direction=sun, side=gnomon.Side.vertices(UP)).values == above).all()
    # Without the lift the neighbour's triangle shadows it.
    at = vertices[found.touching]
    assert not scene.lit(at, direction=(0.5, -2, -0.1))[0]
    assert not gnomon.Scene(roofs()[:2], lattice=STEP).lattice.touched.max() >= 0


def test_the_sliver_of_a_roof():
    """It becomes vertical on steps of 2^-10. Facing on it, by whatever side, is that of the triangle before."""
    sliver = np.array([[0, 0, 0], [10, 0, 3], [5.001, 0.0004, 1.5003]])
    ground = np.array([[[-5, -5, -9], [20, -5, -9], [20, 20, -9]]], float)
    flat = np.array([[0, 0, 0], [0.0006, 0, 0], [0, 0.0004, 0]]) + [2, -3, 5]  # becomes a segment
    over = np.array([[0, 0, 0], [10, 0.6, 0], [5, 0.4, 0]]) * STEP + [2, -4, 5]
    scene = gnomon.Scene(np.concatenate([[sliver], ground, [flat], [over]]), lattice=STEP)
    lattice = scene.lattice
    assert [*lattice.zero_area] == [2] and 3 in lattice.turned_over
    assert {*lattice.turned_over, *lattice.tilted} == {0, 3} and "3 triangles changed" in repr(scene)
    for triangle, id in [(sliver, 0), (flat, 2), (over, 3)]:
        on = triangle.mean(axis=0, keepdims=True)
        is_up = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])[2] > 0
        assert is_up
        for sun, expected in [((0, 0, -1), True), ((0, 0, 1), False)]:
            front, eye = gnomon.Side.front(), gnomon.Side.eye((3, 3, 90))
            for more in ({"side": front}, {"side": front, "lift": True}, {"side": eye}):
                assert scene.lit(on, direction=sun, receivers=[id], **more)[0] == expected, (id, sun, more)
        from_below = gnomon.Side.eye((3, 3, -90))
        assert not scene.lit(on, direction=(0, 0, -1), receivers=[id], side=from_below)[0]


def test_a_wall_that_stands_on_terrain():
    """The wall's foot lies inside of a triangle of the ground. It is found, lifted, and dark from behind the wall."""
    ground = np.array([[[-50, -40, 0.1], [60, -40, 0.1], [0, 70, 0.1]]])
    wall = np.array([[[0, 0, 0.1], [10, 0, 0.1], [10, 0, 4.1]], [[0, 0, 0.1], [10, 0, 4.1], [0, 0, 4.1]]])  # front: -y
    scene = gnomon.Scene(np.concatenate([ground, wall]), lattice=STEP)
    feet = wall[0, :2]
    found = scene.lit(feet, direction=(0.2, 1, -1), side=gnomon.Side.vertices())
    assert found.values.all() and found.touching.tolist() == [0, 1]
    assert not scene.lit(feet, direction=(0.2, -1, -1), side=gnomon.Side.vertices()).values.any()
    assert not scene.lit(feet, direction=(0.2, 1, 1), side=gnomon.Side.vertices()).values.any()
    in_the_grounds_plane = (0.2, 1, 0)
    assert not scene.lit(feet, direction=in_the_grounds_plane, side=gnomon.Side.vertices()).values.any()


def test_touching_is_found_in_near_linear_time():
    import time

    def seconds(n):
        vertices, faces = grid(n, (0.5, 0.5), lambda x, y: np.sin(x) + np.cos(y))
        lattice = gnomon.Scene((vertices + FAR)[faces], lattice=STEP).lattice
        start = time.perf_counter()
        assert lattice.touched.max() < 0
        return time.perf_counter() - start

    small, large = seconds(90), seconds(360)  # 16,200 and 259,200 triangles
    assert large < 60 * small, (small, large)  # 16 times as many


def scene_of_a_city():
    rng = np.random.default_rng(17)
    heights = rng.integers(0, 40, (41, 41)) / 8
    heights[::4] += STEP / 2  # exactly between two steps
    terrain, vertices = raster(heights, 5.0)
    houses = []
    for i in range(6):
        for j in range(6):
            house = box(30.0 * i + 5, 30.0 * j + 5, 10 + (i + j) % 2 * 0.3, 12, 6 + rng.integers(4, 30))
            houses.append(house)  # the walls of half of them stand on lines of vertices
    return np.concatenate([terrain, *houses]), vertices


SUNS_OF_CITY = [(0.6, 0.35, -0.5), (1.0, 1.0, -1.0), (0.0, 1.0, -0.5), (1.0, 0.0, -0.5)]


def digest(*answers):
    return hashlib.sha256(b"".join(np.packbits(a).tobytes() for a in answers)).hexdigest()


@pytest.fixture(scope="module")
def city():
    triangles, vertices = scene_of_a_city()
    triangles, vertices = (np.floor(v / STEP + 0.5) * STEP for v in (triangles, vertices))
    answers = [
        gnomon.Scene(triangles, lattice=STEP).lit(vertices, direction=s, side=gnomon.Side.vertices(UP)).values
        for s in SUNS_OF_CITY
    ]
    assert all(100 < a.sum() < len(a) - 100 for a in answers)
    return triangles, vertices, answers


def test_the_oracle_decides_the_city(city):
    triangles, vertices, answers = city
    scene = gnomon.Scene(triangles, lattice=STEP)
    kept = scene.lit(vertices, direction=SUNS_OF_CITY[0], side=gnomon.Side.vertices(UP))
    touching = {*kept.touching.tolist()}
    assert len(touching) > 20 and (kept.values == answers[0]).all()
    terrain = triangles[: 2 * 40 * 40]
    rows = [i for i in range(0, len(vertices), 211) if i not in touching]
    origin = scene.lattice.origin
    for sun, answer in zip(SUNS_OF_CITY, answers, strict=True):
        near = [np.abs(terrain - vertices[i]).max(axis=2).min(axis=1) == 0 for i in rows]
        facing = [
            oracle.above_height_field(terrain[n], vertices[i], -np.float32(sun))[0]
            for n, i in zip(near, rows, strict=True)
        ]
        free = oracle.lit(scene.triangles.astype(float) + origin, vertices[rows], direction=sun)
        assert (free & facing).tolist() == answer[rows].tolist()


@pytest.mark.parametrize("steps", [(1, 3, -5), (12345677, -7654321, 1023)])
def test_one_hash_when_moved_by_odd_numbers_of_steps(city, steps):
    triangles, vertices, answers = city
    move = FAR + np.array(steps) * STEP
    scene = gnomon.Scene(triangles + move, lattice=STEP)
    moved = [scene.lit(vertices + move, direction=s, side=gnomon.Side.vertices(UP)).values for s in SUNS_OF_CITY]
    assert digest(*moved) == digest(*answers)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_one_hash_in_any_order(city, seed):
    triangles, vertices, answers = city
    order = np.random.default_rng(seed).permutation(len(triangles))
    scene = gnomon.Scene(triangles[order], lattice=STEP)
    found = [scene.lit(vertices, direction=s, side=gnomon.Side.vertices(UP)).values for s in SUNS_OF_CITY]
    assert digest(*found) == digest(*answers)


@pytest.mark.parametrize("size", [200.0, 90.0, 55.0])
def test_one_hash_in_tiles(city, size):
    """Tiles with origins of their own, each with what lies within 90 m, so that shadows and triangles are whole."""
    triangles, vertices, answers = city
    found = [np.zeros(len(vertices), bool) for _ in answers]
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    origins = set()
    for x in np.arange(0, 201, size):
        for y in np.arange(0, 201, size):
            inside = ((vertices[:, :2] >= (x, y)) & (vertices[:, :2] < (x + size, y + size))).all(axis=1)
            if not inside.any():
                continue
            near = ((high[:, :2] >= (x - 90, y - 90)) & (low[:, :2] <= (x + size + 90, y + size + 90))).all(axis=1)
            scene = gnomon.Scene(triangles[near] + FAR, lattice=STEP)
            origins.add(tuple(scene.lattice.origin))
            for answer, sun in zip(found, SUNS_OF_CITY, strict=True):
                answer[inside] = scene.lit(vertices[inside] + FAR, direction=sun, side=gnomon.Side.vertices(UP)).values
    assert len(origins) >= (1 if size == 200 else 4)
    assert digest(*found) == digest(*answers)


def test_what_does_not_fit():
    triangles, vertices = raster(PIT)
    scene = gnomon.Scene(triangles)
    for arguments, text in [
        ({"side": gnomon.Side.vertices(), "receivers": np.zeros(len(vertices), int)}, "takes no receivers="),
        ({"side": gnomon.Side.vertices(), "lift": True}, "no lift="),
        ({"side": gnomon.Side.vertices((0, 0, 0))}, "up: must not be zero"),
    ]:
        with pytest.raises(ValueError, match=text):
            scene.lit(vertices, direction=(0, 0, -1), **arguments)
    with pytest.raises(ValueError, match=r"points: row 1 \[0.5, 0.0, 3.0\] is no vertex"):
        scene.lit([vertices[0], [0.5, 0, 3]], direction=(0, 0, -1), side=gnomon.Side.vertices())
    absent = vertices.copy()
    absent[3] = np.nan
    lit = scene.lit(absent, direction=(0, 0, -1), side=gnomon.Side.vertices(), nan="absent").values
    assert lit.mask.tolist() == [i == 3 for i in range(25)] and not lit.data[3]
    assert scene.lit(np.empty((0, 3)), direction=(0, 0, -1), side=gnomon.Side.vertices()).values.shape == (0,)
