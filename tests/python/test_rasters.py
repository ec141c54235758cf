# SPDX-License-Identifier: MIT
"""Scene.from_raster(): the answers of its triangles, by rational arithmetic and as a mesh; what it refuses."""

import copy
import pickle

import gnomon
import numpy as np
import oracle
import pytest


def ground(x_rises, y_rises, seed=1):
    rng = np.random.default_rng(seed)
    x, y = np.arange(23.0) * (1 if x_rises else -1) + 100, np.arange(17.0) * (0.5 if y_rises else -0.5)
    heights = rng.integers(0, 9, (17, 23)) / 4
    heights[5:8, 9:13] = np.nan
    heights[12, 3] = np.inf
    return x, y, heights


def by_hand(x, y, heights):
    """The triangles of all squares, with the diagonal from south-west to north-east."""
    triangles = []
    order = np.argsort(x), np.argsort(y)
    x, y, z = x[order[0]], y[order[1]], heights[np.ix_(order[1], order[0])]
    for r in range(len(y) - 1):
        for c in range(len(x) - 1):
            sw, se = (x[c], y[r], z[r, c]), (x[c + 1], y[r], z[r, c + 1])
            nw, ne = (x[c], y[r + 1], z[r + 1, c]), (x[c + 1], y[r + 1], z[r + 1, c + 1])
            triangles += [[sw, se, ne], [sw, ne, nw]]
    triangles = np.array(triangles)
    return triangles[np.isfinite(triangles).all(axis=(1, 2))].astype(np.float32)


@pytest.mark.parametrize("x_rises", [True, False])
@pytest.mark.parametrize("y_rises", [True, False])
def test_it_answers_as_its_triangles_do(x_rises, y_rises):
    x, y, heights = ground(x_rises, y_rises)
    scene, triangles = gnomon.Scene.from_raster(x, y, heights), by_hand(x, y, heights)
    finite = np.isfinite(scene.triangles).all(axis=(1, 2))
    assert len(scene) == 2 * 16 * 22 and finite.sum() == len(triangles)
    edges = scene.triangles[finite][:, 1:] - scene.triangles[finite][:, :1]
    assert (np.cross(edges[:, 0], edges[:, 1])[:, 2] > 0).all()  # counter-clockwise from above
    points = np.stack([*np.meshgrid(x, y), np.nan_to_num(heights, nan=1.0, posinf=1.0)], axis=-1).astype(np.float32)
    directions = np.float32([[1, 0, -0.5], [0.5, -0.25, -0.25], [-0.3, 0.9, -0.4], [0, 0, -1], [1, 1, -1]])
    answer = scene.lit_by(points, gnomon.Lights.directions(directions), bits=True).lit()
    as_mesh = gnomon.Scene(triangles)
    for i, direction in enumerate(directions):
        assert (answer[..., i] == as_mesh.lit(points, direction=direction)).all()
        assert (answer[..., i] == scene.lit(points, direction=direction)).all()
    some = points[3::5, 2::7].reshape(-1, 3)
    for i, direction in enumerate(directions):
        assert (answer[3::5, 2::7, i].reshape(-1) == oracle.lit(triangles, some, direction=direction)).all()
    assert 0.1 < answer.mean() < 0.9


def test_it_travels_and_lets_its_triangles_be_named():
    x, y, heights = ground(True, False)
    scene = gnomon.Scene.from_raster(x, y, heights)
    points = scene.triangles[10].mean(axis=0) + np.float32([[0, 0, 0.25]])
    lights = gnomon.Lights.directions([[0, 0, -1], [0.5, 0, -0.25]])
    expected = scene.lit_by(points, lights, receivers=[10], side=gnomon.Side.front(), bits=True).lit()
    for other in (copy.copy(scene), copy.deepcopy(scene), pickle.loads(pickle.dumps(scene))):
        got = other.lit_by(points, lights, receivers=[10], side=gnomon.Side.front(), bits=True)
        assert (got.lit() == expected).all()
    scene.close()
    with pytest.raises(ValueError, match="closed"):
        scene.lit_by(points, lights)


@pytest.mark.parametrize(
    ("wrong", "sentence"),
    [
        (dict(x=np.arange(22.0)), "heights: must have a row for each y"),
        (dict(x=np.zeros(23)), "x: must be finite and rise, or fall"),
        (dict(y=np.append(np.arange(16.0), np.nan)), "y: must be finite and rise, or fall"),
        (dict(x=512_000.1 + np.arange(23)), "x: row 0 has a number that is no float32: subtract a corner"),
        (dict(heights=np.full((17, 23), "a")), "heights: must be numbers"),
    ],
)
def test_it_refuses_what_is_no_raster(wrong, sentence):
    with pytest.raises(ValueError, match=sentence):
        gnomon.Scene.from_raster(**{**dict(zip(("x", "y", "heights"), ground(True, True), strict=True)), **wrong})
