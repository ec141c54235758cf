# SPDX-License-Identifier: MIT
"""Nothing grows: each public operation, repeated; memory, threads, file handles and device memory stay the same after
the first rounds. Beside them stand bare OpenCL calls, which tell what the driver itself keeps. (C++ and C, where no
interpreter blurs the heap: tests/c/nothing_grows_test.cpp.)

GNOMON_ROUNDS=1000 repeats each a thousand times, 20 minutes. So on 2026-11-28 with PoCL 3.1 (viewsheds, observers and
lit shares came later, and did not grow either): threads, files and device memory of all 28 were the same after the
first hundred rounds and after the last. Memory grew by 98 to 110 kB a round where a device was opened (by name, use()
with and without a limit, a queue of the caller's, a scene for many queues), evenly; by 2.0 kB for a study (all in its
first half, then 0); by .1 to .2 kB for many lights, other settings, a thread's calls and a bare program; not at all for
the others.

Those 98 to 110 kB are PoCL's: heaptrack finds all of them (90 rounds less 30) below clBuildProgram, in LLVM's metadata
and attributes (MDTuple::getImpl, AttributeList::getImpl, AttributeSetNode::getSorted) that llvm::parseIRFile reads.
PoCL has one LLVMContext for all contexts, and gives it back with the last of them. So a program of bare OpenCL calls,
which opens a context and a queue, builds the two programs that opening a device builds, and releases all, keeps 86 to
103 kB of the heap a round while another context stays open, and 64 bytes without one; gnomon's 75 to 94 kB and below
300 bytes (C++, rounds 10 to 60, by mallinfo2). test_the_last_device_gives_all_back has the second of these."""

import json
import os

import pytest
from processes import run

ROUNDS = int(os.environ.get("GNOMON_ROUNDS", "30"))

PROGRAM = """
import gc, json, os, sys, copy, pickle, threading, time
import numpy as np
import gnomon
from processes import *
table = gnomon.Lights.directions(np.random.default_rng(0).normal(size=(40, 3)))
scene = gnomon.Scene(ROOF)
many = np.tile(POINTS, (2_000, 1))
name = gnomon.use().description.selector
device = gnomon.use()
{setup}
def operation(i):
    {operation}
def used():
    gc.collect()
    pages = int(open('/proc/self/statm').read().split()[1])
    threads, files = (len(os.listdir('/proc/self/' + kind)) for kind in ('task', 'fd'))
    return pages * os.sysconf('SC_PAGE_SIZE'), threads, files, device.memory_bytes
first = None
for i in range({rounds}):
    operation(i)
    if i == {warm}: first = used()
last = used()
for _ in range(100):  # a thread that was joined may be seen a little longer
    if last[1] > first[1]: time.sleep(0.01); last = used()
print(json.dumps([b - a for a, b in zip(first, last)]))
"""
QUEUE = "import pyopencl as cl, pyopencl.array; context = cl.create_some_context(interactive=False)\n"
HILLS = "hills = 9 * np.random.default_rng(0).random((48, 48))\n"

OPERATIONS = {
    "a scene, opened and closed": ("", "with gnomon.Scene(ROOF) as s: answer(s)"),
    "a scene, dropped": ("", "answer()"),
    "a scene in a cycle": ("", "s = gnomon.Scene(ROOF); s.self = s; answer(s); del s; gc.collect()"),
    "a large scene": ("big = np.random.default_rng(0).random((40_000, 3, 3), np.float32)",
                      "gnomon.Scene(big).lit(POINTS, direction=DOWN)"),
    "a scene on a lattice": ("", "gnomon.Scene(ROOF + 0.1, lattice=2**-10).lit(POINTS, direction=DOWN)"),
    "points": ("", "scene.lit(many, direction=(0.1, 0.01 * i, -1))"),
    "many lights": ("", "scene.lit_by(many, table, bits=True)"),
    "a prepared light": (
        "", "light = (0.1, 0.01 * i, -1); scene.prepare(direction=light); scene.lit(many, direction=light)"),
    "vertices": ("", "scene.lit(np.unique(ROOF.reshape(-1, 3), axis=0), direction=DOWN, side=gnomon.Side.vertices())"),
    "a view": ("", "scene.view((0, 0, 9), (0, 0, 0), up=(0, 1, 0), size=(64, 48)).image(direction=DOWN, samples=4)"),
    "a viewshed": (HILLS, "gnomon.viewshed(hills, (9, 9), cell=1, distance=20 + i % 9, outside=3 * (i % 2) or None)"),
    "viewsheds of one grid": (
        HILLS + "grid = gnomon.ViewshedGrid(hills, cell=1)",
        "grid.viewshed([(9, 9), (20 + i % 9, 30)]); grid.least_heights((9 + i % 9, 9))"),
    "what observers see": (
        "crowd = np.tile(many, (20, 1))",
        "scene.visible_from([[0.1, -1, 0.1 * (i % 9)], [0, 5, 0]], crowd, distance=9 + i % 9, up=(0, 1, 0))"),
    "lit shares": (
        "import gnomon.surfaces; suns = np.array([[0.1 * i, 0.2, -1] for i in range(9)])\n"
        "plates = np.random.default_rng(0).random((60, 3, 3))",
        "gnomon.surfaces.lit_fractions(plates, suns, limit=50 + i % 9, centroids=True, threads=2)"),
    "a technique": ("", "scene.visibility(POINTS, direction=DOWN, technique='pcf')"),
    "a technique with other settings": (
        "", "scene.visibility(POINTS, direction=DOWN, technique=gnomon.Technique('pcf', {'size': 64 + 8 * (i % 20)}))"),
    "lights with other settings": (
        "", "scene.lit_by(POINTS, table, settings={'conservative-map': ['on', 'off', 'auto'][i % 3]})"),
    "a device by name": ("", "answer(gnomon.Scene(ROOF, device=name))"),
    "use()": ("", "gnomon.use(); answer()"),
    "use() with a limit": ("", "gnomon.use(memory_limit_bytes=100_000_000 + i); answer()"),
    "a queue of the caller's": (
        QUEUE, "q = cl.CommandQueue(context); gnomon.Scene(cl.array.to_device(q, ROOF.astype(np.float32))).lit("
               "cl.array.to_device(q, POINTS.astype(np.float32)), direction=DOWN).get()"),
    "a scene for many queues": (
        QUEUE, "q = cl.CommandQueue(context); scene.lit(cl.array.to_device(q, POINTS.astype(np.float32)),"
               " direction=DOWN).get()"),
    "arrays of one queue": (
        QUEUE + "q = cl.CommandQueue(context)\n",
        "gnomon.Scene(cl.array.to_device(q, ROOF.astype(np.float32))).lit("
        "cl.array.to_device(q, POINTS.astype(np.float32)), direction=DOWN).get()"),
    "devices()": ("", "gnomon.devices()"),
    "copies and pickles": ("", "answer(copy.deepcopy(scene)); answer(pickle.loads(pickle.dumps(scene)))"),
    "errors": ("", "for bad in ([[0, 0, np.nan]], 'x', [[1e300, 0, 0]]):\n        try: scene.lit(bad, direction=DOWN)\n"
                   "        except ValueError: pass"),
    "a thread's calls": ("", "t = threading.Thread(target=answer, args=(scene,)); t.start(); t.join()"),
    # zarr's pool begins a thread whenever none is idle, up to its limit: one from the start.
    "a study": (
        "import sys, zarr; zarr.config.set({'threading.max_workers': 1})\n"
        "sys.path[:0] = [os.path.join(os.path.dirname(sys.modules['processes'].__file__), 'study')]\n"
        "from made import *\nfrom gnomon import studies\nimport tempfile; folder = tempfile.mkdtemp()\n"
        "write_raster(folder + '/d.tif', city(24)); write_suns(folder + '/s.csv', [(180, 40)])\n",
        "studies.study(folder + '/study', raster=folder + '/d.tif', directions=folder + '/s.csv', outputs=['bits'],"
        " restart=True)"),
}  # fmt: skip
BARE = {
    "bare OpenCL: a context and a queue": (
        QUEUE, "cl.CommandQueue(cl.create_some_context(interactive=False)).finish()"),
    "bare OpenCL: a queue": (QUEUE, "q = cl.CommandQueue(context); q.finish()"),
    "bare OpenCL: a buffer": (QUEUE + "q = cl.CommandQueue(context)", "cl.array.to_device(q, many).get()"),
    "bare OpenCL: a program": (
        QUEUE + "q = cl.CommandQueue(context)",
        "cl.Program(context, 'kernel void f(global float* x) { x[0] = 1; }').build()"
        ".f(q, (1,), None, cl.Buffer(context, cl.mem_flags.READ_WRITE, 16)); q.finish()"),
}  # fmt: skip


def growth(setup, operation, rounds=ROUNDS):
    warm = max(10, rounds // 10)
    code = PROGRAM.format(setup=setup, operation=operation, rounds=rounds, warm=warm)
    done = run(code, timeout=600)
    assert done.returncode == 0, done.stderr
    memory, threads, files, on_device = json.loads(done.stdout.splitlines()[-1])
    return memory / (rounds - warm - 1), threads, files, on_device


#: Bytes that a round may add: pages that the allocator has not given back, over the rounds.
LIMIT = 200_000
#: A round that opens a device builds programs beside a context that stays open: PoCL keeps some 100 kB of them (above).
#: Where the programs were compiled, too, it was 640 kB. A device that is kept takes 11 MB and a thread.
LIMIT_WITH_DEVICE = 1_000_000
#: Bytes of the heap that a round may keep: what caches of the driver still take in.
LIMIT_OF_HEAP = 20_000


HEAP = """
import ctypes, gc
import gnomon
from processes import *
class Heap(ctypes.Structure):
    _fields_ = [(name, ctypes.c_size_t) for name in 'arena 1 2 3 mapped 5 6 used 8 9'.split()]
library = ctypes.CDLL(None)
library.mallinfo2.restype = Heap
name = gnomon.devices()[0].selector
def used():
    gc.collect()
    heap = library.mallinfo2()
    return heap.used + heap.mapped
for i in range(41):
    with gnomon.Scene(ROOF, device=name) as scene: answer(scene)
    del scene
    if i == 20: first = used()
print((used() - first) / 20)
"""


def test_the_last_device_gives_all_back():
    """Where no other context of the process is open, the driver keeps nothing either."""
    import ctypes

    if not hasattr(ctypes.CDLL(None), "mallinfo2"):
        pytest.skip("needs glibc 2.33")
    done = run(HEAP, timeout=300)
    assert done.returncode == 0, done.stderr
    assert float(done.stdout.splitlines()[-1]) < LIMIT_OF_HEAP


@pytest.mark.parametrize("member", [*BARE, *OPERATIONS])
def test_nothing_grows(member):
    setup, operation = {**BARE, **OPERATIONS}[member]
    if "pyopencl" in setup:
        pytest.importorskip("pyopencl")
    if member == "a study":
        pytest.importorskip("rasterio")
    memory, threads, files, on_device = growth(setup, operation)
    assert threads <= 0 and files <= 0 and on_device == 0  # below 0: the first rounds' ended later
    opens_device = any(word in member for word in ("device by name", "use()", "queue"))
    assert memory < (LIMIT_WITH_DEVICE if opens_device else LIMIT) * max(1, 30 / ROUNDS)
