# SPDX-License-Identifier: MIT
"""Poses, instances and packed files: equal, vertex by vertex, to the float32 of another evaluation in double."""

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
    not hasattr(gnomon._gnomon, "load_scene"), reason="this build reads no glTF files: tinygltf was missing"
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
