# SPDX-License-Identifier: MIT
"""gnomon on arrays of pyopencl, which a kernel of the program's own has made: gnomon copies none of them."""

# README begins
import gnomon
import numpy as np
import pyopencl as cl
import pyopencl.array

source = """__kernel void make_grid(__global float* xyz) {
    int i = get_global_id(0);
    vstore3((float3)(0.5f * (i % 256) - 64, 0.5f * (i / 256) - 64, 0), i, xyz); }"""
queue = cl.CommandQueue(cl.create_some_context(interactive=False))
points = cl.array.empty(queue, (256 * 256, 3), np.float32)  # a grid with steps of half a metre
cl.Program(queue.context, source).build().make_grid(queue, (256 * 256,), None, points.data)
roof = np.float32([[[-32, -32, 8], [32, -32, 8], [32, 32, 8]], [[-32, -32, 8], [32, 32, 8], [-32, 32, 8]]])
scene = gnomon.Scene(cl.array.to_device(queue, roof))
lit = scene.lit(points, direction=(0, 0, -1))  # a pyopencl array of float32: 1 lit, 0 in shadow
# README ends

count = int(lit.get().sum())
print(count, "of", len(points), "points are in the light")
assert isinstance(lit, cl.array.Array) and lit.queue == queue
assert count == 256 * 256 - 129 * 129  # 129 points from -32 to 32 m: those under an edge are in shadow, too
