# SPDX-License-Identifier: MIT
"""Cut-outs: triangles with holes, which a texture's alpha decides."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _arrays, _gnomon

Wrap = Literal["repeat", "mirror", "clamp"]
WRAPS = ("repeat", "mirror", "clamp")
FILTERS = ("nearest", "linear")
OPAQUE = 0xFFFFFFFF
LARGEST_SIDE = 32768


class CutOut(NamedTuple):
    """A material with holes. A triangle of it blocks, and is seen, at a point X only where texel(X) * factor * alpha of
    the corners at X is at least the cutoff, decided exactly: texel(X) >= 255 cutoff / factor, which is rounded once to
    a multiple of 2^-16. A cutoff up to 0: everywhere; a cutoff above 1, or a factor up to 0: nowhere.

    alpha: (height, width) uint8, row by row, the first texel at (u, v) = (0, 0); None: 255 everywhere.
    wrap: what a coordinate outside of 0..1 stands for, "repeat", "mirror" or "clamp": one word, or two for u and v.
    filter: "linear", the exact bilinear mean of four texels, or "nearest", the greatest where a border is hit.
    """

    alpha: Any = None
    cutoff: float = 0.5
    factor: float = 1.0
    wrap: Wrap | tuple[Wrap, Wrap] = "repeat"
    filter: Literal["linear", "nearest"] = "linear"


class CutOuts(NamedTuple):
    """The cut-outs of a scene's F triangles.

    material: (F,) indices of `materials`, negative for an opaque triangle.
    materials: the materials with holes.
    uv: texture coordinates, (F, 3, 2), or (V, 2), one of each vertex of a mesh with faces. float32 values, or float64,
        which are rounded once. None: no texture is used.
    corner_alpha: alpha of each corner, 0 to 1, (F, 3), or (V,) of each vertex; None: 1.
    Arrays may be numpy's or pyopencl's; they are copied.
    """

    material: Any
    materials: Sequence[CutOut]
    uv: Any = None
    corner_alpha: Any = None


class CutOutCounts(NamedTuple):
    """Numbers of triangles that have a material; masked + opaque + clear are all of them.

    masked: the texture decides each hit. opaque: the triangle blocks everywhere. clear: it blocks nothing, and no
        camera sees it.
    unusable: opaque ones with a coordinate that is NaN or 2^30 texels or more away, or an alpha outside 0..1.
    """

    masked: int = 0
    opaque: int = 0
    clear: int = 0
    unusable: int = 0


def native_of(cut_outs: CutOuts, faces: NDArray[Any] | None, count: int) -> _gnomon.CutOuts:
    """The library's cut-outs for `count` triangles. Raises ValueError with the argument's name."""
    material = _host(cut_outs.material, "cut_outs.material")
    if material.shape != (count,):
        raise ValueError(f"cut_outs.material: shape {material.shape} is not ({count},), one for each triangle")
    _arrays.require_integers(material, "cut_outs.material")
    row = _arrays.first_row((material >= len(cut_outs.materials)) & (material != OPAQUE))
    if row is not None:
        raise ValueError(
            f"cut_outs.material: row {row} names material {int(material[row])} of {len(cut_outs.materials)}"
        )
    textures: dict[int, tuple[int, NDArray[np.uint8]]] = {}
    native = _gnomon.CutOuts(
        np.where(material < 0, OPAQUE, material).astype(np.uint32),
        _corners(cut_outs.uv, faces, (count, 3, 2), "cut_outs.uv"),
        _corners(cut_outs.corner_alpha, faces, (count, 3), "cut_outs.corner_alpha"),
    )
    for i, cut_out in enumerate(cut_outs.materials):
        _add_material(native, cut_out, f"cut_outs.materials[{i}]", textures)
    for _, alpha in textures.values():
        native.add_texture(alpha)
    return native


def decode_alpha(data: bytes) -> NDArray[np.uint8]:
    """The alpha of an image file, (height, width). Raises ImportError without Pillow, ValueError for 16-bit alpha."""
    from PIL import Image

    with Image.open(io.BytesIO(data)) as image:
        if data[:8] == b"\x89PNG\r\n\x1a\n" and data[24] == 16 and data[25] in (4, 6):
            raise ValueError("has 16-bit alpha, which Pillow does not round")
        if max(image.size) > LARGEST_SIDE:
            raise ValueError(f"has {image.width}x{image.height} texels; each side may have {LARGEST_SIDE}")
        return np.ascontiguousarray(np.asarray(image.convert("RGBA"))[:, :, 3])


def has_decoder() -> bool:
    """Whether Pillow is installed."""
    try:
        import PIL.Image  # noqa: F401
    except ImportError:
        return False
    return True


def _host(array: Any, name: str) -> NDArray[Any]:
    return array.get() if _arrays.is_on_device(array) else _arrays.on_host(array, name)


def _corners(array: Any, faces: NDArray[Any] | None, shape: tuple[int, ...], name: str) -> NDArray[np.float32]:
    """The values of corners, flat, from an array of this shape or with one row for each vertex; no values for None."""
    if array is None:
        return np.zeros(0, np.float32)
    values = _host(array, name)
    _arrays.require_real(values, name)
    if values.shape != shape:
        if faces is None or values.ndim != len(shape) - 1 or values.shape[1:] != shape[2:]:
            raise ValueError(f"{name}: shape {values.shape} is neither {shape} nor one row for each vertex of a mesh")
        if len(values) <= faces.max(initial=-1):
            raise ValueError(f"{name}: has {len(values)} rows, and a face names vertex {faces.max()}")
        values = values[faces]
    with np.errstate(over="ignore"):
        return np.ascontiguousarray(values, dtype=np.float32).reshape(-1)


def _add_material(
    native: _gnomon.CutOuts, cut_out: CutOut, name: str, textures: dict[int, tuple[int, NDArray[np.uint8]]]
) -> None:
    wraps = (cut_out.wrap, cut_out.wrap) if isinstance(cut_out.wrap, str) else tuple(cut_out.wrap)
    if len(wraps) != 2 or any(wrap not in WRAPS for wrap in wraps):
        raise ValueError(f"{name}.wrap: must be one or two of {', '.join(WRAPS)}, not {cut_out.wrap!r}")
    if cut_out.filter not in FILTERS:
        raise ValueError(f"{name}.filter: must be one of {', '.join(FILTERS)}, not {cut_out.filter!r}")
    if not (np.isfinite(cut_out.cutoff) and np.isfinite(cut_out.factor)):
        raise ValueError(f"{name}: cutoff and factor must be finite numbers")
    texture = OPAQUE
    if cut_out.alpha is not None:
        if id(cut_out.alpha) not in textures:
            alpha = _host(cut_out.alpha, f"{name}.alpha")
            fits = alpha.ndim == 2 and 0 < min(alpha.shape) <= max(alpha.shape) <= LARGEST_SIDE
            if alpha.dtype != np.uint8 or not fits:
                raise ValueError(
                    f"{name}.alpha: must be uint8 of shape (height, width), each from 1 to {LARGEST_SIDE}, "
                    f"not {alpha.dtype} of shape {alpha.shape}"
                )
            textures[id(cut_out.alpha)] = (len(textures), np.ascontiguousarray(alpha))
        texture = textures[id(cut_out.alpha)][0]
    native.add_material(
        texture,
        WRAPS.index(wraps[0]),
        WRAPS.index(wraps[1]),
        FILTERS.index(cut_out.filter),
        float(cut_out.cutoff),
        float(cut_out.factor),
    )
