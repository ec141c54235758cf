# SPDX-License-Identifier: MIT
"""Views: what a camera sees, its shadows and its picture."""

from pathlib import Path

import gnomon
import numpy as np
import pytest

FLOOR_AND_ROOF = np.float32(
    [
        [[-4, 0, -4], [-4, 0, 4], [4, 0, 4]], [[-4, 0, -4], [4, 0, 4], [4, 0, -4]],
        [[-1, 1, -1], [-1, 1, 1], [1, 1, 1]], [[-1, 1, -1], [1, 1, 1], [1, 1, -1]],
    ]
)  # fmt: skip


@pytest.fixture(scope="module")
def view():
    scene = gnomon.Scene(FLOOR_AND_ROOF)
    return scene.view(eye=(0, 6, 6), target=(0, 0, 0), size=(160, 90))


def test_points_lie_on_their_receivers(view):
    assert view.points.shape == view.normals.shape == (90, 160, 3)
    assert view.receivers.shape == (90, 160) and view.receivers.min() == -1 and view.receivers.max() == 3
    is_sky = view.receivers == -1
    assert np.isnan(view.points[is_sky]).all() and np.isfinite(view.points[~is_sky]).all()
    height = np.where(view.receivers >= 2, 1, 0)
    # docs/numerics.md, 9: a point is at most 16 float32 ulps of the largest coordinate of point and eye from its hit.
    ulp = np.spacing(np.float32(max(np.abs(view.points[~is_sky]).max(), 6)))
    assert np.abs(view.points[..., 1] - height)[~is_sky].max() <= 16 * ulp
    assert np.allclose(view.normals[~is_sky], (0, 1, 0))


def test_shadows(view):
    visibility = view.visibility(direction=(0, -1, 0))
    assert visibility.shape == (90, 160) and visibility.dtype == np.float32
    with np.errstate(invalid="ignore"):
        under = (np.abs(view.points[..., 0]) < 1) & (np.abs(view.points[..., 2]) < 1) & (view.receivers < 2)
    assert (visibility[under] == 0).all() and under.any()
    assert (visibility[~under] == 1).all()
    soft = view.visibility(direction=(0, -1, 0), samples=8)
    assert set(np.unique(soft * 8)) <= set(range(9)) and len(np.unique(soft)) > 2
    assert (view.visibility(direction=(0, 1, 0))[view.receivers >= 0] == 0).all(), "light from below"


def test_a_smooth_image_is_smooth_at_edges_alone(view):
    once, smooth = view.image(direction=(0, -1, 0)), view.image(direction=(0, -1, 0), samples=8)
    differs = (once != smooth).any(axis=2)
    assert differs.any() and not differs.all()
    colors = {tuple(color) for color in once.reshape(-1, 4)}
    assert {tuple(color) for color in smooth[differs]} - colors, "edges have colours between those of their sides"


def test_image(view):
    image = view.image(direction=(0, -1, 0))
    assert image.shape == (90, 160, 4) and image.dtype == np.uint8
    dark = view.visibility(direction=(0, -1, 0)) == 0
    assert image[dark][:, :3].max() < image[~dark & (view.receivers >= 0)][:, :3].min()


def test_a_gltf_file_has_cameras_and_lights():
    if not hasattr(gnomon._gnomon, "load_scene"):
        pytest.skip("this build reads no glTF files: tinygltf was missing")
    file = Path(__file__).parents[2] / "scenes" / "concave_corners.glb"
    scene = gnomon.Scene.from_gltf(file)
    assert len(scene) > 0 and scene.cameras and scene.lights and "triangles" in repr(scene)
    view = scene.view(camera=next(iter(scene.cameras)), size=(64, 36))
    visibility = view.visibility(**next(iter(scene.lights.values())))
    assert 0 < visibility.mean() < 1


@pytest.mark.parametrize("size", ["64x48", 64, (64,), (64, 48, 1), (64.5, 48), None, ("64", "48")])
def test_a_size_that_is_none_is_named(size):
    """The characters of "64x48" were a picture of 6 x 4 pixels."""
    scene = gnomon.Scene([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]])
    with pytest.raises(ValueError, match="size: must be width and height in pixels, as .640, 360., not"):
        scene.view((0, 0, 9), (0, 0, 0), size=size)
    assert repr(scene.view((0, 0, 9), (0, 0, 0), size=np.array([64.0, 48]))) == "<gnomon.View of 64 x 48 pixels>"
    with pytest.raises(ValueError, match="fov: must be a finite number, not None"):
        scene.view((0, 0, 9), (0, 0, 0), fov=None)
