# SPDX-License-Identifier: MIT
"""What callers get wrong: an exception of the right kind that names the argument and the first bad row."""

import threading
import time

import gnomon
import numpy as np
import pytest

TRIANGLE = np.float32([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]])
POINTS = np.zeros((2, 3), np.float32)


@pytest.fixture(scope="module")
def scene():
    return gnomon.Scene(TRIANGLE)


@pytest.mark.parametrize(
    ("vertices", "faces", "text"),
    [
        (np.zeros((3, 2)), [[0, 1, 2]], r"vertices: shape \(3, 2\) is not \(V, 3\)"),
        (np.zeros((3, 3)), [[0, 1, 3]], r"faces: row 0 \[0, 1, 3\] names a vertex that is not in 0..2"),
        (np.zeros((3, 3)), [[0, 1, 2], [0, -1, 2]], r"faces: row 1 \[0, -1, 2\]"),
        (np.zeros((3, 3)), [[0, 1]], r"faces: shape \(1, 2\)"),
        (np.zeros((3, 3)), [[0.0, 1.0, 2.0]], "faces: must be integers"),
        (np.zeros((3, 3)), None, r"vertices: shape \(3, 3\) without faces"),
        ([[0, 0, 0], [0, np.nan, 0], [1, 1, 1]], [[0, 1, 2]], "vertices: row 1 .* is not finite"),
        (np.zeros((3, 3), complex), [[0, 1, 2]], "vertices: must be real numbers"),
    ],
)
def test_meshes(vertices, faces, text):
    with pytest.raises(ValueError, match=text):
        gnomon.Scene(vertices, faces)


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({}, "either direction= .* or position="),
        ({"direction": (0, 0, 1), "position": (0, 0, 1)}, "either direction= .* or position="),
        ({"direction": (0, 0, 0)}, "direction: must not be zero"),
        ({"direction": (0, 1)}, "direction: must be three numbers"),
        ({"direction": (0, np.nan, 1)}, "direction: .* not finite"),
        ({"position": (0, 1e300, 1)}, "position: .* not finite in float32"),
        ({"direction": (0, 0, 1), "receivers": [0]}, r"receivers: shape \(1,\) is not the points' \(2,\)"),
        ({"direction": (0, 0, 1), "receivers": [0, 7]}, "receivers: row 1 names triangle 7 of 1"),
        ({"direction": (0, 0, 1), "receivers": [0.5, 1]}, "receivers: must be integers"),
        ({"direction": (0, 0, 1), "side": gnomon.Side.normals([[0, 0, 1]])}, "normals: shape"),
        ({"direction": (0, 0, 1), "side": gnomon.Side.normals([[0, 0, 1], [0, 0, 0]])}, "normals: row 1 is zero"),
        (
            {"direction": (0, 0, 1), "side": gnomon.Side.normals([[0, 0, 1], [0, np.inf, 0]])},
            "normals: row 1 .* not finite",
        ),
        ({"direction": (0, 0, 1), "side": gnomon.Side.front()}, "side: Side.front.. needs receivers="),
        ({"direction": (0, 0, 1), "side": gnomon.Side.eye((0, 0, 1))}, "side: Side.eye.. needs receivers="),
        ({"direction": (0, 0, 1), "nan": "ignore"}, "nan: 'ignore'"),
        ({"direction": (0, 0, 1), "out": np.zeros(2)}, "out: is only for"),
    ],
)
def test_calls(scene, arguments, text):
    with pytest.raises(ValueError, match=text):
        scene.lit(POINTS, **arguments)


def test_a_side_is_a_side(scene):
    with pytest.raises(TypeError, match="side: must be a gnomon.Side"):
        scene.lit(POINTS, direction=(0, 0, 1), side="front", receivers=[0, 0])


@pytest.mark.parametrize(
    ("points", "text"),
    [
        (np.zeros((2, 2)), r"points: shape \(2, 2\)"),
        (np.zeros(3), r"points: shape \(3,\)"),
        ([[0, 0, 0], [0, 0, np.nan]], "points: row 1 .* is not finite"),
        ([[0, 0, 0], [1e39, 0, 0]], "points: row 1 .* is beyond float32"),
        ([["a", "b", "c"]], "points: must be real numbers"),
    ],
)
def test_points(scene, points, text):
    with pytest.raises(ValueError, match=text):
        scene.lit(points, direction=(0, 0, 1))


def test_techniques_and_settings(scene):
    with pytest.raises(ValueError, match='no technique is named "radiosity"'):
        scene.visibility(POINTS, direction=(0, 0, 1), technique="radiosity")
    with pytest.raises(ValueError, match='no setting "map-size": it has size'):
        scene.visibility(POINTS, direction=(0, 0, 1), technique=gnomon.Technique("pcf", {"map-size": -3}))


def test_a_closed_scene(scene):
    with gnomon.Scene(TRIANGLE) as closed:
        pass
    assert "closed" in repr(closed)
    with pytest.raises(ValueError, match="the scene is closed"):
        closed.lit(POINTS, direction=(0, 0, 1))


def test_memory():
    device = gnomon.use(memory_limit_bytes=20_000_000)
    try:
        with pytest.raises(MemoryError, match="under the limit"):
            gnomon.Scene(TRIANGLE).lit(np.zeros((4_000_000, 3), np.float32), direction=(0, 0, 1))
        assert gnomon.Scene(TRIANGLE).lit(POINTS, direction=(0, 0, 1)).all(), "the device stays usable"
        assert device.memory_bytes < 20_000_000
    finally:
        gnomon.use()


def test_devices():
    with pytest.raises(gnomon.DeviceNotFoundError, match='no OpenCL device matches "abacus"'):
        gnomon.use("abacus")
    with pytest.raises(OSError):
        gnomon.Scene(TRIANGLE, device="abacus")
    assert any(d.is_default for d in gnomon.devices())


def test_files(tmp_path):
    with pytest.raises(FileNotFoundError, match="nowhere.glb"):
        gnomon.Scene.from_gltf(tmp_path / "nowhere.glb")
    broken = tmp_path / "broken.glb"
    broken.write_bytes(b"glTF\2\0\0\0")
    with pytest.raises((ValueError, RuntimeError), match="broken.glb|reads no glTF"):
        gnomon.Scene.from_gltf(broken)


def test_views(scene):
    for arguments, text in [
        ({}, "either eye= and target="),
        ({"eye": (0, 0, 1)}, "target: must be three numbers"),
        ({"eye": (0, 0, 1), "target": (0, 0, 1)}, "coincide"),
        ({"camera": "front door"}, "there is no 'front door'"),
        ({"eye": (0, 0, 1), "target": (0, 0, 0), "size": (0, 5)}, "0"),
        ({"eye": (0, 0, 1), "target": (0, 0, 0), "fov": 180}, "fov|180"),
    ]:
        with pytest.raises(ValueError, match=text):
            scene.view(**arguments)


def test_other_threads_run_while_the_device_works():
    """The GIL is released: a counting thread is not held up by a run that takes a while."""
    rng = np.random.default_rng(1)
    scene = gnomon.Scene(rng.random((20_000, 3, 3), np.float32))
    points = rng.random((400_000, 3), np.float32)
    scene.lit(points[:10], direction=(0, 0, 1))  # compiles
    ticks, is_done = [], threading.Event()

    def tick():
        while not is_done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    before = len(ticks)
    scene.lit(points, direction=(0.1, 0.2, 1))
    during = len(ticks) - before
    is_done.set()
    thread.join()
    assert during >= 5


def test_threads_share_a_scene(scene):
    expected = scene.lit(POINTS, direction=(0, 0, 1)).tolist()
    results = []
    threads = [
        threading.Thread(target=lambda: results.append(scene.lit(POINTS, direction=(0, 0, 1)).tolist()))
        for _ in range(8)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results == [expected] * 8
