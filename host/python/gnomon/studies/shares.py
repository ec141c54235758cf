# SPDX-License-Identifier: MIT
"""gnomon-study shares: the lit share of each planar polygon of a model under each sun, as a table (docs/shares.md)."""

from __future__ import annotations

import dataclasses
import datetime
import fnmatch
import math
import sys
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import _gnomon, surfaces, weather
from .._files import require_other, require_writable
from .polygons import Model, load
from .suns import Map, stretched
from .tables import read_suns

WHAT = ("intervals", "shaded", "energyplus")
MINUTES_OF_DAY = 1440


@dataclasses.dataclass(frozen=True)
class ShareSettings:
    """What is asked of a model.

    model: a file whose polygons have shares. occluders: files whose polygons only cast shadows.
    faces: the names of the polygons of the model that have shares, as a pattern with * and ?; None: all of them.
    up: "y" or "z"; None: as the file's format has it. north: degrees clockwise from y (with y up from -z), as seen from
        above.
    directions: a table of suns. epw: a weather file. place: latitude and longitude in degrees, with day ("YYYY-MM-DD")
        or year, and step (minutes; None: 10, of a year 60) and utc (hours; None: the longitude / 15, rounded).
    within, limit, centroids: as gnomon.surfaces.lit_fractions() has them.
    what: "intervals", "shaded" or "energyplus".
    """

    model: str
    occluders: tuple[str, ...] = ()
    faces: str | None = None
    up: str | None = None
    north: float = 0.0
    directions: str | None = None
    epw: str | None = None
    place: tuple[float, float] | None = None
    day: str | None = None
    year: int | None = None
    step: float | None = None
    utc: float | None = None
    within: float = 0.01
    limit: int = 10_000
    centroids: bool = False
    what: str = "intervals"

    def __post_init__(self) -> None:
        def need(holds: bool, text: str) -> None:
            if not holds:
                raise ValueError(text)

        given = [name for name in ("directions", "epw", "place") if getattr(self, name) is not None]
        need(len(given) == 1, "suns: give --directions, --epw or --place: one of them")
        need(0 < self.within <= 1, f"within: {self.within:g} is not above 0 and at most 1")
        need(math.isfinite(self.north), f"north: {self.north:g} is not a number of degrees")
        need(self.limit >= 0, f"limit: {self.limit} is negative")
        of_place = [f"--{name}" for name in ("day", "year", "step", "utc") if getattr(self, name) is not None]
        need(self.place is not None or not of_place, f"{', '.join(of_place)}: needs --place")
        need(self.place is None or (self.day is None) != (self.year is None), "place: needs --day or --year")
        if self.place is not None:
            need(abs(self.place[0]) <= 90, f"place: latitude {self.place[0]:g} is beyond 90 degrees")
            need(abs(self.place[1]) <= 180, f"place: longitude {self.place[1]:g} is beyond 180 degrees")
        step = self.step
        need(
            step is None or 1 <= step <= MINUTES_OF_DAY and step.is_integer() and MINUTES_OF_DAY % step == 0,
            f"step: {step or 0:g} minutes do not divide a day",
        )
        need(
            self.what != "energyplus" or self.epw is not None or self.year is not None,
            "what: energyplus needs each step of a year: give --epw, or --place with --year",
        )
        need(not self.centroids or self.what == "intervals", f"centroids: are not in the file of {self.what}")


class Suns(NamedTuple):
    """towards: (M, 3) vectors to the suns above the horizon, z up. times: of these. ends: of all T steps, also at
    night, or nothing. is_up: (T,). facts: for the record."""

    towards: NDArray[np.float64]
    times: list[str]
    ends: list[Any]
    is_up: NDArray[np.bool_]
    facts: dict[str, Any]


class Shapes(NamedTuple):
    """What lit_fractions() takes, z up; the names of the faces; and those of polygons that are left out or bent."""

    surfaces: surfaces.Surfaces
    names: list[str]
    left_out: list[str]
    not_planar: list[str]
    notes: list[str]


def write_shares(path: Path, settings: ShareSettings, progress: bool = False) -> dict[str, Any]:
    """Computes, writes the table, which appears whole, and returns the record. Raises ValueError and OSError."""
    inputs = [settings.model, *settings.occluders, *filter(None, (settings.directions, settings.epw))]
    require_other(path, inputs)
    shapes, model = shapes_of(settings)
    suns = suns_of(settings, model)
    require_writable(path)
    found = _decided(settings, shapes, suns, progress)
    width = found.high - found.low
    if settings.what == "energyplus":
        whole = np.zeros((2, len(shapes.names), len(suns.is_up)))
        whole[:, :, suns.is_up] = found.low, found.high
        surfaces.LitFractions(whole[0], whole[1], None).write_energyplus(path, shapes.names, suns.ends)
    else:
        if settings.centroids and _is_y_up(settings, model):
            c = found.centroid
            assert c is not None
            found = found._replace(centroid=np.stack([c[..., 0], c[..., 2], -c[..., 1]], axis=-1))
        write = found.write_table if settings.what == "intervals" else found.write_shaded
        write(path, shapes.names, suns.times)
    return {
        "faces": len(shapes.names),
        "triangles": len(shapes.surfaces.triangles),
        "notes": shapes.notes,
        "left_out": shapes.left_out,
        "not_planar": shapes.not_planar,
        **suns.facts,
        "within": settings.within,
        "limit": settings.limit,
        "widest": float(width.max(initial=0)),
        "mean_width": float(width.mean()) if width.size else 0.0,
        "wider_than_within": int((width > settings.within).sum()),
        "what": settings.what,
        "gnomon": _gnomon.__version__,  # type: ignore[attr-defined]
    }


def _decided(settings: ShareSettings, shapes: Shapes, suns: Suns, progress: bool) -> surfaces.LitFractions:
    from tqdm import tqdm

    count = len(shapes.names) * len(suns.towards)
    with tqdm(total=count, unit=" shares", unit_scale=True, disable=not progress, file=sys.stderr) as bar:
        return surfaces.lit_fractions(
            shapes.surfaces, -suns.towards, within=settings.within, limit=settings.limit,
            centroids=settings.centroids, progress=lambda part: bar.update(round(part * count) - bar.n),
        )  # fmt: skip


# ---- Polygons --------------------------------------------------------------------------------------------------------


def _is_y_up(settings: ShareSettings, model: Model) -> bool:
    return (settings.up or model.up) == "y"


def shapes_of(settings: ShareSettings) -> tuple[Shapes, Model]:
    model, *others = (load(name) for name in (settings.model, *settings.occluders))
    names: list[str] = []
    left_out, not_planar, triangles, faces = [], [], [], []
    for source in (model, *others):
        for name, rings in source.polygons:
            of_name = surfaces.cut(rings)
            if of_name.fault:
                left_out.append(f"{name} {of_name.fault}")
            face = -1
            if source is model and not of_name.fault and fnmatch.fnmatchcase(name, settings.faces or "*"):
                face = len(names)
                names.append(name)
            if face >= 0 and not of_name.is_planar:
                not_planar.append(name)
            is_y_up = _is_y_up(settings, source)
            corners = of_name.triangles
            triangles.append(np.stack([corners[..., 0], -corners[..., 2], corners[..., 1]], -1) if is_y_up else corners)
            faces.append(np.full(len(corners), face, np.int32))
    if not names:
        if settings.faces and model.polygons:
            some = ", ".join(repr(name) for name, _ in model.polygons[:3])
            raise ValueError(f"faces: {settings.faces!r} matches none of the names in {settings.model}, such as {some}")
        raise ValueError(f"{settings.model}: none of its {len(model.polygons)} polygons has an area")
    made = surfaces.Surfaces(np.concatenate(triangles), np.concatenate(faces), np.empty(0, np.int64))
    notes = [f"{name}: {note}" for name, source in zip((settings.model, *settings.occluders), (model, *others),
             strict=True) for note in source.notes]  # fmt: skip
    return Shapes(made, names, left_out, not_planar, notes), model


# ---- Suns ------------------------------------------------------------------------------------------------------------


def suns_of(settings: ShareSettings, model: Model) -> Suns:
    if settings.directions is not None:
        return _suns_of_table(settings, model)
    if settings.epw is not None:
        file = weather.read(settings.epw)
        if model.crs is not None:
            latitude, longitude = _place_of(model)
            file.require_near(latitude, longitude)
        about = repr(file).strip("<>").removeprefix("gnomon.weather.Weather of ")
        step = datetime.timedelta(hours=file.step)
        return _suns_of_steps(settings, model, file.times, step, *file.suns(), {"weather": about})
    return _suns_of_place(settings, model)


def _suns_of_table(settings: ShareSettings, model: Model) -> Suns:
    assert settings.directions is not None
    table = read_suns(settings.directions)
    if table.towards is not None:
        towards = table.towards.astype(np.float64)
    else:
        assert table.azimuth is not None and table.elevation is not None
        towards = _on_map(settings, model, table.azimuth, table.elevation)
    if not len(towards):
        raise ValueError(f"{settings.directions}: has no sun above the horizon")
    facts = {"position": "the table of directions", "suns": len(towards), "suns_left_out": table.below_horizon}
    times = table.times or [str(row + 1) for row in range(len(towards))]
    return Suns(towards, times, [], np.ones(len(towards), bool), facts)


def _suns_of_place(settings: ShareSettings, model: Model) -> Suns:
    import pandas
    import pvlib

    assert settings.place is not None
    latitude, longitude = settings.place
    utc = round(longitude / 15) if settings.utc is None else settings.utc
    try:
        day = datetime.date.fromisoformat(settings.day or f"{settings.year:04d}-01-01")
        first = datetime.datetime.combine(day, datetime.time())
        end = first + datetime.timedelta(days=1) if settings.day else first.replace(year=first.year + 1)
        zone = datetime.timezone(datetime.timedelta(hours=utc))
    except (ValueError, OverflowError):
        raise ValueError(
            f"day, year, utc: {settings.day or settings.year} at {utc:g} hours ahead is no date such as 2026-03-20, or "
            "no year from 1 to 9998, or no clock less than 24 hours ahead"
        ) from None
    step = datetime.timedelta(minutes=settings.step or (10 if settings.day else 60))
    count = (end - first) // step
    times = pandas.DatetimeIndex([first + step * i + step / 2 for i in range(count)], tz=zone)
    found = pvlib.solarposition.get_solarposition(times, latitude, longitude, method="nrel_numpy")
    azimuth, elevation = (found[name].to_numpy(np.float64) for name in ("azimuth", "elevation"))
    return _suns_of_steps(
        settings, model, times, step, azimuth, elevation, {"place": [latitude, longitude], "utc": utc}
    )


def _suns_of_steps(
    settings: ShareSettings,
    model: Model,
    times: Any,
    step: datetime.timedelta,
    azimuth: NDArray[np.float64],
    elevation: NDArray[np.float64],
    facts: dict[str, Any],
) -> Suns:
    """times: the middle of each step."""
    is_up = elevation > 0
    facts |= {"position": "pvlib's SPA in the middle of each step", "suns": int(is_up.sum()),
              "suns_left_out": int((~is_up).sum())}  # fmt: skip
    texts = [time.isoformat() for time in times[is_up]]
    towards = _on_map(settings, model, azimuth[is_up], elevation[is_up])
    return Suns(towards, texts, [time + step / 2 for time in times], is_up, facts)


def _on_map(
    settings: ShareSettings, model: Model, azimuth: NDArray[np.float64], elevation: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(M, 3) vectors to suns of degrees from true north, in the model's axes with z up."""
    true = weather.towards(azimuth, elevation)
    if model.crs is None:
        return weather.turned(true, "z", settings.north)
    if settings.north:
        raise ValueError(f"north: {settings.model} names its reference system, which says where north is: leave it out")
    return stretched(true, Map(model.crs).jacobian(*_middle_of(model)))


def _middle_of(model: Model) -> tuple[float, float]:
    corners = np.concatenate([ring for _, rings in model.polygons for ring in rings])
    x, y = ((corners.min(axis=0) + corners.max(axis=0)) / 2)[:2].tolist()
    return x, y


def _place_of(model: Model) -> tuple[float, float]:
    """Latitude and longitude."""
    longitude, latitude = Map(model.crs).longitude_and_latitude(*_middle_of(model))
    return latitude, longitude
