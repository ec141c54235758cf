# SPDX-License-Identifier: MIT
"""Solar energy on surfaces, from weather files: pip install 'gnomon[weather]' (docs/weather.md)."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._earth import EARTH_RADIUS
from ._files import on_disk
from ._lights import Lights
from ._scene import Scene
from ._side import Side
from ._weather_files import readings_of

#: Tregenza's sky: the patches of each of its rows, from the horizon up. A row is 12 degrees high, the last one patch.
PATCHES_OF_ROWS = (30, 30, 24, 24, 18, 12, 6, 1)
#: Each patch is decided in as many parts on a side: planes and walls cut patches.
PARTS = 2


@dataclass(frozen=True, eq=False)
class Weather:
    """A year, or a part of it, of solar radiation at a place, made by read(). Power is in W/m^2, a value an interval.

    name, latitude, longitude, elevation: the file's place; degrees north and east, metres.
    times: the middle of each interval, in the file's time zone and years (of a typical year each month has one).
    step: the length of an interval in hours.
    dni, dhi, ghi: (T,) the mean direct normal, diffuse and global horizontal irradiance of each interval.
    """

    name: str
    latitude: float
    longitude: float
    elevation: float
    times: Any
    step: float
    dni: NDArray[np.float64]
    dhi: NDArray[np.float64]
    ghi: NDArray[np.float64]

    def __repr__(self) -> str:
        years = sorted({int(y) for y in self.times.year})
        span = str(years[0]) if len(years) == 1 else f"months of {years[0]} to {years[-1]}"
        place = f"{self.name}, {self.latitude:g}, {self.longitude:g}"
        of = "hours" if self.step == 1 else f"intervals of {60 * self.step:g} minutes"
        return f"<gnomon.weather.Weather of {place}: {len(self.times):,} {of}, {span}, {self.times.tz}>"

    def require_near(self, latitude: float, longitude: float, within_km: float = 50.0) -> None:
        """ValueError if the file's place is farther away than that."""
        a, b, turn = np.radians([self.latitude, latitude, longitude - self.longitude])
        half = np.sin((b - a) / 2) ** 2 + np.cos(a) * np.cos(b) * np.sin(turn / 2) ** 2
        distance = 2 * EARTH_RADIUS / 1000 * float(np.arcsin(np.sqrt(np.clip(half, 0, 1))))
        if not distance <= within_km:
            raise ValueError(
                f"weather: {self.name} ({self.latitude:g}, {self.longitude:g}) is {distance:,.0f} km from the site "
                f"({latitude:g}, {longitude:g}), more than {within_km:g} km"
            )

    def suns(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(T,) azimuth, clockwise from true north, and true elevation of the Sun in degrees, by pvlib's SPA."""
        import pvlib

        found = pvlib.solarposition.get_solarposition(
            self.times, self.latitude, self.longitude, altitude=self.elevation, method="nrel_numpy"
        )
        return found["azimuth"].to_numpy(np.float64), found["elevation"].to_numpy(np.float64)

    def radiance(self, albedo: float = 0.0) -> NDArray[np.float64]:
        """(146, T) W/(m^2 sr) of the ground (row 0) and of the patches of Tregenza's sky by Perez' model, without the
        Sun: the matrix of Radiance's gendaymtx. It gives a horizontal plane the diffuse irradiance with the cosines of
        the patches' centres; here the sky is .55 % brighter, so that it does with their integrals."""
        import pyradiance

        zone = self.times[0].utcoffset().total_seconds() / 3600
        head = (f"place {self.name}\nlatitude {self.latitude}\nlongitude {-self.longitude}\ntime_zone {-15 * zone}\n"
                f"site_elevation {self.elevation}\nweather_data_file_units 1\n")  # fmt: skip
        hours = self.times.hour + self.times.minute / 60
        rows = zip(self.times.month, self.times.day, hours, self.dni.tolist(), self.dhi.tolist(), strict=True)
        text = head + "".join(f"{m} {d} {h:.6f} {direct:.9g} {diffuse:.9g}\n" for m, d, h, direct, diffuse in rows)
        raw = pyradiance.gendaymtx(text.encode(), header=False, sky_only=True, solar_radiance=True, outform="f",
                                   sky_color=[1, 1, 1], ground_color=[albedo] * 3)  # fmt: skip
        radiance = np.frombuffer(raw, np.float32).reshape(146, len(self.times), 3)[:, :, 0].astype(np.float64)
        vectors, patch = tregenza()
        horizontal = np.bincount(patch, vectors[:, 2]) @ radiance[1:]
        radiance[1:] *= np.where(horizontal > 0, self.dhi / np.where(horizontal > 0, horizontal, 1), 0)
        return radiance

    def on_plane(self, normal: ArrayLike, albedo: float = 0.0) -> PlaneIrradiance:
        """What an unobstructed plane gets in each interval. normal: towards its front; x east, y north, z up."""
        n = np.asarray(normal, np.float64)
        if n.shape != (3,) or not np.isfinite(n).all() or not n.any():
            raise ValueError(f"normal: must be three finite numbers, not all zero, not {normal!r}")
        n = n / np.linalg.norm(n)
        azimuth, elevation = self.suns()
        cosines = np.maximum(towards(azimuth, elevation) @ n, 0)
        radiance, (parts, patch) = self.radiance(albedo), tregenza()
        upper = np.bincount(patch, np.maximum(parts @ n, 0))
        lower = np.maximum(-parts @ n, 0).sum()
        return PlaneIrradiance(
            np.where(elevation > 0, self.dni * cosines, 0), upper @ radiance[1:], lower * radiance[0]
        )

    def write_suns(self, path: str | os.PathLike[str]) -> None:
        """The table of suns of `gnomon hours --directions` and of studies; its weights are Wh/m^2 of direct normal
        irradiation."""
        azimuth, elevation = self.suns()
        rows = zip(azimuth, elevation, self.dni * self.step, self.times, strict=True)
        lines = [f"{a:.9g},{e:.9g},{w:.9g},{t.isoformat()}\n" for a, e, w, t in rows if e > 0]
        Path(path).write_text("azimuth,elevation,weight,time\n" + "".join(lines))


class PlaneIrradiance(NamedTuple):
    """(T,) W/m^2 from the Sun, the sky and the ground, for each interval of a Weather."""

    direct: NDArray[np.float64]
    diffuse: NDArray[np.float64]
    ground: NDArray[np.float64]


class Irradiation(NamedTuple):
    """kWh/m^2 over all intervals, an array of the points' shape each; NaN where a point is NaN.

    direct, diffuse, ground: from the Sun, from the sky's patches, and from patches below the horizon (albedo=).
    total: their sum.
    left_out: kWh/m^2, direct normal, of intervals in whose middle the Sun is not above the horizon.
    """

    direct: NDArray[np.float64]
    diffuse: NDArray[np.float64]
    ground: NDArray[np.float64]
    total: NDArray[np.float64]
    left_out: float


def read(path: str | os.PathLike[str] | IO[bytes]) -> Weather:
    """The weather in a file that pvlib reads: EPW, TMY2, TMY3, PVGIS's typical year (CSV, JSON), NSRDB's CSV, of
    intervals of any length that divides a day; a file's name, or a binary file, such as a member of a ZipFile.
    ValueError with the column and the time of a value that is missing or cannot be."""
    with on_disk(path, "path") as file:
        found = readings_of(file.path)
    return Weather(*found.place, found.middles, found.step, found.dni, found.dhi, found.ghi)


def towards(azimuth: ArrayLike, elevation: ArrayLike) -> NDArray[np.float64]:
    """(..., 3) unit vectors, x east, y north, z up, of degrees clockwise from north and above the horizon. Angles as
    small as radians are taken for degrees: a low Sun has such, and an array has no heading that could name its unit, as
    a table of suns must."""
    a, e = np.radians(np.asarray(azimuth, np.float64)), np.radians(np.asarray(elevation, np.float64))
    return np.stack([np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e)], axis=-1)


def tregenza() -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Tregenza's 145 patches, in gendaymtx' order (row by row from the horizon, clockwise from north), in PARTS x PARTS
    parts each: (N, 3) the integral of the unit vectors to a part, over its solid angle; and (N,) its patch. A plane
    gets of a part in front of it the radiance times its normal's product with this vector."""
    vectors, patch_of, first = [], [], 0
    for row, count in enumerate(PATCHES_OF_ROWS):
        ends = np.radians(np.linspace(12 * row, min(12 * row + 12, 90), PARTS + 1))
        around = count * PARTS if count > 1 else 3 * PARTS
        k = np.arange(around)
        azimuth = ((k + 0.5) / around - (0.5 / count if count > 1 else 0)) * 2 * math.pi
        for low, high in zip(ends[:-1], ends[1:], strict=True):
            upwards = math.pi / around * (math.sin(high) ** 2 - math.sin(low) ** 2)
            outwards = (high - low) / 2 + (math.sin(2 * high) - math.sin(2 * low)) / 4
            outwards *= 2 * math.sin(math.pi / around)
            vectors.append(
                np.stack([outwards * np.sin(azimuth), outwards * np.cos(azimuth), np.full(around, upwards)], axis=1)
            )
            patch_of.append(first + k * count // around)
        first += count
    return np.concatenate(vectors), np.concatenate(patch_of)


def irradiation(
    scene: Scene,
    points: ArrayLike,
    normals: ArrayLike,
    weather: Weather,
    *,
    albedo: float = 0.0,
    up: str = "z",
    north: float = 0.0,
    progress: Callable[[float], object] | None = None,
) -> Irradiation:
    """The solar energy that surfaces get: from the Sun by each hour's direct normal irradiance, from the sky by Perez'
    radiance of Tregenza's 145 patches, of four parts each. Each sun and each part's middle is decided exactly, and has
    its cosine.

    points, normals: (..., 3) on the scene's surfaces, and their fronts' normals (or one for all). Points are snapped
        to a lattice and lifted off their surface (Scene.lit(lift=True)); those with a NaN get NaN.
    albedo: the share of light that ground beyond the scene reflects, the same from everywhere below the horizon. What
        the scene itself reflects is not computed.
    up: the axis that points up, "y" or "z"; north is then -z or y, turned by `north` degrees clockwise as seen from
        above.
    progress: as in Scene.lit_by(), from 0 to 1 for the Sun, then again for the sky.
    """
    if up not in ("y", "z"):
        raise ValueError(f"up: must be 'y' or 'z', not {up!r}")
    if not 0 <= albedo <= 1:
        raise ValueError(f"albedo: must be from 0 to 1, not {albedo!r}")
    if not isinstance(scene, Scene) or not isinstance(weather, Weather):
        raise TypeError(
            f"scene and weather: must be a gnomon.Scene and a Weather of read(), not {type(scene).__name__} and "
            f"{type(weather).__name__}"
        )
    positions, along = np.asarray(points, np.float64), np.asarray(normals, np.float64)
    if positions.shape[-1:] != (3,) or along.shape not in ((3,), positions.shape):
        raise ValueError(f"points and normals: shapes {positions.shape} and {along.shape} are not (..., 3) both")
    along = np.broadcast_to(along, positions.shape).reshape(-1, 3)
    flat = positions.reshape(-1, 3)
    there = np.flatnonzero(np.isfinite(flat).all(axis=1))
    length = np.linalg.norm(along[there], axis=1, keepdims=True)
    azimuth, elevation = weather.suns()
    is_up = elevation > 0
    parts, patch = tregenza()
    size = np.linalg.norm(parts, axis=1)
    energy = weather.radiance(albedo).sum(axis=1) * weather.step
    tables = [
        (towards(azimuth, elevation)[is_up], weather.dni[is_up] * weather.step),
        (parts, energy[1:][patch] * size),
        (-parts, energy[0] * size),
    ]
    on_lattice = scene._on_lattice(flat[there])
    side = Side.normals(along[there] / np.where(length > 0, length, 1))
    found = []
    for directions, weights in tables:
        values = np.full(len(flat), np.nan)
        values[there] = 0
        if there.size and np.any(weights):
            lights = Lights.directions(-turned(directions, up, north), weights / 1000)
            lit = on_lattice.lit_by(flat[there], lights, side=side, lift=True, cosines=True, progress=progress)
            values[there] = lit.sums
        found.append(values.reshape(positions.shape[:-1]))
    left_out = float((weather.dni[~is_up] * weather.step).sum() / 1000)
    direct, diffuse, ground = found
    return Irradiation(direct, diffuse, ground, direct + diffuse + ground, left_out)


def turned(directions: NDArray[np.float64], up: str, north: float) -> NDArray[np.float64]:
    """(M, 3) directions of x east, y north, z up in the axes of a scene whose axis `up`, "y" or "z", points up; its
    north is -z or y, turned by `north` degrees clockwise as seen from above."""
    turn = math.radians(north)
    x = directions[:, 0] * math.cos(turn) + directions[:, 1] * math.sin(turn)
    y = directions[:, 1] * math.cos(turn) - directions[:, 0] * math.sin(turn)
    z = directions[:, 2]
    return np.stack([x, y, z] if up == "z" else [x, z, -y], axis=1)
