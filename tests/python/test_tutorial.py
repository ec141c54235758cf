# SPDX-License-Identifier: MIT
"""Python in README.md and docs/python.md: each section is a program of its own, so that a copy of it runs. Its blocks run
one after the other. (docs/studies.md, viewshed.md: tests/python/study/test_outputs.py, test_viewshed_command.py.)"""

import re
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
BLOCK = re.compile(r"```python\n(.*?)```", re.DOTALL)


def sections(page):
    """The Python blocks of a page, by section."""
    found = {}
    for section in re.split(r"^## ", (ROOT / page).read_text(), flags=re.MULTILINE):
        if blocks := BLOCK.findall(section):
            found[f"{page}: {section.splitlines()[0]}"] = blocks
    return found


SECTIONS = sections("docs/python.md") | sections("README.md")


def test_all_pages_with_python_are_run():
    pages = [p for p in [*ROOT.glob("docs/*.md"), *ROOT.glob("*.md")] if "```python" in p.read_text()]
    assert sorted(p.name for p in pages) == ["README.md", "python.md", "studies.md", "viewshed.md"] and len(SECTIONS) == 5


@pytest.mark.parametrize("name", SECTIONS)
def test_a_section_runs(name, tmp_path, monkeypatch, capsys):
    if "on the device" in name:
        pytest.importorskip("pyopencl")
    monkeypatch.chdir(tmp_path)
    names = {"__name__": "tutorial"}
    for block in SECTIONS[name]:
        exec(compile(block, name, "exec"), names)
    if "A tutorial" in name:
        assert "of the ground is in the sun" in capsys.readouterr().out
        picture = np.asarray(pytest.importorskip("PIL.Image").open("street.png"))
        assert picture.shape == (360, 640, 4) and picture[..., :3].std() > 20
    elif "In short" in name:
        assert names["lit"].tolist() == [False, False, True]
    elif "From Python" in name:
        assert names["lit"].tolist() == [False, True]
