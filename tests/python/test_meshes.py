# SPDX-License-Identifier: MIT
"""Meshes of other packages, and the failures that their users reported, replayed."""

import gnomon
import numpy as np
import oracle
import pytest
from meshes import grid

DOWN = (0, 0, -1)


def test_a_trimesh():
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.creation.box(extents=(2, 2, 2))
    scene = gnomon.Scene(mesh)
    assert len(scene) == 12
    assert scene.lit(np.float32([[0, 0, -3], [3, 0, -3]]), direction=DOWN).tolist() == [False, True]


def test_a_pyvista_mesh():
    pyvista = pytest.importorskip("pyvista", exc_type=ImportError)
    scene = gnomon.Scene(pyvista.Cube(x_length=2, y_length=2, z_length=2))  # quads
    assert len(scene) == 12
    assert scene.lit(np.float32([[0, 0, -3], [3, 0, -3]]), direction=DOWN).tolist() == [False, True]


def test_rays_through_edges_and_vertices_do_not_pass():
    """trimesh #1496, #1919, #1180 (524,287 of 524,288 hits) and Embree #181, #387: a ray through a shared edge or
    vertex of a closed surface went through it."""
    n = 64
    scene = gnomon.Scene(*grid(n))
    steps = np.arange(0, 2 * n + 1) / 2  # every vertex, the middles of edges and diagonals
    x, y = np.meshgrid(steps, steps)
    under = np.stack([x, y, np.full_like(x, -5)], axis=-1)
    assert not scene.lit(under, direction=DOWN).any()
    # A slanted light through the same points of the surface.
    assert not scene.lit(under + [1.25 * 5, -0.75 * 5, 0], direction=(1.25, -0.75, -1)).any()


def test_points_on_the_mesh_do_not_hit_it():
    """trimesh #331, #48: a ray that starts on the surface hits it or not by chance, most of all at coordinates of the
    size of a national grid. A point on a triangle's plane is not shadowed by that triangle."""
    origin = np.float64([528_980, 183_526, 0])  # the British grid of #48, in whole metres
    vertices, faces = grid(100)
    scene = gnomon.Scene(vertices + origin, faces)
    rng = np.random.default_rng(48)
    points = np.floor(rng.random((20_000, 3)) * [1600, 1600, 0]) / 16 + origin
    for direction in (DOWN, (3, 1, -0.125), (-0.001, 1, -0.0001)):
        assert scene.lit(points, direction=direction).all()


def test_a_closed_box_is_dark_inside():
    """Open3D #5430, #1149 of Mitsuba: light leaked through the edges of solids."""
    trimesh = pytest.importorskip("trimesh")
    sphere = trimesh.creation.icosphere(subdivisions=3)
    scene = gnomon.Scene(sphere.vertices.astype(np.float32), sphere.faces)
    rng = np.random.default_rng(5)
    inside = (rng.normal(size=(5_000, 3)) * 0.2).astype(np.float32)
    inside = inside[np.linalg.norm(inside, axis=1) < 0.9]
    # Towards vertices, the middles of edges and random directions.
    towards = np.concatenate([sphere.vertices[:40], sphere.vertices[sphere.edges_unique[:40]].mean(axis=1)])
    for direction in -towards:
        assert not scene.lit(inside[:500], direction=direction).any()
    centre = np.zeros((1, 3), np.float32)
    for direction in -sphere.vertices:
        assert not scene.lit(centre, direction=direction)[0]


def test_random_ties_on_a_height_field():
    """Points at the vertices of a height field, lights along its edges: each answer against the oracle."""
    rng = np.random.default_rng(9)
    heights = rng.integers(0, 3, (7, 7)).astype(float)
    vertices, faces = grid(6, height=lambda x, y: heights[x.astype(int), y.astype(int)])
    triangles = vertices[faces].astype(np.float32)
    scene = gnomon.Scene(triangles)
    points = vertices.astype(np.float32)
    for direction in [(1, 0, -1), (1, 1, -1), (-2, 1, -1), (0, 1, -0.5), (1, 0, 0), (0, 0, -1)]:
        expected = oracle.lit(triangles, points, direction=direction)
        assert scene.lit(points, direction=direction).tolist() == expected.tolist()
