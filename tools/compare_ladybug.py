# SPDX-License-Identifier: MIT
"""Times gnomon.integrations.ladybug against ladybug-radiance's own function, which runs pyradiance's oconv and
rcontrib: a made town, sensors on its ground and roofs, hourly suns of a year, by turns. Needs gnomon[test]. JSON lines.
usage: compare_ladybug.py [--triangles 50000] [--sensors 10000] [--suns 4380] [--rounds 1] [--differing 30]"""

import argparse
import json
import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pyradiance

RADIANCE = Path(pyradiance.__file__).parent
os.environ.update(BINPATH=str(RADIANCE / "bin"), RAYPATH=str(RADIANCE / "lib"))

import gnomon  # noqa: E402
from gnomon._gnomon import WorldLattice  # noqa: E402
from gnomon.integrations import ladybug  # noqa: E402
from ladybug.location import Location  # noqa: E402
from ladybug.sunpath import Sunpath  # noqa: E402
from ladybug_geometry.geometry3d import Mesh3D, Point3D, Vector3D  # noqa: E402
from ladybug_radiance.intersection import intersection_matrix  # noqa: E402

sys.path.append(str(Path(__file__).parents[1] / "tests/python"))
import oracle  # noqa: E402

OFFSET = 0.01  # metres from the surface, as Ladybug's components have it


def town(count, rng):
    """(triangles, corners of roofs, extent): some `count` triangles of houses without floors, 10 each."""
    houses = max(count // 10, 1)
    side = int(np.ceil(np.sqrt(houses)))
    x, y = (20.0 * v.reshape(-1)[:houses] for v in np.meshgrid(np.arange(side), np.arange(side), indexing="ij"))
    w, d, h = rng.uniform([6, 6, 4], [16, 16, 30], (houses, 3)).round(2).T
    low = np.stack([np.stack([x + a * w, y + b * d, 0 * x], 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))], 1)
    top = low + np.stack([0 * h, 0 * h, h], 1)[:, None]
    corners = np.concatenate([low, top], 1)
    faces = np.array([[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [4, 5, 6, 7]])
    quads = corners[:, faces].reshape(-1, 4, 3)
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]), top, 20.0 * side


def suns_of_a_year(count):
    path = Sunpath.from_location(Location("Vienna", latitude=48.2, longitude=16.4, time_zone=1))
    suns = [path.calculate_sun_from_hoy(hour + 0.5) for hour in range(8760)]
    suns = [sun.sun_vector_reversed for sun in suns if sun.altitude > 0]
    return [suns[i] for i in np.linspace(0, len(suns) - 1, count).astype(int)]


def sensors_of(count, tops, extent, rng):
    ground = np.c_[rng.uniform(0, extent, (count // 2, 2)), np.zeros(count // 2)]
    house = rng.integers(0, len(tops), count - count // 2)
    share = rng.random((len(house), 2))
    corner, along, across = tops[house, 0], tops[house, 1] - tops[house, 0], tops[house, 3] - tops[house, 0]
    return np.concatenate([ground, corner + share[:, :1] * along + share[:, 1:] * across])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    for name, value in (("triangles", 50_000), ("sensors", 10_000), ("suns", 4_380), ("rounds", 1), ("differing", 30)):
        parser.add_argument(f"--{name}", type=int, default=value)
    sizes = parser.parse_args()
    rng = np.random.default_rng(43)
    triangles, tops, extent = town(sizes.triangles, rng)
    mesh = Mesh3D([Point3D(*v) for v in triangles.reshape(-1, 3).tolist()],
                  [(i, i + 1, i + 2) for i in range(0, 3 * len(triangles), 3)])  # fmt: skip
    suns = suns_of_a_year(sizes.suns)
    sensors = sensors_of(sizes.sensors, tops, extent, rng)
    points, up = [Point3D(*v) for v in sensors.tolist()], [Vector3D(0, 0, 1)] * len(sensors)
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        ways = {"gnomon": ladybug.intersection_matrix, "ladybug-radiance": intersection_matrix}
        for turn in range(sizes.rounds):
            for name, way in ways.items():
                start, processor = time.perf_counter(), sum(os.times()[:4])
                found[name] = way(suns, points, up, [mesh], OFFSET, False, folder)
                took = time.perf_counter() - start, sum(os.times()[:4]) - processor
                print(json.dumps({"round": turn, "way": name, "seconds": round(took[0], 2),
                                  "processor_seconds": round(took[1], 2)}), flush=True)  # fmt: skip
    differs = np.argwhere(found["gnomon"] != found["ladybug-radiance"])
    height = np.array([sun.z for sun in suns])
    dropped = height[differs[:, 1]] < 0.01472
    judged = rng.permutation(differs[~dropped])[: sizes.differing]
    raised = sensors + [0, 0, OFFSET]
    step = WorldLattice.fit(np.concatenate([triangles.reshape(-1, 3), raised])).step  # as the adapter does
    lattice = gnomon.Scene(triangles, lattice=step).lattice
    models = {"as_given": (triangles, raised),
              "as_snapped": (lattice.triangles, lattice.snap(raised, "points", np.tile([0.0, 0, 1], (len(raised), 1))))}
    right = dict.fromkeys(models, 0)
    for row, sun in judged.tolist():
        for name, (mesh_of_model, places) in models.items():
            exact = oracle.lit(mesh_of_model, places[[row]], direction=-np.array(suns[sun].to_array()))
            right[name] += int(exact[0] == found["gnomon"][row, sun])
    print(json.dumps({"triangles": len(triangles), "pairs": found["gnomon"].size, "lit": int(found["gnomon"].sum()),
                      "differ": len(differs), "of_them_suns_that_radiance_drops": int(dropped.sum()),
                      "judged_exactly": len(judged), "lattice": step, "gnomon_right": right}))  # fmt: skip


if __name__ == "__main__":
    main()
