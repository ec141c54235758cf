# SPDX-License-Identifier: MIT
"""The triangles of a glTF file at one time, and their masks, by pygltflib, DracoPy, Pillow and numpy in double: written
from glTF 2.0 and the texts of its extensions alone, for test_gltf.py to compare gnomon with. meshopt streams are
decoded here, from their specification. Slow, and it knows no bad files.

As a program it writes the masks of a file for build/tools/check_view: gltf_reference.py SCENE.glb MASKS.bin"""

from __future__ import annotations

import base64
import functools
import io
import json
import math
import sys
import urllib.parse
from pathlib import Path
from typing import Any, NamedTuple

import DracoPy
import numpy as np
import pygltflib

TYPES = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}


class File:
    def __init__(self, path: Path) -> None:
        self.path = path
        self.gltf = pygltflib.GLTF2().load(str(path))
        data = path.read_bytes()
        is_glb = data[:4] == b"glTF"  # pygltflib drops the weights of nodes
        self.json = json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")] if is_glb else data)
        self.buffers = [self._buffer(b) for b in self.gltf.buffers]
        self.views: dict[int, tuple[bytes, int | None]] = {}

    def _buffer(self, buffer: Any) -> bytes:
        if buffer.uri is None:
            return self.gltf.binary_blob() or b""
        if buffer.uri.startswith("data:"):
            return base64.b64decode(buffer.uri.split(",", 1)[1])
        return (self.path.parent / urllib.parse.unquote(buffer.uri)).read_bytes()

    def view(self, index: int) -> tuple[bytes, int | None]:
        """A view's bytes and its stride."""
        if index in self.views:
            return self.views[index]
        v = self.gltf.bufferViews[index]
        packed = (v.extensions or {}).get("EXT_meshopt_compression")
        if packed:
            start = packed.get("byteOffset", 0)
            stream = self.buffers[packed["buffer"]][start : start + packed["byteLength"]]
            self.views[index] = meshopt(stream, packed), packed["byteStride"]
        else:
            start = v.byteOffset or 0
            self.views[index] = self.buffers[v.buffer][start : start + v.byteLength], v.byteStride
        return self.views[index]

    def _slice(self, view: int, offset: int, count: int, dtype: Any, width: int) -> np.ndarray:
        data, stride = self.view(view)
        size = np.dtype(dtype).itemsize * width
        rows = [data[offset + i * (stride or size) :][:size] for i in range(count)]
        return np.frombuffer(b"".join(rows), dtype).reshape(count, width)

    @functools.cache  # noqa: B019
    def raw(self, index: int) -> np.ndarray:
        a = self.gltf.accessors[index]
        dtype, width = TYPES[a.componentType], WIDTHS[a.type]
        if a.bufferView is None:
            out = np.zeros((a.count, width), dtype)
        else:
            out = self._slice(a.bufferView, a.byteOffset or 0, a.count, dtype, width).copy()
        if a.sparse is not None:
            s = a.sparse
            where = self._slice(
                s.indices.bufferView, s.indices.byteOffset or 0, s.count, TYPES[s.indices.componentType], 1
            )
            out[where[:, 0]] = self._slice(s.values.bufferView, s.values.byteOffset or 0, s.count, dtype, width)
        return out

    def numbers(self, index: int) -> np.ndarray:
        """Doubles; normalized integers as glTF defines them."""
        raw = self.raw(index)
        if self.gltf.accessors[index].normalized:
            return np.maximum(raw.astype(np.float64) / np.iinfo(raw.dtype).max, -1)
        return raw.astype(np.float64)


# ---- EXT_meshopt_compression, appendix A ----------------------------------------------------------------------------


def meshopt(stream: bytes, packed: dict[str, Any]) -> bytes:
    count, stride = packed["count"], packed["byteStride"]
    if packed["mode"] == "ATTRIBUTES":
        data = meshopt_attributes(stream, count, stride)
        assert packed.get("filter", "NONE") == "NONE"
        return data
    assert packed["mode"] == "TRIANGLES"
    return meshopt_triangles(stream, count).astype({2: np.uint16, 4: np.uint32}[stride]).tobytes()


def meshopt_attributes(stream: bytes, count: int, stride: int) -> bytes:
    assert stream[0] == 0xA0
    tail = max(32, stride)
    last = np.frombuffer(stream[-stride:], np.uint8).copy()  # the first element's base
    block = min((8192 // stride) & ~15, 256)
    out, at = np.zeros((count, stride), np.uint8), 1
    for begin in range(0, count, block):
        size = min(block, count - begin)
        groups = (size + 15) // 16
        for k in range(stride):
            header = stream[at : at + (groups + 3) // 4]
            at += len(header)
            deltas: list[int] = []
            for g in range(groups):
                mode = header[g // 4] >> (g % 4 * 2) & 3
                if mode == 0:
                    deltas += [0] * 16
                elif mode == 3:
                    deltas += stream[at : at + 16]
                    at += 16
                else:
                    bits = 2 * mode
                    packed_bytes, escape = stream[at : at + 2 * bits], (1 << bits) - 1
                    at += 2 * bits
                    for i in range(16):
                        byte = packed_bytes[i * bits // 8]
                        value = byte >> (8 - bits - i * bits % 8) & escape
                        if value == escape:
                            value = stream[at]
                            at += 1
                        deltas.append(value)
            for i in range(size):
                zigzag = deltas[i]
                last[k] = (int(last[k]) + (zigzag >> 1 ^ -(zigzag & 1))) & 255
                out[begin + i, k] = last[k]
    assert at + tail == len(stream)
    return out.tobytes()


def meshopt_triangles(stream: bytes, count: int) -> np.ndarray:
    assert stream[0] == 0xE1
    codes, at, table = stream[1 : 1 + count // 3], 1 + count // 3, stream[-16:]
    edges: list[tuple[int, int]] = []
    vertices: list[int] = []
    following = last = 0
    out: list[int] = []

    def explicit() -> int:
        nonlocal at, last
        value = shift = 0
        while True:
            byte = stream[at]
            at += 1
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                break
        last = (last + (value >> 1 ^ -(value & 1))) & 0xFFFFFFFF
        return last

    def new() -> int:
        nonlocal following
        following += 1
        return following - 1

    for code in codes:
        high, low = code >> 4, code & 15
        if high < 15:
            a, b = edges[-1 - high]
            if low < 13:
                c = new() if low == 0 else vertices[-low]
                is_known = low != 0
            else:
                is_known = False
                if low == 15:
                    c = explicit()
                else:
                    c = last = last + (1 if low == 14 else -1)
            if not is_known:
                vertices.append(c)
            edges += [(c, b), (a, c)]
            out += [a, b, c]
            continue
        if low < 14:
            pair = table[low]
            y, z = pair >> 4, pair & 15
            e = 0
        else:
            pair = stream[at]
            at += 1
            y, z, e = pair >> 4, pair & 15, low - 14 and 15
            if pair == 0:
                following = 0
        a = new() if e == 0 else 0
        b = new() if y == 0 else (vertices[-y] if y < 15 else -1)
        c = new() if z == 0 else (vertices[-z] if z < 15 else -1)
        if e == 15:
            a = explicit()
        if y == 15:
            b = explicit()
        if z == 15:
            c = explicit()
        vertices.append(a)
        if y in (0, 15):
            vertices.append(b)
        if z in (0, 15):
            vertices.append(c)
        edges += [(b, a), (c, b), (a, c)]
        out += [a, b, c]
    return np.array(out)


# ---- Poses ----------------------------------------------------------------------------------------------------------


def rotation_matrix(q: np.ndarray) -> np.ndarray:
    x, y, z, w = np.asarray(q, np.float64) / math.sqrt(float(np.dot(q, q)))
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def trs(translation: Any, rotation: Any, scale: Any) -> np.ndarray:
    m = np.eye(4)
    if rotation is not None:
        m[:3, :3] = rotation_matrix(np.array(rotation, np.float64))
    if scale is not None:
        m[:3, :3] = m[:3, :3] @ np.diag(np.array(scale, np.float64))
    if translation is not None:
        m[:3, 3] = translation
    return m


def slerp(a: np.ndarray, b: np.ndarray, t: float) -> np.ndarray:
    a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
    cosine = float(np.dot(a, b))
    if cosine < 0:
        b, cosine = -b, -cosine
    # The angle by its tangent: accurate for small ones, too.
    angle = 2 * math.atan2(float(np.linalg.norm(a - b)), float(np.linalg.norm(a + b)))
    if angle == 0:
        return a
    return (math.sin((1 - t) * angle) * a + math.sin(t * angle) * b) / math.sin(angle)


def sampled(file: File, sampler: Any, t: float, width: int, is_rotation: bool) -> np.ndarray:
    times = file.numbers(sampler.input)[:, 0]
    values = file.numbers(sampler.output).reshape(len(times), -1, width)  # 1 or 3 (in-tangent, value, out-tangent)
    is_cubic = sampler.interpolation == "CUBICSPLINE"
    middle = 1 if is_cubic else 0
    k = int(np.searchsorted(times, t, side="right")) - 1
    if k < 0 or k == len(times) - 1:
        return values[max(k, 0)][middle]
    if sampler.interpolation == "STEP":
        return values[k][0]
    duration = times[k + 1] - times[k]
    u = (t - times[k]) / duration
    if is_cubic:
        p0, m0, p1, m1 = values[k][1], duration * values[k][2], values[k + 1][1], duration * values[k + 1][0]
        at_ends = (2 * u**3 - 3 * u**2 + 1) * p0 + (3 * u**2 - 2 * u**3) * p1
        return at_ends + (u**3 - 2 * u**2 + u) * m0 + (u**3 - u**2) * m1
    if is_rotation:
        return slerp(values[k][0], values[k + 1][0], u)
    return (1 - u) * values[k][0] + u * values[k + 1][0]


def pose(file: File, time: float | None, animation: int) -> list[dict[str, Any]]:
    nodes = [
        {"translation": n.translation, "rotation": n.rotation, "scale": n.scale, "weights": w.get("weights")}
        for n, w in zip(file.gltf.nodes, file.json["nodes"], strict=True)
    ]
    if time is None:
        return nodes
    moving = file.gltf.animations[animation]
    for channel in moving.channels:
        node, path = channel.target.node, channel.target.path
        width = {"translation": 3, "scale": 3, "rotation": 4}.get(path)
        if width is None:
            mesh = file.gltf.meshes[file.gltf.nodes[node].mesh]
            width = len(mesh.primitives[0].targets)
        nodes[node][path] = sampled(file, moving.samplers[channel.sampler], time, width, path == "rotation")
    return nodes


# ---- Triangles ------------------------------------------------------------------------------------------------------


def draco(file: File, primitive: Any) -> tuple[dict[str, np.ndarray], np.ndarray]:
    packed = primitive.extensions["KHR_draco_mesh_compression"]
    mesh = DracoPy.decode(file.view(packed["bufferView"])[0])
    return {"POSITION": np.asarray(mesh.points, np.float64)}, np.asarray(mesh.faces).reshape(-1)


def attributes(file: File, primitive: Any) -> tuple[dict[str, Any], np.ndarray]:
    named = {k: v for k, v in vars(primitive.attributes).items() if v is not None}
    if "KHR_draco_mesh_compression" in (primitive.extensions or {}):
        return draco(file, primitive)
    read = {k: file.numbers(v) for k, v in named.items() if k.startswith(("POSITION", "JOINTS_", "WEIGHTS_"))}
    if primitive.indices is None:
        return read, np.arange(len(read["POSITION"]))
    return read, file.raw(primitive.indices)[:, 0].astype(np.int64)


def morphed(file: File, primitive: Any, base: np.ndarray, weights: Any) -> np.ndarray:
    out = base.copy()
    for weight, target in zip(weights, primitive.targets or [], strict=False):
        # pygltflib gives an object or a dictionary.
        accessor = target.get("POSITION") if isinstance(target, dict) else target.POSITION
        if accessor is not None:
            out = out + float(weight) * file.numbers(accessor)
    return out


def skinned(read: dict[str, Any], positions: np.ndarray, joints: np.ndarray) -> np.ndarray:
    p = np.hstack([positions, np.ones((len(positions), 1))])
    total, out = np.zeros(len(p)), np.zeros((len(p), 4))
    sets = sum(k.startswith("JOINTS_") for k in read)
    for s in range(sets):
        for i in range(4):
            weight = read[f"WEIGHTS_{s}"][:, i]
            matrix = joints[read[f"JOINTS_{s}"][:, i].astype(int)]
            out += weight[:, None] * np.einsum("nij,nj->ni", matrix, p)
            total += weight
    return out[:, :3] / total[:, None]


# ---- Masks ----------------------------------------------------------------------------------------------------------

WRAPS = {10497: "repeat", 33648: "mirror", 33071: "clamp"}


class Mask(NamedTuple):
    """A material that cuts out."""

    alpha: np.ndarray | None  # (height, width) uint8
    cutoff: float
    factor: float
    wrap: tuple[str, str]
    filter: str


def image_of(file: File, texture: Any) -> int:
    webp = (texture.extensions or {}).get("EXT_texture_webp")
    return webp["source"] if webp else texture.source


def alpha_of(file: File, index: int) -> np.ndarray:
    from PIL import Image

    image = file.gltf.images[index]
    if image.bufferView is not None:
        data = file.view(image.bufferView)[0]
    elif image.uri.startswith("data:"):
        data = base64.b64decode(image.uri.split(",", 1)[1])
    else:
        data = (file.path.parent / urllib.parse.unquote(image.uri)).read_bytes()
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGBA"))[:, :, 3].copy()


def mask_of(file: File, material: Any, blend: str) -> Mask | None:
    if material.alphaMode not in ("MASK", "BLEND") or (material.alphaMode == "BLEND" and blend == "opaque"):
        return None
    pbr = material.pbrMetallicRoughness
    factor = pbr.baseColorFactor[3] if pbr is not None and pbr.baseColorFactor is not None else 1.0
    cutoff = 0.5 if material.alphaCutoff is None or material.alphaMode == "BLEND" else material.alphaCutoff
    if material.alphaMode == "BLEND" and blend == "clear":
        cutoff = 2.0
    if pbr is None or pbr.baseColorTexture is None:
        return Mask(None, cutoff, factor, ("repeat", "repeat"), "linear")
    texture = file.gltf.textures[pbr.baseColorTexture.index]
    sampler = file.gltf.samplers[texture.sampler] if texture.sampler is not None else pygltflib.Sampler()
    wraps = tuple(WRAPS[10497 if w is None else w] for w in (sampler.wrapS, sampler.wrapT))
    alpha = alpha_of(file, image_of(file, texture))
    return Mask(alpha, cutoff, factor, wraps, "nearest" if sampler.magFilter == 9728 else "linear")


def coordinates(file: File, primitive: Any, material: Any) -> np.ndarray | None:
    """u and v of each vertex, with KHR_texture_transform; None without a texture."""
    pbr = material.pbrMetallicRoughness
    if pbr is None or pbr.baseColorTexture is None:
        return None
    info = pbr.baseColorTexture
    transform = (info.extensions or {}).get("KHR_texture_transform", {})
    name = f"TEXCOORD_{transform.get('texCoord', info.texCoord or 0)}"
    accessor = getattr(primitive.attributes, name, None)
    if accessor is None:
        return None
    u, v = file.numbers(accessor).T
    angle, (a, b), (x, y) = (transform.get(k, d) for k, d in (("rotation", 0), ("scale", [1, 1]), ("offset", [0, 0])))
    c, s = math.cos(angle), math.sin(angle)
    return np.stack([x + c * a * u + s * b * v, y - s * a * u + c * b * v], axis=1)


class Evaluation:
    """The triangles in the order of nodes (depth first), instances, primitives; double, (F, 3, 3). Of each its mask, an
    index of `masks` or -1, and, in float32, the texture coordinates and alphas of its corners."""

    def __init__(
        self,
        path: Path,
        time: float | None = None,
        animation: int = 0,
        scene: int | None = None,
        blend: str = "opaque",
    ) -> None:
        self.file = File(path)
        self.nodes = pose(self.file, time, animation)
        self.out: list[np.ndarray] = []
        self.of_masks: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
        self.masks: list[Mask] = []
        self.index_of_mask: dict[int, int] = {}
        for i, material in enumerate(self.file.gltf.materials):
            mask = mask_of(self.file, material, blend)
            if mask is not None:
                self.index_of_mask[i] = len(self.masks)
                self.masks.append(mask)
        gltf = self.file.gltf
        self.parent = {c: i for i, n in enumerate(gltf.nodes) for c in n.children or []}
        chosen = scene if scene is not None else (gltf.scene or 0)
        for root in gltf.scenes[chosen].nodes:
            self.visit(root)
        self.triangles = np.concatenate(self.out)
        self.mask, self.uv, self.alpha = (np.concatenate(part) for part in zip(*self.of_masks, strict=True))

    def world(self, index: int) -> np.ndarray:
        node = self.file.gltf.nodes[index]
        n = self.nodes[index]
        if node.matrix:
            local = np.array(node.matrix, np.float64).reshape(4, 4).T
        else:
            local = trs(n["translation"], n["rotation"], n["scale"])
        return self.world(self.parent[index]) @ local if index in self.parent else local

    def visit(self, index: int) -> None:
        node = self.file.gltf.nodes[index]
        if node.mesh is not None:
            for world in self.instances(index):
                for primitive in self.file.gltf.meshes[node.mesh].primitives:
                    if (4 if primitive.mode is None else primitive.mode) == 4:
                        self.out.append(self.primitive(index, primitive, world))
                        self.of_masks.append(self.mask_data(primitive, len(self.out[-1])))
        for child in node.children or []:
            self.visit(child)

    def instances(self, index: int) -> list[np.ndarray]:
        node = self.file.gltf.nodes[index]
        world = self.world(index)
        packed = (node.extensions or {}).get("EXT_mesh_gpu_instancing")
        if packed is None:
            return [world]
        columns = {k: self.file.numbers(v) for k, v in packed["attributes"].items() if not k.startswith("_")}
        count = len(next(iter(columns.values())))
        return [
            world @ trs(*(columns[k][i] if k in columns else None for k in ("TRANSLATION", "ROTATION", "SCALE")))
            for i in range(count)
        ]

    def primitive(self, index: int, primitive: Any, world: np.ndarray) -> np.ndarray:
        node = self.file.gltf.nodes[index]
        read, corners = attributes(self.file, primitive)
        weights = self.nodes[index]["weights"]
        if weights is None:
            weights = self.file.gltf.meshes[node.mesh].weights or []
        positions = morphed(self.file, primitive, read["POSITION"], weights)
        if node.skin is not None:
            positions = skinned(read, positions, self.joints(node.skin))
        else:
            positions = positions @ world[:3, :3].T + world[:3, 3]
        return positions[corners].reshape(-1, 3, 3)

    def mask_data(self, primitive: Any, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of the primitive's triangles: the mask, u and v, alphas."""
        mask = self.index_of_mask.get(primitive.material, -1)
        uv, alpha = np.zeros((count, 3, 2), np.float32), np.ones((count, 3), np.float32)
        if mask >= 0:
            file, index = self.file, primitive.indices
            corners = np.arange(3 * count) if index is None else file.raw(index)[:, 0].astype(np.int64)
            at = coordinates(file, primitive, file.gltf.materials[primitive.material])
            if at is not None:
                uv = at[corners].astype(np.float32).reshape(count, 3, 2)
            colors = primitive.attributes.COLOR_0
            if colors is not None and file.gltf.accessors[colors].type == "VEC4":
                alpha = file.numbers(colors)[corners, 3].clip(0, 1).astype(np.float32).reshape(count, 3)
        return np.full(count, mask, np.int64), uv, alpha

    def joints(self, index: int) -> np.ndarray:
        skin = self.file.gltf.skins[index]
        inverse = np.tile(np.eye(4), (len(skin.joints), 1, 1))
        if skin.inverseBindMatrices is not None:
            inverse = self.file.numbers(skin.inverseBindMatrices).reshape(-1, 4, 4).transpose(0, 2, 1)
        return np.array([self.world(j) @ inverse[i] for i, j in enumerate(skin.joints)])


def triangles(path: Path, **choices: Any) -> np.ndarray:
    return Evaluation(path, **choices).triangles


def write_masks(of: Evaluation, path: Path) -> None:
    """The file that check_view --masks reads: little-endian words, see tools/check_view.cpp."""
    with path.open("wb") as out:
        images = [mask.alpha for mask in of.masks if mask.alpha is not None]
        np.array([len(of.masks), len(images), len(of.mask)], "<u4").tofile(out)
        image = 0
        for mask in of.masks:
            wraps = [list(WRAPS.values()).index(wrap) for wrap in mask.wrap]
            has_image = mask.alpha is not None
            np.array([image if has_image else -1, *wraps, mask.filter == "linear"], "<i4").tofile(out)
            np.array([mask.cutoff, mask.factor], "<f4").tofile(out)
            image += has_image
        for alpha in images:
            np.array([alpha.shape[1], alpha.shape[0]], "<u4").tofile(out)
            alpha.tofile(out)
        for rows, kind in ((of.mask, "<i4"), (of.uv, "<f4"), (of.alpha, "<f4")):
            rows.astype(kind).tofile(out)


if __name__ == "__main__":
    write_masks(Evaluation(Path(sys.argv[1])), Path(sys.argv[2]))
