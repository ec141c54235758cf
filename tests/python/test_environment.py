# SPDX-License-Identifier: MIT
"""Environments: folders that are not there or cannot be written, and drivers that are there and do not start. gnomon
answers where it can; elsewhere one sentence names the folder or the variable."""

import os

import pytest
from processes import RIGHT, run

ANSWER = "from processes import *; print(answer())"
SAID = """
import gnomon
from processes import *
try: print(answer())
except gnomon.DeviceNotFoundError as error: print(error)
"""
#: No user, and no superuser either, makes a folder there.
NEVER = "/proc/none"

UNWRITABLE = {
    "POCL_CACHE_DIR": {"POCL_CACHE_DIR": NEVER},
    "POCL_CACHE_DIR is empty": {"POCL_CACHE_DIR": ""},
    "POCL_CACHE_DIR is a file": {"POCL_CACHE_DIR": "/etc/hostname"},
    "POCL_CACHE_DIR is below a file": {"POCL_CACHE_DIR": "/etc/hostname/kernels"},
    "HOME": {"HOME": NEVER, "XDG_CACHE_HOME": ""},
    "HOME is missing": {"HOME": "", "XDG_CACHE_HOME": ""},
    "HOME is a file": {"HOME": "/etc/hostname", "XDG_CACHE_HOME": ""},
    "XDG_CACHE_HOME": {"XDG_CACHE_HOME": NEVER},
    "GNOMON_CACHE_DIR": {"GNOMON_CACHE_DIR": NEVER},
    "GNOMON_CACHE_DIR is a file": {"GNOMON_CACHE_DIR": "/etc/hostname"},
    "TMPDIR": {"TMPDIR": NEVER},
    "TMPDIR and HOME": {"TMPDIR": NEVER, "HOME": NEVER, "XDG_CACHE_HOME": ""},
    "devices": {"HOME": "/dev/null", "XDG_CACHE_HOME": "/dev/null", "GNOMON_CACHE_DIR": "/dev/full"},
    "all of them": {"TMPDIR": NEVER, "HOME": NEVER, "XDG_CACHE_HOME": NEVER, "GNOMON_CACHE_DIR": NEVER},
}


def is_pocl():
    import gnomon

    return "Portable Computing" in gnomon.use().description.platform


@pytest.mark.parametrize("member", UNWRITABLE)
def test_it_runs_without_a_cache(member):
    environment = {"POCL_CACHE_DIR": None, **UNWRITABLE[member]}
    done = run(ANSWER, **environment)
    assert (done.returncode, done.stdout) == (0, f"{RIGHT}\n"), done.stderr


def test_a_folder_that_can_be_written_stays_the_one(tmp_path):
    if not is_pocl():
        pytest.skip("only PoCL keeps kernels in this folder")
    done = run(ANSWER + "; import os; print(os.environ['POCL_CACHE_DIR'])", POCL_CACHE_DIR=str(tmp_path / "a" / "b"))
    assert done.stdout == f"{RIGHT}\n{tmp_path}/a/b\n" and list((tmp_path / "a" / "b").iterdir())


def test_a_full_disk_is_named(tmp_path):
    """Every file is full at a kilobyte, as this process sees it."""
    if not is_pocl():
        pytest.skip("only PoCL's compiler is known to say nothing then")
    code = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (1024, 1024))\n" + SAID
    folders = {"POCL_CACHE_DIR": str(tmp_path / "p"), "GNOMON_CACHE_DIR": str(tmp_path / "g")}
    said = run(code.replace("gnomon.DeviceNotFoundError", "gnomon.OpenCLError"), **folders).stdout
    assert "compiling kernels/" in said and "a full disk is one: POCL_CACHE_DIR" in said


@pytest.mark.skipif(os.geteuid() != 0, reason="only the superuser becomes another user")
def test_another_user_runs():
    """Whose HOME is the superuser's, as after sudo and in containers. It may read what this test reads, or skips."""
    code = "import os; os.setgid(65534); os.setuid(65534); " + ANSWER
    probe = "import os; os.setuid(65534); import gnomon, numpy"
    if run(probe).returncode != 0:
        pytest.skip("another user cannot read this Python's packages")
    done = run(code, HOME="/root", XDG_CACHE_HOME="", POCL_CACHE_DIR=None)
    assert (done.returncode, done.stdout) == (0, f"{RIGHT}\n"), done.stderr


def test_without_any_folder_the_sentence_names_it():
    """The temporary folder of another user is not taken."""
    if not is_pocl() or os.geteuid() != 0:
        pytest.skip("needs PoCL, and the superuser to hide /tmp")
    code = "import ctypes, os; libc = ctypes.CDLL(None); print(libc.unshare(0x20000), end=' '); "
    mounts = "[libc.mount(b'none', d, b'tmpfs', 1, b'') for d in (b'/tmp', b'/dev/shm')]\n"
    done = run(code + mounts + SAID, POCL_CACHE_DIR=NEVER, TMPDIR="")
    if done.stdout.startswith("-1"):
        pytest.skip("no namespaces here")
    assert f"{NEVER} (by POCL_CACHE_DIR)" in done.stdout and "name a folder in POCL_CACHE_DIR" in done.stdout
    assert done.stdout.count("\n") == 1


SYSTEM = {"GNOMON_OPENCL_LIBRARY": "libOpenCL.so.1", "OCL_ICD_FILENAMES": None}


def drivers(tmp_path, library):
    (tmp_path / "one.icd").write_text(library + "\n")
    return {"OCL_ICD_VENDORS": str(tmp_path), **SYSTEM}


@pytest.fixture(scope="module")
def system_library():
    if "True" not in run("import ctypes; ctypes.CDLL('libOpenCL.so.1'); print(True)").stdout:
        pytest.skip("the system has no OpenCL library")


def test_a_driver_that_cannot_be_loaded_is_named(system_library, tmp_path):
    done = run(SAID, **drivers(tmp_path, "libnot-there.so.7"))
    assert f"{tmp_path}/one.icd names libnot-there.so.7, which cannot be loaded" in done.stdout, done.stderr
    assert done.stdout.count("\n") == 1 and "OCL_ICD_VENDORS is set" in done.stdout


def test_a_library_that_is_no_driver_is_named(system_library, tmp_path):
    done = run(SAID, **drivers(tmp_path, "libm.so.6"))
    assert "one.icd names libm.so.6, which starts and has no device" in done.stdout, done.stderr


def test_no_driver_at_all(system_library, tmp_path):
    done = run(SAID, OCL_ICD_VENDORS=str(tmp_path), **SYSTEM)
    assert f"no driver in {tmp_path} (OCL_ICD_VENDORS): install one" in done.stdout, done.stderr


def test_a_variable_that_hides_devices_is_named(system_library):
    if not is_pocl():
        pytest.skip("a variable of PoCL's")
    done = run(SAID, POCL_DEVICES="nonsense", **SYSTEM)
    assert 'POCL_DEVICES is set to "nonsense"' in done.stdout and "has no device" in done.stdout, done.stderr


def test_a_device_that_is_not_there_is_named():
    done = run(SAID, GNOMON_DEVICE="abacus")
    assert 'no OpenCL device matches "abacus" (GNOMON_DEVICE)' in done.stdout


def test_a_file_that_is_no_opencl_library():
    done = run(SAID, GNOMON_OPENCL_LIBRARY="libm.so.6")
    assert "libm.so.6 is no OpenCL 1.2 library" in done.stdout and "GNOMON_OPENCL_LIBRARY" in done.stdout


@pytest.mark.parametrize("member", ["HOME", "all of them", "TMPDIR"])
def test_studies_run_there(member, tmp_path):
    pytest.importorskip("rasterio")
    code = """
    import sys; sys.path[:0] = [{!r}]
    from made import *
    from gnomon import studies
    write_raster("d.tif", city(24)); write_suns("s.csv", [(180, 40)])
    print(studies.study("study", raster="d.tif", directions="s.csv", outputs=["bits"]).record["tasks_done"])
    """.format(os.path.join(os.path.dirname(__file__), "study"))
    done = run(code, tmp_path, **{"POCL_CACHE_DIR": None, **UNWRITABLE[member]})
    assert (done.returncode, done.stdout.strip()) == (0, "1"), done.stderr
