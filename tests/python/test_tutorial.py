# SPDX-License-Identifier: MIT
"""docs/python.md: its blocks run one after the other, and its picture is one."""

import re
from pathlib import Path

import numpy as np
import pytest

PAGE = Path(__file__).parents[2] / "docs" / "python.md"


def test_the_tutorial_runs(tmp_path, monkeypatch, capsys):
    image = pytest.importorskip("PIL.Image")
    pytest.importorskip("pyopencl")
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
    assert len(blocks) >= 6
    names = {"__name__": "tutorial"}
    for block in blocks:
        exec(compile(block, str(PAGE), "exec"), names)
    assert "of the ground is in the sun" in capsys.readouterr().out
    picture = np.asarray(image.open("street.png"))
    assert picture.shape == (360, 640, 4) and picture[..., :3].std() > 20
