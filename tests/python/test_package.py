# SPDX-License-Identifier: MIT
"""The package itself: types, stubs, silence, loading, and Ctrl-C."""

import os
import subprocess
import sys
from importlib.resources import files

import gnomon


def run(code, **environment):
    return subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env={**os.environ, **environment}, timeout=120
    )


def test_it_is_typed():
    package = files("gnomon")
    assert (package / "py.typed").is_file()
    stub = (package / "_gnomon.pyi").read_text()
    assert "class DeviceDescription" in stub and "def techniques" in stub


def test_names_and_docstrings():
    for name in gnomon.__all__:
        assert getattr(gnomon, name) is not None
    for documented in (gnomon.Scene, gnomon.Scene.lit, gnomon.Scene.view, gnomon.View.visibility, gnomon.use):
        assert len(documented.__doc__) > 50
    assert "frustum-traced" in [t.name for t in gnomon.techniques() if t.exact]


def test_reprs_help():
    assert "the default" in repr(gnomon.devices()) and "frustum-traced" in repr(gnomon.techniques())
    assert any("conservative-map=auto" in repr(s) for t in gnomon.techniques() for s in t.settings)


def test_importing_loads_no_opencl_and_prints_nothing():
    code = "import gnomon; print(len(gnomon.techniques()) > 5); print('libOpenCL' in open('/proc/self/maps').read())"
    done = run(code, GNOMON_OPENCL_LIBRARY="/nonexistent/libOpenCL.so.1")
    assert (done.stdout, done.stderr) == ("True\nFalse\n", "")


def test_a_missing_library_is_one_sentence_with_the_remedy():
    code = "import gnomon\ntry: gnomon.devices()\nexcept gnomon.DeviceNotFoundError as e: print(e)"
    done = run(code, GNOMON_OPENCL_LIBRARY="/nonexistent/libOpenCL.so.1")
    assert done.stdout.count("\n") == 1 and done.stderr == ""
    assert "/nonexistent/libOpenCL.so.1" in done.stdout and "pip install gnomon[pocl]" in done.stdout


def test_a_run_prints_nothing():
    code = "import gnomon, numpy; gnomon.Scene(numpy.eye(3)[None]).lit(numpy.zeros((5, 3)), direction=(0, 0, 1))"
    done = run(code)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_ctrl_c_is_answered_while_the_device_works():
    code = """
import gnomon, numpy, os, signal, threading, time
rng = numpy.random.default_rng(1)
scene = gnomon.Scene(rng.random((20_000, 3, 3), numpy.float32))
points = rng.random((100_000, 3), numpy.float32)
took = 0
while took < 1:  # a call that takes long on this machine
    points = numpy.concatenate([points, points])
    start = time.monotonic()
    scene.lit(points, direction=(0, 0, 1))
    took = time.monotonic() - start
threading.Timer(took / 4, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
start = time.monotonic()
try:
    scene.lit(points, direction=(0, 0, 1))
    print("finished")
except KeyboardInterrupt:
    answered = time.monotonic() - start
    print("interrupted", answered < 0.75 * took, scene.lit(points[:3], direction=(0, 0, 1)).shape)
"""
    done = run(code)
    assert done.stdout == "interrupted True (3,)\n", done.stderr


def test_ctrl_c_ends_a_viewshed():
    """At the next of its observers, each of which takes 10 ms here."""
    code = """
import gnomon, numpy, signal, threading, time
signal.signal(signal.SIGINT, signal.default_int_handler)
grid, reports = gnomon.ViewshedGrid(numpy.eye(9), cell=1.0), []
def report(done):
    reports.append(done)
    if len(reports) == 1: signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)
    time.sleep(.01)
try:
    grid.viewshed(numpy.full((500, 2), 4.0), progress=report)
except KeyboardInterrupt:
    print("interrupted", grid.viewshed([[4.0, 4.0]]).counts.shape, len(reports) < 400)
"""
    assert run(code).stdout == "interrupted (9, 9) True\n"


def test_ctrl_c_ends_lit_fractions():
    """Within the one sun that each thread has, and a caller's thread that is not the main one goes on."""
    code = """
import gnomon.surfaces, numpy, os, signal, threading, time
signal.signal(signal.SIGINT, signal.default_int_handler)
triangles = numpy.random.default_rng(1).random((1000, 3, 3))
took, suns = 0, numpy.array([[0.1, 0.2, -1]])
while took < 1:
    triangles = numpy.concatenate([triangles, triangles[:500] + 0.001])
    start = time.monotonic()
    whole = gnomon.surfaces.lit_fractions(triangles, suns, threads=1)
    took = time.monotonic() - start
threading.Timer(took / 4, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
start = time.monotonic()
try:
    gnomon.surfaces.lit_fractions(triangles, suns, threads=1)
    print("finished")
except KeyboardInterrupt:
    print("interrupted", time.monotonic() - start < 0.75 * took)
again = []
thread = threading.Thread(target=lambda: again.append(gnomon.surfaces.lit_fractions(triangles, suns, threads=2)))
thread.start()
try:
    os.kill(os.getpid(), signal.SIGINT)
    thread.join()
except KeyboardInterrupt:
    thread.join()
print((again[0].low == whole.low).all())
"""
    done = run(code)
    assert done.stdout == "interrupted True\nTrue\n", done.stderr


def test_signals_are_left_alone():
    # In a process of its own, whatever this one inherited: a shell's background job ignores interrupts.
    code = """
import signal
numbers = [s for s in signal.valid_signals() if s not in (signal.SIGKILL, signal.SIGSTOP)]
signal.signal(signal.SIGINT, signal.default_int_handler)
before = [signal.getsignal(s) for s in numbers]
import gnomon, numpy
gnomon.Scene(numpy.zeros((1, 3, 3))).lit(numpy.zeros((1, 3)), direction=(0, 0, 1))
print([signal.getsignal(s) for s in numbers] == before)
"""
    assert run(code).stdout == "True\n"
