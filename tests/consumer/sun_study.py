# SPDX-License-Identifier: MIT
"""Hours of sun around a tower, from a height raster. Writes into the current folder."""

import numpy as np
import rasterio

heights = np.zeros((80, 60), np.float32)  # cells of 1 m near Munich, row 0 in the north
heights[38:42, 28:32] = 20  # a tower of 20 m
with rasterio.open("dsm.tif", "w", driver="GTiff", width=60, height=80, count=1, dtype="float32", crs="EPSG:25832",
                   transform=rasterio.Affine(1, 0, 691_000, 0, -1, 5_335_000)) as file:  # fmt: skip
    file.write(heights, 1)

# README begins
import gnomon
town = gnomon.study("town", raster="dsm.tif", start="2026-03-20", end="2026-03-21", step="30min", utc_offset=1)
town.picture("town.png")                                   # a map with a legend
town.export("sun_hours.tif")                               # a cloud-optimised GeoTIFF, for QGIS
hours = town.dataset().sun_hours                           # xarray, read as it is needed
print(f"{float(hours.mean()):.1f} hours of sun on average, {town.record['undecided']} answers undecided")
assert town.verify(share=1).is_good                        # computed again: the same bits
# README ends

# At the equinox the sun stands 3 degrees high or higher in the middle of 23 half-hours. It never stands north of east and
# west, and the tip of the tower's shadow moves along a straight line, 20 m * tan(48.15 degrees) = 22.3 m north of it.
assert (hours[43:] == 11.5).all()
assert (hours[16] < 11.5).any() and (hours[:14] == 11.5).all()  # 22 m north; 25 m and more
