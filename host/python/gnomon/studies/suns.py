# SPDX-License-Identifier: MIT
"""Suns: a table of directions for each sun zone, made once for a study and kept beside its results.

A zone is a square of the map, fixed in world coordinates; its suns are those of its centre. The direction in the map's
coordinates follows from azimuth and elevation at the centre (pvlib's SPA) and from the meridian convergence there
(pyproj): azimuth on the map = azimuth from true north - convergence. It is rounded once to float32.
"""

from __future__ import annotations

import dataclasses
import datetime
import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .settings import Settings

#: Angle across the sun's disk as seen from the Earth, in degrees.
SUN_ANGLE = 0.533
#: Whole weights of all suns together stay below this, as in gnomon's many lights.
LARGEST_SUM = 2.0**62


@dataclasses.dataclass
class Suns:
    """The suns of a study: Z zones, M suns in W words of up to 32 bits.

    zones: (Z, 2) int64: floor(x / size), floor(y / size). size: of a zone, in metres.
    towards: (Z, M, 3) float32, unit vectors to the sun in the map's coordinates; NaN where a sun is left out.
    word, bit: (M,) int64: where a sun's answers stand. word_count: W.
    seconds: (M,) int64: the time that a sun stands for. samples: each sun of the sky is this many suns of the table.
    weights: (M,) int64, in units of 2^exponent; all 0 where there are none.
    times: (M,) the middle of each step, ISO 8601 in local time; empty for tables of directions.
    is_hourly: word = 24 x (month - 1) + hour, bit = day - 1.
    notes: what to know about them, for the record.
    """

    zones: NDArray[np.int64]
    size: float
    towards: NDArray[np.float32]
    word: NDArray[np.int64]
    bit: NDArray[np.int64]
    word_count: int
    seconds: NDArray[np.int64]
    samples: int
    weights: NDArray[np.int64]
    exponent: int
    times: list[str]
    is_hourly: bool
    notes: dict[str, Any]

    def save(self, path: Path) -> None:
        fields = {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}
        notes = fields.pop("notes")
        with path.open("wb") as file:
            np.savez_compressed(file, **fields, note_keys=list(notes), note_values=[repr(v) for v in notes.values()])

    @classmethod
    def load(cls, path: Path) -> Suns:
        with np.load(path) as data:
            arrays = ("zones", "towards", "word", "bit", "seconds", "weights")
            return cls(
                **{name: data[name] for name in arrays},
                size=float(data["size"]),
                word_count=int(data["word_count"]),
                samples=int(data["samples"]),
                exponent=int(data["exponent"]),
                times=[str(t) for t in data["times"]],
                is_hourly=bool(data["is_hourly"]),
                notes=dict(zip(map(str, data["note_keys"]), map(str, data["note_values"]), strict=True)),
            )

    def zone_row(self, zone: tuple[int, int]) -> int:
        found = np.flatnonzero((self.zones == zone).all(axis=1))
        if not found.size:
            raise ValueError(f"receivers: a point lies in the sun zone {zone}, outside of the study's extent")
        return int(found[0])

    def centre(self, zone: tuple[int, int]) -> tuple[float, float]:
        return (zone[0] + 0.5) * self.size, (zone[1] + 0.5) * self.size

    def blocks(self, about: int) -> list[NDArray[np.int64]]:
        """The words, divided into blocks of about so many suns. Hourly words go by hour, then month: the suns of a
        block stand near each other, and so do the casters that matter. Words without suns are in no block."""
        up = np.isfinite(self.towards[:, :, 0]).any(axis=0)
        count = np.bincount(self.word[up], minlength=self.word_count)
        order = np.arange(self.word_count)
        if self.is_hourly:
            order = order.reshape(12, 24).T.reshape(-1)
        order = order[count[order] > 0]
        blocks, first, suns = [], 0, 0
        for i, word in enumerate(order):
            suns += int(count[word])
            if suns >= about or i + 1 == len(order):
                blocks.append(order[first : i + 1])
                first, suns = i + 1, 0
        return blocks


def zone_of(x: Any, y: Any, size: float) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The zones of coordinates: a point on a border belongs to the zone in the east or north."""
    return np.floor(np.asarray(x) / size).astype(np.int64), np.floor(np.asarray(y) / size).astype(np.int64)


def zones_of_box(box: tuple[float, float, float, float], size: float) -> NDArray[np.int64]:
    """(Z, 2) all zones that the box x0, y0, x1, y1 meets."""
    i, j = zone_of(np.array(box[::2]), np.array(box[1::2]), size)
    grid = np.meshgrid(np.arange(i[0], i[1] + 1), np.arange(j[0], j[1] + 1), indexing="ij")
    return np.stack(grid, axis=-1).reshape(-1, 2)


# ---- Times -----------------------------------------------------------------------------------------------------------


def _moment(text: str, name: str, offset: datetime.timedelta) -> datetime.datetime:
    """A moment in local time."""
    try:
        parsed = datetime.datetime.fromisoformat(text.replace("Z", "+00:00"))
    except ValueError:
        raise ValueError(f"{name}: {text!r} is not a time such as 2026-06-21T06:00 (ISO 8601)") from None
    local = datetime.timezone(offset)
    return parsed.replace(tzinfo=local) if parsed.tzinfo is None else parsed.astimezone(local)


def _middles(s: Settings) -> list[datetime.datetime]:
    """The middle of each step, in local time. The last step ends at `end` or before."""
    assert s.start is not None and s.end is not None
    offset = datetime.timedelta(hours=s.utc_offset)
    start, end = _moment(s.start, "start", offset), _moment(s.end, "end", offset)
    step = datetime.timedelta(seconds=round(s.step * 60))
    count = (end - start) // step
    if count < 1:
        raise ValueError(f"end: {s.end} is not a step of {s.step:g} minutes after start, {s.start}")
    return [start + step * i + step / 2 for i in range(count)]


def _azimuth_and_elevation(
    s: Settings, times: list[datetime.datetime], longitude: float, latitude: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """In degrees: azimuth clockwise from true north, and the elevation, true or apparent as the settings say."""
    import pandas
    import pvlib

    moments = pandas.DatetimeIndex([t.astimezone(datetime.timezone.utc) for t in times])
    found = pvlib.solarposition.spa_python(
        moments, latitude, longitude, altitude=0, pressure=s.pressure, temperature=s.temperature, delta_t=None,
        atmos_refract=0.5667,
    )  # fmt: skip
    column = "apparent_elevation" if s.elevation == "apparent" else "elevation"
    return found["azimuth"].to_numpy(np.float64), found[column].to_numpy(np.float64)


class _Map:
    """Longitude, latitude and convergence of the map's points."""

    def __init__(self, crs: str | None) -> None:
        import pyproj

        if crs is None:
            raise ValueError("crs: the sun's place needs one: the raster has none, so give crs= (or directions=)")
        try:
            known = pyproj.CRS.from_user_input(crs)
        except pyproj.exceptions.CRSError as error:
            raise ValueError(f"crs: {error}") from None
        units = {axis.unit_name for axis in known.axis_info[:2]}
        if not known.is_projected or units != {"metre"}:
            raise ValueError(f"crs: {known.name} is not a map in metres: use UTM or a national grid")
        self._projection = pyproj.Proj(known)
        self._to_degrees = pyproj.Transformer.from_crs(known, "EPSG:4326", always_xy=True)

    def longitude_and_latitude(self, x: float, y: float) -> tuple[float, float]:
        longitude, latitude = self._to_degrees.transform(x, y)
        if not (math.isfinite(longitude) and math.isfinite(latitude)):
            raise ValueError(f"crs: it has no place for the zone's centre ({x:.0f}, {y:.0f}): is it the raster's?")
        return longitude, latitude

    def factors(self, x: float, y: float) -> Any:
        longitude, latitude = self._projection(x, y, inverse=True)  # on the CRS's own datum
        return self._projection.get_factors(longitude, latitude)


def _towards(
    s: Settings, at: _Map, times: list[datetime.datetime], x: float, y: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(M, 3) unit vectors to the suns in the map's coordinates, and elevations in degrees."""
    azimuth, elevation = _azimuth_and_elevation(s, times, *at.longitude_and_latitude(x, y))
    a, e = np.radians(azimuth - at.factors(x, y).meridian_convergence), np.radians(elevation)
    return np.stack([np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e)], axis=1), elevation


def on_disk(towards: NDArray[np.float64], samples: int) -> NDArray[np.float64]:
    """(M x samples, 3) directions on the sun's disk around each of (M, 3): the i-th lies sqrt((i + 1/2) / samples) of
    the radius from the centre, i golden angles around it (gnomon::sun_disk)."""
    horizontal = np.stack([-towards[:, 1], towards[:, 0], 0 * towards[:, 0]], axis=1)
    horizontal[(horizontal == 0).all(axis=1)] = (1, 0, 0)
    u = horizontal / np.linalg.norm(horizontal, axis=1, keepdims=True)
    v = np.cross(towards, u)
    i = np.arange(samples)
    r = math.tan(math.radians(SUN_ANGLE / 2)) * np.sqrt((i + 0.5) / samples)
    turn = math.pi * (3 - math.sqrt(5)) * i
    around = r[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    return (towards[:, None] + around[:, :1] * u[:, None] + around[:, 1:] * v[:, None]).reshape(-1, 3)


def _is_hourly(times: list[datetime.datetime], s: Settings) -> bool:
    return s.step == 60 and len({t.year for t in times}) == 1


def suns_of(s: Settings, crs: str | None, box: tuple[float, float, float, float]) -> Suns:
    """The suns of all zones that meet the receivers' box x0, y0, x1, y1. Raises ValueError."""
    zones = zones_of_box(box, s.zone)
    if s.start is None:
        return _suns_of_table(s, zones)
    times = _middles(s)
    at = _Map(s.crs or crs)
    directions = np.full((len(zones), len(times), 3), np.nan)
    for row, zone in enumerate(zones):
        found, elevation = _towards(s, at, times, (zone[0] + 0.5) * s.zone, (zone[1] + 0.5) * s.zone)
        directions[row] = np.where((elevation >= s.min_elevation)[:, None], found, np.nan)
    counted = np.isfinite(directions[:, :, 0])
    if not counted.any():
        raise ValueError(f"suns: no sun of {s.start} to {s.end} is {s.min_elevation:g} degrees above the horizon")
    if _is_hourly(times, s):
        word = np.array([24 * (t.month - 1) + t.hour for t in times])
        bit = np.array([t.day - 1 for t in times])
        word_count = 12 * 24
    else:
        word, bit = np.arange(len(times)) // 32, np.arange(len(times)) % 32
        word_count = -(-len(times) // 32)
    whole, exponent = whole_weights(_column(s.weights, len(times)) if s.weights else np.zeros(len(times)))
    samples = max(s.sun_disk, 1)
    if s.sun_disk:
        directions = np.stack([on_disk(zone, samples) for zone in directions])
    return Suns(
        zones=zones,
        size=s.zone,
        towards=directions.astype(np.float32),
        word=np.repeat(word, samples),
        bit=np.repeat(bit, samples),
        word_count=word_count,
        seconds=np.full(len(times) * samples, round(s.step * 60)),
        samples=samples,
        weights=np.repeat(whole, samples),
        exponent=exponent,
        times=[t.isoformat() for t in times],
        is_hourly=_is_hourly(times, s),
        notes=_notes(s, at, times, zones, counted),
    )


def _notes(
    s: Settings, at: _Map, times: list[datetime.datetime], zones: NDArray[np.int64], counted: NDArray[np.bool_]
) -> dict[str, Any]:
    """How far the suns of a zone's centre are off in its corners, found in the first, the middle and the last zone."""
    worst, distortion = 0.0, 0.0
    chosen = np.flatnonzero(counted.any(axis=0))
    some = [times[i] for i in chosen[:: max(1, len(chosen) // 64)]]
    for i, j in zones[sorted({0, len(zones) // 2, len(zones) - 1})]:
        x, y = (i + 0.5) * s.zone, (j + 0.5) * s.zone
        middle = _towards(s, at, some, x, y)[0]
        distortion = max(distortion, at.factors(x, y).angular_distortion)
        for dx in (-0.5, 0.5):
            for dy in (-0.5, 0.5):
                corner = _towards(s, at, some, x + dx * s.zone, y + dy * s.zone)[0]
                sine = np.linalg.norm(np.cross(middle, corner), axis=1)
                worst = max(worst, float(np.degrees(np.arcsin(np.minimum(sine, 1))).max(initial=0)))
    tip = 100 * math.radians(worst) / math.sin(math.radians(s.min_elevation)) ** 2
    return {
        "position": "pvlib's SPA (NREL/TP-560-34302) at the zone's centre, height 0",
        "elevation": s.elevation,
        "refraction": f"{s.pressure:g} Pa, {s.temperature:g} C" if s.elevation == "apparent" else "none",
        "suns": len(times),
        "suns_left_out": int((~counted.any(axis=0)).sum()),
        "min_elevation": s.min_elevation,
        "error_across_a_zone_degrees": worst,
        "error_across_a_zone_metres": f"{tip:.3g} at the shadow's tip of a caster of 100 m at {s.min_elevation:g} deg",
        "angular_distortion_of_the_map_degrees": distortion,
    }


# ---- Tables ----------------------------------------------------------------------------------------------------------


def read_table(name: str, columns: tuple[int, ...]) -> NDArray[np.float64]:
    """A .npy file, or a .csv file with a heading, as (N, C) float64, C one of `columns`."""
    try:
        if name.endswith(".npy"):
            values = np.asarray(np.load(name, allow_pickle=False), np.float64)
        else:
            values = np.loadtxt(name, delimiter=",", skiprows=1, ndmin=2, dtype=np.float64)
    except (ValueError, OSError, EOFError) as error:
        raise ValueError(f"{name}: {error}") from None
    if values.ndim == 1:
        values = values[:, None]
    if values.ndim != 2 or values.shape[1] not in columns:
        raise ValueError(f"{name}: shape {values.shape} has not {' or '.join(map(str, columns))} columns")
    bad = np.flatnonzero(~np.isfinite(values).all(axis=1))
    if bad.size:
        raise ValueError(f"{name}: row {bad[0]} {values[bad[0]].tolist()} is not finite")
    return values


def _column(name: str, count: int) -> NDArray[np.float64]:
    values = read_table(name, (1,))[:, 0]
    if len(values) != count:
        raise ValueError(f"{name}: {len(values)} weights are not {count}, one per sun of start..end")
    return values


def whole_weights(weights: NDArray[np.float64]) -> tuple[NDArray[np.int64], int]:
    """Each weight rounded once to a whole number times 2^exponent, which depends on the largest and on the number of
    weights alone. All of them together stay below 2^62."""
    largest = float(np.abs(weights).max(initial=0))
    if largest == 0:
        return np.zeros(len(weights), np.int64), 0
    exponent = math.frexp(largest)[1] + math.ceil(math.log2(len(weights) + 1)) - 62
    return np.rint(np.ldexp(weights, -exponent)).astype(np.int64), exponent


def _sky(division: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Directions to the centres of Tregenza's patches, each divided, north first, and their weights: the
    integral of the cosine of the angle to the zenith over the patch, over pi (gnomon::sky_patches)."""
    height = math.radians(90 / (7 * division + 0.5))
    towards, weights = [], []
    for row in range(7 * division):
        count = (30, 30, 24, 24, 18, 12, 6)[row // division] * division
        low, high = row * height, (row + 1) * height
        azimuth = 2 * math.pi * np.arange(count) / count
        middle = (low + high) / 2
        up = np.full(count, math.sin(middle))
        towards.append(np.stack([math.cos(middle) * np.sin(azimuth), math.cos(middle) * np.cos(azimuth), up], axis=1))
        weights.append(np.full(count, (math.sin(high) ** 2 - math.sin(low) ** 2) / count))
    cap = 1 - math.sin(7 * division * height) ** 2
    return np.concatenate([*towards, [[0.0, 0.0, 1.0]]]), np.concatenate([*weights, [cap]])


def _suns_of_table(s: Settings, zones: NDArray[np.int64]) -> Suns:
    if s.sky:
        towards, weights = _sky(s.sky)
    else:
        assert s.directions is not None
        table = read_table(s.directions, (3, 4))
        towards, weights = -table[:, :3], table[:, 3] if table.shape[1] == 4 else np.ones(len(table))
        length = np.linalg.norm(towards, axis=1)
        bad = np.flatnonzero((length == 0) | (towards[:, 2] <= 0))
        if bad.size:
            row = int(bad[0])
            raise ValueError(f"{s.directions}: row {row} {table[row].tolist()} does not travel downwards")
    count = len(towards)
    whole, exponent = whole_weights(weights)
    return Suns(
        zones=zones,
        size=s.zone,
        towards=np.broadcast_to(towards.astype(np.float32), (len(zones), count, 3)).copy(),
        word=np.arange(count) // 32,
        bit=np.arange(count) % 32,
        word_count=-(-count // 32),
        seconds=np.zeros(count, np.int64),
        samples=1,
        weights=whole,
        exponent=exponent,
        times=[],
        is_hourly=False,
        notes={"position": f"sky of {count} patches" if s.sky else "the table of directions", "suns": count},
    )
