# SPDX-License-Identifier: MIT
"""Runs the shell blocks of README.md, CONTRIBUTING.md and docs/view.md, line by line, where a reader stands: in a
folder with the build and the sources. What a page says that a line prints must be printed. Lines of pip are left to
tools/test_python.sh, where the package is built. usage: pages.py [BUILD-FOLDER]"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import urllib.request
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGES = ["README.md", "CONTRIBUTING.md", "docs/view.md"]
FILES_OF_READERS = {"scene.glb": "lattice", "town.glb": "city --triangles 10000"}

#: What a line gets in addition: 34 techniques take half a minute of a processor, and a browser is not started.
ADDED = {" gallery ": " --size 96x54 --runs 1 --technique shadow-map", " view ": " --no-open"}
#: CTest says which tests it would run: all have been run when the pages' turn comes.
LISTS_TESTS = '#!/bin/bash\nexec {ctest} --show-only "$@"\n'
#: This program is a part of the one; the other has been run by it.
IN_PROGRESS = ("tools/test.sh --ci", "tools/run.sh")
#: What CONTRIBUTING.md tells its reader to change, and the law that is the first to fail.
LOOSENED = ("at_least, >, (LaneFloat)(0.0f)", "at_least, >, (LaneFloat)(-0.01f)")
FIRST_LAW = "Trace.EqualsReference"


class Failure(Exception):
    pass


def blocks(page):
    """The shell blocks of a page, and with each the block of output after it, if there is one before the next."""
    found = []
    for language, text in re.findall(r"^```(\w*)\n(.*?)^```$", (ROOT / page).read_text(), re.DOTALL | re.MULTILINE):
        if language == "sh":
            found.append([text, ""])
        elif language == "" and found and not found[-1][1]:
            found[-1][1] = text
    return found


def normal(text):
    """Without the line breaks of a page, and with what it leaves out as a gap."""
    return " ".join(text.split())


def require_shown(shown, said, page):
    """Each line that the page shows stands in what was said, an ellipsis for anything; wrapped lines are one."""
    said = normal(said)
    for part in shown.split("\n\n"):
        for piece in normal(part).split(" ... "):
            if normal(piece.removesuffix("...")) not in said:
                raise Failure(f"{page} shows\n{piece}\nwhich is not in\n{said}")


def shell(lines, folder, environment, page, statuses=(0,)):
    done = subprocess.run(["bash", "-c", lines], cwd=folder, env=environment, text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, timeout=600)  # fmt: skip
    if done.returncode not in statuses:
        raise Failure(f"{page}: {lines}\nended with {done.returncode}:\n{done.stdout}")
    return done.stdout


def serve(line, folder, environment, page):
    """A server runs until its page has been answered."""
    with subprocess.Popen(line.split(), cwd=folder, env=environment, text=True, stdout=subprocess.PIPE) as server:
        try:
            address = server.stdout.readline().strip()
            began, answer = time.monotonic(), b""
            while b"<html" not in answer:
                if time.monotonic() > began + 60 or server.poll() is not None:
                    raise Failure(f"{page}: {line}: no page at {address!r}")
                answer = urllib.request.urlopen(address, timeout=60).read()
        finally:
            server.terminate()


def run_line(line, folder, environment, page):
    command = line.split("#")[0].strip()
    if not command or command.startswith("pip ") or command.removeprefix("./") in IN_PROGRESS:
        return
    command += "".join(more for word, more in ADDED.items() if word in command)
    if " view " in command:
        return serve(command, folder, environment, page)
    if re.match(r"(\./)?tools/", command):  # they build and test the tree that they lie in
        return shell(command, ROOT, environment, page)
    before = set(folder.iterdir())
    shell(command, folder, environment, page)
    written = re.search(r" -o (\S+)", command)
    if written and folder / written[1] not in set(folder.iterdir()) - before:
        raise Failure(f"{page}: {command}\nwrote no {written[1]}")


def try_change(folder, environment, blocks_of_page):
    """CONTRIBUTING.md's change to a kernel: the law that fails, and the picture that shows it."""
    shutil.copytree(ROOT / "kernels", folder / "kernels")
    kernel = folder / "kernels/trace/filter.clh"
    text = kernel.read_text()
    if text.count(LOOSENED[0]) != 1:
        raise Failure(f"{kernel.name} has no line {LOOSENED[0]}, which CONTRIBUTING.md tells to change")
    kernel.write_text(text.replace(*LOOSENED))
    environment = {**environment, "GNOMON_KERNELS_DIR": str(kernel.parents[1]), "GTEST_FILTER": FIRST_LAW}
    for text, shown in blocks_of_page:
        require_shown(shown, shell(text, folder, environment, "CONTRIBUTING.md", (0, 1)), "CONTRIBUTING.md")


def main():
    build = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build").resolve()
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        for name, place in {"build": build, "scenes": ROOT / "scenes"}.items():
            (folder / name).symlink_to(place)
        programs = folder / "programs"
        programs.mkdir()
        (programs / "ctest").write_text(LISTS_TESTS.format(ctest=shutil.which("ctest")))
        (programs / "ctest").chmod(0o755)
        (programs / "gnomon").symlink_to(build / "gnomon")
        environment = {**os.environ, "PATH": f"{programs}:{os.environ['PATH']}"}
        environment.setdefault("GNOMON_CACHE_DIR", str(build / "test_kernel_cache"))
        for name, made in FILES_OF_READERS.items():
            shell(f"build/tools/make_scenes {made} -o {name}", folder, environment, "make_scenes")
        for page in PAGES:
            began = time.monotonic()
            of_page = blocks(page)
            plain = [text for text, shown in of_page if not shown]
            for line in "".join(plain).splitlines():
                run_line(line, folder, environment, page)
            if changed := [block for block in of_page if block[1]]:
                try_change(folder, environment, changed)
            print(f"{page}: {len(of_page)} blocks ({time.monotonic() - began:.0f} s)")


if __name__ == "__main__":
    try:
        main()
    except Failure as failure:
        sys.exit(str(failure))
