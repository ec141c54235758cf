# SPDX-License-Identifier: MIT
"""Irradiation in studies: the cosines of receivers, and exact sums of what their suns give.

Normals and suns are taken on the true ground: a map's stretch turns a slope's normal, and does not change its energy. A
product of weight and cosine is rounded once to whole units; sums of units do not depend on tiles or blocks. All is
float64, one operation after the other, so that bits do not depend on the machine.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import _gnomon
from .facing import NEIGHBOURS
from .planes import Planes
from .receivers import Part
from .suns import Suns

#: The unit of sums is 2^UNIT Wh/m^2.
UNIT = -20
#: The outputs of a study with a weather file.
ENERGIES = ("irradiation", "direct", "diffuse")


def true_normals(part: Part, to_map: NDArray[np.float64]) -> NDArray[np.float64]:
    """(3, n) unit normals of a part's receivers, x true east, y true north. to_map: (2, 2) the Jacobian that leads from
    there to the map. A raster's vertex has the sum of the normals of the triangles around it, each as long as twice its
    area; a vertex without triangles, and a point without a normal, look up."""
    if part.normals is not None:
        x, y, z = part.normals.T
    elif part.window is not None:
        x, y, z = _normals_of_window(*part.window)
    else:
        x, y, z = np.zeros(len(part.rows)), np.zeros(len(part.rows)), np.ones(len(part.rows))
    east, north = to_map[0, 0] * x + to_map[1, 0] * y, to_map[0, 1] * x + to_map[1, 1] * y
    length = np.sqrt(east * east + north * north + z * z)
    return np.stack([east, north, z]) / length


def _normals_of_window(
    x: NDArray[np.float64], y: NDArray[np.float64], heights: NDArray[np.float64], inside: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """x, y, z (n,) of the normals of the vertices of a Part's window."""
    rows, columns = inside.shape
    edges = []
    for r, c in NEIGHBOURS:
        dx = np.broadcast_to(x[1 + c : 1 + c + columns] - x[1:-1], inside.shape)[inside]
        dy = np.broadcast_to((y[1 + r : 1 + r + rows] - y[1:-1])[:, None], inside.shape)[inside]
        dz = (heights[1 + r : 1 + r + rows, 1 + c : 1 + c + columns] - heights[1:-1, 1:-1])[inside]
        edges.append((dx, dy, dz))
    total = np.zeros((3, int(inside.sum())))
    for (ax, ay, az), (bx, by, bz) in zip(edges, edges[1:] + edges[:1], strict=True):
        normal = np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
        total += np.where(np.isfinite(normal).all(axis=0), normal, 0)
    total[2, ~total.any(axis=0)] = 1
    return total[0], total[1], total[2]


def energies(
    answers: Planes, normals: NDArray[np.float64] | None, suns: Suns, chosen: NDArray[np.int64]
) -> dict[str, NDArray[np.int64]]:
    """(n,) units of 2^UNIT of the Sun, of the sky and of both, where `answers` have the `chosen` suns. normals: (3, n);
    None: unknown, so each sun counts in full."""
    weights = np.ldexp(suns.weights[chosen].astype(np.float64), suns.exponent - UNIT)
    is_sky = suns.is_sky[chosen]
    direct, diffuse = (
        _gnomon.energy_sums(answers, normals, suns.true[chosen], np.where(is_counted, weights, 0))
        for is_counted in (~is_sky, is_sky)
    )
    return {"direct": direct, "diffuse": diffuse, "irradiation": direct + diffuse}


def kilowatt_hours(units: NDArray[np.int64]) -> NDArray[np.float64]:
    return np.asarray(np.ldexp(units.astype(np.float64), UNIT) / 1000)
