# SPDX-License-Identifier: MIT
"""Every block of code in docs, README.md and CONTRIBUTING.md has something in CI that runs it, or a reason why none
can."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TESTS = ROOT / "tests"
SECTIONS, SHOWN = "python/test_tutorial.py", "build/build.cmake"

#: Of each page and language the number of blocks, and who runs them: files of tests that name the page.
RUN = {
    ("README.md", "cpp"): (1, SHOWN),
    ("README.md", "python"): (1, SECTIONS),
    ("docs/embedding.md", "c"): (1, SHOWN),
    ("docs/integrations.md", "python"): (3, SECTIONS),
    ("docs/many_lights.md", "cpp"): (1, SHOWN),
    ("docs/python.md", "python"): (10, SECTIONS),
    ("docs/studies.md", "python"): (4, "python/study/test_outputs.py"),
    ("docs/studies.md", "toml"): (1, "python/study/test_outputs.py"),
    ("docs/studies.md", "sh"): (1, "python/study/test_outputs.py"),
    ("docs/viewshed.md", "python"): (3, "python/study/test_viewshed_command.py"),
    ("docs/viewshed.md", "sh"): (1, "python/study/test_viewshed_command.py"),
}
#: What runs elsewhere: the place, and a word of it. (README's lines of build/gnomon name a reader's scene:
#: tests/command tries their options.)
ELSEWHERE = {
    ("README.md", "sh"): (3, ".ci/run", "test.sh"),
    ("CONTRIBUTING.md", "sh"): (3, ".ci/run", "test.sh"),
    ("docs/python.md", "sh"): (1, "tools/test_python.sh", "pip"),
    ("docs/view.md", "sh"): (1, "tools/test_view.sh", "view"),
}
#: What CI has no packages for, as the page says.
NOT_RUN = {("docs/embedding.md", "julia"): 1, ("docs/embedding.md", "rust"): 1, ("docs/embedding.md", "cpp"): 1}


def blocks():
    found: dict[tuple[str, str], int] = {}
    for page in [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")]:
        for language in re.findall(r"^```(\w+)$", page.read_text(), re.MULTILINE):
            key = (str(page.relative_to(ROOT)), language)
            found[key] = found.get(key, 0) + 1
    return found


def test_every_block_is_accounted_for():
    known = {key: row[0] for key, row in (RUN | ELSEWHERE).items()} | NOT_RUN
    assert blocks() == known


@pytest.mark.parametrize("key", RUN, ids=" ".join)
def test_who_runs_a_block_names_its_page(key):
    text = (TESTS / RUN[key][1]).read_text()
    assert key[0] in text or Path(key[0]).name in text


@pytest.mark.parametrize("key", ELSEWHERE, ids=" ".join)
def test_what_runs_elsewhere_is_there(key):
    _, place, word = ELSEWHERE[key]
    assert word in (ROOT / place).read_text()
