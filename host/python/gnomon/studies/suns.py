# SPDX-License-Identifier: MIT
"""Suns: a table of directions for each sun zone, made once for a study and kept beside its results.

A zone is a square of the map, fixed in world coordinates; its suns are those of its centre. The direction in the map's
coordinates follows from azimuth and elevation at the centre (pvlib's SPA) and from the projection's Jacobian there
(pyproj), which says where a metre to true east and one to true north lead on the map: their angles and their lengths.
So shadows are as long as on the ground, in the map's metres. A direction is rounded once to float32.
"""

from __future__ import annotations

import dataclasses
import datetime
import math
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _gnomon
from .settings import Settings
from .tables import read_suns, read_weights
from .units import horizontal, jacobian, require_in_area

#: Angle across the sun's disk as seen from the Earth, in degrees.
SUN_ANGLE = 0.533
#: In a study's coordinates.
UP, NORTH = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)


@dataclasses.dataclass
class Suns:
    """The suns of a study: Z zones, M suns in W words of up to 32 bits.

    zones: (Z, 2) int64: floor(x / size), floor(y / size). size: the side of a zone in metres.
    towards: (Z, M, 3) float32, vectors to the suns in the map's coordinates; NaN where a sun is left out.
    word, bit: (M,) int64: the word and the bit of a sun's answers. word_count: W.
    seconds: (M,) int64: the time that a sun stands for. samples: the number of suns here for each step of time.
    weights: (M,) int64, in units of 2^exponent; all 0 where a study has no weights.
    times: (M / samples,) the middle of each step, ISO 8601 in local time; empty for tables of directions.
    is_hourly: word = 24 x (month - 1) + hour, bit = day - 1.
    notes: facts about the suns for the record.
    true: (M, 3) unit vectors to the suns, x true east, y true north; to_map: (Z, 2, 2) the Jacobian from there to the
        map. Both are empty unless the study has a weather file, whose weights are Wh/m^2 at a right angle.
    is_sky: (M,) bool: parts of the sky, not the Sun.
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
    true: NDArray[np.float64] = dataclasses.field(default_factory=lambda: np.empty((0, 3)))
    to_map: NDArray[np.float64] = dataclasses.field(default_factory=lambda: np.empty((0, 2, 2)))
    is_sky: NDArray[np.bool_] = dataclasses.field(default_factory=lambda: np.empty(0, bool))

    def save(self, path: Path) -> None:
        fields = {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}
        notes = fields.pop("notes")
        with path.open("wb") as file:
            np.savez_compressed(file, **fields, note_keys=list(notes), note_values=[repr(v) for v in notes.values()])

    @classmethod
    def load(cls, path: Path) -> Suns:
        with np.load(path) as data:
            arrays = ("zones", "towards", "word", "bit", "seconds", "weights", "true", "to_map", "is_sky")
            return cls(
                **{name: data[name] for name in arrays if name in data},
                size=float(data["size"]),
                word_count=int(data["word_count"]),
                samples=int(data["samples"]),
                exponent=int(data["exponent"]),
                times=[str(t) for t in data["times"]],
                is_hourly=bool(data["is_hourly"]),
                notes=dict(zip(map(str, data["note_keys"]), map(str, data["note_values"]), strict=True)),
            )

    def zone_row(self, zone: tuple[int, int]) -> int:
        rows = np.flatnonzero((self.zones == zone).all(axis=1))
        if not rows.size:
            raise ValueError(f"receivers: a point lies in the sun zone {zone}, outside of the study's extent")
        return int(rows[0])

    def centre(self, zone: tuple[int, int]) -> tuple[float, float]:
        return (zone[0] + 0.5) * self.size, (zone[1] + 0.5) * self.size

    def blocks(self, suns_of_block: int) -> list[NDArray[np.int64]]:
        """The words, divided into blocks of about `suns_of_block` suns. Hourly words are ordered by hour, then month:
        the suns of a block stand near each other, and so do the casters that can shadow. Words without suns are in no
        block."""
        is_up = np.isfinite(self.towards[:, :, 0]).any(axis=0)
        count = np.bincount(self.word[is_up], minlength=self.word_count)
        order = np.arange(self.word_count)
        if self.is_hourly:
            order = order.reshape(12, 24).T.reshape(-1)
        order = order[count[order] > 0]
        blocks, first, suns = [], 0, 0
        for i, word in enumerate(order):
            suns += int(count[word])
            if suns >= suns_of_block or i + 1 == len(order):
                blocks.append(order[first : i + 1])
                first, suns = i + 1, 0
        return blocks


def zone_of(x: Any, y: Any, size: float) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The zones of coordinates: a point on a border belongs to the zone in the east or north."""
    return np.floor(np.asarray(x) / size).astype(np.int64), np.floor(np.asarray(y) / size).astype(np.int64)


def zones_of_box(box: tuple[float, float, float, float], size: float) -> NDArray[np.int64]:
    """(Z, 2): all zones that the box x0, y0, x1, y1 meets."""
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


def _middles_of_steps(s: Settings) -> list[datetime.datetime]:
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
    """Degrees: the azimuth clockwise from true north, and the elevation, true or apparent as the settings say."""
    import pandas
    import pvlib

    moments = pandas.DatetimeIndex([t.astimezone(datetime.timezone.utc) for t in times])
    positions = pvlib.solarposition.spa_python(
        moments, latitude, longitude, altitude=0, pressure=s.pressure, temperature=s.temperature, delta_t=None,
        atmos_refract=0.5667,
    )  # fmt: skip
    column = "apparent_elevation" if s.elevation == "apparent" else "elevation"
    return positions["azimuth"].to_numpy(np.float64), positions[column].to_numpy(np.float64)


class Map:
    """Longitude, latitude and Jacobian of the map's points."""

    def __init__(self, crs: str | None) -> None:
        import pyproj

        if crs is None:
            raise ValueError("crs: the suns' positions need a CRS, and the raster has none: give crs= (or directions=)")
        try:
            projected = pyproj.CRS.from_user_input(crs)
        except pyproj.exceptions.CRSError as error:
            raise ValueError(f"crs: {error}") from None
        self._crs = projected
        units = {axis.unit_name for axis in projected.axis_info[:2]}
        if not projected.is_projected or units != {"metre"}:
            raise ValueError(f"crs: {projected.name} is not a map in metres: use UTM or a national grid")
        self._projection = pyproj.Proj(horizontal(projected))
        self._to_degrees = pyproj.Transformer.from_crs(projected, "EPSG:4326", always_xy=True)

    def longitude_and_latitude(self, x: float, y: float) -> tuple[float, float]:
        longitude, latitude = self._to_degrees.transform(x, y)
        if not (math.isfinite(longitude) and math.isfinite(latitude)):
            raise ValueError(
                f"crs: has no longitude and latitude for the zone's centre ({x:.0f}, {y:.0f}): is it the raster's?"
            )
        require_in_area(self._crs, x, y, longitude, latitude)
        return longitude, latitude

    def jacobian(self, x: float, y: float) -> NDArray[np.float64]:
        self.longitude_and_latitude(x, y)  # refuses what is no place of the CRS
        longitude, latitude = self._projection(x, y, inverse=True)  # on the CRS's own datum
        return jacobian(self._projection, longitude, latitude)

    def scales(self, x: float, y: float) -> tuple[float, float]:
        """The most and the least map metres of a true metre."""
        most, least = np.linalg.svd(self.jacobian(x, y), compute_uv=False).tolist()
        return most, least


def _towards(
    s: Settings, place: Map, times: list[datetime.datetime], x: float, y: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(M, 3) unit vectors to the suns in the map's coordinates, and elevations in degrees."""
    azimuth, elevation = _azimuth_and_elevation(s, times, *place.longitude_and_latitude(x, y))
    return _on_map(azimuth, elevation, place.jacobian(x, y)), elevation


def _on_map(
    azimuth: NDArray[np.float64], elevation: NDArray[np.float64], true_to_map: NDArray[np.float64] | None = None
) -> NDArray[np.float64]:
    """(M, 3) unit vectors of degrees clockwise from true north and above the horizon, on the map that the Jacobian (2,
    2) leads to; without it north is the map's."""
    a, e = np.radians(azimuth), np.radians(elevation)
    true = np.stack([np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e)], axis=1)
    return true if true_to_map is None else stretched(true, true_to_map)


def stretched(true: NDArray[np.float64], true_to_map: NDArray[np.float64]) -> NDArray[np.float64]:
    """(M, 3) unit vectors on the map of vectors on the true ground."""
    towards = np.column_stack([np.ascontiguousarray(true[:, :2]) @ true_to_map.T, true[:, 2]])
    return np.asarray(towards / np.linalg.norm(towards, axis=1, keepdims=True))


def samples_of_disks(towards: NDArray[np.float64], samples: int) -> NDArray[np.float32]:
    """(M x samples, 3) directions to samples of the sun's disk around each of (M, 3); NaN where a sun is left out."""
    result = np.full((len(towards), samples, 3), np.nan, np.float32)
    for row in np.flatnonzero(np.isfinite(towards[:, 0])):
        result[row] = _gnomon.sun_disk((-towards[row]).tolist(), SUN_ANGLE, samples)
    return result.reshape(-1, 3)


def _is_hourly(times: list[datetime.datetime], s: Settings) -> bool:
    return s.step == 60 and len({t.year for t in times}) == 1


def suns_of(s: Settings, crs: str | None, box: tuple[float, float, float, float]) -> Suns:
    """The suns of all zones that meet the receivers' box x0, y0, x1, y1. Raises ValueError. crs: the raster's, for
    settings without one."""
    zones = zones_of_box(box, s.zone)
    if s.weather is not None:
        return _suns_of_weather(s, crs, zones, box)
    if s.start is None:
        return _suns_of_table(s, crs, zones)
    times = _middles_of_steps(s)
    place = Map(s.crs or crs)
    directions = np.full((len(zones), len(times), 3), np.nan)
    for row, zone in enumerate(zones):
        towards, elevation = _towards(s, place, times, (zone[0] + 0.5) * s.zone, (zone[1] + 0.5) * s.zone)
        directions[row] = np.where((elevation >= s.min_elevation)[:, None], towards, np.nan)
    is_counted = np.isfinite(directions[:, :, 0])  # none at all in a polar night, which has 0 hours
    if _is_hourly(times, s):
        word = np.array([24 * (t.month - 1) + t.hour for t in times])
        bit = np.array([t.day - 1 for t in times])
        word_count = 12 * 24
    else:
        word, bit = np.arange(len(times)) // 32, np.arange(len(times)) % 32
        word_count = -(-len(times) // 32)
    weights = read_weights(s.weights, len(times)) if s.weights else np.zeros(len(times))
    whole, exponent = _gnomon.round_weights(weights)
    samples = max(s.sun_disk, 1)
    if s.sun_disk:
        directions = np.stack([samples_of_disks(towards, samples) for towards in directions])
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
        notes=_notes(s, place, times, zones, is_counted),
    )


def _notes(
    s: Settings, place: Map, times: list[datetime.datetime], zones: NDArray[np.int64], is_counted: NDArray[np.bool_]
) -> dict[str, Any]:
    """The record's notes. They say how far the suns of a zone's centre are off in its corners: the most that is found
    in the first, the middle and the last zone."""
    worst = 0.0
    scales: list[float] = []
    chosen = np.flatnonzero(is_counted.any(axis=0))
    sampled = [times[i] for i in chosen[:: max(1, len(chosen) // 64)]]
    for i, j in zones[sorted({0, len(zones) // 2, len(zones) - 1})]:
        x, y = (i + 0.5) * s.zone, (j + 0.5) * s.zone
        scales += place.scales(x, y)
        if not sampled:
            continue
        middle = _towards(s, place, sampled, x, y)[0]
        for dx in (-0.5, 0.5):
            for dy in (-0.5, 0.5):
                corner = _towards(s, place, sampled, x + dx * s.zone, y + dy * s.zone)[0]
                sine = np.linalg.norm(np.cross(middle, corner), axis=1)
                worst = max(worst, float(np.degrees(np.arcsin(np.minimum(sine, 1))).max(initial=0)))
    tip = 100 * math.radians(worst) / math.sin(math.radians(s.min_elevation)) ** 2
    return {
        "position": "pvlib's SPA (NREL/TP-560-34302) at the zone's centre, height 0",
        "elevation": s.elevation,
        "refraction": f"{s.pressure:g} Pa, {s.temperature:g} C" if s.elevation == "apparent" else "none",
        "suns": len(times),
        "suns_left_out": int((~is_counted.any(axis=0)).sum()),
        "min_elevation": s.min_elevation,
        "error_across_a_zone_degrees": worst,
        "error_across_a_zone_metres": f"{tip:.3g} at the shadow's tip of a caster of 100 m at {s.min_elevation:g} deg",
        "map_metres_of_a_true_metre": f"{min(scales):.6f} to {max(scales):.6f}",
    }


# ---- Tables ----------------------------------------------------------------------------------------------------------


def _suns_of_table(s: Settings, crs: str | None, zones: NDArray[np.int64]) -> Suns:
    left_out = 0
    if s.sky:
        patches, sky_weights = _gnomon.sky_patches(UP, NORTH, s.sky)
        towards, weights = np.broadcast_to(patches, (len(zones), *patches.shape)), sky_weights.astype(np.float64)
    else:
        assert s.directions is not None
        table = read_suns(s.directions)
        weights, left_out = table.weights, table.below_horizon
        if table.note:
            warnings.warn(table.note, stacklevel=2)
        if not len(weights) and not left_out:
            raise ValueError(f"{s.directions}: has no suns")
        if table.towards is not None:
            towards = np.broadcast_to(table.towards, (len(zones), *table.towards.shape))
        else:
            assert table.azimuth is not None and table.elevation is not None
            towards = _towards_by_angles(s, s.crs or crs, zones, table.azimuth, table.elevation)
    notes = {
        "position": f"sky of {len(weights)} patches" if s.sky else "the table of directions",
        "suns": len(weights) + left_out,
        "suns_left_out": left_out,
    }
    return _weighed(s, zones, towards, weights, notes)


def _weighed(
    s: Settings,
    zones: NDArray[np.int64],
    towards: NDArray[np.float64],
    weights: NDArray[np.float64],
    notes: dict[str, Any],
) -> Suns:
    """Suns that stand for weights, not for times, 32 to a word."""
    count = len(weights)
    whole, exponent = _gnomon.round_weights(weights)
    return Suns(
        zones=zones,
        size=s.zone,
        towards=towards.astype(np.float32, order="C"),
        word=np.arange(count) // 32,
        bit=np.arange(count) % 32,
        word_count=-(-count // 32),
        seconds=np.zeros(count, np.int64),
        samples=1,
        weights=whole,
        exponent=exponent,
        times=[],
        is_hourly=False,
        notes=notes,
    )


def _towards_by_angles(
    s: Settings, crs: str | None, zones: NDArray[np.int64], azimuth: NDArray[np.float64], elevation: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(Z, M, 3) unit vectors to suns whose azimuths count from true north; without a CRS that is the map's north."""
    if crs is None:
        return np.broadcast_to(_on_map(azimuth, elevation), (len(zones), len(azimuth), 3))
    place = Map(crs)
    centres = (zones + 0.5) * s.zone
    return np.stack([_on_map(azimuth, elevation, place.jacobian(*xy)) for xy in centres.tolist()])


# ---- Weather files ---------------------------------------------------------------------------------------------------


def _suns_of_weather(
    s: Settings, crs: str | None, zones: NDArray[np.int64], box: tuple[float, float, float, float]
) -> Suns:
    """The Sun in the middle of each hour of the file that has direct irradiance, over the file's place; then the parts
    of the sky, if an output needs them. Without a CRS true north is the map's."""
    from .. import weather

    assert s.weather is not None
    file = weather.read(s.weather)
    to_map = np.broadcast_to(np.eye(2), (len(zones), 2, 2))
    if (s.crs or crs) is not None:
        place = Map(s.crs or crs)
        longitude, latitude = place.longitude_and_latitude((box[0] + box[2]) / 2, (box[1] + box[3]) / 2)
        file.require_near(latitude, longitude)
        to_map = np.stack([place.jacobian(*xy) for xy in ((zones + 0.5) * s.zone).tolist()])
    azimuth, elevation = file.suns()
    is_up, is_sunny = elevation > 0, file.dni > 0
    rows = np.flatnonzero(is_up & is_sunny)
    rows = rows[np.argsort(file.times.hour[rows], kind="stable")]  # the suns of a block stand near each other
    true, weights = weather.towards(azimuth, elevation)[rows], file.dni[rows] * file.step
    sky = _sky_of(file) if {"irradiation", "diffuse"} & {*s.outputs} else (np.empty((0, 3)), np.empty(0))
    is_sky = np.arange(len(true) + len(sky[0])) >= len(true)
    true, weights = np.concatenate([true, sky[0]]), np.concatenate([weights, sky[1]])
    notes = {
        "position": "pvlib's SPA at the weather file's place, in the middle of each hour",
        "weather": repr(file).strip("<>").removeprefix("gnomon.weather.Weather of "),
        "suns": int(is_sunny.sum()),
        "suns_left_out": int((is_sunny & ~is_up).sum()),
        "direct_normal_left_out": f"{file.dni[~is_up].sum() * file.step / 1000:.3g} kWh/m2",
        "sky": f"{len(sky[0])} parts of Perez' sky by gendaymtx",
    }
    on_map = np.stack([stretched(true, jacobian) for jacobian in to_map])
    return dataclasses.replace(
        _weighed(s, zones, on_map, weights, notes),
        true=true,
        to_map=to_map,
        is_sky=is_sky,
    )


def _sky_of(file: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(N, 3) unit vectors to the parts of Tregenza's patches, and their Wh/m^2 over all hours on what looks at them."""
    from .. import weather

    try:
        radiance = file.radiance()
    except ModuleNotFoundError:
        raise ValueError(
            "outputs: the sky's light needs pyradiance: pip install 'gnomon[weather]', or give outputs=[\"direct\"]"
        ) from None
    parts, patch = weather.tregenza()
    size = np.linalg.norm(parts, axis=1)
    return parts / size[:, None], radiance[1:].sum(axis=1)[patch] * file.step * size
