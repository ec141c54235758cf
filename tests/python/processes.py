# SPDX-License-Identifier: MIT
"""What the tests of processes share, on both sides of a fork: a roof, three points, their answer, and the programs."""

import os
import subprocess
import sys
import textwrap

import numpy as np

ROOF = np.array([[[-1, -1, 2], [1, -1, 2], [1, 1, 2]], [[-1, -1, 2], [1, 1, 2], [-1, 1, 2]]], float)
POINTS = np.array([[0, 0, 0], [5, 0, 0], [1, 0, 0]], float)
DOWN = (0, 0, -1)
#: By inspection: under the roof, beside it, under its edge, which blocks.
RIGHT = [False, True, False]


def answer(scene=None):
    """The roof's answer, in a process of any kind. It makes the scene, unless it is given one."""
    import gnomon

    return (scene or gnomon.Scene(ROOF)).lit(POINTS, direction=DOWN).tolist()


def run(code, folder=None, timeout=90, **environment):
    """Runs a program, which may import this module; None takes a variable away. Its processes end with the
    time limit."""
    here = os.path.dirname(__file__)
    env = {**os.environ, "PYTHONPATH": here + os.pathsep + os.environ.get("PYTHONPATH", ""), **environment}
    env = {name: value for name, value in env.items() if value is not None}
    script = folder / "script.py" if folder is not None else None
    if script is not None:
        script.write_text(textwrap.dedent(code))
    command = [sys.executable, str(script)] if script is not None else [sys.executable, "-c", textwrap.dedent(code)]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=env, cwd=folder, start_new_session=True
    )
    try:
        out, err = process.communicate(timeout=timeout)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, 9)
        out, err = process.communicate()
        raise AssertionError(f"it hangs: {out}\n{err}") from None
    return subprocess.CompletedProcess(command, process.returncode, out, err)
