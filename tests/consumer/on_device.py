# SPDX-License-Identifier: MIT
"""gnomon on arrays of pyopencl: points and answers stay on the device, and one number is copied to the host."""

import numpy as np

import gnomon

# README begins
import pyopencl as cl
import pyopencl.array
import pyopencl.clmath

queue = cl.CommandQueue(cl.create_some_context(interactive=False))
corners = np.float32([[-32, -32, 8], [32, -32, 8], [32, 32, 8], [-32, 32, 8]])  # a square roof, 8 m above the ground
scene = gnomon.Scene(cl.array.to_device(queue, corners[[[0, 1, 2], [0, 2, 3]]]))
points = cl.array.zeros(queue, (256 * 256, 3), np.float32)  # a grid with steps of half a metre, made on the device
number = cl.array.arange(queue, 256 * 256, dtype=np.float32)
row = pyopencl.clmath.floor(number / 256)
points[:, 0], points[:, 1] = 0.5 * (number - 256 * row) - 64, 0.5 * row - 64
lit = scene.lit(points, direction=(0, 0, -1))  # a pyopencl array of float32: 1 lit, 0 in shadow
count = cl.array.sum(lit)  # on the device, too
# README ends

print(int(count.get()), "of", len(points), "points are in the light")
assert isinstance(lit, cl.array.Array) and lit.queue == queue
assert int(count.get()) == 256 * 256 - 129 * 129  # 129 points from -32 to 32; those under an edge are in shadow
