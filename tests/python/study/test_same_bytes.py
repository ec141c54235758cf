# SPDX-License-Identifier: MIT
"""A made city of 16 tiles: the same bytes whatever divides the work, and the right ones."""

import ctypes
import os

import numpy as np
import pytest
from gnomon import studies
from gnomon.studies import decide
from gnomon.studies.runner import Execution, executor_of
from made import bits, chunk_files, city, exactly_lit, replaced, run, snapped, triangles_of, write_raster, write_suns

SUNS = [(80 + 5 * i, 3 + 25 * np.sin(np.pi * i / 39)) for i in range(40)]  # 3 to 28 degrees
TILES = dict(tile=24, caster_tile=16)


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("city")
    return folder, write_raster(folder / "dsm.tif", city()), write_suns(folder / "suns.csv", SUNS)


@pytest.fixture(scope="module")
def whole(files):
    folder, raster, suns = files
    return run(folder / "whole", raster=raster, directions=suns, outputs=["bits", "weights"], **TILES)


def test_the_city_has_sixteen_tiles_and_all_is_certain(whole):
    assert len(whole.plan.receivers) == 16 and whole.plan.exponent == -10
    assert whole.record["undecided"] == 0 and whole.record["decisions"] == (96 * 96 - 12) * 40
    lit = bits(whole)
    assert 0.2 < lit.mean() < 0.9
    sums = whole.dataset().sum_of_weights.values
    assert np.isnan(sums).sum() == 12 and (np.nan_to_num(sums) == lit.sum(axis=0)).all()


def test_rational_arithmetic_agrees(whole):
    """Pairs drawn at random, and all suns at cells that the tower's and the hole's neighbours shadow."""
    heights = city()
    triangles, vertices = triangles_of(heights, 25.0, 512_000.0, 5_002_400.0)
    triangles, vertices = snapped(triangles), snapped(vertices)
    lit = bits(whole)
    towards = whole.plan.suns.towards[0]
    rng = np.random.default_rng(3)
    pairs = [(*rng.integers(0, 96, 2), rng.integers(0, 40)) for _ in range(60)]
    pairs += [(48, 24 + 4, s) for s in range(0, 40, 4)] + [(95, 40, s) for s in range(0, 40, 4)]
    asked = 0
    for r, c, s in pairs:
        if np.isfinite(heights[r, c]):
            assert lit[s, r, c] == exactly_lit(triangles, vertices[r, c], towards[s]), (r, c, s)
            asked += 1
    assert asked > 60


def test_the_raster_serves_without_its_triangles(files, whole):  # whole: it is made first
    """And with them, the same bytes: both ways to make a scene of caster tiles."""
    folder, raster, suns = files
    settings = dict(raster=raster, directions=suns, outputs=["bits", "weights"], **TILES)

    def none_is_written(*_):
        raise AssertionError("a raster was cut into triangles")

    with replaced(decide, "_snapped_triangles", none_is_written):
        run(folder / "without", **settings)
    with replaced(decide.Decider, "_load_raster", lambda *_: None):
        run(folder / "with", **settings)
    assert chunk_files(folder / "without") == chunk_files(folder / "with") == chunk_files(folder / "whole")


def test_a_whole_scene_agrees(whole):
    """Scene.lit(side=Side.vertices()) on the raster as one mesh answers the same."""
    import gnomon

    heights = city()
    triangles, vertices = triangles_of(heights, 25.0, 512_000.0, 5_002_400.0)
    scene = gnomon.Scene(triangles, lattice=2**-10)
    there = np.isfinite(heights)
    lit = bits(whole)
    for sun in range(0, 40, 3):
        d = -whole.plan.suns.towards[0, sun]
        expected = scene.lit(vertices[there], direction=d, side=gnomon.Side.vertices((0, 0, 1))).values
        assert (lit[sun][there] == expected).all(), sun
    assert not lit[:, ~there].any()


@pytest.mark.parametrize(
    "settings",
    [dict(tile=96, caster_tile=256), dict(tile=37, caster_tile=11), dict(tile=24, caster_tile=16, zone=700, block=7),
     dict(tile=50, caster_tile=20, memory_limit=1 << 20)],
    ids=["one tile", "odd tiles", "zones across tiles", "little memory"],
)  # fmt: skip
def test_the_same_bits_for_other_tiles(files, whole, settings):
    folder, raster, suns = files
    name = "-".join(map(str, settings.values()))
    again = run(folder / name, raster=raster, directions=suns, outputs=["bits", "weights"], **settings)
    assert again.digests() == whole.digests()


def test_the_same_bits_in_another_order_and_by_parts(files, whole, monkeypatch):
    folder, raster, suns = files
    settings = dict(raster=raster, directions=suns, outputs=["bits", "weights"], **TILES)
    for tiles in (slice(9, None), slice(4, 9), slice(None, 4)):
        part = run(folder / "parts", tiles=tiles, **settings)
    assert part.digests() == whole.digests()
    assert chunk_files(folder / "parts") == chunk_files(folder / "whole")


def test_the_same_bits_at_a_moved_origin(files, whole):
    """Moved by odd numbers of steps in each coordinate, heights too (they stay float32 values)."""
    folder, _, suns = files
    moved = write_raster(folder / "moved.tif", city().astype(np.float32) + 64.0, west=512_000.0 - 77_777 / 1024,
                         north=5_002_400.0 + 1_234_567 / 1024)  # fmt: skip
    again = run(folder / "moved", raster=moved, directions=suns, outputs=["bits", "weights"], tile=31, caster_tile=40)
    assert again.digests() == whole.digests()


@pytest.mark.parametrize("workers", [1, 2])
def test_the_same_files_by_processes(files, whole, workers):
    folder, raster, suns = files
    again = run(folder / f"by-{workers}", raster=raster, directions=suns, outputs=["bits", "weights"], workers=workers,
                **TILES)  # fmt: skip
    assert again.digests() == whole.digests()
    assert chunk_files(folder / f"by-{workers}") == chunk_files(folder / "whole")


def test_times_and_zones(files):
    """A day by pvlib: zones that tile borders cross, two divisions of the same work, hours that add up."""
    folder, raster, _ = files
    settings = dict(raster=raster, start="2026-03-20", end="2026-03-21", step="30min", utc_offset=1, zone=900)
    one = run(folder / "day", tile=96, caster_tile=32, **settings)
    two = run(folder / "day-2", tile=41, caster_tile=24, block=9, **settings)
    assert one.digests() == two.digests()
    assert len(one.plan.suns.zones) >= 9 and len(two.plan.blocks) > 1
    hours = one.dataset().sun_hours.values
    assert (np.nan_to_num(hours) == 0.5 * bits(one).sum(axis=0)).all() and 0 < np.nanmax(hours) < 12


def test_open_study_reads_what_is_there(whole):
    again = studies.open_study(whole.folder)
    assert again.digests() == whole.digests() and "16 of 16 tasks" in repr(again)


def test_workers_inherit_nothing_that_a_driver_set():
    """A driver sets variables of the process behind Python's back, as setenv() of C does."""
    ctypes.CDLL(None).setenv(b"GNOMON_TEST_AS_A_DRIVER", b"1", 1)
    with executor_of(Execution(workers=1)) as executor:
        ((_, seen),) = executor.run([("environment", os.getenv, ("GNOMON_TEST_AS_A_DRIVER",))])
    assert seen is None
