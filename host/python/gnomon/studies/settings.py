# SPDX-License-Identifier: MIT
"""The settings of a study: arguments of gnomon.study(), and keys of study.toml of the same names."""

from __future__ import annotations

import dataclasses
import glob
import hashlib
import json
import math
import os
import re
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

OUTPUTS = ("hours", "bits", "weights", "irradiation", "direct", "diffuse")


@dataclasses.dataclass(frozen=True)
class Settings:
    """The settings of a study. Lengths are in metres, angles in degrees, times in UTC unless they say otherwise.

    Casters and receivers:
    raster: GeoTIFF files of heights (a DSM or DEM) on one grid, north up: a mosaic; where files overlap the first one
        counts. Names may hold * and ?. The centres of cells are vertices. The diagonal of each square of four centres
        runs from south-west to north-east. A triangle with a nodata corner does not exist.
    height_unit: the unit of the raster's heights, such as "foot" or "US survey foot"; None: what each file declares,
        its band or its CRS, and metres where it declares none. Feet are turned into metres: all results are metres.
    meshes: files in the study's coordinates less mesh_offset: CityJSON (.json, .city.json, .jsonl), from which each
        object has its highest level of detail; or a format that trimesh loads (glTF, OBJ, PLY, STL).
    mesh_up: "z", or "y" for meshes whose y is up (x, y, z becomes x, -z, y); None: "y" for glTF files, else "z".
    mesh_offset: (3,) is added to the coordinates of meshes, in float64.
    receivers: "raster": the centres of the raster's cells; "points": the rows of the file `points`; "faces": points on
        the faces of the meshes, `spacing` apart.
    points: a .npy file of (N, 3) or (N, 6) float64, or a .csv file with the columns x, y, z and perhaps nx, ny, nz. A
        point with a normal lies on a surface: it is lifted off the surface by a proven number of steps, and is dark
        where the light is not strictly on the normal's side. A point without a normal stays where it is.
    crs: the coordinates' CRS as pyproj takes it; None: the raster's.

    Suns:
    start, end: the first and the last moment, ISO 8601. A time without a time zone is in the zone of utc_offset.
    step: minutes. The sun in the middle of each step counts for the whole step.
    utc_offset: hours that local time is ahead of UTC. It names the hours of packed bits.
    elevation: "true", or "apparent": raised by the refraction of the air at `pressure` (Pa) and `temperature` (C).
    min_elevation: suns of start..end below this elevation are left out, and counted.
    zone: the side of sun zones. The suns of a zone's centre serve the whole zone.
    directions: a table of suns instead of times, a .csv or .npy file (docs/studies.md). The light travels along its
        x, y, z, downwards; z points up unless the column `up` says y.
    weather: a file of gnomon.weather.read() (EPW, TMY2, TMY3, ...) instead of times: irradiation in kWh/m2 by the
        file's direct and diffuse irradiance, with the cosines of the receivers' normals; place, years and time zone are
        the file's.
    weights: a .csv or .npy file of one number per sun of start..end, below the horizon too (W h/m2, say).
    sun_disk: 0: the sun is a point. N: N directions on a disk of .533 degrees for each sun.
    sky: 0, or N, 1 to 16: each of Tregenza's 145 patches of the sky is N x N suns, which weigh cos(zenith) x solid
        angle.
    curvature: lower casters and receivers by the Earth's curvature around the zone's centre.
    refraction_of_ground: the coefficient k of rays along the ground: the Earth's radius is divided by 1 - k. It counts
        only with curvature.

    Limits, and how work is divided:
    lattice: the step, a power of two; None: the finest from 2^-10 on that holds the study's reach.
    outside: None: nothing stands beyond the casters' extent, which the user warrants. A number: nothing there is higher
        than this; the answer for a ray that leaves the extent below it is undecided.
    halo_limit: None, or the greatest distance at which casters are tested. An answer that a farther caster can change
        is undecided.
    memory_limit: bytes of casters that a task holds at once. It changes no answer.
    tile: cells on a side of a receiver tile; tile x tile points for lists of points. It changes no answer.
    caster_tile: cells on a side of a caster tile. It changes no decided answer.
    block: the approximate number of suns of a task. It changes no answer.
    outputs: any of "hours" (hours of sun), "bits" (each answer) and "weights" (sums of weights); of a weather file any
        of "irradiation" (the Sun's and the sky's), "direct" and "diffuse".
    """

    raster: tuple[str, ...] = ()
    height_unit: str | None = None
    meshes: tuple[str, ...] = ()
    mesh_up: str | None = None
    mesh_offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    receivers: str = "raster"
    points: str | None = None
    spacing: float = 1.0
    crs: str | None = None
    start: str | None = None
    end: str | None = None
    step: float = 60.0
    utc_offset: float = 0.0
    elevation: str = "true"
    pressure: float = 101325.0
    temperature: float = 12.0
    min_elevation: float = 3.0
    zone: float = 10_000.0
    directions: str | None = None
    weather: str | None = None
    weights: str | None = None
    sun_disk: int = 0
    sky: int = 0
    curvature: bool = False
    refraction_of_ground: float = 0.13
    lattice: float | None = None
    outside: float | None = None
    halo_limit: float | None = None
    memory_limit: int = 2 << 30
    tile: int = 512
    caster_tile: int = 128
    block: int = 384
    outputs: tuple[str, ...] = ("hours", "bits")

    def __post_init__(self) -> None:
        for check in (_check_scene, _check_suns, _check_work):
            check(self)

    def as_json(self) -> str:
        """The settings as one line of JSON, with the keys in the order of the fields."""
        return json.dumps(dataclasses.asdict(self))

    @classmethod
    def from_json(cls, values: dict[str, Any]) -> Settings:
        """The settings from the dictionary that json.loads() makes of as_json(); lists become tuples."""
        fields: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in values.items()}
        return cls(**fields)

    def hash_of_answers(self) -> str:
        """Names the study that these settings describe, without memory_limit, which changes no answer."""
        values = dataclasses.asdict(self)
        del values["memory_limit"]
        if self.weather is None:
            del values["weather"]  # older studies go on
        return hashlib.sha256(json.dumps(values, sort_keys=True).encode()).hexdigest()


def _need(holds: bool, text: str) -> None:
    if not holds:
        raise ValueError(text)


def _check_scene(s: Settings) -> None:
    _need(bool(s.raster or s.meshes), "raster, meshes: a study needs casters: give one of them")
    _need(s.receivers in ("raster", "points", "faces"), f"receivers: {s.receivers!r} is not raster, points or faces")
    _need(s.receivers != "raster" or bool(s.raster), 'receivers: "raster" needs raster=')
    _need(s.receivers != "points" or s.points is not None, 'receivers: "points" needs points=, a file')
    _need(s.receivers != "faces" or bool(s.meshes), 'receivers: "faces" needs meshes=')
    _need(s.mesh_up in (None, "y", "z"), f"mesh_up: {s.mesh_up!r} is neither 'y' nor 'z'")
    _need(len(s.mesh_offset) == 3, "mesh_offset: must be three numbers")
    _need(s.spacing > 0, f"spacing: {s.spacing} must be above 0")
    if s.height_unit is not None:
        from .units import metres_of

        _need(metres_of(s.height_unit) is not None, f"height_unit: {s.height_unit!r} is no unit of length")
    names = [*s.raster, *s.meshes, *(f for f in (s.points, s.directions, s.weather, s.weights) if f)]
    for name in names:
        _need(Path(name).exists() or _is_gdals(name), f"{name}: there is no such file")


def _check_suns(s: Settings) -> None:
    sources = [s.start is not None or s.end is not None, s.directions is not None, s.weather is not None, s.sky > 0]
    _need(sum(sources) == 1, "suns: give start and end, or directions, or sky, or weather: one of them")
    _need((s.start is None) == (s.end is None), "start, end: one needs the other")
    _need(s.step > 0 and abs(s.step * 60 - round(s.step * 60)) < 1e-9, f"step: {s.step} is not whole seconds")
    _need(abs(s.utc_offset) <= 14, f"utc_offset: {s.utc_offset} hours are not between -14 and 14")
    _need(s.pressure >= 0, f"pressure: {s.pressure} Pa must not be below 0")
    _need(s.temperature > -273.15, f"temperature: {s.temperature} C is below absolute zero")
    _need(s.refraction_of_ground < 1, f"refraction_of_ground: {s.refraction_of_ground} is not below 1")
    _need(s.elevation in ("true", "apparent"), f"elevation: {s.elevation!r} is neither 'true' nor 'apparent'")
    _need(0 < s.min_elevation < 90, f"min_elevation: {s.min_elevation} is not between 0 and 90")
    _need(s.zone > 0, f"zone: {s.zone} must be above 0")
    _need(s.sun_disk == 0 or s.start is not None, "sun_disk: needs start and end")
    _need(0 <= s.sun_disk <= 1024, f"sun_disk: {s.sun_disk} is not between 0 and 1024")
    _need(0 <= s.sky <= 16, f"sky: {s.sky} is not between 0 and 16")
    _need(s.weights is None or s.start is not None, "weights: one per sun of start..end; directions have their own")
    _need(
        not (s.sun_disk and "bits" in s.outputs),
        'outputs: a sun disk gives shares of hours, not bits: leave out "bits"',
    )
    _need(not s.sky or tuple(s.outputs) == ("weights",), 'outputs: a sky gives outputs=["weights"], its view factor')
    has_weights = s.weights is not None or s.directions is not None or s.sky > 0
    _need("weights" not in s.outputs or has_weights, 'outputs: "weights" needs weights=, directions= or sky=')
    are_energies = [output in ("irradiation", "direct", "diffuse") for output in s.outputs]
    _need(
        all(are_energies) if s.weather else not any(are_energies),
        'outputs: weather= gives "irradiation", "direct" and "diffuse", and these need weather=',
    )
    _need("hours" not in s.outputs or s.start is not None, 'outputs: "hours" needs start= and end=')


#: Settings of suns by time.
OF_TIMES = ("step", "utc_offset", "elevation", "pressure", "temperature", "min_elevation")


def _check_effect(s: Settings) -> None:
    """What has no effect was meant for something."""
    defaults = {field.name: field.default for field in dataclasses.fields(Settings)}
    for name in OF_TIMES if s.start is None else ():
        is_given = getattr(s, name) != defaults[name]
        _need(not is_given, f"{name}: is of suns by time, start= to end=, and has no effect on others: leave it out")
    has_faces = s.receivers == "faces" or s.spacing == defaults["spacing"]
    _need(has_faces, 'spacing: is of points on faces, and has no effect without receivers="faces": leave it out')


def _check_work(s: Settings) -> None:
    unknown = sorted({*s.outputs} - {*OUTPUTS})
    _need(bool(s.outputs) and not unknown, f"outputs: {unknown or 'nothing'}: must be any of {', '.join(OUTPUTS)}")
    for name in ("tile", "caster_tile", "block"):
        _need(1 <= getattr(s, name) <= 1 << 16, f"{name}: {getattr(s, name)} is not between 1 and 65536")
    if s.lattice is not None:
        is_power = s.lattice > 0 and math.isfinite(s.lattice) and math.frexp(s.lattice)[0] == 0.5
        _need(is_power, f"lattice: the step {s.lattice!r} is not a power of two, such as 2**-10")
    _need(s.halo_limit is None or s.halo_limit >= 0, f"halo_limit: {s.halo_limit} must not be below 0")
    _need(s.memory_limit >= 1 << 20, f"memory_limit: {s.memory_limit} is below a mebibyte")


def _held(value: Any) -> str | None:
    """How to write what an object holds into a file; None for what may be names."""
    if isinstance(value, str | bytes | os.PathLike):
        return None
    if hasattr(value, "dims") and hasattr(value, "coords"):
        return "gnomon.xarray's dem.gnomon.sun_hours() takes it, or write it with dem.rio.to_raster(name)"
    if hasattr(value, "profile") and hasattr(value, "crs"):
        return f"give its name, {value.name!r}"
    if hasattr(value, "read_bytes") or hasattr(value, "read"):
        return "write it first, pathlib.Path(name).write_bytes(file.read())"
    if hasattr(value, "to_csv"):
        return "write it first, table.to_csv(name, index=False)"
    if hasattr(value, "export") and hasattr(value, "bounds"):
        return "write it first, mesh.export('name.ply')"
    if hasattr(value, "save") and hasattr(value, "points"):
        return "write it first, mesh.save('name.ply')"
    if hasattr(value, "__array__"):
        return "write it first: numpy.save('name.npy', array) for suns, weights and points, rasterio for heights"
    return None if isinstance(value, Iterable) else "a str or a pathlib.Path"


def _names_of(value: Any, key: str) -> list[str]:
    """File names. Raises ValueError with the setting's name for what a later run, or another process, cannot read."""
    remedy = _held(value)
    if remedy is not None:
        why = "must be a file's name, which workers and later runs read again"
        raise ValueError(f"{key}: {why}, not {type(value).__name__}: {remedy}")
    if isinstance(value, str | bytes | os.PathLike):
        _need(bool(os.fsdecode(value)), f"{key}: the name of a file is empty")
        return [os.fsdecode(value)]
    return [name for one in value for name in _names_of(one, key)]


def _is_gdals(name: str) -> bool:
    """A name that only GDAL finds: an address, a member of an archive, or a raster in a file (netcdf:a.nc:z)."""
    is_inside = re.match(r"[A-Za-z]\w+:", name) is not None and not Path(name).exists()
    return "://" in name or name.startswith("/vsi") or is_inside


def files_of(value: Any, folder: Path | None = None, key: str = "files") -> tuple[str, ...]:
    """Absolute paths in the given order. A name with * or ? stands for its matches, sorted."""
    folder = Path.cwd() if folder is None else folder
    paths: list[str] = []
    for name in _names_of(value, key):
        path = name if _is_gdals(name) else str((folder / name).absolute())
        matches = sorted(glob.glob(path)) if re.search(r"[*?]", name) else [path]
        _need(bool(matches), f"{name}: there is no such file")
        paths += matches
    return tuple(paths)


def settings_of(values: dict[str, Any], folder: Path | None = None) -> Settings:
    """Checked settings from arguments or a file's keys. Paths are relative to the folder. Raises ValueError, which
    names the argument."""
    known = {field.name for field in dataclasses.fields(Settings)}
    unknown = sorted(set(values) - known)
    _need(not unknown, f"{', '.join(unknown)}: there is no such setting; there are {', '.join(sorted(known))}")
    fields = {key: value for key, value in values.items() if value is not None}
    base = Path.cwd() if folder is None else folder
    for key in ("raster", "meshes"):
        if key in fields:
            fields[key] = files_of(fields[key], base, key)
    for key in ("points", "directions", "weather", "weights"):
        if key in fields:
            files = files_of(fields[key], base, key)
            _need(len(files) == 1, f"{key}: must be one file, not {len(files)}")
            fields[key] = files[0]
    for key in ("start", "end", "crs", "height_unit"):
        if key in fields:
            fields[key] = fields[key].isoformat() if hasattr(fields[key], "isoformat") else str(fields[key])
    if "outputs" in fields:
        outputs = [fields["outputs"]] if isinstance(fields["outputs"], str) else fields["outputs"]
        fields["outputs"] = tuple(o for o in OUTPUTS if o in outputs) + tuple(o for o in outputs if o not in OUTPUTS)
    elif fields.get("sky"):
        fields["outputs"] = ("weights",)
    elif "weather" in fields:
        fields["outputs"] = ("irradiation", "direct", "diffuse")
    elif "directions" in fields:
        fields["outputs"] = ("bits", "weights")
    elif fields.get("sun_disk"):
        fields["outputs"] = ("hours",)
    if "mesh_offset" in fields:
        fields["mesh_offset"] = tuple(_number("mesh_offset", x) for x in fields["mesh_offset"])
    for key in ("step", "utc_offset", "min_elevation", "zone", "spacing", "pressure", "temperature"):
        if key in fields:
            fields[key] = _number(key, fields[key])
    for key in ("refraction_of_ground", "lattice", "outside", "halo_limit"):
        if key in fields and not isinstance(fields[key], int):  # older studies go on
            fields[key] = _number(key, fields[key])
    for key in ("sun_disk", "sky", "memory_limit", "tile", "caster_tile", "block"):
        if key in fields:
            fields[key] = _whole_number(key, fields[key])
    if "curvature" in fields:
        _need(fields["curvature"] in (True, False), f"curvature: {fields['curvature']!r} is neither true nor false")
        fields["curvature"] = bool(fields["curvature"])
    settings = Settings(**fields)
    _check_effect(settings)  # of those of an older study nothing is asked
    return settings


def _number(key: str, value: Any) -> float:
    if key == "step" and isinstance(value, str):
        match = re.fullmatch(r"([0-9.]+) ?(s|min|h)?", value)
        _need(match is not None, f"step: {value!r} is not a number of minutes, nor like '10min', '1h', '30s'")
        assert match is not None
        return float(match[1]) * {"s": 1 / 60, "min": 1, None: 1, "h": 60}[match[2]]
    if key == "step" and hasattr(value, "total_seconds"):
        return float(value.total_seconds()) / 60
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = math.nan
    hours = ": give hours, such as 1 or 5.5" if key == "utc_offset" else ""
    _need(math.isfinite(number), f"{key}: {value!r} is not a finite number{hours}")
    return number


def _whole_number(key: str, value: Any) -> int:
    number = _number(key, value)
    _need(number.is_integer(), f"{key}: {value!r} is not a whole number")
    return int(number)


def read_toml(path: str | Path, **more: Any) -> tuple[Settings, dict[str, Any]]:
    """The settings of a file, and its table [run]: folder, workers, device. more: settings in place of the file's, with
    absolute paths. Raises ValueError or OSError."""
    file = Path(path)
    try:
        values = tomllib.loads(file.read_text("utf-8"))
    except FileNotFoundError:
        raise ValueError(f"{file}: there is no such file") from None
    except UnicodeDecodeError:
        raise ValueError(f"{file}: is no text in UTF-8, as the settings of a study are (docs/studies.md)") from None
    except tomllib.TOMLDecodeError as error:
        raise ValueError(f"{file}: {error}") from None
    run = values.pop("run", {})
    return settings_of(values.pop("study", {}) | values | more, file.absolute().parent), run
