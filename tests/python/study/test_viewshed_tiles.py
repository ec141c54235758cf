# SPDX-License-Identifier: MIT
"""Viewsheds by tiles: the same bits whatever divides the work, across a kill, and the certificate."""

import json
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import rasterio
import sight_oracle
from gnomon import _gnomon, studies
from gnomon.studies import tasks as of_tasks
from gnomon.studies.command import main
from gnomon.studies.exact_lines import is_seen
from gnomon.studies.runner import Execution, executor_of, run_plan
from gnomon.studies.viewshed import write_viewshed
from gnomon.studies.viewshed_plan import ViewshedSettings, viewshed_plan
from made import chunk_files, city, write_raster

RNG = np.random.default_rng(44)
PLACES = [(float(512_012.5 + 25 * c), float(5_002_387.5 - 25 * r), float(h)) for c, r, h in zip(
    RNG.uniform(0, 17, 70), RNG.uniform(0, 19, 70), RNG.uniform(1, 90, 70), strict=True)]  # fmt: skip


@pytest.fixture(scope="module")
def raster(tmp_path_factory):
    return write_raster(tmp_path_factory.mktemp("dem") / "dem.tif", city(40))


@pytest.fixture(scope="module")
def asked(raster):
    """70 observers, what stands in the hole unknown, a distance that leaves some tiles out of reach of some."""
    return dict(raster=(raster,), observers=tuple(PLACES), outside=60.0, distance=420.0, target_height=1.5,
                outputs=("bits", "counts"))  # fmt: skip


def run(folder, settings, execution=None):
    execution = execution or Execution()
    plan = viewshed_plan(folder, settings)
    with executor_of(execution) as executor:
        run_plan(plan, execution, executor)
    return studies.open_study(folder)


@pytest.fixture(scope="module")
def whole(asked, tmp_path_factory):
    return run(tmp_path_factory.mktemp("viewshed") / "whole", ViewshedSettings(**asked))


def test_the_whole_is_what_viewshed_answers(whole):
    import gnomon

    x, y = 512_012.5 + 25.0 * np.arange(40), 5_002_387.5 - 25.0 * np.arange(40)
    places, heights = np.array(PLACES)[:, :2], np.array(PLACES)[:, 2]
    found = gnomon.viewshed(city(40), places, x=x, y=y, height=heights, target_height=1.5, distance=420, outside=60,
                            bits=True)  # fmt: skip
    data = whole.dataset()
    assert (data.seen.values == found.bits).all() and (data.undecided.values == found.undecided_bits).all()
    counts, open_counts = data.counts.values.astype(np.int64), data.undecided_counts.values.astype(np.int64)
    absent = 2**32 - 1
    assert (counts == np.where(found.is_absent, absent, found.counts)).all() and found.counts.max() > 5
    assert (open_counts == np.where(found.is_absent, absent, found.undecided)).all() and found.undecided.any()
    record = whole.record
    assert record["decisions"] == (~found.is_absent).sum() * 70 and record["undecided"] == found.undecided.sum()
    assert record["tasks_done"] == record["tasks"] == 1 and record["refraction"] == pytest.approx(1 / 7)
    assert {"step", "observers_moved_by_cells", "chunks", "versions"} <= set(record)


@pytest.mark.parametrize(
    ("tile", "block", "workers"), [(1, 128, None), (7, 32, None), (16, 64, None), (39, 96, None), (13, 32, 2)]
)
def test_the_same_bits_for_any_tiles_blocks_and_workers(asked, whole, tmp_path, tile, block, workers):
    again = run(tmp_path / "x", ViewshedSettings(**asked, tile=tile, block=block), Execution(workers=workers))
    assert again.record["tasks"] == -(-40 // tile) * -(-70 // block) == again.record["tasks_done"]
    assert again.digests() == whole.digests()


def test_the_same_bits_in_another_order(asked, whole, tmp_path):
    settings = ViewshedSettings(**asked, tile=7, block=32)
    for tiles in (slice(4, None), slice(2, 4), slice(None, 2)):
        part = run(tmp_path / "parts", settings, Execution(tiles=tiles))
    assert part.digests() == whole.digests()


def test_a_killed_run_goes_on(asked, raster, whole, tmp_path):
    """kill -9 between two tasks: the same command goes on, repeats no task, and ends with the same bits."""
    table = tmp_path / "guards.csv"
    table.write_text("x,y,height\n" + "".join(f"{x!r},{y!r},{h!r}\n" for x, y, h in PLACES))
    words = [raster, table, tmp_path / "counts.tif", "--outside", 60, "--distance", 420, "--target-height", 1.5,
             "--bits", "--tile", 2, "--block", 32, "--quiet"]  # fmt: skip
    slow = ("import time; from gnomon.studies import tasks; now = tasks.computed\n"
            "tasks.computed = lambda *a: (time.sleep(0.1), now(*a))[1]\n"
            "from gnomon._study import main; raise SystemExit(main())")  # fmt: skip
    process = subprocess.Popen([sys.executable, "-c", slow, "viewshed", *map(str, words)])
    folder = tmp_path / ".counts.tif.study"
    for _ in range(1200):
        before = {p: p.stat().st_mtime_ns for p in folder.glob("tasks/*.json")}
        if len(before) >= 4:
            break
        assert process.poll() is None, "it ended before it was killed"
        time.sleep(0.05)
    process.send_signal(signal.SIGKILL)
    process.wait()
    before = {p: p.stat().st_mtime_ns for p in folder.glob("tasks/[0-9]*-[0-9]*.json")}
    assert 4 <= len(before) < 60 and not (tmp_path / "counts.tif").exists()
    kept = tmp_path / "kept"
    shutil.copytree(folder, kept)
    assert main(["viewshed", *map(str, words), "--folder", str(kept)]) == 0
    again = {p.name: p.stat().st_mtime_ns for p in kept.glob("tasks/[0-9]*-[0-9]*.json")}
    assert len(again) == 60 and all(again[p.name] == time for p, time in before.items())
    assert studies.open_study(kept).digests() == whole.digests()
    first = (tmp_path / "counts.tif").read_bytes()
    assert main(["viewshed", *map(str, words)]) == 0 and not folder.exists()
    assert (tmp_path / "counts.tif").read_bytes() == first
    with rasterio.open(tmp_path / "counts.tif") as file:
        assert (file.read(1) == whole.dataset().counts.values).all()


def test_verify_recomputes_and_follows_lines(asked, whole, tmp_path, capsys):
    folder = tmp_path / "study"
    run(folder, ViewshedSettings(**asked, tile=9, block=32))
    assert main(["verify", str(folder), "--share", "1", "--lines", "60", "--seed", "3"]) == 0
    assert "15 tasks recomputed" in (said := capsys.readouterr().out) and "60 lines of sight in rational" in said
    # Bits that were wrong from the first, with the hashes of the wrong: only the lines can tell.
    plan = of_tasks.plan_in(folder)
    facts = json.loads(plan.store.done_path(0, 0).read_text())
    seen = plan.store.array("results.zarr/seen")
    wrong = ~np.asarray(seen[0, :9])
    facts["chunks"]["results.zarr/seen/c/0/0/0"] = plan.store.write(
        "results.zarr/seen", (0, slice(0, 9), slice(0, 40)), wrong, (0, 0, 0)
    )
    plan.store.mark_done(0, 0, facts)
    found = studies.verify(folder, share=0, seed=3, lines=60)
    assert found.wrong_lines and not found.damaged and not found.is_good
    assert main(["verify", str(folder), "--share", "0", "--lines", "60", "--seed", "3"]) == 1
    assert "differs: observer" in capsys.readouterr().out
    seen[1, :9] = 7
    assert studies.verify(folder, share=0).damaged == ["results.zarr/seen/c/1/0/0"]


@pytest.mark.parametrize("what", ["heights", "counts"])
def test_verify_of_other_outputs(raster, tmp_path, what):
    settings = ViewshedSettings((raster,), tuple(PLACES[:1]), outputs=(what,), tile=11)
    study = run(tmp_path / what, settings)
    found = study.verify(share=1, seed=1)
    assert found.is_good and found.tasks == 4 and found.lines == 20
    if what == "heights":
        least = study.plan.store.array("results.zarr/least_heights")
        least[0, :] = least[0, :] + 2.0**-10
        wrong = studies.verify(study.folder, share=0, seed=1)
        assert wrong.wrong_lines and wrong.damaged


def test_lines_in_rational_arithmetic_are_the_definition():
    """exact_lines.is_seen() against sight_oracle.seen(), which clips each line by each triangle, edge and vertex."""
    rng = np.random.default_rng(8)
    steps = rng.integers(-3, 4, (6, 7)) * 300
    steps[2, 3] = steps[4, 5] = _gnomon.NO_HEIGHT
    rows = [[None if v == _gnomon.NO_HEIGHT else int(v) for v in row] for row in steps]
    from fractions import Fraction

    seen = 0
    for x, y, top in ((768, 1024, 901), (0, 0, 1300), (1000, 333, 1000), (256 * 6, 130, 950)):
        for above in (0, 250):
            expected = sight_oracle.seen(rows, (Fraction(x, 256), Fraction(y, 256), top), above)
            for cell, answer in expected.items():
                if (256 * cell[1], 256 * cell[0]) != (x, y):
                    assert is_seen(steps, _gnomon.NO_HEIGHT, (x, y, top, above), cell) == answer, (x, y, above, cell)
                    seen += answer
    assert 50 < seen < 280
    ridge = np.zeros((3, 7), int)
    ridge[:, 3] = 100
    answers = [is_seen(ridge, _gnomon.NO_HEIGHT, (0, 256, 200, above), (1, 6)) for above in (0, 1)]
    assert answers == [False, True], "a line that touches the ground is not seen"


def test_a_folder_of_another_viewshed_or_study_is_refused(asked, raster, tmp_path, capsys):
    folder = tmp_path / "f"
    words = ["viewshed", raster, "512400,5002010", str(tmp_path / "a.tif"), "--quiet", "--folder", str(folder)]
    assert main(words) == 0 and main([*words, "--height", "9"]) == 1
    assert "holds a study with other settings" in capsys.readouterr().err
    assert main([*words, "--height", "9", "--restart"]) == 0
    with pytest.raises(ValueError, match="holds a viewshed"):
        studies.study(folder, raster=raster, start="2026-06-21", end="2026-06-22")
    with pytest.raises(ValueError, match="has no picture"):
        studies.open_study(folder).picture(tmp_path / "p.png")
    assert main(["export", str(folder), str(tmp_path / "b.tif")]) == 0
    assert (tmp_path / "b.tif").read_bytes() == (tmp_path / "a.tif").read_bytes()
    copy = tmp_path / "copy.tif"
    shutil.copy(raster, copy)
    settings = ViewshedSettings((str(copy),), tuple(PLACES[:1]))
    write_viewshed(tmp_path / "c.tif", settings, tmp_path / "g")
    write_raster(copy, city(40) + 1)
    with pytest.raises(ValueError, match="a raster or mesh has changed"):
        write_viewshed(tmp_path / "c.tif", settings, tmp_path / "g")


def test_chunks_are_the_same_files(asked, tmp_path):
    settings = ViewshedSettings(**asked, tile=16, block=64)
    one, two = (run(tmp_path / name, settings) for name in ("one", "two"))
    assert chunk_files(one.folder) == chunk_files(two.folder)


@pytest.mark.parametrize(
    ("words", "text"),
    [(["--tile", "0"], "tile: 0 rows"), (["--block", "33"], "block: 33 observers: must be a multiple of 32")],
)
def test_wrong_divisions_are_named(raster, tmp_path, capsys, words, text):
    assert main(["viewshed", raster, "512400,5002010", str(tmp_path / "x.tif"), *words]) == 1
    assert text in capsys.readouterr().err and list(tmp_path.iterdir()) == []
