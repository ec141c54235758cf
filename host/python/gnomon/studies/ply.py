# SPDX-License-Identifier: MIT
"""Faces of PLY files, text or binary. A face may have any number of corners and any other properties, lists among them:
trimesh gives each row of a binary file the lengths that the first row's lists have.

The format: Turk, "The PLY Polygon File Format", Stanford University, 1994.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4",
    "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4",
    "float32": "f4", "float64": "f8",
}  # fmt: skip
TEXT = "text"
FORMATS = {"ascii": TEXT, "binary_little_endian": "<", "binary_big_endian": ">"}
CORNERS = ("vertex_indices", "vertex_index")


class Property(NamedTuple):
    """type: as the header has it. stored: as the rows have it. length: of a list's length in the rows, None for a value
    alone."""

    name: str
    type: np.dtype[Any]
    stored: np.dtype[Any]
    length: np.dtype[Any] | None


class Element(NamedTuple):
    name: str
    rows: int
    properties: list[Property]


def read(file: str) -> tuple[NDArray[np.float64], list[NDArray[np.int64]]]:
    """Vertices (V, 3), and the faces by blocks (F, n) of as many corners each. Raises ValueError."""
    data = Path(file).read_bytes()
    elements, is_text, at = _header(data)
    if is_text:  # its numbers are stored as doubles, and read as a binary file's
        data, at = np.array(data[at:].split(), "S").astype(np.float64).tobytes(), 0
    columns: dict[str, dict[str, list[NDArray[Any]]]] = {}
    for element in elements:
        columns[element.name], at = _read(data, at, element)
    if "tristrips" in columns:
        raise ValueError("has triangle strips, which are not read: export it with triangles as faces")
    vertex, face = columns.get("vertex", {}), columns.get("face", {})
    if not set("xyz") <= set(vertex):
        raise ValueError("has no vertices with x, y, z")
    vertices = np.stack([np.concatenate([[], *vertex[axis]]).astype(np.float64) for axis in "xyz"], axis=1)
    blocks = next((face[name] for name in CORNERS if name in face), [])
    return vertices, [block.astype(np.int64) for block in blocks]


def _header(data: bytes) -> tuple[list[Element], bool, int]:
    """The elements, whether they are text, and the first byte of the rows."""
    first = re.match(rb"ply[ \t]*(\r\n|\n|\r)", data)
    last = re.search(rb"end_header[ \t]*" + first[1], data) if first else None
    if not first or not last:
        raise ValueError("has no whole header of a PLY file")
    elements: list[Element] = []
    order = ""
    for line in data[first.end() : last.start()].decode("latin-1").splitlines():
        match line.split():
            case ["property", "list", _, _, name] if name in CORNERS and elements and elements[-1].name == "vertex":
                raise ValueError(f'its header has the list "{name}" without the line "element face N" above it')
            case ["format", name, *_] if name in FORMATS:
                order = FORMATS[name]
            case ["element", name, rows]:
                elements.append(Element(name, int(rows), []))
            case ["property", "list", count, kind, name] if elements and order:
                elements[-1].properties.append(Property(name, *_types(order, kind), _types(order, count)[1]))
            case ["property", kind, name] if elements and order:
                elements[-1].properties.append(Property(name, *_types(order, kind), None))
            case ["format" | "element" | "property", *_]:  # other lines are for people
                raise ValueError(f'its header has the line "{line}", which is not known')
    return elements, order == TEXT, last.end()


def _types(order: str, name: str) -> tuple[np.dtype[Any], np.dtype[Any]]:
    """A type as the header has it, and as the rows have it."""
    if name not in TYPES:
        raise ValueError(f'its header has the type "{name}", which is not known')
    return np.dtype(TYPES[name]), np.dtype(np.float64 if order == TEXT else order + TYPES[name])


def _read(data: bytes, at: int, element: Element) -> tuple[dict[str, list[NDArray[Any]]], int]:
    """Each property of an element, by blocks of rows whose lists are as long; and the first byte behind the rows."""
    blocks: list[NDArray[Any]] = []
    done = 0
    while element.properties and done < element.rows:
        layout = _layout(data, at, element)
        count = min(element.rows - done, (len(data) - at) // layout.itemsize)
        if count == 0:
            raise _cut_off(element)
        if blocks:  # where lengths change from row to row, few rows are compared with each
            count = min(count, 2 * len(blocks[-1]))
        rows = np.frombuffer(data, layout, count, at)
        is_other = np.zeros(count, bool)
        for one in element.properties:
            if one.length is not None:
                is_other |= rows["count " + one.name] != rows["count " + one.name][0]
        blocks.append(rows[: int(np.argmax(is_other)) if is_other.any() else count])
        done, at = done + len(blocks[-1]), at + len(blocks[-1]) * layout.itemsize
    return {one.name: [block[one.name].astype(one.type) for block in blocks] for one in element.properties}, at


def _layout(data: bytes, at: int, element: Element) -> np.dtype[Any]:
    """Of the row that begins at this byte."""
    fields: list[Any] = []
    for one in element.properties:
        if one.length is None:
            fields.append((one.name, one.stored))
            continue
        begin = at + (np.dtype(fields).itemsize if fields else 0)
        if begin + one.length.itemsize > len(data):
            raise _cut_off(element)
        length = int(np.frombuffer(data, one.length, 1, begin)[0])
        fields += [("count " + one.name, one.length), (one.name, one.stored, (length,))]
    return np.dtype(fields)


def _cut_off(element: Element) -> ValueError:
    return ValueError(f"is cut off: it says that it has {element.rows} rows of {element.name}, and has fewer")
