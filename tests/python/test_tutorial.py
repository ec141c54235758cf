# SPDX-License-Identifier: MIT
"""Python in README.md and docs/python.md: each section is a program of its own, so that a copy of it runs. Its blocks
run one after the other, as do those of docs/ladybug.md, weather.md and shares.md. (docs/studies.md, viewshed.md:
tests/python/study/test_outputs.py, test_viewshed_command.py.)"""

import importlib
import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
BLOCK = re.compile(r"```python\n(.*?)```", re.DOTALL)


def blocks_of(page):
    return BLOCK.findall((ROOT / page).read_text())


def sections(page):
    """The Python blocks of a page, by section."""
    found = {}
    for section in re.split(r"^## ", (ROOT / page).read_text(), flags=re.MULTILINE):
        if blocks := BLOCK.findall(section):
            found[f"{page}: {section.splitlines()[0]}"] = blocks
    return found


WHOLE = [f"docs/{name}.md" for name in ("ladybug", "weather", "shares")]
SECTIONS = sections("docs/python.md") | sections("README.md") | {page: blocks_of(page) for page in WHOLE}
#: The packages that a section needs beside numpy.
NEEDED = {
    "on the device": ["pyopencl"],
    "ladybug.md": ["ladybug_radiance"],
    "weather.md": ["pyradiance", "pvlib", "pyvista", "matplotlib"],
    "shares.md": ["mapbox_earcut", "matplotlib", "pvlib"],
}


def test_all_pages_with_python_are_run():
    pages = [p for p in [*ROOT.glob("docs/*.md"), *ROOT.glob("*.md")] if "```python" in p.read_text()]
    of_docs = ["ladybug", "python", "shares", "studies", "viewshed", "weather"]
    assert sorted(p.name for p in pages) == ["README.md", *(f"{name}.md" for name in of_docs)]
    assert len(SECTIONS) == 9


def run_the_commands_of_shares(folder):
    """In the folder of the page's blocks."""
    from gnomon.studies.command import main

    greensboro = Path(importlib.import_module("pvlib").__file__).parent / "data" / "723170TYA.CSV"
    shutil.copy(greensboro, folder / "greensboro.csv")
    (commands,) = re.findall(r"```sh\n(.*?)```", (ROOT / "docs/shares.md").read_text(), re.DOTALL)
    for line in commands.splitlines():
        program, *words = shlex.split(line, comments=True)
        assert program == "gnomon-study" and main(words) == 0
    assert (
        (folder / "shares.csv").read_text().startswith("time,panel low,panel high,panel x,panel y,panel z\n2026-06-21T")
    )
    assert len((folder / "sunlit.csv").read_text().splitlines()) == 8761
    noon, later = (folder / "shaded.csv").read_text().splitlines()[1:]
    assert noon.startswith("12:00,0.33") and noon.endswith(",0") and later.startswith("13:00,0.3")


@pytest.mark.parametrize("name", SECTIONS)
def test_a_section_runs(name, tmp_path, monkeypatch, capsys):
    for section, needed in NEEDED.items():
        if section in name:
            for package in needed:
                pytest.importorskip(package)
    if "ladybug.md" in name:
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
    elif "ladybug.md" in name:
        hours = np.reshape(names["hours"], (64, 64))  # eastwards, northwards; a column is a quarter of a metre wide
        assert len(names["suns"]) == 13 and (hours[:, :32] == 13).all()  # in the south nothing is before the sun
        # At the wall's foot only suns along it: over the sill, 2 m up, one would have to stand at 86 degrees.
        assert hours[12:52, 32].max() <= 6
    elif "weather.md" in name:
        assert np.asarray(pytest.importorskip("PIL.Image").open("energy.png"))[..., :3].std() > 20
        assert 900 < np.nanmin(names["energy"].total) < 1600 < np.nanmax(names["energy"].total) < 1800
    elif "shares.md" in name:
        head = "time,panel low,panel high,panel x,panel y,panel z"
        assert (tmp_path / "shares.csv").read_text().startswith(head + "\n12:00,0.66")
        run_the_commands_of_shares(tmp_path)
    elif "In short" in name:
        assert names["lit"].tolist() == [False, False, True]
    elif "From Python" in name:
        assert names["lit"].tolist() == [False, True]
