#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes suns_of_pvlib.csv: the sun's positions by pvlib's SPA (Reda and Andreas, NREL/TP-560-34302), which the test of
gnomon hours is held against. pip install pvlib, then: python suns_of_pvlib.py > suns_of_pvlib.csv"""

import pandas as pd
import pvlib

PLACES = [(90, 0), (-90, 30), (89.99, 100), (0, 0), (52, 0), (-33.9, 151.2), (48.2, 16.4), (64.1, -21.9), (-54.8, -68.3)]
TIMES = [
    "1990-01-01T12:05Z", "2000-03-20T07:35Z", "2010-06-21T00:35Z", "2016-02-29T23:55Z", "2020-12-21T10:05Z",
    "2024-09-22T12:45Z", "2026-06-21T11:35Z", "2026-11-23T15:05Z", "2030-04-02T05:05Z",
]  # fmt: skip

print("latitude,longitude,time,azimuth,elevation,apparent_elevation")
for latitude, longitude in PLACES:
    times = pd.DatetimeIndex(TIMES)
    sun = pvlib.solarposition.spa_python(
        times, latitude, longitude, altitude=0, pressure=101000, temperature=10, delta_t=None, atmos_refract=0.5667
    )
    for time, row in zip(TIMES, sun.itertuples(), strict=True):
        print(f"{latitude},{longitude},{time},{row.azimuth:.6f},{row.elevation:.6f},{row.apparent_elevation:.6f}")
