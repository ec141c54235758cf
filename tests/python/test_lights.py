# SPDX-License-Identifier: MIT
"""Scene.lit_by(): each answer is lit()'s for the one light; sums are integers of the tests' own; bad rows."""

import fractions

import gnomon
import meshes
import numpy as np
import pytest

DOWN = (0.25, 0.5, -1)
ONE = gnomon.Lights.directions([DOWN])


def town(seed=5, houses=12):
    rng = np.random.default_rng(seed)
    faces = [meshes.box(*rng.integers(0, 24, 2), 2, 3, rng.integers(1, 9)) for _ in range(houses)]
    return np.float32(np.concatenate([*faces, np.float32([[[-9, -9, 0], [40, -9, 0], [40, 40, 0]]])]))


def on_faces(triangles, count, seed=6):
    rng = np.random.default_rng(seed)
    ids = rng.integers(0, len(triangles), count)
    a, b = rng.integers(0, 9, (2, count, 1)) / np.float32(16)
    v = triangles[ids]
    return np.float32(v[:, 0] + a * (v[:, 1] - v[:, 0]) + b * (v[:, 2] - v[:, 0])), ids


def suns(count, seed=7):
    rng = np.random.default_rng(seed)
    directions = rng.integers(-8, 9, (count, 3)).astype(float)
    directions[:, 2] = -rng.integers(1, 9, count)
    return directions


@pytest.mark.parametrize("side", [None, "front", "normals"])
def test_each_bit_is_that_of_one_light(side):
    triangles = town()
    scene = gnomon.Scene(triangles)
    points, ids = on_faces(triangles, 300)
    normals = np.cross(triangles[ids, 1] - triangles[ids, 0], triangles[ids, 2] - triangles[ids, 0])
    directions, weights = suns(70), np.linspace(-2, 5, 70)
    chosen = {None: None, "front": gnomon.Side.front(), "normals": gnomon.Side.normals(normals)}[side]
    seen = []
    lights = gnomon.Lights.directions(directions, weights)
    result = scene.lit_by(points, lights, receivers=ids, side=chosen, bits=True, progress=seen.append)
    one_by_one = np.stack([scene.lit(points, direction=d, receivers=ids, side=chosen) for d in directions], axis=1)
    assert (result.lit() == one_by_one).all()
    assert (result.counts == one_by_one.sum(axis=1)).all()
    assert 0.05 < one_by_one.mean() < 0.95
    for row, lit in enumerate(one_by_one):
        rows = np.flatnonzero(lit)
        assert (result.first[row], result.last[row]) == ((rows[0], rows[-1]) if len(rows) else (-1, -1))
        exact = sum(fractions.Fraction(float(np.float32(w))) for w in weights[rows])
        error = abs(fractions.Fraction(float(result.sums[row])) - exact)
        assert error <= abs(exact) / 2**52 + fractions.Fraction(1, 2**50)
    assert seen[-1] == 1 and seen == sorted(seen)


def test_point_lights_shapes_and_a_lattice():
    triangles = town().astype(float) + (4.5e6, 6e6, 0)
    scene = gnomon.Scene(triangles, lattice=2**-10)
    at = np.array([4.5e6 + 5, 6e6 + 7, 30.0])
    points = triangles[:6, 0].reshape(2, 3, 3) + (0, 0, 20)
    result = scene.lit_by(points, gnomon.Lights.positions([at, at + 3]), bits=True)
    assert result.sums.shape == result.counts.shape == (2, 3)
    for light, position in enumerate([at, at + 3]):
        assert (result.lit()[..., light] == scene.lit(points, position=position)).all()
    with pytest.raises(ValueError, match="lattice give Side.normals"):
        scene.lit_by(points, ONE, receivers=np.zeros((2, 3), int), side=gnomon.Side.front())


@pytest.mark.parametrize("count", [0, 1, 31, 32, 33])
def test_as_many_columns_as_lights(count):
    """Not a multiple of 32: a mean over the columns is a share of the lights."""
    scene = gnomon.Scene(town())
    at = np.float32([[[1, 1, 90], [5, 5, 90]]])  # above all
    result = scene.lit_by(at, gnomon.Lights.directions(suns(count)), bits=True)
    assert result.light_count == count
    assert result.bits.shape == (1, 2, (count + 31) // 32)
    assert result.lit().shape == (1, 2, count)
    assert result.lit().all() and (result.counts == count).all()


def test_nothing_at_all():
    scene = gnomon.Scene(town())
    none = scene.lit_by(np.empty((0, 3), np.float32), ONE)
    assert none.sums.shape == (0,)
    dark = scene.lit_by(np.float32([[1, 1, 50]]), gnomon.Lights.directions(np.empty((0, 3))))
    assert (dark.counts[0], dark.sums[0], dark.first[0]) == (0, 0, -1)


def test_cosines():
    scene = gnomon.Scene(town())
    lights = gnomon.Lights.directions([(0, 0, -2), (0, -3, -4), (0, 0, 1)], [2, 5, 9])
    result = scene.lit_by(np.float32([[1, 1, 90]]), lights, side=gnomon.Side.normals([[0, 0, 1]]), cosines=True)
    assert result.sums[0] == pytest.approx(2 + 5 * 0.8, rel=1e-6)
    assert result.counts[0] == 2
    with pytest.raises(ValueError, match="normals: row 0"):
        scene.lit_by([[1, 1, 90]], ONE, side=gnomon.Side.normals([[0, 0, 1e300]]), cosines=True)


def test_bad_rows_are_named():
    scene = gnomon.Scene(town())
    at = np.float32([[1, 1, 50]])
    directions = gnomon.Lights.directions
    for lights, arguments, text in [
        (directions([DOWN, (0, 0, 0)]), {}, r"directions: row 1 \[0.0, 0.0, 0.0\] is zero"),
        (directions([DOWN, (0, np.nan, 0)]), {}, "directions: row 1 .* is not finite"),
        (directions([(1e300, 0, 0)]), {}, "directions: row 0 .* is not finite"),
        (directions(DOWN), {}, r"directions: shape \(3,\)"),
        (gnomon.Lights.positions(DOWN), {}, r"positions: shape \(3,\)"),
        (directions([DOWN], [1, 2]), {}, r"weights: shape \(2,\) is not \(1,\)"),
        (directions([DOWN], [np.inf]), {}, "weights: row 0 inf"),
        (directions([DOWN] * 3, [5, -9999, -1]), {}, "weights: row 1 -9999 stands for no data in files: make it 0"),
        (directions([DOWN], [1e36]), {}, "weights: row 0 1e.36 stands for no data"),
        (ONE, {"cosines": True}, "cosines: needs side=Side.normals"),
        (ONE, {"side": gnomon.Side.front()}, "side: Side.front.. needs receivers="),
        (ONE, {"side": gnomon.Side.vertices()}, "side: Side.vertices.. is for lit"),
    ]:
        with pytest.raises(ValueError, match=text):
            scene.lit_by(at, lights, **arguments)
    with pytest.raises(TypeError, match="lights: must be"):
        scene.lit_by(at, [DOWN])
    with pytest.raises(ValueError, match="bits=True"):
        scene.lit_by(at, ONE).lit()


def test_a_run_that_progress_ends_is_cancelled():
    scene = gnomon.Scene(town())
    at = np.float32([[1, 1, 50]])
    with pytest.raises(gnomon.Cancelled, match="cancelled"):
        scene.lit_by(at, ONE, progress=lambda done: False)
    assert issubclass(gnomon.Cancelled, RuntimeError) and not issubclass(gnomon.OpenCLError, gnomon.Cancelled)
    with pytest.raises(ZeroDivisionError):
        scene.lit_by(at, ONE, progress=lambda done: 1 / 0)
    assert scene.lit_by(at, ONE).counts.shape == (1,), "the scene stays usable"


def test_lifted_points_are_those_of_lit():
    rng = np.random.default_rng(4)
    vertices = np.stack([*(v.reshape(-1) / 7 for v in np.meshgrid(np.arange(12), np.arange(12), indexing="ij"))], 1)
    vertices = np.c_[vertices, vertices @ [0.3, 0.7]]
    corner = (np.arange(11)[:, None] * 12 + np.arange(11)).reshape(-1)
    halves = [[corner, corner + 12, corner + 13], [corner, corner + 13, corner + 1]]
    faces = np.concatenate([np.stack(half, 1) for half in halves])
    scene = gnomon.Scene(vertices, faces, lattice=2**-10)
    points = vertices[faces].mean(axis=1)
    side = gnomon.Side.normals(np.tile([-0.3, -0.7, 1], (len(points), 1)))
    suns = rng.normal(size=(9, 3)) * [1, 1, 0.2] - [0, 0, 0.4]
    found = scene.lit_by(points, gnomon.Lights.directions(suns), side=side, lift=True, bits=True).lit()
    for k, sun in enumerate(suns):
        assert (found[:, k] == scene.lit(points, direction=sun, side=side, lift=True)).all()
    flat = scene.lit_by(points, gnomon.Lights.directions(suns), side=side, bits=True).lit()
    assert (flat != found).any()
    with pytest.raises(ValueError, match="lift: needs side=Side.normals"):
        scene.lit_by(points, gnomon.Lights.directions(suns), lift=True)
    with pytest.raises(ValueError, match="lift: needs a lattice"):
        gnomon.Scene(np.eye(3)[None]).lit_by(points, gnomon.Lights.directions(suns), side=side, lift=True)
