# SPDX-License-Identifier: MIT
"""Times lit shares of faces and a year of energy on a made town (docs/integrations.md). Needs gnomon[test,weather].
JSON lines. usage: time_sunlight.py [--triangles 50000] [--faces 1000] [--cells 100000] [--suns 4408]"""

import argparse
import json
import os
import time
from pathlib import Path

import gnomon
import numpy as np
import pvlib
from compare_ladybug import town
from gnomon import surfaces, weather


def timed(name, call, **more):
    start, processor = time.perf_counter(), sum(os.times()[:2])
    found = call()
    took = round(time.perf_counter() - start, 2), round(sum(os.times()[:2]) - processor, 2)
    print(json.dumps({"what": name, **more, "seconds": took[0], "processor_seconds": took[1]}), flush=True)
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    for name, value in (("triangles", 50_000), ("faces", 1_000), ("cells", 100_000), ("suns", 4_408)):
        parser.add_argument(f"--{name}", type=int, default=value)
    sizes = parser.parse_args()
    rng = np.random.default_rng(43)
    triangles, _, _ = town(sizes.triangles, rng)
    made = weather.read(Path(pvlib.__file__).parent / "data" / "723170TYA.CSV")
    azimuth, elevation = made.suns()
    directions = -weather.towards(azimuth, elevation)[elevation > 0]
    directions = directions[np.linspace(0, len(directions) - 1, sizes.suns).astype(int)]
    half = len(triangles) // 2  # a quad's two triangles lie half the table apart
    faces = np.full(len(triangles), -1)
    chosen = rng.permutation(half)[: sizes.faces]
    faces[chosen] = faces[chosen + half] = np.arange(sizes.faces)
    shares = timed("lit shares", lambda: surfaces.lit_fractions(triangles, directions, faces, within=0.01),
                   faces=sizes.faces, suns=len(directions), triangles=len(triangles))  # fmt: skip
    width = shares.high - shares.low
    print(json.dumps({"widest": width.max().item(), "mean": width.mean().item(), "lit": float(shares.low.mean())}))
    of, weights = rng.integers(0, len(triangles), sizes.cells), rng.dirichlet([1, 1, 1], sizes.cells)
    corners = triangles[of]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    points = (weights[:, :, None] * corners).sum(axis=1)
    order = np.lexsort(points.T)
    scene = gnomon.Scene(triangles)
    for _ in range(2):
        energy = timed("a year of energy", lambda: weather.irradiation(scene, points[order], normals[order], made),
                       cells=sizes.cells, triangles=len(triangles))  # fmt: skip
    print(json.dumps({"kWh/m2": np.percentile(energy.total, [0, 50, 100]).round(1).tolist()}))


if __name__ == "__main__":
    main()
