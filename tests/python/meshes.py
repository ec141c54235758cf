# SPDX-License-Identifier: MIT
"""Meshes that several tests make."""

import numpy as np


def box(x, y, width, depth, height):
    corners = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)], float)
    faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
             [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]  # fmt: skip
    return (corners * [width, depth, height] + [x, y, 0])[np.array(faces)]


def grid(n, size=(1.0, 1.0), height=lambda x, y: 0 * x):
    """n x n rectangles of this size, two triangles each: vertices and faces."""
    x, y = np.meshgrid(size[0] * np.arange(n + 1.0), size[1] * np.arange(n + 1.0), indexing="ij")
    vertices = np.stack([x, y, height(x, y)], axis=-1).reshape(-1, 3)
    a = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).reshape(-1)
    return vertices, np.concatenate([np.stack([a, a + n + 1, a + n + 2], 1), np.stack([a, a + n + 2, a + 1], 1)])
