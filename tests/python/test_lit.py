# SPDX-License-Identifier: MIT
"""Scene.lit() against the rational oracle, on made scenes and on scenes that hypothesis finds."""

import gnomon
import numpy as np
import oracle
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

SQUARE = np.float32([[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])
SQUARE_FACES = [[0, 1, 2], [0, 2, 3]]


def test_a_square_shades_what_lies_under_it():
    scene = gnomon.Scene(SQUARE, SQUARE_FACES)
    # Inside, on the diagonal that two triangles share, on the outer edge, outside, above, on the plane.
    points = [[0.3, 0.2, 0], [0.5, 0.5, 0], [0, 0.5, 0], [1.5, 0.5, 0], [0.5, 0.5, 2], [0.5, 0.25, 1]]
    lit = scene.lit(np.float32(points), direction=(0, 0, -1))
    assert lit.dtype == bool
    assert lit.tolist() == [False, False, False, True, True, True]


def test_a_point_light_shades_only_what_is_behind():
    scene = gnomon.Scene(SQUARE[SQUARE_FACES])
    points = np.float32([[0.5, 0.5, 0], [0.5, 0.5, 1.5], [4, 0.5, 0]])
    assert scene.lit(points, position=(0.5, 0.5, 3)).tolist() == [False, True, True]
    assert scene.lit(points, position=(0.5, 0.5, 0.5)).tolist() == [True, False, True]


def test_receivers_exclude_their_triangle_and_decide_no_facing():
    scene = gnomon.Scene(SQUARE, SQUARE_FACES)
    above = np.float32([[0.6, 0.25, 0.75]])  # under the square, on triangle 0 as the caller says
    assert not scene.lit(above, direction=(0, 0, -1))[0]
    assert scene.lit(above, direction=(0, 0, -1), receivers=[0])[0]
    assert not scene.lit(above, direction=(0, 0, -1), receivers=[-1])[0]


def test_sides():
    scene = gnomon.Scene(SQUARE, SQUARE_FACES)  # counter-clockwise from above
    on = np.float32([[0.6, 0.25, 1]])
    down, up, along = (0, 0, -1), (0, 0, 1), (1, 0, 0)
    assert scene.lit(on, direction=up)[0], "without a side the far side may be lit"
    assert scene.lit(on, direction=down, receivers=[0], side=gnomon.Side.front())[0]
    assert not scene.lit(on, direction=up, receivers=[0], side=gnomon.Side.front())[0]
    assert not scene.lit(on, direction=along, receivers=[0], side=gnomon.Side.front())[0]
    assert scene.lit(on, direction=down, side=gnomon.Side.normals([[0, 0, 5]]))[0]
    assert not scene.lit(on, direction=up, side=gnomon.Side.normals([[0, 0, 5]]))[0]
    assert not scene.lit(on, direction=along, side=gnomon.Side.normals([[0, 0, 5]]))[0]
    assert scene.lit(on, direction=up, receivers=[0], side=gnomon.Side.eye((0, 0, -9)))[0]
    assert not scene.lit(on, direction=up, receivers=[0], side=gnomon.Side.eye((0, 0, 9)))[0]


def test_shapes_are_kept():
    scene = gnomon.Scene(SQUARE, SQUARE_FACES)
    grid = np.zeros((4, 5, 3), np.float32)
    grid[..., 0] = np.arange(5) / 2
    upwards = gnomon.Side.normals(np.broadcast_to(np.float32([0, 0, 1]), grid.shape))
    lit = scene.lit(grid, direction=(0, 0, -1), side=upwards)
    assert lit.shape == (4, 5)
    assert lit[0].tolist() == [False, False, False, True, True]
    assert scene.lit(np.empty((0, 3)), direction=(0, 0, -1)).shape == (0,)


def test_arrays_of_every_kind():
    scene = gnomon.Scene(SQUARE.astype(np.float64), np.asarray(SQUARE_FACES, np.int64))
    points = np.float32([[0.5, 0.25, 0], [3, 0, 0], [0.25, 0.5, 0], [3, 1, 0]])
    expected = [False, True, False, True]
    read_only = points.copy()
    read_only.flags.writeable = False
    doubled = np.repeat(points, 2, axis=0)
    for array in (
        points,
        points.tolist(),
        points.astype(np.float64),
        read_only,
        doubled[::2],
        np.asfortranarray(points),
    ):
        assert scene.lit(array, direction=(0, 0, -1)).tolist() == expected

    class OnlyDlpack:
        def __dlpack__(self, **keywords):
            return points.__dlpack__(**keywords)

        def __dlpack_device__(self):
            return points.__dlpack_device__()

    assert scene.lit(OnlyDlpack(), direction=(0, 0, -1)).tolist() == expected


def test_absent_points_never_read_as_lit():
    scene = gnomon.Scene(SQUARE, SQUARE_FACES)
    points = np.float32([[3, 0, 0], [np.nan, 0, 0], [3, np.inf, 0]])
    lit = scene.lit(points, direction=(0, 0, -1), nan="absent")
    assert lit.data.tolist() == [True, False, False]
    assert lit.mask.tolist() == [False, True, True]
    assert lit.filled().tolist() == [True, False, False]


def test_an_empty_scene_shades_nothing():
    scene = gnomon.Scene(np.empty((0, 3)), np.empty((0, 3), int))
    assert len(scene) == 0
    assert scene.lit(np.zeros((3, 3)), direction=(0, 0, -1)).all()


def test_prepared_lights_and_other_techniques():
    rng = np.random.default_rng(5)
    scene = gnomon.Scene(rng.random((40, 3, 3), np.float32))
    points = rng.random((500, 3), np.float32)
    direction = (0.25, -1, 0.5)
    before = scene.lit(points, direction=direction)
    scene.prepare(direction=direction)
    assert (scene.lit(points, direction=direction) == before).all()
    assert (scene.visibility(points, direction=direction, technique="izb") == before).all()
    soft = scene.visibility(points, direction=direction, technique=gnomon.Technique("pcf", {"size": 64}))
    assert soft.dtype == np.float32 and soft.min() >= 0 and soft.max() <= 1


@pytest.mark.parametrize("light", [{"direction": (0.5, -1, 0.25)}, {"position": (0.5, 0.5, 0.5)}])
def test_random_triangles_equal_the_oracle(light):
    rng = np.random.default_rng(11)
    triangles = rng.random((60, 1, 3), np.float32) + 0.25 * rng.random((60, 3, 3), np.float32)
    receivers = rng.integers(-1, 60, 150)
    points = rng.random((150, 3), np.float32)
    normals = rng.normal(size=(150, 3)).astype(np.float32)
    scene = gnomon.Scene(triangles)
    by_normals = oracle.lit(triangles, points, receivers=receivers, normals=normals, **light)
    in_front = oracle.lit(triangles, points, receivers=receivers, front=True, **light)
    for side, expected in ((gnomon.Side.normals(normals), by_normals), (gnomon.Side.front(), in_front)):
        assert 0 < expected.sum() < 150
        assert (scene.lit(points, receivers=receivers, side=side, **light) == expected).all()
    assert (by_normals != in_front).any()


# Small whole numbers make ties: rays through corners and edges, points on planes, coplanar and zero-area triangles.
coordinates = st.integers(-3, 3).map(float)
vectors = st.tuples(coordinates, coordinates, coordinates)


@settings(max_examples=150, deadline=None)
@given(
    triangles=st.lists(st.tuples(vectors, vectors, vectors), min_size=1, max_size=8),
    points=st.lists(vectors, min_size=1, max_size=8),
    light=vectors,
    is_position=st.booleans(),
)
def test_ties_equal_the_oracle(triangles, points, light, is_position):
    if not is_position and light == (0, 0, 0):
        return
    which = {"position": light} if is_position else {"direction": light}
    triangles, points = np.float32(triangles), np.float32(points)
    receivers = np.arange(len(points)) % (len(triangles) + 1) - 1
    with gnomon.Scene(triangles) as scene:
        got = scene.lit(points, receivers=receivers, **which)
        assert got.tolist() == oracle.lit(triangles, points, receivers=receivers, **which).tolist()
