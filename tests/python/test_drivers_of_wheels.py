# SPDX-License-Identifier: MIT
"""The drivers that PyPI's wheels bring are found, without importing pyopencl and without a setting."""

import importlib.util
import os
import subprocess
import sys

import pytest


@pytest.mark.skipif(importlib.util.find_spec("pocl_binary_distribution") is None, reason="PyPI's PoCL is not installed")
@pytest.mark.parametrize("imports", ["gnomon", "pyopencl, gnomon", "gnomon, pyopencl"])
def test_pocl_of_the_wheel_is_found_and_right(imports):
    code = f"""
import {imports}
import numpy
assert ('pyopencl' in '{imports}') == ('pyopencl' in __import__('sys').modules)
found = [d for d in gnomon.devices() if d.driver_version.startswith("3.0")]
assert len(found) == 1, [d.driver_version for d in gnomon.devices()]
triangle = numpy.float32([[[-1, 1, -1], [-1, 1, 3], [3, 1, -1]]])
scene = gnomon.Scene(triangle, device=found[0].selector)
print(scene.lit(numpy.float32([[0, 0, 0], [5, 0, 0]]), direction=(0, -1, 0)).tolist())
"""
    variables = {k: v for k, v in os.environ.items() if k not in ("GNOMON_OPENCL_LIBRARY", "OCL_ICD_VENDORS")}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=variables, timeout=300)
    if "compiler is older than the CPU" in done.stderr:
        pytest.skip("the compiler of PyPI's PoCL does not know this CPU (docs/drivers.md)")
    assert done.stdout == "[False, True]\n", done.stderr


@pytest.mark.skipif(importlib.util.find_spec("pocl_binary_distribution") is None, reason="PyPI's PoCL is not installed")
def test_a_compiler_that_pocl_of_the_wheel_misses_is_named(tmp_path):
    def said(path):
        variables = {k: v for k, v in os.environ.items() if k not in ("GNOMON_OPENCL_LIBRARY", "OCL_ICD_VENDORS")}
        code = "import gnomon; gnomon.devices()"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=300,
                              env=variables | {"PATH": path})  # fmt: skip
        return done.stderr

    (tmp_path / "gcc").symlink_to("/bin/true")
    assert "install one (Debian and Ubuntu: gcc libc6-dev)" in said("/nowhere")
    assert "gcc libc6-dev" not in said(str(tmp_path))
