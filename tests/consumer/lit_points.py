# SPDX-License-Identifier: MIT
"""Which of these points does the sun reach? example.cpp in Python: a roof, three points under and beside it."""

# README begins
import gnomon
import numpy as np

corners = np.array([[-1, -1, 2], [1, -1, 2], [1, 1, 2], [-1, 1, 2]])  # a square roof, 2 m wide, 2 m above the ground
faces = [[0, 1, 2], [0, 2, 3]]
points = np.array([[0, 0, 0], [1, 0, 0], [1.125, 0, 0]])  # under its middle, under its edge, beside it
roof = gnomon.Scene(corners, faces)
lit = roof.lit(points, direction=(0, 0, -1))  # False, False, True: an edge blocks, it is part of the roof
# README ends

for point, is_lit in zip(points, lit, strict=True):
    print(point, "is in the light" if is_lit else "is in shadow")
assert lit.tolist() == [False, False, True]
