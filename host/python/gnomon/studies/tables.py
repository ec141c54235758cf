# SPDX-License-Identifier: MIT
"""Tables of numbers in .csv and .npy files: suns, weights, points. `gnomon hours` reads the same files;
docs/studies.md has the format of a table of suns."""

from __future__ import annotations

import gzip
import zlib
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

import numpy as np
from numpy.typing import NDArray

from .. import _gnomon
from .._arrays import first_absent_place, first_no_height, first_row

SUN_COLUMNS = ("x", "y", "z"), ("x", "y", "z", "weight")
OBSERVER_COLUMNS = ("x", "y"), ("x", "y", "height")
POINT_COLUMNS = ("x", "y", "z"), ("x", "y", "z", "nx", "ny", "nz")


def _text_of(file: str) -> bytes:
    """The text of a file, unpacked if it is gzip's. What is not UTF-8 is taken for Latin-1: its numbers are the same,
    and messages can have its headings. What is no text stays as it is, and the reader names it."""
    try:
        data = Path(file).read_bytes()
        data = gzip.decompress(data) if data.startswith(b"\x1f\x8b") else data
    except (OSError, EOFError, zlib.error) as error:
        raise ValueError(f"{file}: cannot be read: {getattr(error, 'strerror', None) or error}") from None
    try:
        data.decode()
    except UnicodeDecodeError:
        is_text = b"\0" not in data and not data.startswith(b"\x28\xb5\x2f\xfd")  # zstd's
        return data.decode("latin-1").encode() if is_text else data
    return data


class _NpyTable:
    """Rows of float64 in a .npy file, with the names of its records, or of the one of `unnamed` that has as many
    columns."""

    def __init__(self, file: str, unnamed: tuple[tuple[str, ...], ...], are_points: bool) -> None:
        self.file = file
        self._headings: Any = None
        try:
            values = np.load(file, allow_pickle=False)
        except (ValueError, OSError, EOFError) as error:
            is_objects = "allow_pickle" in str(error)
            what = "holds objects, not numbers: numpy.save(name, array.astype(float)) writes numbers"
            raise ValueError(f"{file}: {what if is_objects else error}") from None
        if values.dtype.names:
            headings = ",".join('"{}"'.format(name.replace('"', '""')) for name in values.dtype.names)
            self._headings = _gnomon.NumberTable(headings.encode(), file, [], are_points)
            self.names = self._headings.names
            self._columns = [self._real(values[name].reshape(-1)) for name in values.dtype.names]
            return
        values = self._real(values)
        if values.ndim not in (1, 2):
            raise ValueError(f"{file}: shape {values.shape} is not (N, columns)")
        self._columns = list(values[:, None].T if values.ndim == 1 else values.T)
        found = [names for names in unnamed if len(names) == len(self._columns)]
        if not found:
            counts = " or ".join(str(len(names)) for names in unnamed)
            raise ValueError(f"{file}: must have {counts} columns, or names for its {len(self._columns)}")
        self.names = list(found[0])

    def _real(self, values: NDArray[Any]) -> NDArray[np.float64]:
        if values.dtype.kind not in "iuf":
            raise ValueError(f"{self.file}: holds {values.dtype}, not real numbers")
        return np.asarray(values, np.float64)

    def __len__(self) -> int:
        return len(self._columns[0]) if self._columns else 0

    def text(self, row: int, name: str) -> str:
        return f"{self._columns[self.names.index(name)][row]:g}"

    def numbers(self, name: str) -> NDArray[np.float64]:
        values = self._columns[self.names.index(name)]
        if (row := first_row(~np.isfinite(values))) is not None:
            self.refuse(row, f'{name} = "{self.text(row, name)}", which is no finite number')
        return values

    def float_numbers(self, name: str) -> NDArray[np.float32]:
        with np.errstate(over="ignore"):
            values = self.numbers(name).astype(np.float32)
        if (row := first_row(~np.isfinite(values))) is not None:
            self.refuse(row, f'{name} = "{self.text(row, name)}", which is beyond float32')
        return values

    def require_degrees(self, azimuths: list[float], elevations: list[float]) -> None:
        self._headings.require_degrees(azimuths, elevations)  # a table without headings has no angles

    def require_places(self, columns: list[str]) -> None:
        rows = np.stack([self.numbers(name) for name in columns], axis=1)
        if (row := first_absent_place(rows)) is not None:
            cells = ", ".join(f'{name} = "{self.text(row, name)}"' for name in columns)
            remedy = "leave the row out, or move it a little if it is a place"
            self.refuse(row, f"{cells}, of which one stands for no data: {remedy}")

    def require_weights(self, column: str) -> None:
        if (row := _gnomon.first_absent_weight(self.numbers(column))) is not None:
            self.refuse(row, f'{column} = "{self.text(row, column)}", which stands for no data: write 0')

    def require_all_or_none(self, columns: list[str]) -> None:
        if self._headings is not None:
            self._headings.require_all_or_none(columns)

    def unread_weights(self) -> str:
        return "" if self._headings is None else str(self._headings.unread_weights())

    def refuse(self, row: int, reason: str) -> NoReturn:
        raise ValueError(f"{self.file}, row {row} has {reason}")

    def require(self, columns: list[str], what: str) -> None:
        if not set(columns) <= set(self.names):
            raise ValueError(f"{self.file}: {what}")


def _table(file: str, unnamed: tuple[tuple[str, ...], ...], are_points: bool = False) -> Any:
    """Columns of a file by name: of text by gnomon's own reader (_gnomon.NumberTable), which `gnomon hours` has, too;
    of a .npy file. Raises ValueError with the row and the column."""
    if file.lower().endswith(".npy"):
        return _NpyTable(file, unnamed, are_points)
    return _gnomon.NumberTable(_text_of(file), file, [list(names) for names in unnamed], are_points)


def _has(table: Any, *names: str) -> bool:
    return set(names) <= set(table.names)


class SunTable(NamedTuple):
    """M suns above the horizon, z up: either their directions or their angles are known.

    towards: (M, 3) float32 vectors to the suns, or None. azimuth: (M,) degrees clockwise from true north, or None.
    elevation: (M,) degrees, or None. weights: (M,). below_horizon: the number of rows that were left out.
    times: M texts of the column time, or nothing. note: a sentence about columns that were not read, or nothing.
    """

    towards: NDArray[np.float32] | None
    azimuth: NDArray[np.float64] | None
    elevation: NDArray[np.float64] | None
    weights: NDArray[np.float64]
    below_horizon: int
    times: list[str]
    note: str


def read_suns(file: str) -> SunTable:
    """Raises ValueError with the row and the column."""
    table = _table(file, SUN_COLUMNS)
    has_angles = _has(table, "azimuth", "elevation")
    if not has_angles:
        table.require(["x", "y", "z"], "a table of suns needs the columns x, y, z or azimuth, elevation")
    has_directions = _has(table, "x", "y", "z")
    if not has_directions:
        table.require_degrees(table.numbers("azimuth").tolist(), table.numbers("elevation").tolist())
    weights = np.ones(len(table))
    if _has(table, "weight"):
        weights = table.float_numbers("weight").astype(np.float64)
        table.require_weights("weight")
    is_up = np.ones(len(table), bool)
    azimuth = elevation = None
    if has_angles:
        azimuth, elevation = table.numbers("azimuth"), table.numbers("elevation")
        if (row := first_row(np.asarray(np.abs(azimuth) > 360))) is not None:
            table.refuse(row, "an azimuth beyond 360 degrees")
        if (row := first_row(np.asarray(np.abs(elevation) > 90))) is not None:
            table.refuse(row, "an elevation beyond 90 degrees")
        is_up = elevation > 0
        azimuth, elevation = azimuth[is_up], elevation[is_up]
    towards = _directions(table, is_up)[is_up] if has_directions else None
    times = [table.text(row, "time") for row in np.flatnonzero(is_up).tolist()] if _has(table, "time") else []
    return SunTable(towards, azimuth, elevation, weights[is_up], int((~is_up).sum()), times, table.unread_weights())


def _directions(table: Any, is_up: NDArray[np.bool_]) -> NDArray[np.float32]:
    """(N, 3) vectors to the suns, z up."""
    x, y, z = (table.float_numbers(name) for name in "xyz")
    if _has(table, "up"):
        ups = np.array([table.text(row, "up") for row in range(len(table))])
        if (row := first_row(~np.isin(ups, ["y", "z"]))) is not None:
            table.refuse(row, f'up = "{ups[row]}", which is neither y nor z')
        is_y_up = ups == "y"
        y, z = np.where(is_y_up, -z, y), np.where(is_y_up, y, z)
    towards = 0 - np.stack([x, y, z], axis=1)  # 0 - x: no minus zero
    if (row := first_row(is_up & (towards[:, 2] <= 0))) is not None:
        table.refuse(row, "x, y, z of light that does not travel downwards")
    return towards


def suns_text(towards: NDArray[np.float32], weights: NDArray[np.float64], times: list[str]) -> str:
    """The .csv file of M suns, z up, which read_suns() and `gnomon hours` take back with the same bits. times: M, or
    none at all."""
    lines = ["time,x,y,z,up,weight" if times else "x,y,z,up,weight"]
    for i, (x, y, z) in enumerate((0 - towards).tolist()):
        time = f"{times[i]}," if times else ""
        lines.append(f"{time}{x:.9g},{y:.9g},{z:.9g},z,{np.float32(weights[i]):.9g}")
    return "\n".join(lines) + "\n"


def read_weights(file: str, count: int) -> NDArray[np.float64]:
    """(count,) the only column of a file, or the one that is called weight. Raises ValueError."""
    table = _table(file, (("weight",),))
    if len(table.names) != 1:
        table.require(["weight"], "must have one column, or a column weight")
    if len(table) != count:
        raise ValueError(f"{file}: has {len(table)} weights, and must have {count}, one per sun of start..end")
    name = "weight" if _has(table, "weight") else table.names[0]
    table.require_weights(name)
    values: NDArray[np.float64] = table.numbers(name)
    return values


def read_points(file: str) -> NDArray[np.float64]:
    """(N, 3) positions, or (N, 6) positions and normals. Raises ValueError."""
    table = _table(file, POINT_COLUMNS, are_points=True)
    positions, with_normals = POINT_COLUMNS
    table.require(list(positions), "points need the columns x, y, z, and nx, ny, nz for the side that they face")
    table.require_all_or_none(["nx", "ny", "nz"])
    names = with_normals if _has(table, *with_normals) else positions
    points = np.stack([table.numbers(name) for name in names], axis=1)
    found = first_no_height(points[:, 2:3], np.ones((len(points), 1), bool))
    if found is not None:
        table.refuse(
            found[0], f"z = {points[found[0], 2]:g}, which is no height but stands for no data: leave the row out"
        )
    table.require_places(list(positions))
    if len(names) > 3 and (row := first_row((points[:, 3:] == 0).all(axis=1))) is not None:
        table.refuse(row, "nx, ny, nz = 0, 0, 0, which is no side")
    return points


def read_observers(file: str) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    """(M, 2) places of observers, and (M,) heights of their eyes if the table has them. Raises ValueError."""
    table = _table(file, OBSERVER_COLUMNS)
    table.require(["x", "y"], "observers need the columns x, y, and perhaps height")
    table.require_places(["x", "y"])
    places = np.stack([table.numbers("x"), table.numbers("y")], axis=1)
    return places, table.numbers("height") if _has(table, "height") else None
