# SPDX-License-Identifier: MIT
"""World coordinates: the same bits wherever the origin lies, however the scene is cut, in whatever order it comes."""

import gnomon
import numpy as np
import oracle
import pytest
from gnomon import _gnomon
from meshes import box, grid

STEP = 2.0**-10
FAR = np.array([4_500_000.0, 6_000_000.0, 0.0])
SUN = (0.6, 0.35, -0.5)


def city(rng):
    """64 houses in 200 m; half of them on whole metres, so that lights along the grid meet edges and corners exactly,
    the others at any coordinates, halves of a step among them."""
    houses = []
    for i in range(8):
        for j in range(8):
            place = np.array([25.0 * i, 25.0 * j, 10.0, 12.0, rng.integers(4, 30)])
            if (i + j) % 2:
                place[:4] += rng.random(4)
            if (i + j) % 4 == 1:
                place[:2] = np.floor(place[:2] / STEP) * STEP + STEP / 2  # exactly between two steps
            houses.append(box(*place))
    return np.concatenate(houses)


def receivers(rng):
    """Points on the ground, half of them at whole metres."""
    points = np.zeros((4000, 3))
    points[:, :2] = rng.random((4000, 2)) * 200
    points[::2] = np.round(points[::2])
    return points


@pytest.fixture(scope="module")
def made():
    rng = np.random.default_rng(17)
    triangles, points = city(rng), receivers(rng)
    lights = [SUN, (1.0, 1.0, -1.0), (0.0, 1.0, -0.5), (1.0, 0.0, 0.0)]
    expected = [gnomon.Scene(triangles, lattice=STEP).lit(points, direction=d) for d in lights]
    assert all(0 < e.sum() < len(e) for e in expected)
    return triangles, points, lights, expected


def test_the_oracle_agrees(made):
    triangles, points, lights, expected = made
    scene = gnomon.Scene(triangles, lattice=STEP)
    # What was snapped, by its definition, in numbers that need no rounding here.
    assert (np.floor(triangles / STEP + 0.5) * STEP == scene.triangles + scene.lattice.origin).all()
    here = scene.lattice.snap(points[:40], "points")
    for direction, lit in zip(lights[1:], expected[1:], strict=True):
        assert oracle.lit(scene.triangles, here, direction=direction).tolist() == lit[:40].tolist()


@pytest.mark.parametrize("steps", [(0, 0, 0), (1, 3, -5), (12345677, -7654321, 1023), (-1, -1, -1)])
def test_moved_by_odd_numbers_of_steps(made, steps):
    triangles, points, lights, expected = made
    move = FAR + np.array(steps) * STEP
    assert (triangles + move - move == triangles).mean() > 0.4  # the ties are exact in both places
    snapped = np.floor(triangles / STEP + 0.5) * STEP
    scene = gnomon.Scene(snapped + move, lattice=STEP)
    here = np.floor(points / STEP + 0.5) * STEP + move
    for direction, lit in zip(lights, expected, strict=True):
        assert (scene.lit(here, direction=direction) == lit).all()


@pytest.mark.parametrize("size", [200.0, 67.0, 25.0])
def test_cut_into_tiles(made, size):
    """Each tile has its own scene, with the houses within 80 m, and so its own origin."""
    triangles, points, lights, expected = made
    answers = [np.zeros(len(points), bool) for _ in lights]
    centres = triangles.mean(axis=1)
    whole = gnomon.Scene(triangles + FAR, lattice=STEP)
    origins = set()
    is_covered = (points[:, :2] < 200).all(axis=1)
    for x in np.arange(0, 200, size):
        for y in np.arange(0, 200, size):
            inside = ((points[:, :2] >= (x, y)) & (points[:, :2] < (x + size, y + size))).all(axis=1)
            near = ((centres[:, :2] > (x - 80, y - 80)) & (centres[:, :2] < (x + size + 80, y + size + 80))).all(axis=1)
            scene = gnomon.Scene(triangles[near] + FAR, lattice=STEP)
            origins.add(tuple(scene.lattice.origin))
            for answer, direction in zip(answers, lights, strict=True):
                answer[inside] = scene.lit(points[inside] + FAR, direction=direction)
    assert len(origins) >= (1 if size == 200 else 4)
    for answer, direction in zip(answers, lights, strict=True):
        if direction[2] != 0:  # a level sun's shadows reach farther than 80 m
            assert (answer == whole.lit(points + FAR, direction=direction))[is_covered].all()


def test_given_in_three_orders(made):
    triangles, points, lights, expected = made
    rng = np.random.default_rng(3)
    for order in (np.arange(len(triangles))[::-1], rng.permutation(len(triangles)), rng.permutation(len(triangles))):
        scene = gnomon.Scene(triangles[order], lattice=STEP)
        for direction, lit in zip(lights, expected, strict=True):
            assert (scene.lit(points, direction=direction) == lit).all()


def test_point_lights_are_snapped(made):
    triangles, points, _, _ = made
    at = np.array([100.3, 99.9, 60.1])
    here = gnomon.Scene(triangles, lattice=STEP).lit(points, position=at)
    snapped = [np.floor(v / STEP + 0.5) * STEP for v in (triangles, points, at)]
    there = gnomon.Scene(snapped[0] + FAR, lattice=STEP).lit(snapped[1] + FAR, position=snapped[2] + FAR)
    assert (here == there).all() and 0 < here.sum() < len(here)


def test_a_view_does_not_depend_on_the_origin(made):
    ground = np.array([[[-50, -50, 0], [250, -50, 0], [250, 250, 0]], [[-50, -50, 0], [250, 250, 0], [-50, 250, 0]]])
    triangles = np.concatenate([np.floor(made[0] / STEP + 0.5) * STEP, ground])
    eye, target = np.array([-60.25, -40.5, 70.125]), np.array([100.0, 100.0, 0.0])
    pictures, points = [], []
    for move in (np.zeros(3), FAR, FAR + np.array([1, 3, 5]) * STEP):
        extra = box(*(move[:2] + [-400, -400]), 1, 1, 1) + [0, 0, move[2]] if move[0] else triangles[:0]
        scene = gnomon.Scene(np.concatenate([triangles + move, extra]), lattice=STEP)
        view = scene.view(eye=eye + move, target=target + move, up=(0, 0, 1), size=(160, 90))
        seen = view.receivers < len(triangles)  # the extra house, which moves the origin, stands behind the eye
        assert seen.all()
        pictures.append(view.visibility(direction=(-0.6, -0.35, -0.5)))
        points.append(view._read()[0])  # relative to the lattice point nearest the eye
    assert (pictures[0] == pictures[1]).all() and (pictures[0] == pictures[2]).all()
    assert 0.2 < pictures[0].mean() < 0.95
    assert np.array_equal(points[0], points[1], equal_nan=True) and np.array_equal(points[0], points[2], equal_nan=True)
    here = _gnomon.WorldLattice.around(eye.reshape(1, 3), -10).world_of((0.0, 0.0, 0.0))
    assert np.array_equal(view.points, points[0] + (here + FAR + np.array([1, 3, 5]) * STEP), equal_nan=True)


def test_the_step_is_chosen_and_shown():
    model = gnomon.Scene(np.array([[[0, 0, 0], [0.15, 0, 0], [0, 0.1, 0.03]]]))
    assert model.lattice.step < 1e-7 and model.lattice.largest_move <= model.lattice.step / 2
    assert "Lattice of step 2^-26" in repr(model)
    assert gnomon.Scene(np.float64([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]])).lattice is None
    large = gnomon.Scene(np.array([[[4.49e6, 6e6, 0.1], [4.51e6, 6e6, 3], [4.5e6, 6.02e6, 400]]]))
    assert large.lattice.step == 2.0**-9


def test_the_rounding_of_points_is_reported():
    scene = gnomon.Scene(np.array([[[0, 0, 0], [4, 0, 0], [0, 4, 0.0]]]), lattice=STEP)
    assert scene.lattice.largest_move == scene.lattice.largest_move_of_points == 0
    scene.lit(np.array([[1, 1, 1], [1, 1 + STEP / 4, 1]]), direction=SUN)
    assert scene.lattice.largest_move_of_points == STEP / 4
    scene.lit(np.array([[1, 1, 1 + STEP / 2]]), direction=SUN, side=gnomon.Side.normals([[0, 0, 1]]), lift=True)
    assert scene.lattice.largest_move_of_points == STEP / 2


def test_what_does_not_fit():
    triangle = np.array([[[0, 0, 0.1], [30_000, 0, 0], [0, 40_000, 0]]])
    with pytest.raises(ValueError, match=r"row 0 .* the finest step that fits these positions is 2\^-9"):
        gnomon.Scene(triangle, lattice=2.0**-10)
    scene = gnomon.Scene(triangle, lattice=2.0**-7)
    with pytest.raises(ValueError, match=r"points: row 1 .* lies more than 2\^24 steps"):
        scene.lit([[0, 0, 0], [1e6, 0, 0.1]], direction=SUN)
    with pytest.raises(ValueError, match=r"position: .* the finest step that fits these positions is 2\^-4"):
        scene.lit([[0, 0, 0]], position=(0, 1e6, 0), direction=None)  # 980,000 from the origin: 2^24 x 2^-4 = 1,048,576
    # The other way, away from the triangle: the ray above would touch its corner, which blocks.
    assert gnomon.Scene(triangle, lattice=2.0**-4).lit([[0, 0, 0]], position=(0, -1e6, 0)).tolist() == [True]
    with pytest.raises(ValueError, match="not a power of two"):
        gnomon.Scene(triangle, lattice=0.001)
    with pytest.raises(ValueError, match="lift: needs a lattice"):
        gnomon.Scene(np.float32(triangle)).lit(np.zeros((1, 3)), direction=SUN, lift=True)
    with pytest.raises(ValueError, match="lift: needs Side.normals"):
        scene.lit(np.zeros((1, 3)), direction=SUN, lift=True)


def roof(n=40, slope=0.37):
    """A sloping roof of n x n squares, at coordinates that no step holds, and points on it."""
    vertices, faces = grid(n, (9.7 / n, 7.3 / n), lambda x, y: slope * x + 0.11 * y)
    triangles = (vertices + FAR)[faces]
    rng = np.random.default_rng(2)
    ids = rng.integers(0, len(triangles), 3000)
    weights = rng.dirichlet((1, 1, 1), 3000)
    return triangles, (triangles[ids] * weights[..., None]).sum(axis=1), ids


def test_a_flat_roof_does_not_shadow_its_points():
    triangles, points, ids = roof()
    scene = gnomon.Scene(triangles, lattice=STEP)
    suns = [(0, 0, -1), (0.9, 0.2, -0.2), (-1, 0.3, -0.375), (0.1, -1, -0.12)]
    dark = 0
    for sun in suns:
        assert scene.lit(points, direction=sun, receivers=ids, side=gnomon.Side.front(), lift=True).all()
        normals = np.tile([-0.37, -0.11, 1.0], (len(points), 1))
        assert scene.lit(points, direction=sun, side=gnomon.Side.normals(normals), lift=True).all()
        dark += (~scene.lit(points, direction=sun, receivers=ids)).sum()
    assert dark > 100, "without the lift the neighbours shadow many points"
    for sun in [(0, 0, 1), (1, 0.3, 0.6)]:
        from_below = scene.lit(points, direction=sun, receivers=ids, side=gnomon.Side.front(), lift=True)
        assert not from_below.any()


def test_triangles_that_snapping_changes_are_named_and_never_silently_dark():
    sliver = np.array([[0, 0, 0], [10, 0, 3], [5.001, 0.0004, 1.5003]])  # becomes vertical on 2^-10
    plain = np.array([[[-5, -5, -9], [20, -5, -9], [20, 20, -9]]], float)
    scene = gnomon.Scene(np.concatenate([[sliver], plain]), lattice=STEP)
    changed = {*scene.lattice.zero_area, *scene.lattice.turned_over, *scene.lattice.tilted}
    assert changed == {0} and "1 triangles changed" in repr(scene)
    on = sliver.mean(axis=0, keepdims=True)
    # It faces up before snapping; a sun from above reaches it.
    assert np.cross(sliver[1] - sliver[0], sliver[2] - sliver[0])[2] > 0
    assert scene.lit(on, direction=(0, 0, -1), receivers=[0], side=gnomon.Side.front(), lift=True)[0]
    assert not scene.lit(on, direction=(0, 0, 1), receivers=[0], side=gnomon.Side.front(), lift=True)[0]
