# SPDX-License-Identifier: MIT
"""What is far away shadows what it should, and what was not tested makes answers undecided, never lit."""

import math

import numpy as np
import pytest
from gnomon import EARTH_RADIUS
from gnomon.studies.halo import Curvature, Pyramid, leaves_below, rises_above
from hypothesis import given, settings
from hypothesis import strategies as st
from made import bits, run, write_raster, write_suns

PLANE = Curvature(0, 0, 0)


@pytest.fixture(scope="module")
def strip(tmp_path_factory):
    """10 km of flat ground from west to east, cells of 25 m, and a tower of 470 m in the east."""
    folder = tmp_path_factory.mktemp("strip")
    heights = np.zeros((9, 400))
    heights[3:6, 396:398] = 470
    raster = write_raster(folder / "strip.tif", heights)
    return folder, dict(raster=raster, directions=write_suns(folder / "suns.csv", [(90, 3), (270, 3), (90, 60)]),
                        outputs=["bits", "weights"], tile=16, caster_tile=16)  # fmt: skip


def expected_of_the_tower():
    """By the shadow's length: the tower's western top edge stands at column 396, and its foot is a slope."""
    length = 470 / math.tan(math.radians(3))  # 8,968 m
    away = (396 - np.arange(400)) * 25.0
    return (away > 0) & (away < length), length


def test_the_towers_shadow_at_full_length(strip):
    folder, settings = strip
    study = run(folder / "full", **settings)
    shadow, length = expected_of_the_tower()
    assert 8_960 < length < 8_970 and shadow.sum() == 358
    dark = ~bits(study)[0, 4]
    assert (dark[:396] == shadow[:396]).all(), "358 cells, over 22 tiles of 16 cells"
    assert bits(study)[0, [0, 8]].all() and study.record["undecided"] == 0
    assert study.plan.exponent == -10 and study.record["reach_metres"] > length


@pytest.mark.parametrize("limit", [0.0, 1000.0, 5000.0])
def test_a_capped_halo_is_undecided_where_the_shadow_was_cut(strip, limit):
    folder, settings = strip
    study = run(folder / f"limit-{limit:g}", halo_limit=limit, **settings)
    shadow, _ = expected_of_the_tower()
    lit, undecided = bits(study)[0], bits(study, "undecided")[0]
    assert not (lit & undecided).any()
    assert not lit[4, :396][shadow[:396]].any(), "nothing that is in shadow reads as lit"
    # The tower's caster tile begins at column 384. Its own receivers test it; those of a tile that is farther away than
    # the limit do not, and their rays are undecided where they enter the tile's box below 470 m.
    column = np.arange(384)
    is_cut = (384 - (column // 16 * 16 + 15)) * 25.0 > limit
    enters = (384 - column) * 25.0 * math.tan(math.radians(3)) <= 470
    for row in (0, 4):
        assert (undecided[row, :384] == (is_cut & enters)).all()
    assert is_cut.sum() > 100 and not undecided[:, 384:].any(), "its own tile is tested"
    assert undecided[4, :384][shadow[:384] & is_cut].all(), "what was cut is undecided"
    assert study.record["undecided"] == bits(study, "undecided").sum() > 0
    full = bits(run(folder / "full", **settings))
    assert not (bits(study) & ~full).any(), "lit is lit"
    assert (full <= (bits(study) | bits(study, "undecided"))).all(), "hours <= truth <= hours + undecided"


def test_what_may_stand_outside(strip):
    folder, settings = strip
    study = run(folder / "outside", outside=100.0, **settings)
    # From the middle row the ray to the east leaves the data, at the last column, below 100 m if it is near.
    away = (399 - np.arange(400)) * 25.0
    below = away * math.tan(math.radians(3)) <= 100
    undecided = bits(study, "undecided")
    assert (undecided[0, 0] == below).all() and below.sum() == 77
    assert (undecided[2, 0] == (away * math.tan(math.radians(60)) <= 100)).all()
    assert not (bits(study)[0] & undecided[0]).any()


@pytest.fixture(scope="module")
def ridge(tmp_path_factory):
    """80 km from west to east in cells of 500 m, and a ridge of 4,000 m in the east."""
    folder = tmp_path_factory.mktemp("ridge")
    heights = np.zeros((6, 160))
    heights[:, 158] = 4000
    raster = write_raster(folder / "ridge.tif", heights, cell=500.0, west=500_000.0, north=5_003_000.0)
    return folder, dict(raster=raster, directions=write_suns(folder / "suns.csv", [(90, 3)]), outputs=["bits"],
                        tile=20, caster_tile=16)  # fmt: skip


def test_a_ridge_seventy_kilometres_away(ridge):
    folder, settings = ridge
    study = run(folder / "flat", **settings)
    away = (158 - np.arange(158)) * 500.0
    expected = away * math.tan(math.radians(3)) > 4000  # beyond 76,325 m
    assert 5 < expected.sum() < 10 and not expected[away == 70_000]
    assert (bits(study)[0, :, :158] == expected).all()
    assert study.plan.exponent == -7, "2^25 steps of 2^-8 m are 131 km: not enough for 76 km and the tiles"
    plan = study.plan
    part = plan.receivers.tile(0).parts[0]
    box = np.array([*part.xyz[:, :2].min(axis=0), *part.xyz[:, :2].max(axis=0)])
    pyramid, towards = plan.decider.pyramid, plan.suns.towards[0].astype(float)
    found, _ = pyramid.tiles_that_can_shadow(box, 0.0, towards, PLANE, plan.decider.pad)
    assert len(found) < len(plan.casters), "flat tiles between are left out"
    assert plan.survey.tops[found].max() == 4000


def test_the_earths_curvature(ridge):
    """Heights fall by d^2 / 2R' around the zone's centre; the ridge, far from it, is lower: its shadow is shorter."""
    folder, settings = ridge
    study = run(folder / "round", curvature=True, refraction_of_ground=0.0, zone=200_000.0, **settings)
    x = 500_250.0 + 500.0 * np.arange(160)
    fall = (x - 500_000.0) ** 2 / (2 * EARTH_RADIUS)  # the zone 400,000..600,000 has its centre at 500,000
    rows = (5_000_250.0 + 500 * np.arange(6) - 5_100_000.0) ** 2 / (2 * EARTH_RADIUS)
    assert np.ptp(rows) < 60
    away = (158 - np.arange(158)) * 500.0
    expected = away * math.tan(math.radians(3)) > 4000 - fall[158] + fall[:158]
    flat = away * math.tan(math.radians(3)) > 4000
    assert expected.sum() > flat.sum() + 5
    assert (bits(study)[0, :, :158] == expected).all()


def test_beyond_the_lattices_reach(ridge):
    """A step that cannot hold ridge and receivers together: what the ridge may shadow is undecided."""
    folder, settings = ridge
    study = run(folder / "fine", lattice=2.0**-10, **settings)
    full = bits(run(folder / "flat", **settings))
    lit, undecided = bits(study), bits(study, "undecided")
    assert undecided.sum() > 100 and not (lit & ~full).any() and (full <= lit | undecided).all()


boxes = st.tuples(*[st.floats(-1e3, 1e3)] * 2, *[st.floats(0, 300)] * 2, st.floats(-50, 500))


@settings(max_examples=150, deadline=None)
@given(st.lists(boxes, min_size=1, max_size=60), boxes, st.floats(0, 360), st.floats(0.2, 90), st.integers(0, 999))
def test_no_caster_that_matters_is_left_out(tiles, receivers, azimuth, elevation, seed):
    """Rays from points in the receivers' box through points in the casters' boxes below their tops."""

    def boxed(t):
        return [t[0], t[1], t[0] + t[2], t[1] + t[3]]

    casters, tops = np.array([boxed(t) for t in tiles]), np.array([t[4] for t in tiles])
    box, lowest = np.array(boxed(receivers)), receivers[4]
    a, e = math.radians(azimuth), math.radians(elevation)
    sun = np.array([math.sin(a) * math.cos(e), math.cos(a) * math.cos(e), math.sin(e)])
    found, hit = Pyramid(casters, tops).tiles_that_can_shadow(box, lowest, sun[None], PLANE, 0.01)
    one_by_one = np.array([rises_above(c, t, box, np.float64(lowest), sun, 0.01) for c, t in zip(casters, tops)])  # noqa: B905
    assert found.tolist() == np.flatnonzero(one_by_one).tolist() and hit.all()
    rng = np.random.default_rng(seed)
    start = box[:2] + rng.random((200, 2)) * (box[2:] - box[:2])
    for t in np.concatenate([rng.random(20) * 2000, [0]]):
        at = start + t * sun[:2]
        inside = (at[:, None] >= casters[None, :, :2]).all(axis=2) & (at[:, None] <= casters[None, :, 2:]).all(axis=2)
        meets = inside & (lowest + t * sun[2] <= tops)[None]
        assert set(np.flatnonzero(meets.any(axis=0))) <= set(found.tolist())


def test_where_a_ray_leaves_the_extent():
    extent = np.array([0.0, 0.0, 100.0, 100.0])
    points = np.array([[50.0, 50, 0], [90, 50, 0], [50, 50, 30]])
    east = np.array([math.cos(math.radians(45)), 0, math.sin(math.radians(45))])
    assert leaves_below(extent, 20.0, points, east, 0.0).tolist() == [False, True, False]
    assert leaves_below(extent, 60.0, points, east, 0.0).tolist() == [True, True, False]
    assert not leaves_below(extent, 1e9, points, np.array([0.0, 0, 1]), 0.0).any()


def test_a_group_of_tiles_is_filled_up_to_a_rectangle_by_tiles_that_can_shadow_nothing(strip):
    folder, settings = strip
    decider = run(folder / "filled", **settings).plan.decider

    def fill(group, tiles):
        return decider._filled(np.array(group), np.array(tiles)).tolist()

    assert len(decider.casters) == 25
    assert fill([3, 4, 6, 7], [3, 4, 6, 7]) == [3, 4, 5, 6, 7]
    assert fill([3, 4, 6, 7], [3, 4, 5, 6, 7]) == [3, 4, 6, 7], "tile 5 can shadow, and is left to another group"
    assert fill([3, 7], [3, 7]) == [3, 7], "the rectangle has 2.5 times the triangles"
    decider.survey.tops[5] = np.inf
    assert decider.survey.unread[5] and fill([3, 4, 6, 7], [3, 4, 6, 7]) == [3, 4, 6, 7]
