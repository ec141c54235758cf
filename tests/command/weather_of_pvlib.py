#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes weather_of_pvlib.csv, three days of the TMY3 table of Greensboro that pvlib ships, and weather_of_pvlib.json,
the direct irradiance of their hours on planes by pvlib. pip install pvlib, then: python weather_of_pvlib.py FOLDER"""

import json
import sys
from pathlib import Path

import pandas as pd
import pvlib

FOLDER = Path(sys.argv[1])
PLANES = [(0, 0), (35, 180), (90, 180), (90, 97), (60, 300), (20, 45), (110, 10)]  # tilt, azimuth in degrees

table = (Path(pvlib.__file__).parent / "data" / "723170TYA.CSV").read_text().splitlines()
days = [line for line in table[2:] if line[:5] in ("01/02", "06/21", "10/09")]
(FOLDER / "weather_of_pvlib.csv").write_text("\n".join(table[:2] + days) + "\n")

rows = [line.split(",") for line in days]
middles = pd.DatetimeIndex([pd.Timestamp(row[0]) + pd.Timedelta(hours=int(row[1][:2]) - 0.5) for row in rows])
zone, latitude, longitude = (float(cell) for cell in table[0].split(",")[3:6])
sun = pvlib.solarposition.spa_python(middles.tz_localize(int(3600 * zone)), latitude, longitude, delta_t=None)
hours = []
for time, row, azimuth, zenith in zip(middles, rows, sun["azimuth"], sun["zenith"], strict=True):
    dni = float(row[7])
    if dni > 0:
        beam = [round(float(pvlib.irradiance.beam_component(t, a, zenith, azimuth, dni)), 3) for t, a in PLANES]
        hours.append({"time": f"{time:%Y-%m-%dT%H:%M:%S}-05:00", "dni": dni, "beam": beam})
text = ",\n".join(json.dumps(hour) for hour in hours)
(FOLDER / "weather_of_pvlib.json").write_text(f'{{"planes": {json.dumps(PLANES)}, "hours": [\n{text}]}}\n')
