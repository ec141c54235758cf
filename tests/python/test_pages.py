# SPDX-License-Identifier: MIT
"""Every block of code in docs, README.md and CONTRIBUTING.md has something in CI that runs it."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SECTIONS, SHOWN = "tests/python/test_tutorial.py", "tests/build/build.cmake"
SHELL, PIP = "tests/build/pages.py", "tools/test_python.sh"
OUTPUTS, VIEWSHED = "tests/python/study/test_outputs.py", "tests/python/study/test_viewshed_command.py"

#: Of each page and language the number of blocks, and who runs them in CI: files that name the page.
RUN = {
    ("README.md", "sh"): (3, [SHELL, PIP]),
    ("README.md", "cpp"): (1, [SHOWN]),
    ("README.md", "python"): (1, [SECTIONS]),
    ("CONTRIBUTING.md", "sh"): (3, [SHELL]),
    ("CONTRIBUTING.md", ""): (2, [SHELL]),  # what the commands print
    ("docs/embedding.md", "c"): (1, [SHOWN]),
    ("docs/embedding.md", "rust"): (1, [SHOWN]),
    ("docs/ladybug.md", "python"): (1, [SECTIONS]),
    ("docs/many_lights.md", "cpp"): (1, [SHOWN]),
    ("docs/python.md", "python"): (11, [SECTIONS]),
    ("docs/python.md", "sh"): (1, [PIP]),
    ("docs/shares.md", "python"): (2, [SECTIONS]),
    ("docs/shares.md", "sh"): (1, [SECTIONS]),
    ("docs/studies.md", "python"): (4, [OUTPUTS]),
    ("docs/studies.md", "toml"): (1, [OUTPUTS]),
    ("docs/studies.md", "sh"): (1, [OUTPUTS]),
    ("docs/view.md", "sh"): (1, [SHELL]),
    ("docs/viewshed.md", "python"): (3, [VIEWSHED]),
    ("docs/viewshed.md", "sh"): (1, [VIEWSHED]),
    ("docs/weather.md", "python"): (1, [SECTIONS]),
}


def blocks():
    found: dict[tuple[str, str], int] = {}
    for page in [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")]:
        for language in re.findall(r"^ *(?:```|~~~)(.*)\n(?:.*\n)*? *(?:```|~~~)$", page.read_text(), re.MULTILINE):
            key = (str(page.relative_to(ROOT)), language)
            found[key] = found.get(key, 0) + 1
    return found


def test_every_block_is_run():
    assert blocks() == {key: count for key, (count, _) in RUN.items()}


@pytest.mark.parametrize("key", RUN, ids=" ".join)
def test_who_runs_a_block_names_its_page(key):
    for runner in RUN[key][1]:
        text = (ROOT / runner).read_text()
        assert key[0] in text or Path(key[0]).name in text, runner


def test_ci_runs_the_runners():
    """ctest has the files of tests/build, and pytest those of tests/python."""
    ci = (ROOT / "tools/test.sh").read_text()
    assert f"python3 {SHELL} build" in ci and PIP in ci and "run_tests build" in ci
