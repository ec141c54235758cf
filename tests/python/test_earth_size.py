# SPDX-License-Identifier: MIT
"""glTF files whose nodes lead to places where float32 has steps of half a metre: their double coordinates reach the
lattice, in Scene.from_gltf() and in studies. The roof is a metre wide; the edge lies between points 2 mm apart."""

import gnomon
import numpy as np
import pytest

pytest.importorskip("DracoPy")

from gltf_made import Made  # noqa: E402

PLACE = np.array([4_500_001.201, 123.456, 5_300_001.303])
ROOF = np.array([[-0.5, 0, -0.5], [-0.5, 0, 0.5], [0.5, 0, 0.5], [0.5, 0, -0.5]])
FACES = [[0], [1], [2], [0], [2], [3]]
EDGES = [[0.499, -1, 0.1], [0.501, -1, 0.1], [-0.499, -1, 0.1], [-0.501, -1, 0.1], [0.1, -1, 0.499], [0.1, -1, 0.501]]
UNDER = [False, True] * 3
DOWN = (0, -1, 0)

pytestmark = pytest.mark.skipif(
    not hasattr(gnomon._gnomon, "load_scene"), reason="this build reads no glTF files: a library was missing"
)


def made(positions=ROOF, dtype="float32", **node):
    """One node with the roof."""
    file = Made()
    mesh = file.mesh(file.accessor(positions, dtype), indices=file.accessor(FACES, "uint16"))
    file.add("nodes", mesh=mesh, **node)
    return file


def under_parents():
    """The sum of two translations, of which float32 holds neither."""
    file = made(translation=(PLACE - [4_000_000.3, 0, 0.7]).tolist())
    file.add("nodes", translation=[4_000_000.3, 0, 0.7], children=[0])
    file.json["scenes"] = [{"nodes": [1]}]
    return file


def instanced():
    file = made(translation=(PLACE - [64, 0, 0]).tolist())
    places = file.accessor([[64, 0, 0], [32, 0, 0]])
    file.json["nodes"][0]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}}
    file.json["extensionsUsed"] = ["EXT_mesh_gpu_instancing"]
    return file


def morphed():
    file = Made()
    target = file.accessor(ROOF / 2)
    mesh = file.mesh(file.accessor(ROOF / 2), indices=file.accessor(FACES, "uint16"), targets=[{"POSITION": target}],
                     weights=[1])  # fmt: skip
    file.add("nodes", mesh=mesh, translation=PLACE.tolist())
    return file


def skinned():
    """A skin ignores the node of its mesh, and goes where its joint is."""
    file = Made()
    joints, weights = file.accessor([[0, 0, 0, 0]] * 4, "uint8"), file.accessor([[1, 0, 0, 0]] * 4)
    mesh = file.mesh(file.accessor(ROOF), {"JOINTS_0": joints, "WEIGHTS_0": weights},
                     indices=file.accessor(FACES, "uint16"))  # fmt: skip
    file.add("nodes", mesh=mesh, skin=0)
    file.add("nodes", translation=PLACE.tolist())
    file.add("skins", joints=[1])
    file.json["scenes"] = [{"nodes": [0, 1]}]
    return file


def quantized():
    file = made(2 * ROOF, "int8", translation=PLACE.tolist(), scale=[0.5, 0.5, 0.5])
    file.json["extensionsUsed"] = ["KHR_mesh_quantization"]
    return file


def animated():
    """The keyframes are float32 and stay near; the parent leads away."""
    file = made()
    file.add("nodes", translation=(PLACE - [8, 0, 0]).tolist(), children=[0])
    file.json["scenes"] = [{"nodes": [1]}]
    file.channel(0, "translation", "LINEAR", [0, 1], [[0, 0, 0], [16, 0, 0]])
    return file


def beside_one_that_stays():
    """A second roof has the file's own bits, 3 km away."""
    file = made(translation=PLACE.tolist())
    far = file.accessor(np.float32(ROOF * 64 + [4_503_000, 0, 5_300_000]))
    file.add("nodes", mesh=file.mesh(far, indices=file.accessor(FACES, "uint16")))
    file.json["scenes"] = [{"nodes": [0, 1]}]
    return file


def strip():
    file = Made()
    mesh = file.mesh(file.accessor(ROOF[[0, 1, 3, 2]]))
    file.json["meshes"][mesh]["primitives"][0]["mode"] = 5
    file.add("nodes", mesh=mesh, translation=PLACE.tolist())
    return file


MEMBERS = {
    "a translation": lambda: made(translation=PLACE.tolist()),
    "a matrix": lambda: made(matrix=[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, *PLACE.tolist(), 1]),
    "a scale": lambda: made(ROOF * 8, translation=PLACE.tolist(), scale=[0.125] * 3),
    "a mirrored node": lambda: made(translation=PLACE.tolist(), scale=[-1, 1, 1]),
    "a quarter turn": lambda: made(translation=PLACE.tolist(), rotation=[0, 0.5**0.5, 0, 0.5**0.5]),
    "a node below another": under_parents,
    "instances": instanced,
    "a morph target": morphed,
    "a skin": skinned,
    "quantized positions": quantized,
    "an animation": animated,
    "beside a mesh that stays": beside_one_that_stays,
    "a strip": strip,
    "a millimetre's mesh": lambda: made(ROOF * 1000, translation=PLACE.tolist(), scale=[0.001] * 3),
}


@pytest.mark.parametrize("member", MEMBERS)
def test_it_is_exact_there(member, tmp_path):
    file = tmp_path / "roof.glb"
    file.write_bytes(MEMBERS[member]().glb())
    scene = gnomon.Scene.from_gltf(file, time=0.5 if member == "an animation" else None)
    assert scene.warnings == [] and scene.lattice is not None
    assert scene.lattice.largest_move < 2.0**-10
    assert scene.lit(PLACE + EDGES, direction=DOWN).tolist() == UNDER


def test_float32_would_be_wrong(tmp_path):
    """So that the cases above mean something: float32 has four corners of the roof in two places each."""
    rounded = np.float32(PLACE + ROOF)[FACES].reshape(2, 3, 3)
    assert gnomon.Scene(rounded).lit(PLACE + EDGES, direction=DOWN).tolist() != UNDER


def test_a_roof_that_float32_makes_a_point(tmp_path):
    file = tmp_path / "roof.glb"
    file.write_bytes(made(ROOF / 32, translation=PLACE.tolist()).glb())
    scene = gnomon.Scene.from_gltf(file)
    assert np.ptp(np.float32(PLACE + ROOF / 32), axis=0).max() == 0
    assert scene.lit(PLACE + np.array(EDGES) / [32, 1, 32], direction=DOWN).tolist() == UNDER


def with_lamp_and_camera(file, at):
    """A lamp two metres above the roof, .1 mm beside its edge, and a camera above its corner that looks down."""
    file.json["extensionsUsed"] = ["KHR_lights_punctual"]
    file.json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point"}]}}
    lamp, eye = (at + [0.5001, 2, 0]).tolist(), (at + [0.5, 10, 0.5]).tolist()
    file.add("nodes", name="lamp", translation=lamp, extensions={"KHR_lights_punctual": {"light": 0}})
    file.add("cameras", type="perspective", perspective={"yfov": 0.02, "znear": 0.1})
    file.add("nodes", name="above", translation=eye, camera=0, rotation=[-(0.5**0.5), 0, 0, 0.5**0.5])
    file.json["scenes"] = [{"nodes": [0, 1, 2]}]
    return file


@pytest.mark.parametrize("stays", [False, True], ids=["moved", "float32 holds the mesh"])
def test_lamps_and_cameras(stays, tmp_path):
    """A ray down beside the edge is free, one a millimetre further in is not; the camera sees a quarter of its picture
    filled by the corner."""
    at = np.array([4_500_001.0, 123.0, 5_300_001.0]) if stays else PLACE
    roof = made(ROOF + at) if stays else made(translation=at.tolist())
    file = tmp_path / "roof.glb"
    file.write_bytes(with_lamp_and_camera(roof, at).glb())
    scene = gnomon.Scene.from_gltf(file)
    assert (scene.lattice is None) == stays
    lamp = scene.lights["lamp"]
    assert lamp["position"] == tuple(at + [0.5001, 2, 0])
    below = at + [[0.5001, -2, 0.1], [0.499, -2, 0.1]]
    assert scene.lit(below, **lamp).tolist() == [True, False]
    view = scene.view(camera="above", size=(64, 64))
    assert (view.receivers >= 0).mean() == 0.25


def test_a_study_reads_them_too(tmp_path):
    """x, -z, y: in a study z is up."""
    pytest.importorskip("rasterio")
    file = tmp_path / "roof.glb"
    file.write_bytes(made(translation=PLACE.tolist()).glb())
    points = (PLACE + EDGES)[:, [0, 2, 1]] * [1, -1, 1]
    np.save(tmp_path / "points.npy", points)
    (tmp_path / "suns.csv").write_text("x,y,z\n0,0,-1\n")
    done = gnomon.study(
        tmp_path / "study", meshes=file, receivers="points", points=tmp_path / "points.npy", crs="EPSG:25832",
        directions=tmp_path / "suns.csv",
    )  # fmt: skip
    assert (done.dataset().sum_of_weights.values.reshape(-1) == 1).tolist() == UNDER
