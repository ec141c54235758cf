# SPDX-License-Identifier: MIT
"""Python in README.md, docs/python.md and docs/integrations.md: each section is a program of its own, so that a copy of
it runs. Its blocks run one after the other. (docs/studies.md, viewshed.md: tests/python/study/test_outputs.py,
test_viewshed_command.py.)"""

import importlib
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


SECTIONS = sections("docs/python.md") | sections("docs/integrations.md") | sections("README.md")
#: The packages that a section needs beside numpy.
NEEDED = {
    "on the device": ["pyopencl"],
    "Ladybug's studies": ["ladybug_radiance"],
    "Weather files": ["pyradiance", "pvlib", "pyvista", "matplotlib"],
    "Lit shares": ["mapbox_earcut"],
}


def test_all_pages_with_python_are_run():
    pages = [p for p in [*ROOT.glob("docs/*.md"), *ROOT.glob("*.md")] if "```python" in p.read_text()]
    assert sorted(p.name for p in pages) == ["README.md", "integrations.md", "python.md", "studies.md", "viewshed.md"]
    assert len(SECTIONS) == 8


@pytest.mark.parametrize("name", SECTIONS)
def test_a_section_runs(name, tmp_path, monkeypatch, capsys):
    for section, needed in NEEDED.items():
        if section in name:
            for package in needed:
                pytest.importorskip(package)
    if "Ladybug's studies" in name:
        for module in ("ladybug_radiance.intersection", "ladybug_radiance.study.directsun"):  # it replaces theirs
            module = importlib.import_module(module)
            monkeypatch.setattr(module, "intersection_matrix", module.intersection_matrix)
    monkeypatch.chdir(tmp_path)
    names = {"__name__": "tutorial"}
    for block in SECTIONS[name]:
        exec(compile(block, name, "exec"), names)
    if "A tutorial" in name:
        assert "of the ground is in the sun" in capsys.readouterr().out
        picture = np.asarray(pytest.importorskip("PIL.Image").open("street.png"))
        assert picture.shape == (360, 640, 4) and picture[..., :3].std() > 20
    elif "Ladybug's studies" in name:
        hours = np.reshape(names["hours"], (64, 64))  # eastwards, northwards; a column is a quarter of a metre wide
        assert len(names["suns"]) == 13 and (hours[:, :32] == 13).all()  # in the south nothing is before the sun
        # At the wall's foot only suns along it: over the sill, 2 m up, one would have to stand at 86 degrees.
        assert hours[12:52, 32].max() <= 6
    elif "Weather files" in name:
        assert np.asarray(pytest.importorskip("PIL.Image").open("energy.png"))[..., :3].std() > 20
        assert 900 < np.nanmin(names["energy"].total) < 1600 < np.nanmax(names["energy"].total) < 1800
    elif "Lit shares" in name:
        assert (tmp_path / "shares.csv").read_text().startswith("time,panel low,panel high\n12:00,0.66")
    elif "In short" in name:
        assert names["lit"].tolist() == [False, False, True]
    elif "From Python" in name:
        assert names["lit"].tolist() == [False, True]
