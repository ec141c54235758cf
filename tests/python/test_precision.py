# SPDX-License-Identifier: MIT
"""Coordinates as people have them, without a lattice= of their own: small decimal meshes with points, lamps and cameras
some way off; float64 points beside float32 meshes, also of Earth size."""

import warnings

import gnomon
import numpy as np
import pytest
from meshes import box

BOX = box(-0.2, 0, 0.6, 0.4, 0.3) + [0, 0, 0.85]  # over the ground
DOWN = (0, 0, -1)
GRID = np.stack(np.meshgrid(np.arange(-10, 11.0) + 0.1, np.arange(-10, 11.0) + 0.2, [0.0]), -1).reshape(-1, 3)
EARTH = np.array([4_500_000.0, 5_300_000.0, 0.0])
ROOF = box(0, 0, 10, 10, 1) + [0, 0, 3]  # its edge is at x = 10


@pytest.mark.parametrize("unit", [1, 1000, 0.001], ids=["metres", "millimetres", "kilometres"])
def test_a_small_decimal_mesh_over_wide_ground(unit):
    """441 points, 20 m wide: the one under the box is dark."""
    lit = gnomon.Scene(BOX * unit).lit(GRID * unit, direction=DOWN)
    assert np.flatnonzero(~lit).tolist() == [220]
    by_table = gnomon.Scene(BOX * unit).lit_by(GRID * unit, gnomon.Lights.directions([DOWN]))
    assert (by_table.sums == lit).all()
    absent = np.concatenate([GRID * unit, [[np.nan] * 3]])
    masked = gnomon.Scene(BOX * unit).lit(absent, direction=DOWN, nan="absent")
    assert (masked[:-1] == lit).all() and masked.mask.tolist() == [False] * 441 + [True]


@pytest.mark.parametrize("height", [1.5, 5, 100.3, 1e6])
def test_a_lamp_over_a_small_mesh(height):
    scene = gnomon.Scene(BOX)
    lamp = (0.1, 0.2, height)
    assert scene.lit([[0.1, 0.2, 0], [9.1, 0.2, 0]], position=lamp).tolist() == [False, True]
    assert scene.lit_by([[0.1, 0.2, 0]], gnomon.Lights.positions([lamp])).sums.tolist() == [0]
    scene.prepare(position=lamp)
    assert not scene.lit([[0.1, 0.2, 0]], position=lamp)[0]


@pytest.mark.parametrize("distance", [1, 5, 5000.3])
def test_a_camera_before_a_small_mesh(distance):
    scene = gnomon.Scene(BOX)
    view = scene.view(eye=(0.1, 0.2, 1 + distance), target=(0.1, 0.2, 1), up=(0, 1, 0), fov=1 / distance, size=(9, 9))
    assert view.receivers[4, 4] >= 0 and np.allclose(view.points[4, 4], (0.1, 0.2, 1.15), atol=1e-3 * distance)
    lit = view.visibility(position=(0.1, 0.2, 1 + 2 * distance))
    assert lit[4, 4] == 1 and view.visibility(position=(0.1, 0.2, 0.1))[4, 4] == 0


def test_points_that_float32_does_not_hold():
    """The roof's coordinates are float32 values, half a metre apart; the points lie a millimetre beside its edge."""
    scene = gnomon.Scene(ROOF + EARTH)
    assert scene.lattice is None
    points = EARTH + [[10.001, 5, 0], [9.999, 5, 0], [4.001, 4.001, 0]]
    assert scene.lit(points, direction=DOWN).tolist() == [True, False, False]
    assert scene.lit_by(points, gnomon.Lights.directions([DOWN])).sums.tolist() == [1, 0, 0]
    normals = gnomon.Side.normals(np.tile([0.0, 0.0, 1.0], (3, 1)))
    assert scene.lit(points, direction=DOWN, side=normals).tolist() == [True, False, False]
    assert scene.lit(points.astype(np.float32), direction=DOWN).tolist() == [False] * 3, "the edge"


def test_lamps_and_cameras_that_float32_moves():
    """At 5,300,000 m float32 has steps of half a metre. The ray to a lamp at x = 8 meets the roof's edge; float32 would
    put both lamps there."""
    scene = gnomon.Scene(ROOF + EARTH)
    beside = np.float32(EARTH + [[12, 5, 0]])
    assert scene.lit(beside, position=EARTH + [8.2, 5, 8]).tolist() == [True]
    assert scene.lit(beside, position=EARTH + [7.8, 5, 8]).tolist() == [False]
    view = scene.view(eye=EARTH + [9.9, 5.2, 30], target=EARTH + [9.9, 5.2, 0], up=(0, 1, 0), fov=1, size=(65, 65))
    half = 26 * np.tan(np.radians(0.5))  # of what the picture shows of the roof's plane
    assert abs((view.receivers[32] >= 0).mean() - (half + 0.1) / (2 * half)) < 1.5 / 65, "where the edge is"


def test_far_points_leave_near_ones_where_they_are():
    snap = gnomon.Scene(0.1 + np.random.default_rng(2).random((4, 3, 3))).lattice.native.snap
    near = np.random.default_rng(3).random((5, 3))
    both, _ = snap(np.concatenate([near, [[1e7, 0.3, -2e9]]]))
    assert (both[:5] == snap(near)[0]).all() and np.abs(both[5] - [1e7, 0.3, -2e9]).max() < 256


def test_decimal_points_beside_a_float32_mesh():
    scene = gnomon.Scene(BOX.astype(np.float32))
    assert scene.lit([[0.1, 0.2, 0], [0.9, 0.2, 0]], direction=DOWN).tolist() == [False, True]


def test_float32_that_moves_less_than_a_lattice():
    """A small roof beside ground of 1,000 km, whose lattice has steps of centimetres: it would put edge and points, a
    millimetre apart, at one place. float32 moves the points by less than a nanometre."""
    edge = 2.0**-10
    roof = box(-1, -1, 1 + edge, 2, 1) + [0, 0, 2]
    far = np.array([[[-5e5, -5e5, -9], [5e5, -5e5, -9], [0, 5e5, -9]]])
    scene = gnomon.Scene(np.concatenate([roof, far]).astype(np.float32))
    points = np.array([[edge + 1e-4, 0, 0], [edge - 1e-4, 0, 0]])
    assert scene._on_lattice().lattice.step > 0.01 and (points.astype(np.float32) != points).any()
    assert scene.lit(points, direction=DOWN).tolist() == [True, False]
    assert scene.lit_by(points, gnomon.Lights.directions([DOWN])).sums.tolist() == [1, 0]
    normals = gnomon.Side.normals(np.tile([0.0, 0.0, 1.0], (2, 1)))
    assert scene.lit(points, direction=DOWN, side=normals).tolist() == [True, False]


def test_what_float32_serves_keeps_its_bits():
    """Points that are float32 values go the way they went, and decide as the triangles' own bits say."""
    scene = gnomon.Scene(BOX.astype(np.float32))
    points = GRID.astype(np.float32)
    as_float64 = scene.lit(points.astype(np.float64), direction=DOWN)
    assert (as_float64 == scene.lit(points, direction=DOWN)).all() and scene.lattice is None and scene._twin is None


def test_a_stray_triangle_is_named():
    stray = np.array([[[1e9, 0, 0.1], [1e9 + 1, 0, 0], [1e9, 1, 0]]])
    with pytest.warns(UserWarning, match="moves vertices by up to .* triangle 12, 1e.09 away from the others"):
        gnomon.Scene(np.concatenate([BOX, stray]))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        gnomon.Scene(BOX)
        gnomon.Scene(np.concatenate([BOX, BOX + [50, 20, 3]]))
        gnomon.Scene(BOX + EARTH)
