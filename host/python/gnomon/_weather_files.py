# SPDX-License-Identifier: MIT
"""Weather files as pvlib reads them, in one form. Times come from the rows themselves: pvlib moves leap days of TMY3
files, gives all months of a TMY2 file one year, and drops the minutes of EPW files."""

from __future__ import annotations

import io
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

#: More than the Sun gives outside the air (W/m^2). Files write 9999 for what is missing.
LARGEST = 1500.0
_FORMATS = "an EPW, TMY2 or TMY3 file, PVGIS's typical year (CSV, JSON), or NSRDB's CSV"


class Place(NamedTuple):
    name: str
    latitude: float
    longitude: float
    elevation: float


class Rows(NamedTuple):
    """A file's table with columns dni, dhi, ghi. labels: a time a row, which belongs to the row's day. moment: hours
    from a label to the moment that its values hold for; None: labels are the beginnings of intervals."""

    table: Any
    place: Place
    labels: Any
    moment: float | None


class Readings(NamedTuple):
    place: Place
    middles: Any
    step: float
    dni: NDArray[np.float64]
    dhi: NDArray[np.float64]
    ghi: NDArray[np.float64]


def readings_of(file: Path) -> Readings:
    """What a weather file says. ValueError, one sentence, for what it should not."""
    if file.is_dir():
        raise ValueError(f"{file}: is a folder: name the weather file in it")
    data = file.read_bytes()
    if not data.strip(b"\0 \t\r\n"):
        raise ValueError(f"{file}: the file is empty: download it again")
    kind, rows_of = _format_of(file, data)
    try:
        rows = rows_of(file, data)
    except _RefusedError as error:
        raise ValueError(f"{file}: {error}") from None
    except Exception as error:  # pvlib lets pandas' errors through, of many kinds
        said = (str(error) or repr(error)).splitlines()[0]
        raise ValueError(f"{file}: cannot be read as {kind}: {said}; must be {_FORMATS}") from None
    powers = [_power(file, rows, name) for name in ("dni", "dhi", "ghi")]
    step = _step_of_days(file, rows.labels)
    place = rows.place
    if not (abs(place.latitude) <= 90 and abs(place.longitude) <= 180):
        raise ValueError(f"{file}: its place {place.latitude:g}, {place.longitude:g} is not on Earth")
    return Readings(place, rows.labels + _hours(step / 2 if rows.moment is None else rows.moment), step, *powers)


class _RefusedError(ValueError):
    """What a sentence of ours says of a file."""


def _format_of(file: Path, data: bytes) -> tuple[str, Callable[[Path, bytes], Rows]]:
    """The format by what a file begins with, and its reader."""
    start = data[:200].removeprefix(b"\xef\xbb\xbf").lstrip(b"\r\n")
    suffix = file.suffix.lower()
    if start.startswith(b"LOCATION") or suffix == ".epw":
        return "an EPW file", _epw
    if start.lstrip().startswith(b"{") or suffix == ".json":
        return "PVGIS's JSON", _pvgis_json
    if start.startswith(b"Latitude (decimal degrees)"):
        return "PVGIS's CSV", _pvgis_csv
    if start.startswith(b"Source,Location ID"):
        return "NSRDB's CSV", _nsrdb
    if suffix == ".tm2" or re.match(rb" ?\d{5} [^,]* [NS] +\d+ +\d+ +[EW] ", start):
        return "a TMY2 file", _tmy2
    return "a TMY3 table", _tmy3


def _text(data: bytes) -> io.StringIO:
    """The file's text: UTF-8, or Latin-1 as many EPW files of places with accents are."""
    try:
        return io.StringIO(data.decode("utf-8-sig"))
    except UnicodeDecodeError:
        return io.StringIO(data.decode("latin-1"))


def _hours(hours: Any) -> Any:
    return np.round(np.asarray(hours, np.float64) * 3.6e12).astype("timedelta64[ns]")


def _days(table: Any, zone: Any, year: Any = 0) -> Any:
    import pandas

    parts = {"year": table["year"].astype(int) + year, "month": table["month"], "day": table["day"]}
    return pandas.DatetimeIndex(pandas.to_datetime(parts)).tz_localize(zone)


def _place(name: Any, meta: Any) -> Place:
    latitude, longitude, elevation = (float(meta[key]) for key in ("latitude", "longitude", "altitude"))
    return Place(str(name).strip('" '), latitude, longitude, elevation)


def _epw(file: Path, data: bytes) -> Rows:
    """Rows count hours from 1 on, and minutes to the end of their interval; those of hourly files mean nothing."""
    import pvlib

    if b"COMMENTS 2,Irradiance Time Offset" in data[:2000]:
        raise _RefusedError("PVGIS's EPW files give hours of UTC another time zone: take its CSV or JSON file")
    table, meta = pvlib.iotools.read_epw(_text(data))
    hour, minute = (table[name].to_numpy(np.int64) for name in ("hour", "minute"))
    dates = table[["year", "month", "day", "hour"]].to_numpy()
    is_first = [*(dates[:60] == dates[:1]).all(axis=1).tolist(), False]
    in_hour = max(1, is_first.index(False))
    k = np.arange(len(table)) % in_hour
    bad = np.flatnonzero(minute % 60 * in_hour != (k + 1) % in_hour * 60) if in_hour > 1 else np.empty(0, np.int64)
    if bad.size:
        raise _RefusedError(f"row {bad[0] + 1} has minute {minute[bad[0]]}, where intervals of {60 / in_hour:g} minutes"
                            f" end at {60 * (k[bad[0]] + 1) / in_hour:g}: mend the row")  # fmt: skip
    labels = _days(table, table.index.tz) + _hours(hour - 1 + k / in_hour)
    return Rows(table, _place(meta["city"], meta), labels, None)


def _tmy3(file: Path, data: bytes) -> Rows:
    """Rows have the ends of their intervals; midnight is 24:00, or 0:00 of the day after."""
    import pandas
    import pvlib

    table, meta = pvlib.iotools.read_tmy3(_text(data), map_variables=True)
    table = table.rename(columns={"DNI (W/m^2))": "dni"})  # SolarAnywhere
    days = pandas.DatetimeIndex(pandas.to_datetime(table["Date (MM/DD/YYYY)"], format="%m/%d/%Y"))
    clock = table["Time (HH:MM)"].str.split(":", expand=True).to_numpy(np.float64)
    ends = days.tz_localize(table.index.tz) + _hours(clock[:, 0] + clock[:, 1] / 60)
    return Rows(table, _place(meta["Name"], meta), ends - (ends[1:2] - ends[:1])[0], None)


def _tmy2(file: Path, data: bytes) -> Rows:
    """Rows count hours from 1 on, and years of the 20th century by two digits."""
    import pvlib

    words = data.split(b"\n", 1)[0].split()
    if len(words) != 11:
        raise _RefusedError("its first line has not 11 words, as pvlib needs it: write the city's name as one")
    table, meta = pvlib.iotools.read_tmy2(file)
    table = table.rename(columns={"DNI": "dni", "DHI": "dhi", "GHI": "ghi"})
    labels = _days(table, table.index.tz, 1900) + _hours(table["hour"].to_numpy(np.float64) - 1)
    return Rows(table, _place(meta["City"], meta), labels, None)


def _pvgis_json(file: Path, data: bytes) -> Rows:
    return _pvgis(data, "json")


def _pvgis_csv(file: Path, data: bytes) -> Rows:
    return _pvgis(data, "csv")


def _pvgis(data: bytes, kind: str) -> Rows:
    """Values of moments, some time after their label. Without that time, the labels are the moments."""
    import pvlib

    if b"tmy_hourly" not in data and b"month,year" not in data:
        raise _RefusedError("is no typical year of PVGIS, which alone has direct normal irradiance: take its TMY")
    table, meta = pvlib.iotools.read_pvgis_tmy(io.BytesIO(data), pvgis_format=kind, map_variables=True)
    inputs = meta["inputs"]
    place = inputs.get("location", inputs)
    lag = place.get("irradiance_time_offset", place.get("irradiance time offset", 0.0))
    return Rows(table, _place("PVGIS", place | {"altitude": place["elevation"]}), table.index, float(lag))


def _nsrdb(file: Path, data: bytes) -> Rows:
    """Values of moments: the labels."""
    import pvlib

    table, meta = pvlib.iotools.read_nsrdb_psm4(_text(data), map_variables=True)
    return Rows(table, _place(f"NSRDB {meta.get('Location ID', '')}", meta), table.index, 0.0)


def _power(file: Path, rows: Rows, name: str) -> NDArray[np.float64]:
    """A column of the table, W/m^2."""
    if name not in rows.table:
        raise ValueError(f"{file}: has no column {name}: take a file with direct, diffuse and global irradiance")
    try:
        values = np.asarray(rows.table[name].to_numpy(np.float64))
    except ValueError as error:
        raise ValueError(f"{file}: column {name}: {error}") from None
    bad = np.flatnonzero(~((values >= 0) & (values <= LARGEST)))
    if bad.size:
        raise ValueError(
            f"{file}: column {name} has {values[bad[0]]:g} at {rows.labels[bad[0]]}, which is no power of sunlight in "
            f"W/m^2 ({bad.size:,} of {len(values):,} rows are so): mend the row or take another file"
        )
    return values


def _step_of_days(file: Path, labels: Any) -> float:
    """The length of the intervals in hours, if each day is whole and none comes twice."""
    count = len(labels)
    step = float((labels[1] - labels[0]).total_seconds() / 3600) if count > 1 else 0.0
    in_day = round(24 / step) if step > 0 else 24
    if not 24 <= in_day <= 1440 or count == 0 or count % in_day:
        raise ValueError(f"{file}: has {count:,} rows, which are not whole days")
    days, at = (times.to_numpy("datetime64[ns]").reshape(-1, in_day) for times in (labels.normalize(), labels))
    wrong = np.flatnonzero((np.diff(at, axis=1) != _hours(step)).any(axis=1) | (days != days[:, :1]).any(axis=1))
    if wrong.size:
        first, has = in_day * int(wrong[0]), "hours 1 to 24" if in_day == 24 else f"{in_day} intervals in order"
        raise ValueError(f"{file}: the day of row {first + 1} ({labels[first]:%d %B}) has not {has}")
    found, first_rows = np.unique(days[:, 0], return_index=True)
    if len(found) < len(days):
        again = in_day * int(np.setdiff1d(np.arange(len(days)), first_rows)[0])
        raise ValueError(f"{file}: has {labels[again]:%d %B %Y} twice, again from row {again + 1} on")
    return step
