# SPDX-License-Identifier: MIT
"""Faults: a dead worker, a dead client, a full disk, a damaged chunk, a tile that cannot be read. The study goes on or
resumes, repeats only what is missing, and ends with the same bytes."""

import errno
import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
import rasterio
import zarr
from gnomon import studies
from gnomon.studies import runner
from gnomon.studies.command import main
from made import bits, chunk_files, city, replaced, run, write_raster, write_suns

SUNS = [(100 + 8 * i, 4 + i) for i in range(20)]
WORK = dict(tile=16, caster_tile=16, outputs=["bits", "weights"])


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("faults")
    return folder, dict(
        raster=write_raster(folder / "dsm.tif", city(48)), directions=write_suns(folder / "s.csv", SUNS)
    )


@pytest.fixture(scope="module")
def whole(files):
    folder, settings = files
    return run(folder / "whole", **settings, **WORK)


def tasks(folder):
    """Names of the tasks that are done, and when."""
    return {p.name: p.stat().st_mtime_ns for p in (folder / "tasks").glob("[0-9]*.json")}


def wait_for_tasks(folder, count, process=None):
    for _ in range(1200):
        if len(tasks(folder)) >= count:
            return
        assert process is None or process.poll() is None, "it ended before it was killed"
        time.sleep(0.05)
    raise AssertionError("no tasks")


def is_the_same(study, whole):
    assert study.digests() == whole.digests()
    assert chunk_files(study.folder) == chunk_files(whole.folder)


def test_a_worker_is_killed(files, whole):
    from distributed import Client

    folder, settings = files
    killed = []

    def kill(pid):
        wait_for_tasks(folder / "killed", 2)
        os.kill(pid, signal.SIGKILL)
        killed.append(len(tasks(folder / "killed")))

    import dask

    strict = {"distributed.scheduler.allowed-failures": 0}  # dask gives a task up at its worker's first death
    with dask.config.set(strict), runner._cluster([None, None]) as cluster, Client(cluster) as client:
        client.wait_for_workers(2)
        pids = client.run(os.getpid)
        killer = threading.Thread(target=kill, args=(min(pids.values()),))
        killer.start()
        study = run(folder / "killed", client=client, **settings, **WORK)
        killer.join()
        assert min(pids.values()) not in client.run(os.getpid).values()
    assert killed and killed[0] < 18, "it died in mid-run"
    is_the_same(study, whole)


def test_the_client_is_killed_and_the_study_resumed(files, whole):
    folder, settings = files
    lines = [f"{k} = {json.dumps(v)}" for k, v in (settings | WORK).items()]
    (folder / "city.toml").write_text("\n".join(lines))
    command = [
        sys.executable,
        "-c",
        "from gnomon._study import main; raise SystemExit(main())",
        "run",
        folder / "city.toml",
    ]
    process = subprocess.Popen([*command, "--quiet"], start_new_session=True)
    wait_for_tasks(folder / "city", 2, process)
    process.kill()
    process.wait()
    before = tasks(folder / "city")
    assert 2 <= len(before) < 18
    done = subprocess.run(command, capture_output=True, text=True, timeout=200)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["tasks_done"] == 9 and "decisions" in done.stderr, "a summary, and a bar"
    after = tasks(folder / "city")
    assert all(after[name] == at for name, at in before.items()), "what was done is not done again"
    is_the_same(studies.open_study(folder / "city"), whole)


def test_a_disk_that_fills_up(files, whole):
    folder, settings = files
    from zarr.storage import _local

    calls = []

    def full(path, value, exclusive=False):
        calls.append(path)
        if len(calls) > 50:
            raise OSError(errno.ENOSPC, "No space left on device", str(path))
        return put(path, value, exclusive)

    with replaced(_local, "_put", full) as put, pytest.raises(studies.StudyStoppedError, match="make room"):
        run(folder / "full", **settings, **WORK)
    before = tasks(folder / "full")
    assert 0 < len(before) < 18
    study = run(folder / "full", **settings, **WORK)
    assert all(tasks(folder / "full")[name] == at for name, at in before.items())
    is_the_same(study, whole)


def test_a_small_disk(files, whole, tmp_path):
    """The same on a file system that is full, where one can be mounted."""
    folder, settings = files
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=150k", "none", tmp_path], capture_output=True)
    if mounted.returncode:
        pytest.skip("no file system can be mounted here")
    try:
        with pytest.raises(studies.StudyStoppedError, match="No space left on device.*make room.*run the same study"):
            run(tmp_path / "small", **settings, **WORK)
        assert subprocess.run(["mount", "-o", "remount,size=50m", tmp_path]).returncode == 0
        is_the_same(run(tmp_path / "small", **settings, **WORK), whole)
    finally:
        subprocess.run(["umount", tmp_path], check=True)


def test_a_damaged_chunk_is_found_and_made_again(files, whole, capsys):
    folder, settings = files
    shutil.copytree(whole.folder, folder / "damaged", symlinks=True)
    chunk = folder / "damaged" / "results.zarr" / "lit" / "c" / "0" / "1" / "2"
    data = bytearray(chunk.read_bytes())
    data[len(data) // 2] ^= 1
    chunk.write_bytes(data)
    (folder / "damaged" / "results.zarr" / "sum_of_weights" / "c" / "0" / "0").unlink()
    found = studies.verify(folder / "damaged", share=0)
    assert (
        sorted(found.damaged) == ["results.zarr/lit/c/0/1/2", "results.zarr/sum_of_weights/c/0/0"] and not found.is_good
    )
    assert main(["verify", str(folder / "damaged"), "--share", "0"]) == 1
    assert "damaged: results.zarr/lit/c/0/1/2" in capsys.readouterr().out
    before = tasks(folder / "damaged")
    study = run(folder / "damaged", **settings, **WORK)
    changed = {name for name, at in tasks(folder / "damaged").items() if at != before[name]}
    assert changed == {"5-0.json", "0-sum.json"}, "tile (1, 2), and the sums of tile (0, 0)"
    is_the_same(study, whole)
    assert studies.verify(folder / "damaged", share=1).is_good


def test_wrong_answers_are_found(files, whole):
    """A chunk that some broken machine wrote, with hashes that fit it."""
    folder, _ = files
    shutil.copytree(whole.folder, folder / "wrong")
    array = zarr.open_array(str(folder / "wrong" / "results.zarr" / "lit"), mode="r+")
    array[0, 20, 20] ^= 4
    store = studies.open_study(folder / "wrong").plan.store
    facts = json.loads(store.done_path(4, 0).read_text())
    facts["chunks"]["results.zarr/lit/c/0/1/1"] = store.write(
        "results.zarr/lit", (0, slice(16, 32), slice(16, 32)), array[0, 16:32, 16:32], (0, 1, 1)
    )
    store.mark_done(4, 0, facts)
    found = studies.verify(folder / "wrong", share=1)
    assert found.wrong == ["results.zarr/lit/c/0/1/1"] and not found.damaged and found.tasks == 9


def spoil(path):
    """Compressed cells that cannot be unpacked, behind a heading that can be read."""
    with rasterio.open(path) as data:
        at = int(data.get_tag_item("BLOCK_OFFSET_0_0", "TIFF", bidx=1))
    whole = path.read_bytes()
    path.write_bytes(whole[:at] + b"\xff" * (len(whole) - at))
    return whole


def test_a_tile_that_cannot_be_read(files, whole, capsys):
    folder, settings = files
    heights = city(48)
    west = folder / "west.tif"
    east = folder / "east.tif"
    for path, part, first in ((west, heights[:, :30], 0), (east, heights[:, 30:], 30)):
        write_raster(path, part, west=512_000.0 + 25 * first, compress="deflate")
    intact = spoil(east)
    mosaic = settings | dict(raster=[str(west), str(east)])
    study = run(folder / "unread", **mosaic, **WORK)
    record = study.record
    assert record["undecided"] > 0 and any("cells 0:17, 16:33" in name for name in record["unread_casters"])
    lit, undecided, truth = bits(study), bits(study, "undecided"), bits(whole)
    assert not (lit & undecided).any() and not (lit & ~truth).any() and (truth <= lit | undecided).all()
    assert undecided[:, :, 32:].all(), "receivers that could not be read"
    assert lit[:, :, :12].any() and (~lit & ~undecided).any(), "what does not need them is decided"
    lines = [f"{k} = {json.dumps(v)}" for k, v in (mosaic | WORK).items()]
    (folder / "unread.toml").write_text("\n".join(lines))
    assert main(["run", str(folder / "unread.toml"), "--strict", "--quiet"]) == 1
    assert "could not read" in capsys.readouterr().err
    before = tasks(folder / "unread")
    certain = {
        f"{t}-{b}.json" for t, b in study.plan.tasks if not study.plan.store.done(t, b, study.plan.hash)["unread"]
    }
    east.write_bytes(intact)
    again = run(folder / "unread", **mosaic, **WORK)
    assert again.digests() == whole.digests() and not again.record["unread_casters"]
    after = tasks(folder / "unread")
    assert all(after[name] == before[name] for name in certain)
    assert again.plan.exponent == -10


def test_a_change_of_files_or_settings_is_refused(files):
    folder, settings = files
    raster = folder / "changing.tif"
    write_raster(raster, np.zeros((20, 20)))
    own = settings | dict(raster=str(raster))
    run(folder / "changing", **own, **WORK)
    with pytest.raises(ValueError, match="holds a study with other settings"):
        run(folder / "changing", **own, **(WORK | dict(tile=10)))
    write_raster(raster, np.ones((20, 20)))
    with pytest.raises(ValueError, match="changing.tif: has changed since the study began"):
        run(folder / "changing", **own, **WORK)
    assert run(folder / "changing", restart=True, **own, **WORK).record["tasks_done"] == 4


def test_a_call_that_always_fails_stops_the_study(files):
    folder, settings = files
    from gnomon.studies import tasks as of_tasks

    def fails(plan, tile, block):
        raise RuntimeError("made to fail")

    with (
        replaced(of_tasks, "compute_task", fails),
        pytest.raises(studies.StudyStoppedError, match="made to fail.*kept"),
    ):
        run(folder / "fails", **settings, **WORK)
