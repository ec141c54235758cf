# SPDX-License-Identifier: MIT
# ruff: noqa: E501 - programs stand in tables
"""Processes: forks in every state of the parent, pools, objects that travel, and the interpreter's exit. Each ends with
the right answer, or with one exception at once that names 'spawn'; none hangs."""

import copy
import os
import pickle
import subprocess
import sys
import types

import gnomon
import numpy as np
import pytest
from processes import DOWN, POINTS, RIGHT, ROOF, answer, run

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")

ANSWERED, REFUSED = f"answered {RIGHT}", "refused RuntimeError True"

#: What the parent did before it forks.
STATES = {
    "imported": ("", ANSWERED),
    "techniques listed": ("gnomon.techniques(), gnomon.Lights.directions([[0, 0, -1]])", ANSWERED),
    "no library found": (
        "os.environ['GNOMON_OPENCL_LIBRARY'] = '/nowhere.so'\ntry: gnomon.use()\nexcept OSError: pass\n"
        "del os.environ['GNOMON_OPENCL_LIBRARY']",
        ANSWERED,
    ),
    "devices listed": ("gnomon.devices()", REFUSED),
    "device open": ("gnomon.use()", REFUSED),
    "scene made": ("scene = gnomon.Scene(ROOF)", REFUSED),
    "scene used": ("scene = gnomon.Scene(ROOF); answer(scene)", REFUSED),
    "scene used and closed": ("scene = gnomon.Scene(ROOF); answer(scene); scene.close(); del scene", REFUSED),
    "device by name": ("scene = gnomon.Scene(ROOF, device=gnomon.devices()[0].selector); answer(scene)", REFUSED),
    "device is being opened": ("threading.Thread(target=gnomon.use).start(); time.sleep(.05)", REFUSED),
    "run in another thread": (
        "big = gnomon.Scene(ROOF); pts = numpy.tile(POINTS, (200_000, 1))\n"
        "threading.Thread(target=lambda: [big.lit(pts, direction=DOWN) for _ in range(3)]).start(); time.sleep(.3)",
        REFUSED,
    ),
    "pyopencl alone used": (
        "import pyopencl; queue = pyopencl.CommandQueue(pyopencl.create_some_context(interactive=False))",
        REFUSED,
    ),
}  # fmt: skip

FORK = """
import os, sys, threading, time
import gnomon, numpy
from processes import *
{state}
sys.stdout.flush()
child = os.fork()
if child == 0:
    try:
        {act}
        print("answered", answer({given}), flush=True)
    except Exception as error:
        print("refused", type(error).__name__, "spawn" in str(error), flush=True)
    {end}
os.waitpid(child, 0)
os._exit(0)
"""


def forked(state, act="", given="", end="os._exit(0)"):
    return run(FORK.format(state=state, act=act, given=given, end=end)).stdout.strip()


@pytest.mark.parametrize("state", STATES)
def test_a_child_answers_or_refuses_at_once(state):
    if "pyopencl" in state:
        pytest.importorskip("pyopencl")
    before, expected = STATES[state]
    assert forked(before) == expected


#: What the child does with what it inherited. The parent has used `scene`.
ACTS = {
    "the remedy of other packages": ("gnomon.use()", ""),
    "lists devices": ("gnomon.devices()", ""),
    "uses the inherited scene": ("", "scene"),
    "prepares it": ("scene.prepare(direction=DOWN)", "scene"),
    "uses the inherited view": ("view.visibility(direction=DOWN)", ""),
    "drops what it inherited": ("del scene, view, table; import gc; gc.collect()", ""),
    "closes the scene": ("scene.close()", "scene"),
    "many lights": ("scene.lit_by(POINTS, table)", ""),
    "a copy of the scene": ("import copy; copy.deepcopy(scene).lit(POINTS, direction=DOWN)", ""),
    "a pickled scene": ("import pickle; scene = pickle.loads(pickle.dumps(scene))", "scene"),
    "a grandchild": ("child = os.fork()\n        if child: os.waitpid(child, 0); os._exit(0)", "scene"),
    "a study": ("from gnomon.studies import runner\n        with runner.executor_of(runner.Execution()): pass", ""),
}
USED = (
    "scene = gnomon.Scene(ROOF); answer(scene); view = scene.view((0, 0, 9), (0, 0, 0), up=(0, 1, 0), size=(8, 8))\n"
    "view.visibility(direction=DOWN); table = gnomon.Lights.directions([DOWN]); scene.lit_by(POINTS, table)"
)


@pytest.mark.parametrize("act", ACTS)
def test_a_child_uses_what_it_inherited(act):
    refused = forked(USED, *ACTS[act])
    expected = REFUSED if act != "closes the scene" else "refused ValueError False"
    assert refused == expected


def test_a_child_reads_the_results_of_a_study(tmp_path):
    """Which need no device. The parent has read them, too, by dask's threads, which a child has not."""
    pytest.importorskip("rasterio")
    state = (
        f"sys.path[:0] = [{os.path.join(os.path.dirname(__file__), 'study')!r}]\nfrom made import *\n"
        f"os.chdir({str(tmp_path)!r})\nfrom gnomon import studies\n"
        "write_raster('d.tif', city(24)); write_suns('s.csv', [(180, 40)])\n"
        "done = studies.study('study', raster='d.tif', directions='s.csv', outputs=['bits'])\n"
        "lit = int(done.dataset().lit.values.sum())"
    )
    act = "answer = lambda: int(done.dataset().lit.values.sum()) == lit"
    assert forked(state, act) == "answered True"


@pytest.mark.parametrize("end", ["sys.exit(0)", "raise SystemExit", "pass", "os.execv('/bin/true', ['true'])"])
def test_a_child_ends_in_any_way(end):
    assert forked(USED, "", "scene", end).splitlines()[0] == REFUSED


def test_what_an_unused_child_opens_is_refused_to_its_own_child():
    act = "answer()\n        child = os.fork()\n        if child: os.waitpid(child, 0); os._exit(0)"
    assert forked("", act) == REFUSED


def test_the_parent_goes_on():
    code = FORK.replace("os.waitpid(child, 0)\nos._exit(0)", "os.waitpid(child, 0)\nprint(answer(scene), answer())")
    code = code.format(state=USED, act="del scene, view", given="", end="os._exit(0)")
    assert run(code).stdout.splitlines() == [REFUSED, f"{RIGHT} {RIGHT}"]


POOL = """
import gnomon, multiprocessing, os
from processes import *

def work(scene):
    return answer(scene)

if __name__ == "__main__":
    scene = gnomon.Scene(ROOF)
    answer(scene)
    try:
        {call}
    except RuntimeError as error:
        print("refused", "spawn" in str(error))
"""
POOLS = {
    "multiprocessing, fork": ("with multiprocessing.get_context('fork').Pool(2) as p: print(p.map(work, [{}] * 2))", 0),
    "multiprocessing, spawn": (
        "with multiprocessing.get_context('spawn').Pool(2) as p: print(p.map(work, [{}] * 2))", 1),
    "multiprocessing, forkserver": (
        "with multiprocessing.get_context('forkserver').Pool(2) as p: print(p.map(work, [{}] * 2))", 1),
    "futures, fork": (
        "from concurrent.futures import *\n        with ProcessPoolExecutor(2, multiprocessing.get_context('fork')) as p:"
        "\n            print(list(p.map(work, [{}] * 2)))", 0),
    "futures, spawn": (
        "from concurrent.futures import *\n        with ProcessPoolExecutor(2, multiprocessing.get_context('spawn')) as p:"
        "\n            print(list(p.map(work, [{}] * 2)))", 1),
    "threads": (
        "from concurrent.futures import *\n        with ThreadPoolExecutor(2) as p: print(list(p.map(work, [{}] * 2)))", 1),
    "joblib, loky": (
        "import joblib; print(joblib.Parallel(2)(joblib.delayed(answer)(s) for s in [{}] * 2))", 1),
    "joblib, multiprocessing": (
        "import joblib\n        print(joblib.Parallel(2, 'multiprocessing')(joblib.delayed(answer)(s) for s in [{}] * 2))", 0),
    "dask, processes": (
        "import dask\n        print(list(dask.compute(*[dask.delayed(answer)(s) for s in [{}] * 2], scheduler='processes',"
        " num_workers=2)))", 1),
    "dask, a cluster of processes": (
        "from distributed import *\n        with LocalCluster(2, processes=True, threads_per_worker=1, dashboard_address=None)"
        " as c, Client(c) as client:\n            print(client.gather([client.submit(answer, s, pure=False) for s in [{}] * 2]))",
        1),
}  # fmt: skip


@pytest.mark.parametrize(  # None: the worker makes a scene
    ("pool", "given"), [(p, g) for p in POOLS for g in ("scene", "None") if g == "scene" or "multiprocessing" in p]
)
def test_pools(pool, given, tmp_path):
    if pool.split(",")[0] in ("joblib", "dask"):
        pytest.importorskip(pool.split(",")[0])
    call, is_answered = POOLS[pool]
    done = run(POOL.format(call=call.format(given)), tmp_path)
    expected = str([RIGHT] * 2) if is_answered else "refused True"
    assert done.stdout.strip() == expected, done.stderr


def test_pytest_by_workers(tmp_path):
    pytest.importorskip("xdist")
    (tmp_path / "test_roof.py").write_text(
        "import gnomon, pytest\nfrom processes import *\ngnomon.use()\n"
        "@pytest.mark.parametrize('i', range(4))\ndef test_roof(i): assert answer() == RIGHT\n"
    )
    done = run("import pytest, sys; sys.exit(pytest.main(['-q', '-n2', '-p', 'no:cacheprovider']))", tmp_path)
    assert "4 passed" in done.stdout, done.stdout + done.stderr


UNGUARDED = """
from gnomon.studies import runner
print("line 3")
{guard}with runner.executor_of(runner.Execution(workers=2)) as e:{rest}
"""


@pytest.mark.parametrize("guard", ["", "if __name__ == '__main__':\n  "])
def test_a_script_without_main_guard_is_one_sentence(guard, tmp_path):
    pytest.importorskip("distributed")
    code = UNGUARDED.format(guard=guard, rest=" print(sorted(dict(e.run([(i, abs, (-i,)) for i in (1, 2)])).items()))")
    done = run(code, tmp_path)
    if guard:
        assert "[(1, 1), (2, 2)]" in done.stdout and done.returncode == 0, done.stderr
    else:
        assert done.stdout == "line 3\n" and "line 4: the worker processes" in done.stderr.splitlines()[-1]
        assert '__name__ == "__main__"' in done.stderr.splitlines()[-1]


def test_a_thread_of_a_script_without_main_guard_is_one_sentence(tmp_path):
    pytest.importorskip("distributed")
    code = """
import threading
from gnomon.studies import runner
def go():
    with runner.executor_of(runner.Execution(workers=1)): pass
threading.Thread(target=go).start()
"""
    done = run(code, tmp_path)
    assert done.stderr.count("Traceback") == 1, done.stderr
    assert done.stderr.splitlines()[-1].endswith('put what starts it below if __name__ == "__main__":')


def test_a_study_outlives_no_main_thread(tmp_path):
    """Calls in its thread end by one sentence, whenever the main thread ends, and the program does end."""
    pytest.importorskip("rasterio")
    for seconds in (0, 0.3):
        code = f"""
import threading, time
from gnomon.studies import runner
def go():
    calls = ((i, time.sleep, (0.1,)) for i in range(200))
    try:
        with runner.executor_of(runner.Execution()) as e: print(len(list(e.run(calls))))
    except runner.StudyStoppedError as error: print(error)
threading.Thread(target=go).start()
time.sleep({seconds})
"""
        done = run(code, tmp_path, timeout=15)
        assert done.stdout.startswith("the program's main thread has ended, and a study"), done.stdout + done.stderr
        assert (done.returncode, done.stderr, done.stdout.count("\n")) == (0, "", 1)


def test_a_program_that_workers_cannot_import_is_one_sentence(tmp_path):
    pytest.importorskip("distributed")
    start = (
        "import sys\nfrom gnomon.studies import runner\nwith runner.executor_of(runner.Execution(workers=1)): pass\n"
    )
    done = subprocess.run([sys.executable], input=start, capture_output=True, text=True, timeout=90)
    assert done.stderr.splitlines()[-1].endswith("import the program, and <stdin> is no file: write it into one")
    pool = "with multiprocessing.get_context('spawn').Pool(1) as p: p.apply(start)"
    code = f"import multiprocessing\ndef start(): exec({start!r}, {{}})\nif __name__ == '__main__':\n    {pool}\n"
    said = run(code, tmp_path).stderr.splitlines()[-1]
    assert said.startswith(
        "RuntimeError: workers=: a process of multiprocessing.Pool or of a dask worker may start none"
    )


def test_an_interactive_program_needs_no_guard():
    pytest.importorskip("distributed")
    code = UNGUARDED.format(guard="", rest=" print(sorted(dict(e.run([(i, abs, (-i,)) for i in (1, 2)])).items()))")
    done = run(code)
    assert "[(1, 1), (2, 2)]" in done.stdout, done.stderr


# ---- Objects that travel ---------------------------------------------------------------------------------------------

MESH = np.concatenate([ROOF, ROOF + [0.1, 0, 1]])


def cut_out_scene():
    leaf = np.array([[0, 255], [255, 255]], np.uint8)
    materials = [gnomon.CutOut(leaf, filter="nearest")]
    uv = np.array([[0, 0], [1, 0], [1, 1], [0, 0], [1, 1], [0, 1]], float).reshape(2, 3, 2)
    return gnomon.Scene(ROOF, cut_outs=gnomon.CutOuts(material=[0, 0], materials=materials, uv=uv))


SCENES = {
    "float32": lambda: gnomon.Scene(ROOF),
    "on a lattice": lambda: gnomon.Scene(MESH + [4_500_000, 0.1, 0], lattice=2**-10),
    "with cut-outs": cut_out_scene,
    "by a device's name": lambda: gnomon.Scene(ROOF, device=gnomon.devices()[0].selector),
    "after a run": lambda: (lambda s: (answer(s), s)[1])(gnomon.Scene(ROOF)),
    "without triangles": lambda: gnomon.Scene(np.empty((0, 3, 3))),
}
WAYS = {
    "pickle": lambda o: pickle.loads(pickle.dumps(o)),
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("kind", SCENES)
def test_scenes_travel(kind, way):
    scene = SCENES[kind]()
    travelled = WAYS[way](scene)
    shift = [4_500_000, 0, 0] if scene.lattice is not None else [0, 0, 0]
    grid = np.stack(np.meshgrid(np.arange(-2, 2, 0.25), np.arange(-2, 2, 0.25), [0.0]), axis=-1) + shift
    assert (travelled.lit(grid, direction=DOWN) == scene.lit(grid, direction=DOWN)).all()
    assert (travelled.triangles == scene.triangles).all() and repr(travelled) == repr(scene)
    scene.close()
    assert travelled.lit(grid, direction=DOWN).shape == grid.shape[:-1]


def test_a_gltf_scene_travels_with_its_cameras_and_warnings():
    file = os.path.join(os.path.dirname(__file__), "..", "..", "scenes", "leaves.glb")
    try:
        scene = gnomon.Scene.from_gltf(file)
    except RuntimeError as error:
        pytest.skip(str(error))
    travelled = pickle.loads(pickle.dumps(scene))
    assert list(travelled.cameras) == list(scene.cameras) and travelled.lights == scene.lights
    assert travelled.warnings == scene.warnings and travelled.cut_out_counts == scene.cut_out_counts
    for name in scene.cameras:
        one, two = (s.view(camera=name, size=(40, 30)).image(direction=(1, -3, 2)) for s in (scene, travelled))
        assert (one == two).all()


@pytest.mark.parametrize("way", WAYS)
def test_small_objects_travel(way):
    through = WAYS[way]
    assert through(gnomon.Side.normals([[0, 0, 1]])).value == [[0, 0, 1]]
    assert through(gnomon.Technique("pcf", {"size": 64})) == gnomon.Technique("pcf", {"size": 64})
    assert through(gnomon.Lights.directions([[0, 0, -1]], [2.0])).weights == [2.0]
    for one in gnomon.techniques():
        two = through(one)
        assert (two.name, two.summary, two.exact, repr(two)) == (one.name, one.summary, one.exact, repr(one))
        assert list(map(repr, two.settings)) == list(map(repr, one.settings))
    names = [name for name in dir(gnomon.DeviceDescription) if not name.startswith("_")]
    for device in gnomon.devices():
        travelled = through(device)
        assert [getattr(travelled, name) for name in names] == [getattr(device, name) for name in names]
        assert len(names) == 13 and repr(travelled) == repr(device)
    scene = gnomon.Scene(ROOF)
    result = through(scene.lit_by(POINTS, gnomon.Lights.directions([DOWN]), bits=True))
    assert result.lit().tolist() == [[lit] for lit in RIGHT]
    masked = through(scene.lit(np.array([[0, 0, np.nan]]), direction=DOWN, nan="absent"))
    assert masked.mask.all()
    at_vertices = through(
        scene.lit(np.unique(ROOF.reshape(-1, 3), axis=0), direction=DOWN, side=gnomon.Side.vertices())
    )
    assert at_vertices.values.shape == (4,)


def view_of(scene):
    return scene.view((0, 0, 9), (0, 0, 0), up=(0, 1, 0), size=(8, 8))


@pytest.mark.parametrize(
    ("make", "text"),
    [
        (lambda: gnomon.use(), "gnomon.use.. in the other process"),
        (lambda: view_of(gnomon.Scene(ROOF)), "call Scene.view.. in the other process"),
    ],
)
def test_what_lies_on_a_device_says_what_to_pickle(make, text):
    made = make()
    with pytest.raises(TypeError, match=text):
        pickle.dumps(made)


def test_a_scene_of_a_device_array_says_what_to_pickle():
    array = pytest.importorskip("pyopencl.array")
    import pyopencl

    queue = pyopencl.CommandQueue(pyopencl.create_some_context(interactive=False))
    scene = gnomon.Scene(array.to_device(queue, ROOF.astype(np.float32)))
    for way in (pickle.dumps, copy.copy, copy.deepcopy):
        with pytest.raises(TypeError, match="make a scene of that"):
            way(scene)


def test_a_closed_scene_does_not_travel():
    with gnomon.Scene(ROOF) as closed:
        pass
    for way in WAYS.values():
        with pytest.raises(ValueError, match="the scene is closed"):
            way(closed)


def test_a_device_is_its_own_copy():
    device = gnomon.use()
    assert copy.copy(device) is device and copy.deepcopy([device])[0] is device


def test_a_travelled_scene_opens_no_device_before_it_is_used():
    pickled = pickle.dumps(gnomon.Scene(ROOF)).hex()
    code = f"""
    import gnomon, pickle
    from processes import *
    scene = pickle.loads(bytes.fromhex('{pickled}'))
    print('libOpenCL' in open('/proc/self/maps').read(), repr(scene), answer(scene))
    """
    assert run(code).stdout.strip() == f"False <gnomon.Scene of 2 triangles, on no device yet> {RIGHT}"


@pytest.mark.parametrize("way", WAYS)
def test_errors_travel(way):
    """multiprocessing waits for ever for an exception that it cannot unpickle."""
    from gnomon.studies import StudyStoppedError

    for kind in (gnomon.OpenCLError, gnomon.Cancelled, gnomon.DeviceNotFoundError, StudyStoppedError):
        travelled = WAYS[way](kind("what happened"))
        assert type(travelled) is kind and str(travelled) == "what happened"


# ---- The interpreter's exit ------------------------------------------------------------------------------------------

EXITS = {
    "objects left alive": ("keep.append((scene, view)); answer(scene)", "", 0),
    "work in a thread": ("threading.Thread(target=lambda: scene.lit(many, direction=DOWN)).start()", "", 0),
    "work in a daemon": (
        "threading.Thread(target=lambda: scene.lit(many, direction=DOWN), daemon=True).start(); time.sleep(.2)", "", 0),
    "work for all time in a daemon": (
        "def go():\n    while True: scene.lit(many, direction=DOWN)\n"
        "threading.Thread(target=go, daemon=True).start(); time.sleep(.2)", "", 0),
    "many lights under way": (
        "t = gnomon.Lights.directions(numpy.random.default_rng(0).normal(size=(64, 3)))\n"
        "threading.Thread(target=lambda: scene.lit_by(many, t)).start()", "", 0),
    "a call at exit": ("import atexit; atexit.register(lambda: print(answer(scene)))", "[False, True, False]\n", 0),
    "an error": ("scene.lit('x', direction=DOWN)", "", 1),
    "sys.exit": ("answer(scene); sys.exit(3)", "", 3),
    "os._exit in a run": (
        "threading.Thread(target=lambda: scene.lit(many, direction=DOWN)).start(); time.sleep(.1); os._exit(4)", "", 4),
    "a cycle": ("scene.self = scene; answer(scene)", "", 0),
    "in a module": ("sys.modules['kept'] = scene; answer(scene)", "", 0),
    "a generator": ("def g():\n    yield answer(scene)\n    yield 1\nkeep.append(g()); next(keep[0])", "", 0),
}  # fmt: skip


@pytest.mark.parametrize("member", EXITS)
def test_the_interpreter_ends(member):
    code = (
        "import gnomon, numpy, os, sys, threading, time\nfrom processes import *\nkeep = []\n"
        "scene = gnomon.Scene(ROOF); view = scene.view((0, 0, 9), (0, 0, 0), up=(0, 1, 0), size=(8, 8))\n"
        "many = numpy.tile(POINTS, (300_000, 1))\n"
    )
    act, out, code_of_exit = EXITS[member]
    done = run(code + act)
    assert (done.returncode, done.stdout) == (code_of_exit, out), done.stderr
    assert ("Traceback" in done.stderr) == (member == "an error") and "nanobind" not in done.stderr, done.stderr


@pytest.mark.parametrize(("gpus", "cores", "of_each"), [(1, 1, 1), (1, 16, 4), (2, 12, 3), (2, 32, 4), (8, 4, 1)])
def test_a_gpu_has_several_processes_where_the_host_has_cores_for_them(gpus, cores, of_each, monkeypatch):
    runner = pytest.importorskip("gnomon.studies.runner")
    listed = [types.SimpleNamespace(selector=f"1:{i}", type="GPU") for i in range(gpus)]
    cpu = types.SimpleNamespace(selector="0:0", type="CPU")
    monkeypatch.setattr("gnomon._devices.devices", lambda: [cpu, *listed])
    monkeypatch.setattr(os, "cpu_count", lambda: cores)
    assert sorted(runner._devices_of("gpus", None)) == sorted(of_each * [d.selector for d in listed])
