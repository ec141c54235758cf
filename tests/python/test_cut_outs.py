# SPDX-License-Identifier: MIT
"""Cut-outs: triangles with holes against rational arithmetic, in every form that a caller may give them."""

import json
import struct
from io import BytesIO

import gnomon
import numpy as np
import oracle
import pytest

DOWN = (0.25, -0.5, -1.0)
LEAF = np.array([[0, 255, 0, 255], [255, 255, 255, 0], [0, 255, 128, 127]], np.uint8)


def scene_of(seed: int, count: int = 40) -> tuple[np.ndarray, gnomon.CutOuts]:
    """Triangles, textures and coordinates on lattices, so that hits on borders of texels are frequent."""
    random = np.random.default_rng(seed)
    triangles = (random.integers(-16, 17, (count, 3, 3)) / 8).astype(np.float32)
    other = random.choice([0, 51, 102, 127, 128, 153, 255], (5, 8)).astype(np.uint8)
    materials = [
        gnomon.CutOut(LEAF),
        gnomon.CutOut(LEAF, wrap="mirror", filter="nearest"),
        gnomon.CutOut(other, cutoff=0.4, wrap=("clamp", "repeat")),
        gnomon.CutOut(other, cutoff=0.2, factor=0.7, filter="nearest"),
        gnomon.CutOut(LEAF, cutoff=1.5),
    ]
    return triangles, gnomon.CutOuts(
        material=random.integers(-1, len(materials), count),
        materials=materials,
        uv=(random.integers(-16, 17, (count, 3, 2)) / 8).astype(np.float32),
        corner_alpha=random.choice([1.0, 0.5, 0.9], (count, 3)).astype(np.float32),
    )


def opaque_by(cut_outs: gnomon.CutOuts):
    def opaque(triangle, weights):
        material = cut_outs.material[triangle]
        if material < 0:
            return True
        return oracle.is_opaque(
            weights, cut_outs.uv[triangle], cut_outs.corner_alpha[triangle], cut_outs.materials[material]
        )

    return opaque


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_equals_rational_arithmetic(seed):
    triangles, cut_outs = scene_of(seed)
    points = (np.random.default_rng(seed).integers(-32, 33, (250, 3)) / 8).astype(np.float32)
    scene = gnomon.Scene(triangles, cut_outs=cut_outs)
    for light in ({"direction": DOWN}, {"position": (0.125, 0.25, 3.0)}):
        lit = scene.lit(points, **light)
        np.testing.assert_array_equal(lit, oracle.lit(triangles, points, **light, opaque=opaque_by(cut_outs)))
        assert (lit != gnomon.Scene(triangles).lit(points, **light)).sum() > 5, "the masks must matter"
    counts = scene.cut_out_counts
    assert counts.masked + counts.opaque + counts.clear == (cut_outs.material >= 0).sum()
    assert counts.clear >= (cut_outs.material == 4).sum() and counts.unusable == 0 and counts.masked > 10


def quad(cut_out: gnomon.CutOut, **more: object) -> gnomon.Scene:
    """A square from 0 to 4 in x and y, one above the ground, whose texture it shows once, its first row at y = 4."""
    vertices = np.array([[0, 4, 1], [4, 4, 1], [4, 0, 1], [0, 0, 1]], np.float64)
    uv = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    return gnomon.Scene(vertices, faces, cut_outs=gnomon.CutOuts([0, 0], [cut_out], uv), **more)


@pytest.mark.parametrize("lattice", [None, 2.0**-10])
def test_a_texture_falls_as_it_is_drawn(lattice):
    """A shadow of 4 x 4 texels under a light from above is the texture itself."""
    alpha = np.array([[255, 0, 0, 0], [0, 255, 255, 0], [0, 0, 0, 255], [255, 0, 255, 0]], np.uint8)
    scene = quad(gnomon.CutOut(alpha, filter="nearest"), lattice=lattice)
    x, y = np.meshgrid(np.arange(4) + 0.5, 3.5 - np.arange(4))
    lit = scene.lit(np.stack([x, y, np.zeros_like(x)], axis=-1), direction=(0, 0, -1))
    np.testing.assert_array_equal(lit, alpha < 128)


def test_a_camera_sees_through_holes():
    alpha = np.array([[255, 0], [0, 0]], np.uint8)
    scene = quad(gnomon.CutOut(alpha, filter="nearest"))
    view = scene.view(eye=(2, 2, 9), target=(2, 2, 0), up=(0, 1, 0), fov=20, size=(40, 40))
    seen = view.receivers >= 0 if view.receivers.dtype.kind == "i" else view.receivers != 0xFFFFFFFF
    assert seen[:19, :19].all() and not seen[21:].any() and not seen[:, 21:].any()


def test_pyopencl_arrays_are_copied():
    cl = pytest.importorskip("pyopencl")
    array = pytest.importorskip("pyopencl.array")
    triangles, cut_outs = scene_of(7)
    points = np.random.default_rng(5).uniform(-3, 3, (300, 3)).astype(np.float32)
    queue = cl.CommandQueue(cl.Context([cl.get_platforms()[0].get_devices()[0]]))
    on = {
        name: array.to_device(queue, np.ascontiguousarray(value))
        for name, value in cut_outs._asdict().items()
        if isinstance(value, np.ndarray)
    }
    textures = {id(m.alpha): array.to_device(queue, m.alpha) for m in cut_outs.materials}
    on["materials"] = [m._replace(alpha=textures[id(m.alpha)]) for m in cut_outs.materials]
    scene = gnomon.Scene(array.to_device(queue, triangles), cut_outs=cut_outs._replace(**on))
    lit = scene.lit(array.to_device(queue, points), direction=DOWN).get() == 1
    np.testing.assert_array_equal(lit, gnomon.Scene(triangles, cut_outs=cut_outs).lit(points, direction=DOWN))


@pytest.mark.parametrize(
    "change, sentence",
    [
        ({"material": [0]}, "cut_outs.material: shape (1,) is not (40,)"),
        ({"material": [9] * 40}, "cut_outs.material: row 0 names material 9 of 5"),
        ({"material": [0.5] * 40}, "cut_outs.material: must be integers"),
        ({"uv": np.zeros((40, 2))}, "cut_outs.uv: shape (40, 2) is neither (40, 3, 2)"),
        ({"corner_alpha": np.zeros(3)}, "cut_outs.corner_alpha: shape (3,) is neither"),
        ({"materials": [gnomon.CutOut(LEAF.astype(float))] * 5}, "materials[0].alpha: must be uint8"),
        ({"materials": [gnomon.CutOut(np.zeros((0, 4), np.uint8))] * 5}, "materials[0].alpha: must be uint8 of shape"),
        ({"materials": [gnomon.CutOut(LEAF, wrap="twice")] * 5}, "materials[0].wrap: must be one or two of repeat"),
        ({"materials": [gnomon.CutOut(LEAF, filter="cubic")] * 5}, "materials[0].filter: must be one of nearest"),
        ({"materials": [gnomon.CutOut(LEAF, cutoff=np.nan)] * 5}, "materials[0]: cutoff and factor must be finite"),
    ],
)
def test_bad_cut_outs_are_named(change, sentence):
    triangles, cut_outs = scene_of(1)
    with pytest.raises(ValueError) as error:
        gnomon.Scene(triangles, cut_outs=cut_outs._replace(**change))
    assert sentence in str(error.value)


def masked_file(folder, image: bytes, mode: str = "MASK"):
    """A triangle (0,0,1) (4,0,1) (0,4,1) whose u, v are x / 4 and y / 4."""
    arrays = np.array([0, 0, 1, 4, 0, 1, 0, 4, 1, 0, 0, 1, 0, 0, 1], np.float32).tobytes()
    binary = arrays + image + b"\0" * (-len(image) % 4)
    views = [{"buffer": 0, "byteOffset": o, "byteLength": n} for o, n in ((0, 36), (36, 24), (60, len(image)))]
    root = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 1], "max": [4, 4, 1]},
            {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
        ],
        "bufferViews": views,
        "buffers": [{"byteLength": len(binary)}],
        "images": [{"bufferView": 2, "mimeType": "image/png"}],
        "samplers": [{"magFilter": 9728}],
        "textures": [{"source": 0, "sampler": 0}],
        "materials": [{"alphaMode": mode, "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
    }
    text = json.dumps(root).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
    file = folder / "masked.glb"
    file.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)
    return file


@pytest.mark.skipif(not hasattr(gnomon._gnomon, "load_scene"), reason="this build reads no glTF files")
def test_files_with_masks(tmp_path):
    image = pytest.importorskip("PIL.Image")
    alpha = np.array([[255, 0], [0, 255]], np.uint8)
    data = BytesIO()
    image.fromarray(np.dstack([np.zeros((2, 2, 3), np.uint8), alpha])).save(data, "PNG")
    points = np.array([[0.5, 0.5, 0], [2.5, 0.5, 0], [0.5, 2.5, 0]])
    scene = gnomon.Scene.from_gltf(masked_file(tmp_path, data.getvalue()))
    assert scene.warnings == [] and scene.cut_out_counts.masked == 1
    assert scene.lit(points, direction=(0, 0, -1)).tolist() == [False, True, True]
    for blend, lit in (("opaque", [False] * 3), ("mask", [False, True, True]), ("clear", [True] * 3)):
        scene = gnomon.Scene.from_gltf(masked_file(tmp_path, data.getvalue(), "BLEND"), blend=blend)
        assert scene.lit(points, direction=(0, 0, -1)).tolist() == lit
    with pytest.raises(ValueError, match="blend: must be one of opaque, clear, mask"):
        gnomon.Scene.from_gltf(masked_file(tmp_path, data.getvalue()), blend="half")
    broken = gnomon.Scene.from_gltf(masked_file(tmp_path, data.getvalue()[:40]))
    assert len(broken.warnings) == 1 and "opaque" in broken.warnings[0]
    assert not broken.lit(points, direction=(0, 0, -1)).any()
