# SPDX-License-Identifier: MIT
"""Checks of arguments. Each function returns the value that the library takes, or raises and names the argument."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

NO_RECEIVER = 0xFFFFFFFF


def is_on_device(array: Any) -> bool:
    """Whether it is a pyopencl array."""
    return hasattr(array, "base_data") and hasattr(array, "queue")


def on_host(array: Any, name: str) -> NDArray[Any]:
    """A numpy array of an object with the array or the DLPack protocol, or of a sequence."""
    if is_on_device(array):
        raise TypeError(f"{name}: must be an array in host memory, not a pyopencl array")
    if not hasattr(array, "__array__") and hasattr(array, "__dlpack__"):
        return np.from_dlpack(array)
    return np.asarray(array)


def first_row(rows: NDArray[np.bool_]) -> int | None:
    """The first row that is marked; None if no row is."""
    marked = np.flatnonzero(rows)
    return int(marked[0]) if marked.size else None


def require_real(array: NDArray[Any], name: str) -> None:
    if array.dtype.kind not in "iuf":
        raise ValueError(f"{name}: must be real numbers, not {array.dtype}")


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


def rows_of_triples(array: Any, name: str) -> NDArray[Any]:
    """An array (..., 3) of real numbers."""
    values = on_host(array, name)
    if values.ndim < 2 or values.shape[-1] != 3:
        raise ValueError(f"{name}: shape {values.shape} is not (..., 3)")
    require_real(values, name)
    return values


def all_finite(array: NDArray[Any]) -> bool:
    """Whether no value is NaN or infinite. Such a value makes the sum NaN or infinite, and the sum takes a tenth of the
    time of a test of each value. A sum of finite values can be infinite, too: then each value is tested."""
    with np.errstate(over="ignore", invalid="ignore"):
        return bool(np.isfinite(array.sum(dtype=np.float64))) or bool(np.isfinite(array).all())


def require_finite(array: NDArray[Any], name: str) -> None:
    if not all_finite(array):
        row = first_row(~np.isfinite(array).all(axis=1))
        raise ValueError(f"{name}: row {row} {array[row].tolist()} is not finite")


def triple(value: Any, name: str) -> tuple[float, float, float]:
    """Three finite numbers, each rounded once to float32."""
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
    values = on_host(vertices, "vertices")
    require_real(values, "vertices")
    if faces is None:
        if values.ndim not in (2, 3) or values.shape[1:] not in ((3, 3), (9,)):
            raise ValueError(f"vertices: shape {values.shape} without faces is neither (F, 3, 3) nor (F, 9)")
        require_finite(values.reshape(-1, 3), "vertices")
        return values.reshape(-1, 3, 3)
    if values.ndim != 2 or values.shape[1] != 3:
        raise ValueError(f"vertices: shape {values.shape} is not (V, 3)")
    require_finite(values, "vertices")
    indices = on_host(faces, "faces")
    if indices.ndim != 2 or indices.shape[1] != 3:
        raise ValueError(f"faces: shape {indices.shape} is not (F, 3)")
    require_integers(indices, "faces")
    row = first_row(np.asarray(((indices < 0) | (indices >= len(values))).any(axis=1)))
    if row is not None:
        raise ValueError(f"faces: row {row} {indices[row].tolist()} names a vertex that is not in 0..{len(values) - 1}")
    return values[indices.astype(np.intp)].reshape(-1, 3, 3)


def receivers_of(receivers: Any, shape: tuple[int, ...], triangle_count: int) -> NDArray[np.uint32]:
    """Ids of triangles, one per point; negative: none."""
    ids = on_host(receivers, "receivers")
    if ids.shape != shape:
        raise ValueError(f"receivers: shape {ids.shape} is not the points' {shape}")
    require_integers(ids, "receivers")
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
    require_finite(flat, "normals")
    row = first_row((flat == 0).all(axis=1))
    if row is not None:
        raise ValueError(f"normals: row {row} is zero, which is no side")
    return scaled(flat)


def scaled(normals: NDArray[np.float64]) -> NDArray[np.float64]:
    """Each row times a power of two, exactly, so that its values lie in the range of float32; rows of zeros stay."""
    _, exponents = np.frexp(np.abs(normals).max(axis=1, initial=0))
    return np.ldexp(normals, -exponents[:, None])
