# SPDX-License-Identifier: MIT
"""Small glTF files, a feature each, for test_gltf.py and as seeds of the fuzzer (python gltf_made.py FOLDER)."""

from __future__ import annotations

import json
import struct
import sys
from pathlib import Path
from typing import Any

import DracoPy
import numpy as np

COMPONENTS = {"int8": 5120, "uint8": 5121, "int16": 5122, "uint16": 5123, "uint32": 5125, "float32": 5126}
TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
rng = np.random.default_rng(20261123)


class Made:
    def __init__(self) -> None:
        self.json: dict[str, Any] = {"asset": {"version": "2.0"}, "bufferViews": [], "accessors": []}
        self.buffer = b""

    def view(self, data: bytes, **more: Any) -> int:
        self.buffer += b"\0" * (-len(self.buffer) % 4)
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.buffer), "byteLength": len(data), **more})
        self.buffer += data
        return len(self.json["bufferViews"]) - 1

    def accessor(self, values: Any, dtype: str = "float32", stride: int = 0, **more: Any) -> int:
        """Of an array (count, components); rows are padded to the stride."""
        array = np.atleast_2d(np.asarray(values, dtype))
        rows = b"".join(row.tobytes().ljust(stride, b"\0") for row in array)
        view = self.view(rows, **({"byteStride": stride} if stride else {}))
        return self.describe(array.shape, dtype, bufferView=view, **more)

    def describe(self, shape: tuple[int, ...], dtype: str, **more: Any) -> int:
        self.json["accessors"].append(
            {"componentType": COMPONENTS[dtype], "count": shape[0], "type": TYPES[shape[1]], **more}
        )
        return len(self.json["accessors"]) - 1

    def sparse(self, shape: tuple[int, ...], where: list[int], values: Any) -> int:
        return self.describe(
            shape,
            "float32",
            sparse={
                "count": len(where),
                "indices": {"bufferView": self.view(np.array(where, np.uint16).tobytes()), "componentType": 5123},
                "values": {"bufferView": self.view(np.asarray(values, np.float32).tobytes())},
            },
        )

    def add(self, array: str, **entry: Any) -> int:
        self.json.setdefault(array, []).append(entry)
        return len(self.json[array]) - 1

    def mesh(self, positions: int, attributes: dict[str, int] | None = None, **more: Any) -> int:
        primitive = {k: more.pop(k) for k in ("indices", "targets", "extensions") if k in more}
        attributes = {"POSITION": positions, **(attributes or {})}
        return self.add("meshes", primitives=[{"attributes": attributes, **primitive}], **more)

    def channel(self, node: int, path: str, interpolation: str, times: Any, values: Any, **more: Any) -> None:
        """One more channel of the one animation."""
        if "animations" not in self.json:
            self.add("animations", channels=[], samplers=[])
        animation = self.json["animations"][0]
        sampler = {
            "input": self.accessor(np.reshape(times, (-1, 1))),
            "output": self.accessor(values, **more),
            "interpolation": interpolation,
        }
        animation["samplers"].append(sampler)
        target = {"node": node, "path": path}
        animation["channels"].append({"sampler": len(animation["samplers"]) - 1, "target": target})

    def glb(self) -> bytes:
        self.json.setdefault("scenes", [{"nodes": [0]}])
        self.json.setdefault("buffers", [{}])[0]["byteLength"] = len(self.buffer)
        text = json.dumps(self.json).encode()
        text += b" " * (-len(text) % 4)
        chunk = self.buffer + b"\0" * (-len(self.buffer) % 4)
        body = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(chunk), b"BIN\0") + chunk
        return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def points(count: int = 12) -> np.ndarray:
    return rng.uniform(-3, 3, (count, 3)).astype(np.float32)


def unit(count: int) -> np.ndarray:
    q = rng.normal(size=(count, 4))
    return (q / np.linalg.norm(q, axis=1, keepdims=True)).astype(np.float32)


def morphed() -> Made:
    m = Made()
    base = m.accessor(points())
    targets = [{"POSITION": m.accessor(points())}, {"POSITION": m.sparse((12, 3), [2, 7], points(2))}, {"NORMAL": base}]
    m.mesh(base, targets=targets, weights=[0.3, -0.7, 1.0])
    m.add("nodes", mesh=0, translation=[0.1, 0.2, 0.3], scale=[1.5, -2, 0.7])
    return m


def weights_of_node_and_animation() -> Made:
    m = morphed()
    m.json["nodes"][0]["weights"] = [0.9, 0.4, 0]
    m.channel(0, "weights", "LINEAR", [0, 0.7, 1.1], np.reshape([0, 1, 0, 0.5, 0.2, 0, 1, 0, 0], (-1, 1)))
    return m


def moving(interpolation: str) -> Made:
    m = Made()
    m.mesh(m.accessor(points()))
    m.add("nodes", mesh=0, children=[1], rotation=unit(1)[0].tolist())
    m.add("nodes", mesh=0, translation=[1, 2, 3])
    each = 3 if interpolation == "CUBICSPLINE" else 1
    times = [0.25, 0.5, 1.25, 2]
    m.channel(0, "translation", interpolation, times, points(4 * each))
    m.channel(1, "scale", interpolation, times, points(4 * each))
    m.channel(1, "rotation", interpolation, times, unit(4 * each))
    bytes_of = np.round(unit(4 * each) * 32767).astype(np.int16)
    m.channel(0, "rotation", interpolation, times, bytes_of, dtype="int16", normalized=True)
    return m


def skinned(weights: str = "float32") -> Made:
    m = Made()
    base = m.accessor(points())
    values = rng.uniform(0, 1, (12, 8))
    values /= values.sum(axis=1, keepdims=True)
    scale = {"float32": 1, "uint8": 255, "uint16": 65535}[weights]
    sets: dict[str, int] = {}
    for s in range(2):
        four = values[:, 4 * s : 4 * s + 4] * scale
        sets[f"WEIGHTS_{s}"] = m.accessor(
            np.round(four) if scale > 1 else four, weights, **({"normalized": True} if scale > 1 else {})
        )
        sets[f"JOINTS_{s}"] = m.accessor(rng.integers(0, 3, (12, 4)), ["uint8", "uint16"][s])
    m.mesh(base, sets)
    m.add("nodes", mesh=0, skin=0, translation=[50, 0, 0])
    m.add("nodes", children=[2], rotation=unit(1)[0].tolist())
    m.add("nodes", children=[3], translation=[0, 1, 0], scale=[1, 2, 1])
    m.add("nodes", rotation=unit(1)[0].tolist(), translation=[0.5, 0, 0])
    inverse = np.stack([np.vstack([rng.normal(size=(3, 4)), [0, 0, 0, 1]]).T.reshape(-1) for _ in range(3)])
    m.add("skins", joints=[3, 1, 2], inverseBindMatrices=m.accessor(inverse))
    m.json["scenes"] = [{"nodes": [0, 1]}]
    m.channel(2, "rotation", "LINEAR", [0, 1], unit(2))
    return m


def instanced() -> Made:
    m = Made()
    m.mesh(m.accessor(points()))
    columns = {
        "TRANSLATION": m.accessor(points(5)),
        "ROTATION": m.accessor(np.round(unit(5) * 127), "int8", normalized=True),
        "SCALE": m.accessor(points(5)),
        "_ID": m.accessor(np.arange(5).reshape(-1, 1)),
    }
    m.add("nodes", mesh=0, scale=[2, 2, 2], extensions={"EXT_mesh_gpu_instancing": {"attributes": columns}})
    return m


def quantized(dtype: str, normalized: bool) -> Made:
    m = Made()
    limits = np.iinfo(dtype)
    values = rng.integers(limits.min, limits.max, (12, 3), endpoint=True)
    stride = 8 if dtype.endswith("16") else 4
    target = m.accessor(rng.integers(-100, 100, (12, 3)), "int8", stride=4, normalized=normalized)
    base = m.accessor(values, dtype, stride=stride, normalized=normalized)
    m.mesh(base, targets=[{"POSITION": target}], weights=[0.3])
    m.add("nodes", mesh=0, scale=[0.01, 0.02, 0.03], rotation=unit(1)[0].tolist())
    return m


def draco(level: int) -> Made:
    """Level 10 encodes by Edgebreaker, level 0 in sequence."""
    m = Made()
    vertices = points(6)
    faces = np.array([[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5]], np.uint32)
    stream = DracoPy.encode(vertices, faces, quantization_bits=14, compression_level=level)
    packed = {"bufferView": m.view(stream), "attributes": {"POSITION": 0}}
    m.mesh(
        m.describe((6, 3), "float32"),
        indices=m.describe((12, 1), "uint16"),
        extensions={"KHR_draco_mesh_compression": packed},
    )
    m.add("nodes", mesh=0, translation=[1, 2, 3], scale=[0.3, 0.3, 0.3])
    m.json["extensionsRequired"] = ["KHR_draco_mesh_compression"]
    return m


def meshopt_stream(data: np.ndarray) -> bytes:
    """EXT_meshopt_compression, mode ATTRIBUTES, with the deltas as whole bytes. Up to 256 rows."""
    count, stride = data.shape
    first = data[0].astype(int)
    out = b"\xa0"
    groups = (count + 15) // 16
    for k in range(stride):
        column = data[:, k].astype(int)
        deltas = np.diff(np.concatenate([[first[k]], column]))
        deltas = (deltas + 128) % 256 - 128
        zigzag = np.where(deltas < 0, -2 * deltas - 1, 2 * deltas).astype(np.uint8)
        header = np.zeros((groups + 3) // 4, np.uint8)
        for g in range(groups):
            header[g // 4] |= 3 << (g % 4 * 2)
        out += header.tobytes() + zigzag.tobytes().ljust(groups * 16, b"\0")
    return out + first.astype(np.uint8).tobytes().rjust(max(32, stride), b"\0")


def meshopt() -> Made:
    m = Made()
    m.json["buffers"] = [{}, {"byteLength": 12 * 12, "extensions": {"EXT_meshopt_compression": {"fallback": True}}}]
    m.mesh(m.accessor(points(), stride=12))
    view = m.json["bufferViews"][0]
    data = np.frombuffer(m.buffer, np.uint8).reshape(12, 12)
    m.buffer = stream = meshopt_stream(data)
    view["extensions"] = {
        "EXT_meshopt_compression": {
            "buffer": 0,
            "byteLength": len(stream),
            "byteStride": 12,
            "count": 12,
            "mode": "ATTRIBUTES",
        }
    }
    view["buffer"] = 1
    m.add("nodes", mesh=0, translation=[1, 2, 3])
    m.json["extensionsRequired"] = ["EXT_meshopt_compression"]
    return m


MADE = {
    "morphed": morphed,
    "weights": weights_of_node_and_animation,
    "step": lambda: moving("STEP"),
    "linear": lambda: moving("LINEAR"),
    "cubic": lambda: moving("CUBICSPLINE"),
    "skinned": skinned,
    "skinned_u8": lambda: skinned("uint8"),
    "skinned_u16": lambda: skinned("uint16"),
    "instanced": instanced,
    "draco_sequential": lambda: draco(0),
    "draco_edgebreaker": lambda: draco(10),
    "meshopt": meshopt,
    **{
        f"quantized_{dtype}_{'normalized' if n else 'plain'}": lambda dtype=dtype, n=n: quantized(dtype, n)
        for dtype in ("int8", "uint8", "int16", "uint16")
        for n in (False, True)
    },
}

if __name__ == "__main__":
    for name, make in MADE.items():
        (Path(sys.argv[1]) / f"{name}.glb").write_bytes(make().glb())
