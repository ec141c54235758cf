# SPDX-License-Identifier: MIT
"""Checks of arguments. Each function returns the value that the library takes, or raises and names the argument."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _gnomon

NO_RECEIVER = 0xFFFFFFFF


def is_on_device(array: Any) -> bool:
    """Whether it is a pyopencl array."""
    return hasattr(array, "base_data") and hasattr(array, "queue")


def on_host(array: Any, name: str) -> NDArray[Any]:
    """A numpy array of an object with the array or the DLPack protocol, or of a sequence. What is masked, None or
    pandas.NA, or no data by a DataArray's attributes, is NaN."""
    if is_on_device(array):
        raise TypeError(f"{name}: must be an array in host memory, not a pyopencl array")
    _require_no_file(array, name)
    if not hasattr(array, "__array__") and hasattr(array, "__dlpack__"):
        return np.from_dlpack(array)
    try:
        values = np.ma.array(array) if _has_mask(array) else np.asarray(array)
    except ValueError as error:  # rows of different lengths
        raise ValueError(f"{name}: is no array: {error}") from None
    absent = np.ma.getmaskarray(values) if isinstance(values, np.ma.MaskedArray) else _declared_absent(array, values)
    if values.dtype == object:
        values, absent = _numbers_of(np.asarray(values), absent)
    if absent is None or not absent.any():
        return np.asarray(values)
    real = values.dtype if values.dtype.kind == "f" else np.dtype(np.float64)
    return np.where(absent, np.array(np.nan, real), np.asarray(values).astype(real))


def _require_no_file(array: Any, name: str) -> None:
    is_name = isinstance(array, os.PathLike) or (isinstance(array, str) and os.path.splitext(array)[1] != "")
    if not is_name and (not hasattr(array, "read") or hasattr(array, "__array__")):
        return
    if name == "heights":
        call = "rasterio.open(file).read(1, masked=True)"
    elif name.endswith("alpha"):
        call = "numpy.asarray(PIL.Image.open(file).convert('RGBA'))[..., 3]"
    else:
        call = "numpy.load(file), or numpy.loadtxt(file, delimiter=',')"
    given = repr(os.fspath(array)) if is_name else type(array).__name__
    raise ValueError(f"{name}: must be an array, not a file ({given}): {call} makes one")


def _has_mask(array: Any) -> bool:
    """A list of masked arrays has a mask, too, which numpy.asarray() drops."""
    return isinstance(array, np.ma.MaskedArray) or (
        isinstance(array, list | tuple) and any(isinstance(one, np.ma.MaskedArray) for one in array)
    )


#: nodatavals: of xarray.open_rasterio(), a value for each band.
NO_DATA_ATTRIBUTES = ("_FillValue", "missing_value", "nodata", "nodatavals")


def declared_no_data(array: Any) -> list[Any]:
    """The values that an xarray.DataArray's attributes declare for no data."""
    attrs = getattr(array, "attrs", {})
    return [value for key in NO_DATA_ATTRIBUTES for value in np.atleast_1d(attrs.get(key, ()))]


def _declared_absent(array: Any, values: NDArray[Any]) -> NDArray[np.bool_] | None:
    """Where an xarray.DataArray that was read as it lies in its file has the value that stands for no data."""
    absent = None
    if hasattr(array, "dims") and values.dtype.kind in "iuf":
        for value in declared_no_data(array):
            absent = (values == value) | (False if absent is None else absent)
    return absent


def _numbers_of(
    objects: NDArray[Any], absent: NDArray[np.bool_] | None
) -> tuple[NDArray[Any], NDArray[np.bool_] | None]:
    """Python's integers as int64, if it holds them, its numbers as float64; None and pandas.NA as NaN. Others stay."""
    is_absent = np.array([one is None or type(one).__name__ in ("NAType", "NaTType") for one in objects.flat], bool)
    is_absent = is_absent.reshape(objects.shape) | (False if absent is None else absent)
    try:
        is_whole = all(isinstance(one, int | np.integer) and abs(int(one)) < 2**63 for one in objects.flat)
        if is_whole:
            return objects.astype(np.int64), None
        return np.where(is_absent, np.nan, objects).astype(np.float64), is_absent
    except (TypeError, ValueError):
        return objects, absent


def integers_on_host(array: Any, name: str) -> NDArray[Any]:
    """The same of integers, none of which may be absent."""
    values = on_host(array, name)
    if values.dtype.kind == "f" and np.isnan(values).any():
        row = first_row(np.isnan(values).reshape(len(values), -1).any(axis=1))
        raise ValueError(f"{name}: row {row} is masked or has no value")
    require_integers(values, name)
    return values


#: Values that files hold where they have no data, and that no place has: the extremes of float and double, netCDF's
#: and Surfer's.
FILL_VALUES = (*(s * float(np.finfo(t).max) for t in (np.float32, np.float64) for s in (-1, 1)),
               9.969209968386869e36, 9.96921e36, 1.70141e38, 1.7014118346046923e38, 3.4e38, -3.4e38, 3.40282e38,
               -3.40282e38, 3.402823e38, -3.402823e38, 3.4028235e38, -3.4028235e38)  # fmt: skip


def _fill_values_of(array: NDArray[Any]) -> NDArray[Any] | None:
    """Those that its type holds; None where no value is far out. Of integers the extremes of 32 and 64 bits, which NaN
    becomes; 16 bits are full of quantized positions."""
    if not array.size:
        return None
    if array.dtype.kind in "iu":
        limits = np.iinfo(array.dtype)
        values = np.array([n for n in (limits.min, limits.max) if n != 0], array.dtype)
        return values if limits.bits >= 32 and np.isin(values, (array.min(), array.max())).any() else None
    if array.dtype.kind != "f" or max(-float(np.nanmin(array)), float(np.nanmax(array))) < 1e36:
        return None
    with np.errstate(over="ignore"):
        return np.array(FILL_VALUES).astype(array.dtype)


def first_fill_value(array: NDArray[Any]) -> int | None:
    """The first of the rows (N, ...) of real numbers with one of FILL_VALUES or of an integer's extremes."""
    values = _fill_values_of(array)
    if values is None:
        return None
    is_fill = np.isin(array, values) & np.isfinite(array)
    return first_row(is_fill.reshape(len(array), -1).any(axis=1))


def require_no_fill_values(array: NDArray[Any], name: str) -> None:
    """Rows (N, ...) of real numbers."""
    _refuse_no_data(array, name, first_fill_value(array))


def _refuse_no_data(array: NDArray[Any], name: str, row: int | None) -> None:
    if row is not None:
        remedy = "make it NaN, with nan='absent'" if name == "points" else "leave it out"
        raise ValueError(
            f"{name}: row {row} {array[row].tolist()} has a value that stands for no data in files: {remedy}, or move "
            "it a little if it is a place"
        )


def first_absent_place(rows: NDArray[Any]) -> int | None:
    """Of rows (N, C) of coordinates, C of 2 or 3: the first with a coordinate that stands for no data, -9999, say, far
    from all others. Quantized positions, integers of 16 bits or fewer, are places."""
    if not rows.size or (rows.dtype.kind in "iu" and rows.dtype.itemsize <= 2):
        return None
    low, high = (float(f.reduce(rows, axis=None)) for f in (np.fmin, np.fmax))
    if low > -9998 and high < 1e19:
        return None
    return _gnomon.first_absent_place(
        np.ascontiguousarray(rows, np.float32 if rows.dtype == np.float32 else np.float64)
    )


def require_places(places: NDArray[Any], name: str) -> None:
    """Rows (N, C) of coordinates. Raises ValueError for a value that is not finite or stands for no data."""
    require_finite(places, name)
    _refuse_no_data(places, name, first_absent_place(places))


def require_points(points: NDArray[Any], nan: str = "error") -> None:
    """Rows (N, 3) of real numbers. nan: what NaN is, "error" or "absent"."""
    if nan == "error":
        return require_places(points, "points")
    require_no_fill_values(points, "points")
    _refuse_no_data(points, "points", first_absent_place(points))


LOWEST_HEIGHT = -99_000.0


def first_no_height(
    heights: NDArray[Any], is_there: NDArray[np.bool_], says_no_data: bool = False
) -> tuple[int, int] | None:
    """Row and column of the first height that stands for no data and does not say so: one of _gnomon.no_data, anything
    of 1e30 or more, and the extremes of a type of 16 bits or more. Also the lowest or the highest, more than twice as
    far out as all others or the only one, if it is all nines (_gnomon.no_data_beside_places) or below -99 000, unless
    the file says what its no data is."""
    is_there = is_there & np.isfinite(heights)
    low, high = heights.min(where=is_there, initial=0), heights.max(where=is_there, initial=0)
    is_usual = low > -99 and high < 9999
    alone = [] if says_no_data or is_usual else [n for n in (low, high) if _is_alone(heights, is_there, n)]
    if not alone and low > -9999 and high < 32767:
        return None
    if heights.dtype.kind in "iu":
        limits = np.iinfo(heights.dtype)
        extremes = [n for n in (limits.min, limits.max) if n != 0 and heights.dtype.itemsize > 1]
        listed = [int(n) for n in _gnomon.no_data if limits.min <= n <= limits.max]
        is_wrong = np.isin(heights, np.array([*extremes, *listed]))
    else:
        with np.errstate(over="ignore"):
            is_wrong = (np.abs(heights) >= 1e30) | np.isin(heights, np.array(_gnomon.no_data, heights.dtype))
    for number in alone:
        is_wrong = is_wrong | (heights == number)
    found = np.argwhere(is_wrong & is_there)
    return (int(found[0][0]), int(found[0][1])) if len(found) else None


def _is_alone(heights: NDArray[Any], is_there: NDArray[np.bool_], number: Any) -> bool:
    """Whether the lowest or highest height stands for no data where no other is half as far out, and none is."""
    of_type = heights.dtype if heights.dtype.kind == "f" else np.float64
    is_nines = number in np.array(_gnomon.no_data_beside_places).astype(of_type)
    if not is_nines and number > LOWEST_HEIGHT:
        return False
    others = heights[is_there & (heights != number)]
    return not others.size or bool((others.min() > number / 2) if number < 0 else (others.max() < number / 2))


def is_of_heights(standard_name: str) -> bool:
    """Whether a name of the CF conventions is one of heights; none says nothing."""
    words = ("altitude", "height", "elevation", "topography", "orography")
    return not standard_name or any(word in standard_name for word in words)


def require_heights(
    heights: NDArray[Any], is_there: NDArray[np.bool_], how_to_say: str, says_no_data: bool = False
) -> None:
    """Of arrays: raises ValueError for a height that stands for no data. how_to_say: that it does; {} is the value."""
    found = first_no_height(heights, is_there, says_no_data)
    if found is not None:
        value = heights[found].item()
        other = f"; if the ground lies there, say {how_to_say.format('-32768')}" if value > -9999 else ""
        raise ValueError(
            f"heights: row {found[0]}, column {found[1]} is {value:.9g}, which is no height but stands for no data in "
            f"files: say {how_to_say.format(repr(value))}, or make such cells NaN{other}"
        )


#: First words of attrs["units"] that are metres.
METRES = ("", "m", "m.", "metre", "metres", "meter", "meters", "mtr")


def require_attributes_of_heights(dem: Any) -> None:
    """Of a DataArray. Raises ValueError where its attributes say that it is none of heights in metres."""
    units = str(dem.attrs.get("units", "")).strip()
    if (units.lower().split() or [""])[0] not in METRES:
        raise ValueError(
            f"heights: attrs['units'] is {units!r}, which is not metres: multiply them by the metres of that unit, and "
            "say so, as in (dem * 0.3048).assign_attrs(units='m')"
        )
    what = str(dem.attrs.get("standard_name", ""))
    if not is_of_heights(what):
        raise ValueError(
            f"heights: attrs['standard_name'] is {what!r}, which is none of heights: if they are, del "
            "dem.attrs['standard_name']"
        )
    packing = [key for key, none in (("scale_factor", 1), ("add_offset", 0)) if dem.attrs.get(key, none) != none]
    if packing:
        raise ValueError(
            f"heights: are packed numbers (attrs['{packing[0]}'] is {dem.attrs[packing[0]]}): decode them first, as in "
            "xarray.decode_cf(dem.to_dataset(name='z')).z"
        )


def first_row(rows: NDArray[np.bool_]) -> int | None:
    """The first row that is marked; None if no row is."""
    marked = np.flatnonzero(rows)
    return int(marked[0]) if marked.size else None


def require_real(array: NDArray[Any], name: str) -> None:
    if array.dtype.names:
        raise ValueError(
            f"{name}: must be real numbers, not records of {', '.join(array.dtype.names)}: "
            "numpy.lib.recfunctions.structured_to_unstructured(records) makes them"
        )
    if array.dtype.kind not in "iuf":
        one = array.flat[0] if array.size and array.dtype == object else None
        kind = array.dtype if one is None else type(one).__name__
        remedy = ": numpy.asarray() must make an array of it, of numbers" if one is not None and array.ndim == 0 else ""
        remedy = ": give the list() of an iterator" if isinstance(one, Iterator) else remedy
        raise ValueError(f"{name}: must be real numbers, not {kind}{remedy}")


def number(value: Any, name: str, least: float = -np.inf) -> float:
    """One finite number. Raises ValueError."""
    is_number = isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)
    if not is_number or not np.isfinite(value) or value < least:
        below = "" if least == -np.inf else f", at least {least:g}"
        raise ValueError(f"{name}: must be a finite number{below}, not {value!r}")
    return float(value)


def per_observer(value: Any, count: int, name: str) -> NDArray[np.float64]:
    """(count,) of a number, or of one for each. Raises ValueError."""
    values = on_host(value, name)
    if values.shape not in ((), (count,)) or values.dtype.kind not in "iuf" or np.isnan(values).any():
        raise ValueError(f"{name}: must be a number, or one for each of the {count} observers, not {value!r}")
    return np.broadcast_to(values.astype(np.float64), (count,))


def exponent_of_step(step: Any) -> int:
    """Of a lattice's step, a power of two. Raises ValueError."""
    is_number = isinstance(step, int | float | np.integer | np.floating) and not isinstance(step, bool)
    fraction, exponent = math.frexp(step) if is_number and step > 0 and math.isfinite(step) else (0.0, 0)
    if fraction != 0.5:
        raise ValueError(f"lattice: the step {step!r} is not a power of two, such as 2**-10")
    return exponent - 1


def require_integers(array: NDArray[Any], name: str) -> None:
    if array.size and array.dtype.kind not in "iu":
        raise ValueError(f"{name}: must be integers, not {array.dtype}")


def not_float32(array: NDArray[Any]) -> int | None:
    """The first row with a value that is no float32 value; None if there is none."""
    if array.dtype == np.float32:
        return None
    with np.errstate(over="ignore", invalid="ignore"):
        is_float32 = (array.astype(np.float32) == array) | np.isnan(array)
    return first_row(~is_float32.all(axis=tuple(range(1, array.ndim))))


def moved_by_float32(array: NDArray[Any]) -> float:
    """The largest distance by which rounding to float32 moves a coordinate; NaN does not count."""
    if array.dtype == np.float32 or not array.size:
        return 0.0
    with np.errstate(over="ignore", invalid="ignore"):
        moved = np.abs(array.astype(np.float32).astype(np.float64) - array)
    return float(np.nanmax(moved, initial=0.0)) if not np.isnan(moved).all() else 0.0


def float32_of(array: NDArray[Any], name: str) -> NDArray[np.float32]:
    """The values as float32, C-contiguous, each rounded once."""
    with np.errstate(over="ignore"):
        rounded = np.ascontiguousarray(array, dtype=np.float32)
    row = first_row(np.asarray((np.isinf(rounded) & np.isfinite(array)).any(axis=1)))
    if row is not None:
        raise ValueError(f"{name}: row {row} {array[row].tolist()} is beyond float32")
    return rounded


def _three_of(names: Any, of_one: str) -> list[Any] | None:
    """Of names those that are x, y and z, of normals nx, ny and nz too, in any case; None unless each is there once."""
    places = {one.strip().lower(): one for one in names}
    for three in [("nx", "ny", "nz")] * (of_one == "normals") + [("x", "y", "z")]:
        if len(places) == len(names) and all(one in places for one in three):
            return [places[one] for one in three]
    return None


def _labelled(array: Any, name: str) -> Any:
    """An xarray.DataArray with a dimension whose labels are x, y and z: with them in this order, along the last axis.
    Other objects stay as they are."""
    for dim in array.dims if hasattr(array, "dims") and hasattr(array, "sel") and hasattr(array, "transpose") else ():
        labels = array.coords[dim].values.tolist() if dim in array.coords else []
        if labels and all(isinstance(one, str) for one in labels) and (three := _three_of(labels, name)):
            return array.sel({dim: three}).transpose(..., dim)
    return array


def names_of_columns(table: Any) -> list[str]:
    """Of a table, an xarray.Dataset or a structured array; none of other objects, and of columns without names."""
    if hasattr(table, "data_vars"):
        return [str(key) for key in table.data_vars]
    names: Any = getattr(getattr(table, "dtype", None), "names", None)
    names = getattr(table, "columns", None) if names is None else names
    is_named = names is not None and not callable(names) and all(isinstance(one, str) for one in names)
    return list(names) if is_named else []


def columns_of(array: Any, name: str) -> Any:
    """Of a table, an xarray.Dataset or a structured array the columns x, y and z, of normals nx, ny and nz too,
    wherever they stand; of a DataArray the labels. Other objects stay as they are, and so does a table whose columns
    have no names."""
    array = _labelled(array, name)
    for part in ("points", "vertices"):
        if not isinstance(array, np.ndarray) and not hasattr(array, "__array__") and hasattr(array, part):
            raise TypeError(f"{name}: {type(array).__name__} is no array: give its {part}, numpy.asarray(it.{part})")
    names = names_of_columns(array)
    if not names and not hasattr(array, "data_vars"):
        return array
    three = _three_of(names, name)
    if three is None:
        given = ", ".join(names)
        raise ValueError(f"{name}: of the columns {given} three must be x, y, z, each once; or give an array (N, 3)")
    return np.stack([on_host(array[one], name) for one in three], axis=-1)


def rows_of_triples(array: Any, name: str) -> NDArray[Any]:
    """An array (..., 3) of real numbers. Tables by the names of their columns."""
    values = on_host(columns_of(array, name), name)
    require_real(values, name)
    if values.ndim < 2 or values.shape[-1] != 3:
        raise ValueError(f"{name}: shape {values.shape} is not (..., 3)")
    return values


def all_finite(array: NDArray[Any]) -> bool:
    """Whether no value is NaN or infinite. Such a value makes the sum NaN or infinite, and the sum takes a tenth of the
    time of a test of each value. A sum of finite values can be infinite, too: then each value is tested."""
    with np.errstate(over="ignore", invalid="ignore"):
        return bool(np.isfinite(array.sum(dtype=np.float64))) or bool(np.isfinite(array).all())


def require_finite(array: NDArray[Any], name: str) -> None:
    if not all_finite(array):
        row = first_row(~np.isfinite(array).all(axis=1))
        if row is not None:
            raise ValueError(f"{name}: row {row} {array[row].tolist()} is not finite, or is masked")
    require_no_fill_values(array, name)


def triple(value: Any, name: str) -> tuple[float, float, float]:
    """Three finite numbers, each rounded once to float32. Of a mapping or a pandas.Series with these names x, y, z."""
    names = getattr(value, "index", None) if hasattr(value, "iloc") else value if isinstance(value, dict) else None
    if names is not None and all(isinstance(one, str) for one in names):
        three = _three_of(names, name)
        if three is None:
            raise ValueError(
                f"{name}: of the names {', '.join(names)} three must be x, y, z, each once; or give three numbers"
            )
        value = [value[one] for one in three]
    values = on_host(value, name)
    if values.shape != (3,) or values.dtype.kind not in "iuf":
        raise ValueError(f"{name}: must be three numbers, not {value!r}")
    with np.errstate(over="ignore"):
        rounded = values.astype(np.float32)
    if not np.isfinite(rounded).all():
        raise ValueError(f"{name}: {values.tolist()} is not finite in float32")
    return float(rounded[0]), float(rounded[1]), float(rounded[2])


def triangles_of(vertices: Any, faces: Any) -> NDArray[Any]:
    """Triangles (F, 3, 3) of a mesh's vertices (V, 3) and faces (F, 3), or of triangles (F, 3, 3) or (F, 9), in the
    vertices' own dtype."""
    values = on_host(vertices if faces is None else columns_of(vertices, "vertices"), "vertices")
    require_real(values, "vertices")
    if faces is None:
        if values.ndim not in (2, 3) or values.shape[1:] not in ((3, 3), (9,)):
            raise ValueError(f"vertices: shape {values.shape} without faces is neither (F, 3, 3) nor (F, 9)")
        require_places(values.reshape(-1, 3), "vertices")
        return values.reshape(-1, 3, 3)
    if values.ndim != 2 or values.shape[1] != 3:
        raise ValueError(f"vertices: shape {values.shape} is not (V, 3)")
    require_places(values, "vertices")
    indices = integers_on_host(faces, "faces")
    if indices.ndim != 2 or indices.shape[1] != 3:
        raise ValueError(f"faces: shape {indices.shape} is not (F, 3)")
    row = first_row(np.asarray(((indices < 0) | (indices >= len(values))).any(axis=1)))
    if row is not None:
        raise ValueError(f"faces: row {row} {indices[row].tolist()} names a vertex that is not in 0..{len(values) - 1}")
    return values[indices.astype(np.intp)].reshape(-1, 3, 3)


def receivers_of(receivers: Any, shape: tuple[int, ...], triangle_count: int) -> NDArray[np.uint32]:
    """Ids of triangles, one per point; negative or masked: none."""
    if isinstance(receivers, np.ma.MaskedArray):
        receivers = receivers.filled(-1)
    ids = integers_on_host(receivers, "receivers")
    if ids.shape != shape:
        raise ValueError(f"receivers: shape {ids.shape} is not the points' {shape}")
    flat = ids.reshape(-1)
    row = first_row((flat >= triangle_count) & (flat != NO_RECEIVER))
    if row is not None:
        raise ValueError(f"receivers: row {row} names triangle {int(flat[row])} of {triangle_count}")
    return np.where(flat < 0, NO_RECEIVER, flat).astype(np.uint32)


def normals_of(normals: Any, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """One normal per point, finite and not zero, each scaled so that its largest coordinate is below 2."""
    values = rows_of_triples(normals, "normals")
    if values.shape != shape:
        raise ValueError(f"normals: shape {values.shape} is not the points' {shape}")
    flat = values.reshape(-1, 3).astype(np.float64)
    require_places(flat, "normals")
    row = first_row((flat == 0).all(axis=1))
    if row is not None:
        raise ValueError(f"normals: row {row} is zero, which is no side")
    return scaled(flat)


def scaled(normals: NDArray[np.float64]) -> NDArray[np.float64]:
    """Each row times a power of two, exactly, so that its values lie in the range of float32; rows of zeros stay."""
    _, exponents = np.frexp(np.abs(normals).max(axis=1, initial=0))
    return np.ldexp(normals, -exponents[:, None])


def unpacked(words: NDArray[np.uint32], count: int) -> NDArray[np.bool_]:
    """(..., count): the bits of words (..., W), the lowest one of the first word first."""
    as_bytes = np.ascontiguousarray(words, "<u4").view(np.uint8)
    return np.unpackbits(as_bytes, axis=-1, count=count, bitorder="little").view(bool)
