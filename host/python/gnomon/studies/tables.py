# SPDX-License-Identifier: MIT
"""Tables of numbers in .csv and .npy files: suns, weights, points. `gnomon hours` reads the same files;
docs/studies.md has the format of a table of suns."""

from __future__ import annotations

import array
import csv
import math
from collections.abc import Sequence
from typing import Any, NamedTuple, NoReturn

import numpy as np
from numpy.typing import NDArray

from .._arrays import first_row

SUN_COLUMNS = ("x", "y", "z"), ("x", "y", "z", "weight")
POINT_COLUMNS = ("x", "y", "z"), ("x", "y", "z", "nx", "ny", "nz")


def _finite_number(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


class NumberTable:
    """Columns of a file by name. The first line of a .csv file names them, in any order, unless it begins with a
    number; empty lines, and lines that begin with #, do not count. A .npy file has rows of float64 and no names.
    Columns without names get those of the one of `unnamed` that has as many. Raises ValueError."""

    def __init__(self, file: str, unnamed: tuple[tuple[str, ...], ...]) -> None:
        self.file = file
        self.names: list[str] = []
        self._numbers: Sequence[Any] = []  # of each column, (N,); NaN where a cell is no finite number
        self._texts: dict[tuple[int, int], str] = {}  # of the other cells, by row and column
        self._lines = array.array("q")  # of each row of a .csv file
        if file.endswith(".npy"):
            self._read_npy(unnamed)
            return
        try:
            self._read_csv(unnamed)
        except (OSError, UnicodeDecodeError, csv.Error) as error:
            raise ValueError(f"{file}: {error}") from None

    def _read_npy(self, unnamed: tuple[tuple[str, ...], ...]) -> None:
        try:
            values = np.asarray(np.load(self.file, allow_pickle=False), np.float64)
        except (ValueError, OSError, EOFError) as error:
            raise ValueError(f"{self.file}: {error}") from None
        if values.ndim not in (1, 2):
            raise ValueError(f"{self.file}: shape {values.shape} is not (N, columns)")
        self._numbers = list(values[:, None].T if values.ndim == 1 else values.T)
        self.names = self._names_for(len(self._numbers), unnamed)

    def _read_csv(self, unnamed: tuple[tuple[str, ...], ...]) -> None:
        with open(self.file, newline="", encoding="utf-8-sig") as stream:
            reader = csv.reader(stream, skipinitialspace=True)
            for line in reader:
                cells = [cell.strip() for cell in line]
                if cells in ([], [""]) or cells[0].startswith("#"):
                    continue
                numbers = [_finite_number(cell) for cell in cells]
                if not self.names:
                    self.names = self._names_for(len(cells), unnamed) if numbers[0] is not None else cells
                    self._numbers = [array.array("d") for _ in cells]
                    if numbers[0] is None:
                        continue
                row = len(self._lines)
                self._lines.append(reader.line_num)
                if len(cells) != len(self.names):
                    self.refuse(row, f"{len(cells)} columns in place of {len(self.names)}")
                for column, number in enumerate(numbers):
                    self._numbers[column].append(math.nan if number is None else number)
                    if number is None:
                        self._texts[row, column] = cells[column]

    def _names_for(self, count: int, unnamed: tuple[tuple[str, ...], ...]) -> list[str]:
        for names in unnamed:
            if len(names) == count:
                return list(names)
        counts = " or ".join(str(len(names)) for names in unnamed)
        raise ValueError(f"{self.file}: must have {counts} columns, or names for its {count}")

    def __len__(self) -> int:
        return len(self._numbers[0]) if self._numbers else 0

    def has(self, *names: str) -> bool:
        return all(name in self.names for name in names)

    def refuse(self, row: int, reason: str) -> NoReturn:
        place = f"line {self._lines[row]}" if self._lines else f"row {row}"
        raise ValueError(f"{self.file}, {place} has {reason}")

    def text(self, row: int, name: str) -> str:
        column = self.names.index(name)
        return self._texts.get((row, column)) or f"{self._numbers[column][row]:g}"

    def column(self, name: str) -> NDArray[np.float64]:
        """(N,) finite numbers. Raises ValueError with the row and the column."""
        values = np.array(self._numbers[self.names.index(name)], np.float64)
        row = first_row(~np.isfinite(values))
        if row is not None:
            self.refuse(row, f'{name} = "{self.text(row, name)}", which is no finite number')
        return values

    def columns(self, *names: str) -> NDArray[np.float64]:
        """(N, C) the columns of these names."""
        return np.stack([self.column(name) for name in names], axis=1)


class SunTable(NamedTuple):
    """M suns above the horizon, z up: either their directions or their angles are known.

    towards: (M, 3) float32 vectors to the suns, or None. azimuth: (M,) degrees clockwise from true north, or None.
    elevation: (M,) degrees, or None. weights: (M,). below_horizon: the number of rows that were left out.
    """

    towards: NDArray[np.float32] | None
    azimuth: NDArray[np.float64] | None
    elevation: NDArray[np.float64] | None
    weights: NDArray[np.float64]
    below_horizon: int


def read_suns(file: str) -> SunTable:
    """Raises ValueError with the row and the column."""
    table = NumberTable(file, SUN_COLUMNS)
    has_angles = table.has("azimuth", "elevation")
    if not has_angles and not table.has("x", "y", "z"):
        raise ValueError(f"{file}: a table of suns needs the columns x, y, z or azimuth, elevation")
    weights = _weights(table) if table.has("weight") else np.ones(len(table))
    is_up = np.ones(len(table), bool)
    azimuth = elevation = None
    if has_angles:
        azimuth, elevation = table.column("azimuth"), table.column("elevation")
        if (row := first_row(np.asarray(np.abs(elevation) > 90))) is not None:
            table.refuse(row, "an elevation beyond 90 degrees")
        is_up = elevation > 0
        azimuth, elevation = azimuth[is_up], elevation[is_up]
    towards = _directions(table, is_up)[is_up] if table.has("x", "y", "z") else None
    return SunTable(towards, azimuth, elevation, weights[is_up], int((~is_up).sum()))


def _weights(table: NumberTable) -> NDArray[np.float64]:
    """(N,) float32 values, as gnomon.Lights has them."""
    with np.errstate(over="ignore"):
        weights = table.column("weight").astype(np.float32).astype(np.float64)
    if (row := first_row(~np.isfinite(weights))) is not None:
        table.refuse(row, "a weight beyond float32")
    return weights


def _directions(table: NumberTable, is_up: NDArray[np.bool_]) -> NDArray[np.float32]:
    """(N, 3) vectors to the suns, z up."""
    x, y, z = table.columns("x", "y", "z").T
    if table.has("up"):
        ups = np.array([table.text(row, "up") for row in range(len(table))])
        if (row := first_row(~np.isin(ups, ["y", "z"]))) is not None:
            table.refuse(row, f'up = "{ups[row]}", which is neither y nor z')
        is_y_up = ups == "y"
        y, z = np.where(is_y_up, -z, y), np.where(is_y_up, y, z)
    with np.errstate(over="ignore"):
        towards = (0.0 - np.stack([x, y, z], axis=1)).astype(np.float32)  # 0 - x: no minus zero
    if (row := first_row(np.asarray(~np.isfinite(towards).all(axis=1)))) is not None:
        table.refuse(row, "x, y, z beyond float32")
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
    """(count,) the only column of a file. Raises ValueError."""
    table = NumberTable(file, (("weight",),))
    if len(table.names) != 1:
        raise ValueError(f"{file}: has {len(table.names)} columns, and must have 1")
    if len(table) != count:
        raise ValueError(f"{file}: has {len(table)} weights, and must have {count}, one per sun of start..end")
    return table.column(table.names[0])


def read_points(file: str) -> NDArray[np.float64]:
    """(N, 3) positions, or (N, 6) positions and normals. Raises ValueError."""
    table = NumberTable(file, POINT_COLUMNS)
    positions, with_normals = POINT_COLUMNS
    if not table.has(*positions):
        raise ValueError(f"{file}: points need the columns x, y, z, and nx, ny, nz for the side that they face")
    if not table.has(*with_normals):
        return table.columns(*positions)
    points = table.columns(*with_normals)
    if (row := first_row((points[:, 3:] == 0).all(axis=1))) is not None:
        table.refuse(row, "nx, ny, nz = 0, 0, 0, which is no side")
    return points
