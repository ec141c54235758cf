#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Times gnomon's Python package beside what Python users have today, on the same mesh and the same points.

    pip install '.[pocl]' trimesh embreex open3d
    python tools/compare_python.py [--houses 300] [--points 1000000] [--rounds 3]

A city of boxes on a plain, points a centimetre above the ground (where a ray that starts on it would meet it), one sun.
Each contestant answers which points see the sun:
gnomon exactly, also with this sun prepared (Scene.prepare), the others by a ray from each point. Rounds go by turns; the medians are printed, the mesh's structure
built anew in each round (build) and kept (again), and how many answers differ from gnomon's. A contestant that is not
installed is left out, loudly.
"""

from __future__ import annotations

import argparse
import importlib.util
import statistics
import time

import gnomon
import numpy as np

SUN = np.array([0.6, 0.35, -0.5])


def city(count: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """count x count houses, 12 triangles each, 20 m apart, and the ground under each: vertices and faces."""
    corner = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)], np.float32)
    box = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
                    [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])  # fmt: skip
    places = np.stack(np.meshgrid(np.arange(count), np.arange(count), indexing="ij"), -1).reshape(-1, 2) * 20
    sizes = rng.integers((8, 8, 4), (16, 16, 40), (len(places), 3))
    houses = corner * sizes[:, None] + np.concatenate([places, np.zeros((len(places), 1))], 1)[:, None]
    plots = (corner[::2] * [20, 20, 0])[None] + np.concatenate([places, np.zeros((len(places), 1))], 1)[:, None]
    first = np.arange(len(places))[:, None, None]
    plot = np.array([[0, 2, 3], [0, 3, 1]])
    faces = np.concatenate([(box + 8 * first).reshape(-1, 3), (plot + 4 * first + 8 * len(places)).reshape(-1, 3)])
    return np.concatenate([houses.reshape(-1, 3), plots.reshape(-1, 3)]).astype(np.float32), faces.astype(np.int32)


def of_gnomon(vertices, faces, points):
    def build():
        return gnomon.Scene(vertices, faces)

    return build, lambda scene: scene.lit(points, direction=SUN)


def of_prepared(vertices, faces, points):
    def build():
        scene = gnomon.Scene(vertices, faces)
        scene.prepare(direction=SUN)
        return scene

    return build, lambda scene: scene.lit(points, direction=SUN)


def of_open3d(vertices, faces, points):
    import open3d as o3d

    def build():
        scene = o3d.t.geometry.RaycastingScene()
        scene.add_triangles(o3d.core.Tensor(vertices), o3d.core.Tensor(faces.astype(np.uint32)))
        return scene

    rays = np.concatenate([points, np.broadcast_to(-SUN, points.shape)], 1).astype(np.float32)
    return build, lambda scene: ~scene.test_occlusions(o3d.core.Tensor(rays)).numpy()


def of_embreex(vertices, faces, points):
    import trimesh
    from trimesh.ray.ray_pyembree import RayMeshIntersector

    def build():
        return RayMeshIntersector(trimesh.Trimesh(vertices, faces, process=False))

    towards = np.broadcast_to(-SUN, points.shape)
    return build, lambda scene: ~scene.intersects_any(points, towards)


CONTESTANTS = {"gnomon": of_gnomon, "prepared": of_prepared, "open3d": of_open3d, "embreex": of_embreex}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--houses", type=int, default=300, help="houses per side of the city")
    parser.add_argument("--points", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--order", choices=["rows", "random"], default="rows", help="of the points: a grid's, or none")
    options = parser.parse_args()
    rng = np.random.default_rng(1)
    vertices, faces = city(options.houses, rng)
    points = np.zeros((options.points, 3), np.float32)
    points[:, :2] = rng.random((options.points, 2)) * 20 * options.houses
    points[:, 2] = 0.01
    if options.order == "rows":
        side = int(options.points**0.5)
        grid = np.arange(side, dtype=np.float32) * (20 * options.houses / side) + np.float32(0.37)  # on no wall
        points = np.stack([*np.meshgrid(grid, grid), np.full((side, side), 0.01, np.float32)], -1).reshape(-1, 3)
    print(f"{len(faces):,} triangles, {len(points):,} points, {options.order} order, {gnomon.use()!r}")

    found, times, answers = {}, {}, {}
    for name, make in CONTESTANTS.items():
        if name not in ("gnomon", "prepared") and importlib.util.find_spec(name) is None:
            print(f"{name}: not installed, left out")
            continue
        found[name] = make(vertices, faces, points)
        times[name] = {"build": [], "first": [], "again": []}
    found["gnomon"][1](found["gnomon"][0]())  # compiles the kernels
    for _ in range(options.rounds):
        for name, (build, run) in found.items():
            clock = [time.perf_counter()]
            scene = build()
            clock.append(time.perf_counter())
            run(scene)
            clock.append(time.perf_counter())
            answers[name] = run(scene)
            clock.append(time.perf_counter())
            for key, seconds in zip(times[name], np.diff(clock), strict=True):
                times[name][key].append(1000 * seconds)

    truth = answers["gnomon"]
    print(f"{truth.mean():.1%} of the points are lit\n")
    print(f"{'ms':10}{'build':>10}{'first':>10}{'again':>10}{'build+first':>13}{'differ':>9}")
    for name, columns in times.items():
        build, first, again = (statistics.median(columns[key]) for key in ("build", "first", "again"))
        differ = int((answers[name] != truth).sum())
        print(f"{name:10}{build:10.0f}{first:10.0f}{again:10.0f}{build + first:13.0f}{differ:9,}")


if __name__ == "__main__":
    main()
