# SPDX-License-Identifier: MIT
"""gnomon.view(): the page of the command, for scenes of arrays and of files; pictures of views in notebooks."""

import copy
import io
import json
import os
import pickle
import socket
import subprocess
import sys
import urllib.parse
import urllib.request
from pathlib import Path

import gnomon
import numpy as np
import pytest
from gnomon import _page
from test_views import FLOOR_AND_ROOF

ROOT = Path(__file__).parents[2]
BINARY = Path(os.environ.get("GNOMON_BINARY", ROOT / "build" / "gnomon"))
FROM_ABOVE = {"eye": (0, 6, 6), "target": (0, 0, 0)}


@pytest.fixture
def command(monkeypatch):
    """The command gnomon, on PATH."""
    if not BINARY.exists():
        pytest.skip(f"{BINARY} is not built")
    monkeypatch.setenv("PATH", f"{BINARY.parent}{os.pathsep}{os.environ['PATH']}")
    return str(BINARY)


def ask(page, path, **parameters):
    address, token = page.address.split("?token=")
    request = urllib.request.Request(f"{address}{path}?{urllib.parse.urlencode(parameters)}")
    request.add_header("X-Gnomon-Token", token)
    with urllib.request.urlopen(request, timeout=120) as answer:
        return answer.read()


def facts_of(page):
    while "doing" in (facts := json.loads(ask(page, "state"))):
        pass
    return facts


def is_listening(address):
    try:
        socket.create_connection(("127.0.0.1", urllib.parse.urlsplit(address).port), timeout=5).close()
    except OSError:
        return False
    return True


def pixels_of(png):
    image = pytest.importorskip("PIL.Image").open(io.BytesIO(png))
    return np.asarray(image.convert("RGBA"))


def test_a_written_scene_keeps_bits_and_order(tmp_path):
    if not hasattr(gnomon._gnomon, "load_scene"):
        pytest.skip("this build reads no glTF files")
    random = np.random.default_rng(41)
    triangles = np.float32(random.normal(size=(500, 3, 3)) * 10.0 ** random.integers(-30, 30, (500, 1, 1)))
    triangles[7] = triangles[3]  # twice the same
    triangles[9, 1] = triangles[9, 0]  # without area
    scene = gnomon.Scene(triangles)
    x, y, z = np.moveaxis(triangles, -1, 0)
    for up, expected in (("y", triangles), ("z", np.stack([x, z, -y], -1))):
        file = tmp_path / f"{up}.glb"
        file.write_bytes(_page._glb(scene, up))
        assert (gnomon.Scene.from_gltf(file).triangles.view(np.uint32) == expected.view(np.uint32)).all()


def test_a_page_shows_arrays(command):
    scene = gnomon.Scene(FLOOR_AND_ROOF)
    with gnomon.view(scene, browser=False) as page:
        assert facts_of(page)["triangles"] == 4 and page.address in repr(page)
        shown = ask(page, "frame.png", size="160x90", eye="0,6,6", target="0,0,0", **{"light-direction": "0,-1,0"})
        view = scene.view(**FROM_ABOVE, size=(160, 90))
        assert (pixels_of(shown) == view.image(direction=(0, -1, 0))).all()
        folder = Path(page._folder)
        assert list(folder.iterdir())
        frame = page._repr_html_()
        assert "<iframe" in frame and f'src="{page.address}"' in frame
    assert not is_listening(page.address) and not folder.exists() and "closed" in repr(page)
    page.close()  # once more
    assert "iframe" not in page._repr_html_()


def test_z_can_point_up(command):
    city = gnomon.Scene(FLOOR_AND_ROOF[..., [0, 2, 1]] * np.float32([1, -1, 1]))
    with gnomon.view(city, up="z", browser=False) as page:
        assert facts_of(page)["bounds"] == [-4, 0, -4, 4, 1, 4]


def test_a_page_shows_what_was_read_of_a_file(command):
    file = ROOT / "scenes" / "concave_corners.glb"
    for scene in (file, str(file), gnomon.Scene.from_gltf(file, blend="mask")):
        with gnomon.view(scene, browser=False, options=["--samples", "4"]) as page:
            facts = facts_of(page)
            assert facts["scene"] == "concave_corners.glb" and facts["start"]["samples"] == "4"
            assert facts["cameras"] == list(gnomon.Scene.from_gltf(file).cameras)
            assert page._folder is None


def test_what_cannot_be_shown_is_said(command, tmp_path, monkeypatch):
    with pytest.raises(RuntimeError, match=r"missing\.glb"):
        gnomon.view(tmp_path / "missing.glb", browser=False)
    with pytest.raises(RuntimeError, match="--samples"):
        gnomon.view(gnomon.Scene(FLOOR_AND_ROOF), browser=False, options=["--samples", "3"])
    with pytest.raises(TypeError, match="ndarray"):
        gnomon.view(FLOOR_AND_ROOF)
    with pytest.raises(ValueError, match="no triangles"):
        gnomon.view(gnomon.Scene(np.empty((0, 3, 3), np.float32)))
    with pytest.raises(ValueError, match="up"):
        gnomon.view("room.glb", up="z")
    with pytest.raises(ValueError, match="up"):
        gnomon.view("room.glb", up="x")
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(FileNotFoundError, match="PATH"):
        gnomon.view(gnomon.Scene(FLOOR_AND_ROOF))
    assert not _page._open


def test_a_page_lives_as_long_as_its_process(command):
    script = (
        "import gnomon, numpy, gc\n"
        "gnomon.view(gnomon.Scene(numpy.eye(3, dtype='float32')[None]), browser=False)\n"
        "gc.collect(); page, = gnomon._page._open\n"
        "print(page.address, page._folder, page._process.poll())"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    address, folder, ended = done.stdout.split()
    assert ended == "None" and not is_listening(address) and not Path(folder).exists()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
@pytest.mark.parametrize(
    "act", ["sys.exit()", "page.close(); os._exit(0)", "_page._open.clear(); del page; gc.collect()"]
)
def test_a_child_leaves_its_parents_page(command, act):
    script = (
        "import gnomon, numpy, gc, os, sys\nfrom gnomon import _page\n"
        "page = gnomon.view(gnomon.Scene(numpy.eye(3, dtype='float32')[None]), browser=False)\n"
        f"child = os.fork()\nif child == 0:\n    {act}\n    sys.exit()\nos.waitpid(child, 0)\n"
        "print(os.path.exists(page._folder + '/scene.glb'), page._process.poll())"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout == "True None\n", done.stderr


def test_a_page_does_not_travel(command):
    with gnomon.view(gnomon.Scene(FLOOR_AND_ROOF), browser=False) as page:
        for way in (pickle.dumps, copy.copy, copy.deepcopy):
            with pytest.raises(TypeError, match="a gnomon.Page is a server of its process .* pickle its address"):
                way(page)


def test_a_notebook_shows_the_picture_of_a_view(command, tmp_path):
    view = gnomon.Scene(FLOOR_AND_ROOF).view(**FROM_ABOVE, size=(160, 90))
    (tmp_path / "scene.glb").write_bytes(_page._glb(gnomon.Scene(FLOOR_AND_ROOF), "y"))
    words = ["scene.glb", "--size", "160x90", "--eye", "0,6,6", "--target", "0,0,0", "-o", "view.png", "--quiet"]
    subprocess.run([command, "render", *words], cwd=tmp_path, check=True)
    assert (pixels_of(view._repr_png_()) == pixels_of((tmp_path / "view.png").read_bytes())).all()
    upright = gnomon.Scene(FLOOR_AND_ROOF[..., [0, 2, 1]] * np.float32([1, -1, 1]))
    turned = upright.view(eye=(0, -6, 6), target=(0, 0, 0), up=(0, 0, 1), size=(160, 90))
    assert (turned.visibility(**turned._light) == view.visibility(**view._light)).all()
    lamp = gnomon.Scene.from_gltf(ROOT / "scenes" / "concave_corners.glb")
    name, light = next(iter(lamp.lights.items()))
    view = lamp.view(camera=next(iter(lamp.cameras)), size=(64, 36))
    assert (pixels_of(view._repr_png_()) == view.image(**light)).all()
