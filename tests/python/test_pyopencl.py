# SPDX-License-Identifier: MIT
"""pyopencl arrays: read and written where they lie, on the caller's queue."""

import gnomon
import numpy as np
import pytest

cl = pytest.importorskip("pyopencl")
pytest.importorskip("pyopencl.array")


@pytest.fixture(scope="module")
def queue():
    gnomon.devices()
    platform = cl.get_platforms()[0]
    return cl.CommandQueue(cl.Context(platform.get_devices()[:1]))


def made(count=200):
    rng = np.random.default_rng(3)
    return rng.random((30, 3, 3), np.float32), rng.random((count, 3), np.float32), rng.integers(0, 30, count)


def test_same_bits_as_from_the_host_and_no_copy(queue):
    triangles, points, receivers = made()
    normals = np.random.default_rng(4).normal(size=points.shape).astype(np.float32)
    expected = gnomon.Scene(triangles).lit(
        points, direction=(0, -1, 0), receivers=receivers, side=gnomon.Side.normals(normals)
    )
    on_device = cl.array.to_device(queue, points)
    out = cl.array.empty(queue, len(points), np.float32)
    scene = gnomon.Scene(cl.array.to_device(queue, triangles))
    arguments = {
        "receivers": cl.array.to_device(queue, receivers.astype(np.uint32)),
        "side": gnomon.Side.normals(cl.array.to_device(queue, normals)),
    }
    result = scene.lit(on_device, direction=(0, -1, 0), out=out, **arguments)
    assert result is out and result.base_data.int_ptr == out.base_data.int_ptr
    assert (result.get() != 0).tolist() == expected.tolist()
    assert (on_device.get() == points).all()
    fresh = scene.lit(on_device, direction=(0, -1, 0), **arguments)
    assert fresh.queue == queue and (fresh.get() == out.get()).all()
    assert scene._on(scene.device).triangles.buffer != 0


def test_the_triangles_buffer_is_the_callers(queue):
    triangles, points, _ = made()
    array = cl.array.to_device(queue, triangles)
    scene = gnomon.Scene(array)
    assert scene._on(scene.device).triangles.buffer == array.base_data.int_ptr
    assert len(scene) == 30
    lit = scene.lit(cl.array.to_device(queue, points), direction=(0, -1, 0)).get()
    assert (lit != 0).tolist() == gnomon.Scene(triangles).lit(points, direction=(0, -1, 0)).tolist()


def test_slices_with_an_offset(queue):
    triangles, points, _ = made()
    scene = gnomon.Scene(triangles)
    array = cl.array.to_device(queue, points)[50:]
    assert array.offset != 0
    got = scene.lit(array, direction=(0, -1, 0)).get()
    assert (got != 0).tolist() == scene.lit(points[50:], direction=(0, -1, 0)).tolist()


@pytest.mark.parametrize("offset", [1, 7, 32, 4096])
def test_results_and_receivers_with_any_offset(queue, offset):
    """OpenCL makes sub-buffers at multiples of an alignment alone; other offsets cost a copy on the device."""
    triangles, points, receivers = made()
    normals = np.random.default_rng(4).normal(size=points.shape).astype(np.float32)
    scene = gnomon.Scene(
        cl.array.to_device(queue, np.concatenate([triangles[: offset % 30], triangles]))[offset % 30 :]
    )
    expected = gnomon.Scene(triangles).lit(
        points, direction=(0, -1, 0), receivers=receivers, side=gnomon.Side.normals(normals)
    )

    def part(array, fill):
        whole = np.concatenate([np.full((offset, *array.shape[1:]), fill, array.dtype), array])
        return cl.array.to_device(queue, whole)[offset:]

    kept = cl.array.to_device(queue, np.full(offset + len(points) + 3, 0.25, np.float32))
    out = kept[offset : offset + len(points)]
    assert out.offset == 4 * offset
    result = scene.lit(
        part(points, 9), direction=(0, -1, 0), out=out, receivers=part(receivers.astype(np.uint32), 3),
        side=gnomon.Side.normals(part(normals, 1)),
    )  # fmt: skip
    assert result is out
    after = kept.get()
    assert (after[offset:-3] != 0).tolist() == expected.tolist() and 0 < expected.sum() < len(expected)
    assert (after[:offset] == 0.25).all() and (after[-3:] == 0.25).all(), "nothing beside `out` is written"


def test_what_does_not_fit(queue):
    triangles, points, receivers = made()
    scene = gnomon.Scene(triangles)
    array = cl.array.to_device(queue, points)
    with pytest.raises(TypeError, match="receivers: must be a pyopencl array"):
        scene.lit(array, direction=(0, 0, 1), receivers=receivers)
    with pytest.raises(ValueError, match="points: must be C-contiguous float32"):
        scene.lit(cl.array.to_device(queue, points.astype(np.float64)), direction=(0, 0, 1))
    with pytest.raises(ValueError, match="out: must be C-contiguous float32"):
        scene.lit(array, direction=(0, 0, 1), out=cl.array.empty(queue, 3, np.float32))
    with pytest.raises(ValueError, match="side: Side.vertices.. is only for points on the host"):
        scene.lit(array, direction=(0, 0, 1), side=gnomon.Side.vertices())
    with pytest.raises(TypeError, match="normals: must be an array in host memory, not a pyopencl array"):
        scene.lit(points, direction=(0, 0, 1), side=gnomon.Side.normals(array))
    with pytest.raises(ValueError, match="another OpenCL queue"):
        other = cl.CommandQueue(queue.context)
        gnomon.Scene(cl.array.to_device(queue, triangles)).lit(cl.array.to_device(other, points), direction=(0, 0, 1))


def test_a_side_of_triangles_that_snapping_changed_is_refused(queue):
    roof = np.array([[[0, 0, 0], [10, 0, 3], [5.001, 0.0004, 1.5003]], [[0, 0, 0], [10, 0, 0], [0, 10, 0]]])
    scene = gnomon.Scene(roof, lattice=2**-10)
    assert scene.lattice.is_changed.tolist() == [True, False]
    points = cl.array.to_device(queue, np.float32([[1, 1, 0]]))
    receivers = cl.array.to_device(queue, np.uint32([1]))
    for side in gnomon.Side.front(), gnomon.Side.eye((1, 1, 5)):
        with pytest.raises(ValueError, match="snapping changed triangle 0"):
            scene.lit(points, direction=(0, 0, -1), receivers=receivers, side=side)
    normals = cl.array.to_device(queue, np.float32([[0, 0, 1]]))
    lit = scene.lit(points, direction=(0, 0, -1), receivers=receivers, side=gnomon.Side.normals(normals))
    assert lit.get().tolist() == [1]


def test_an_out_of_order_queue_is_refused(queue):
    device = queue.device
    if not device.queue_properties & cl.command_queue_properties.OUT_OF_ORDER_EXEC_MODE_ENABLE:
        pytest.skip("this device has no out-of-order queues")
    unordered = cl.CommandQueue(queue.context, properties=cl.command_queue_properties.OUT_OF_ORDER_EXEC_MODE_ENABLE)
    with pytest.raises(ValueError, match="in-order"):
        gnomon.Scene(made()[0]).lit(cl.array.to_device(unordered, made()[1]), direction=(0, 0, 1))
