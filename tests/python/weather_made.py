# SPDX-License-Identifier: MIT
"""Made weather files."""

import numpy as np
import pandas
import pvlib


def write_epw(path, latitude=48.2, longitude=16.4, zone=1.0, year=2019, days=365, change=lambda table: table):
    """A made EPW file of clear sky. `change` takes the rows, 35 columns of text each."""
    times = pandas.date_range(f"{year}-01-01 00:30", periods=24 * days, freq="h", tz=f"Etc/GMT{-int(zone):+d}")
    clear = pvlib.location.Location(latitude, longitude).get_clearsky(times, model="haurwitz")["ghi"].to_numpy()
    zenith = pvlib.solarposition.get_solarposition(times, latitude, longitude)["zenith"].to_numpy()
    dhi = 0.25 * clear
    dni = np.where(zenith < 87, (clear - dhi) / np.maximum(np.cos(np.radians(zenith)), 0.05), 0)
    rows = []
    for t, values in zip(times, np.stack([clear, dni, dhi], 1).round(1), strict=True):
        rows.append([str(t.year), str(t.month), str(t.day), str(t.hour + 1), "0", "?9", *["9"] * 7,
                     *map(str, values), *["0"] * 19])  # fmt: skip
    head = [f"LOCATION,Made,-,AUT,made,110350,{latitude},{longitude},{zone},170.0", "DESIGN CONDITIONS,0",
            "TYPICAL/EXTREME PERIODS,0", "GROUND TEMPERATURES,0", "HOLIDAYS/DAYLIGHT SAVINGS,No,0,0,0", "COMMENTS 1,",
            "COMMENTS 2,", "DATA PERIODS,1,1,Data,Sunday,1/1,12/31"]  # fmt: skip
    path.write_text("\n".join(head + [",".join(row) for row in change(rows)]) + "\n")
    return path
