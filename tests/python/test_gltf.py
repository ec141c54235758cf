# SPDX-License-Identifier: MIT
"""Poses, instances and packed files: equal, vertex by vertex, to the float32 of another evaluation in double."""

import json
import math
import warnings
from pathlib import Path

import gnomon
import numpy as np
import pytest

pytest.importorskip("pygltflib")
pytest.importorskip("DracoPy")

import gltf_made  # noqa: E402
import gltf_reference  # noqa: E402

SHARED = Path(__file__).resolve().parents[3] / "shared" / "gltf"
TIMES = [-1.0, 0.0, 0.1, 0.37, 1.0, 1.234567, 100.0]

pytestmark = pytest.mark.skipif(
    not hasattr(gnomon._gnomon, "load_scene"), reason="this build reads no glTF files: a library was missing"
)


def load(file: Path, **choices: object) -> gnomon.Scene:
    try:
        return gnomon.Scene.from_gltf(file, **choices)
    except ValueError as error:
        if "without compression" in str(error):
            pytest.skip(f"this build has no library for it: {error}")
        raise


def expect_equal(scene: gnomon.Scene, expected: np.ndarray) -> None:
    """Two evaluations in double differ by their own rounding: at most 2^-46 of the largest coordinate here. Each
    coordinate is the float32 of a number that near to the reference's, so that nearly all are equal."""
    got = scene.triangles
    assert got.shape == expected.shape
    slack = np.abs(expected).max() * 2.0**-46
    assert (got >= (expected - slack).astype(np.float32)).all()
    assert (got <= (expected + slack).astype(np.float32)).all()
    large = np.abs(expected) > np.abs(expected).max() * 2.0**-20  # those that did not cancel to almost nothing
    unequal = (got != expected.astype(np.float32)) & large
    assert unequal.mean() < 2e-3
    if unequal.any():
        ulps = np.abs(got - expected)[unequal] / np.spacing(np.abs(got[unequal]))
        assert ulps.max() < 0.51, "a tie, that either evaluation may round its way"


@pytest.mark.parametrize("name", gltf_made.MADE)
def test_made_files(name, tmp_path):
    file = tmp_path / f"{name}.glb"
    file.write_bytes(gltf_made.MADE[name]().glb())
    scene = load(file)
    assert scene.warnings == []
    expect_equal(scene, gltf_reference.triangles(file))
    for time in [*TIMES, 0.25, 0.5, 1.25, 2.0] if scene.animations else []:
        expect_equal(load(file, time=time), gltf_reference.triangles(file, time=time))


def shared_files() -> list[Path]:
    if not SHARED.is_dir():
        warnings.warn(f"SKIPPED: {SHARED} is not there, so no real glTF file was compared", stacklevel=1)
    return sorted(SHARED.glob("*/*.gl*"))


@pytest.mark.parametrize("file", shared_files(), ids=lambda f: f"{f.parent.name}")
def test_shared_files(file):
    scene = load(file)
    assert all("alphaMode" in w for w in scene.warnings), scene.warnings
    expect_equal(scene, gltf_reference.triangles(file))
    for index, _ in enumerate(scene.animations):
        for time in TIMES:
            expected = gltf_reference.triangles(file, time=time, animation=index)
            expect_equal(load(file, time=time, animation=index), expected)


# ---- Masks ----------------------------------------------------------------------------------------------------------


def expect_same_masks(scene: gnomon.Scene, of: gltf_reference.Evaluation) -> None:
    """The scene's masks are the reference's: both block the same points, whose rays meet masked triangles at random."""
    triangles = scene.triangles
    masks = [gnomon.CutOut(m.alpha, m.cutoff, m.factor, m.wrap, m.filter) for m in of.masks]
    same = gnomon.Scene(triangles, cut_outs=gnomon.CutOuts(of.mask, masks, of.uv, of.alpha))
    assert scene.cut_out_counts == same.cut_out_counts
    random = np.random.default_rng(5)
    where = np.flatnonzero(of.mask >= 0)
    size = np.ptp(triangles, axis=(0, 1)).max()
    through = 0.0
    for towards in random.normal(size=(8, 3)):
        chosen = triangles[where][random.integers(0, len(where), 1000)].astype(np.float64)
        hits = np.einsum("nk,nki->ni", random.dirichlet([1, 1, 1], len(chosen)), chosen)
        points = (hits - towards * size * 1e-3).astype(np.float32)
        lit = scene.lit(points, direction=-towards)
        np.testing.assert_array_equal(lit, same.lit(points, direction=-towards))
        through += (lit != gnomon.Scene(triangles).lit(points, direction=-towards)).mean() / 8
    assert 0.001 < through < 0.99, "the masks must matter"


@pytest.mark.parametrize("blend", ["opaque", "mask", "clear"])
@pytest.mark.parametrize("name", ["AlphaBlendModeTest", "GlassVaseFlowers"])
def test_masks_of_shared_files(name, blend):
    pytest.importorskip("PIL")
    file = SHARED / name / f"{name}.glb"
    if not file.exists():
        pytest.skip(f"SKIPPED: {file} is not there")
    expect_same_masks(load(file, blend=blend), gltf_reference.Evaluation(file, blend=blend))


@pytest.mark.parametrize("name", ["TextureTransformTest", "TextureTransformMultiTest"])
def test_texture_transforms_of_shared_files(name, tmp_path):
    """The files' materials as masks, with images that tell every place from every other."""
    image = pytest.importorskip("PIL.Image")
    folder = SHARED / name
    if not folder.exists():
        pytest.skip(f"SKIPPED: {folder} is not there")
    file = gltf_reference.File(next(folder.glob("*.gl*")))
    root = file.json
    alpha = np.random.default_rng(1).integers(0, 256, (32, 32), np.uint8)
    image.fromarray(np.dstack([np.zeros((32, 32, 3), np.uint8), alpha])).save(tmp_path / "noise.png")
    root["images"] = [{"uri": "noise.png"} for _ in root["images"]]
    for material in root["materials"]:
        material.update(alphaMode="MASK", alphaCutoff=0.4)
    for i, buffer in enumerate(root["buffers"]):
        buffer["uri"] = f"{i}.bin"
        (tmp_path / f"{i}.bin").write_bytes(file.buffers[i])
    made = tmp_path / "masked.gltf"
    made.write_text(json.dumps(root))
    expect_same_masks(load(made), gltf_reference.Evaluation(made))


def test_scenes_of_a_file():
    file = SHARED / "MultipleScenes_Embedded" / "MultipleScenes.gltf"
    if not file.exists():
        pytest.skip(f"SKIPPED: {file} is not there")
    for index in range(2):
        expect_equal(gnomon.Scene.from_gltf(file, scene=index), gltf_reference.triangles(file, scene=index))
    assert (len(gnomon.Scene.from_gltf(file, scene=0).triangles)) == 1
    with pytest.raises(ValueError, match="there is no scene '7'"):
        gnomon.Scene.from_gltf(file, scene=7)


def test_animations_by_name(tmp_path):
    file = tmp_path / "moving.glb"
    file.write_bytes(gltf_made.moving("LINEAR").glb())
    assert gnomon.Scene.from_gltf(file).animations == ["animation 0"]
    with pytest.raises(ValueError, match="there is no animation 'Walk'"):
        gnomon.Scene.from_gltf(file, time=0, animation="Walk")
    assert (gnomon.Scene.from_gltf(file, animation=0).triangles == gnomon.Scene.from_gltf(file, time=0).triangles).all()


def test_the_reference_knows_its_angles():
    """A quarter turn about z, a third of the way: 30 degrees."""
    q = gltf_reference.slerp(np.array([0, 0, 0, 1.0]), np.array([0, 0, math.sqrt(0.5), math.sqrt(0.5)]), 1 / 3)
    assert np.allclose(gltf_reference.rotation_matrix(q) @ [1, 0, 0], [math.sqrt(0.75), 0.5, 0], atol=1e-15)
