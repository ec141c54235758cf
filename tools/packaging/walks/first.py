# SPDX-License-Identifier: MIT
"""The first thing that a stranger does with the Python package: two points, and a picture (first.ppm)."""

import gnomon
import numpy as np

box = [[[0, 0, 1], [1, 0, 1], [0, 1, 1]], [[-3, -3, 0], [4, -3, 0], [4, 4, 0]], [[-3, -3, 0], [4, 4, 0], [-3, 4, 0]]]
scene = gnomon.Scene(np.float32(box))
print(scene.lit([[0.2, 0.2, 0.5], [2, 2, 0.5]], direction=(0, 0, -1)).tolist())
view = scene.view(eye=(2, -4, 4), target=(0.5, 0.5, 0.5), up=(0, 0, 1), size=(320, 180))
picture = view.image(direction=(0.3, 0.2, -1))[..., :3]
with open("first.ppm", "wb") as file:
    file.write(b"P6 320 180 255\n" + picture.tobytes())
