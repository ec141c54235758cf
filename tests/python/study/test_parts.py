# SPDX-License-Identifier: MIT
"""The parts of a study: facing on a grid, suns and zones, rasters, settings."""

import datetime
import math
import warnings
from pathlib import Path

import gnomon
import numpy as np
import oracle
import pyproj
import pytest
from gnomon import studies
from gnomon.studies import planes
from gnomon.studies.decide import steps_of
from gnomon.studies.facing import GridFacing
from gnomon.studies.rasters import faces_of_grid, open_mosaic
from gnomon.studies.settings import Settings, read_toml, settings_of
from gnomon.studies.suns import Suns, samples_of_disks, suns_of, zone_of
from hypothesis import given, settings
from hypothesis import strategies as st
from made import UTM, run, write_raster, write_suns

UP = (0, 0, 1)


def facing(x, y, heights, suns):
    """GridFacing of all vertices of a raster, (R, C, M)."""
    z = np.pad(heights, 1, constant_values=np.nan)
    x, y = (np.concatenate([[2 * v[0] - v[1]], v, [2 * v[-1] - v[-2]]]) for v in (x, y))
    inside = np.isfinite(heights)
    result = np.ones((*heights.shape, len(suns)), bool)
    faces = GridFacing(x, y, z, inside).faces(np.array(suns, np.float32))
    result[inside] = planes.unpacked(faces, len(suns))
    return result


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.one_of(st.integers(-3, 3), st.just(None)), min_size=20, max_size=20),
    st.lists(st.tuples(st.integers(-3, 3), st.integers(-3, 3), st.integers(1, 4)), min_size=1, max_size=5),
    st.booleans(),
)
def test_facing_equals_the_oracle(heights, suns, is_even):
    """Borders, holes, suns in the planes of triangles and above edges; columns of one width and of two."""
    heights = np.array([np.nan if h is None else h for h in heights], float).reshape(4, 5)
    x = np.arange(5.0) if is_even else np.array([0.0, 2, 3, 5, 6])
    y = np.arange(4.0)[::-1]
    at = np.stack([*np.meshgrid(x, y), heights], axis=-1)
    triangles = at.reshape(-1, 3)[faces_of_grid(4, 5)]
    triangles = triangles[np.isfinite(triangles).all(axis=(1, 2))]
    got = facing(x, y, heights, suns)
    for r, c in np.argwhere(np.isfinite(heights)):
        around = triangles[(np.abs(triangles - at[r, c]).max(axis=2) == 0).any(axis=1)]
        for s, sun in enumerate(suns):
            expected = oracle.above_height_field(around, at[r, c], np.float32(sun))[0] if len(around) else True
            assert got[r, c, s] == expected, (r, c, sun)


@pytest.mark.parametrize("spread", [0.01, 0.2])
def test_suns_close_together_face_as_the_oracle_says(spread):
    """32 suns at once: above, below, and some of them above, at vertices with all six triangles."""
    rng = np.random.default_rng(6)
    heights = rng.integers(0, 4, (7, 7)).astype(float)
    middles = np.repeat([[1, 0.3, 0.9], [-0.2, -1, 1.4]], 32, axis=0)
    suns = (middles + spread * rng.uniform(-1, 1, (64, 3))).astype(np.float32)
    x, y = np.arange(7.0), np.arange(7.0)[::-1]
    at = np.stack([*np.meshgrid(x, y), heights], axis=-1)
    triangles = at.reshape(-1, 3)[faces_of_grid(7, 7)]
    got = facing(x, y, heights, suns)
    whole = []
    for r, c in np.ndindex(5, 5):
        vertex = at[r + 1, c + 1]
        around = triangles[(np.abs(triangles - vertex).max(axis=2) == 0).any(axis=1)]
        expected = [bool(oracle.above_height_field(around, vertex, sun)[0]) for sun in suns]
        assert got[r + 1, c + 1].tolist() == expected, (r, c)
        whole += [sum(expected[:32]), sum(expected[32:])]
    assert 0 in whole and 32 in whole and (spread < 0.1 or {*whole} - {0, 32})


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.integers(0, 119), st.integers(1, 40)), min_size=1, max_size=4), st.integers(0, 2**32 - 1))
def test_planes_hold_the_answers(runs, seed):
    """Moved, added and unpacked as arrays of bool are; a table's bits beyond its last sun are 0."""
    rng = np.random.default_rng(seed)
    to = np.unique(np.concatenate([np.arange(first, first + count) for first, count in runs]))
    answers = rng.random((9, len(to))) < 0.5
    packed = planes.packed(answers)
    spread = np.zeros((9, 160), bool)
    spread[:, to] = answers
    assert (planes.unpacked(packed, len(to)) == answers).all()
    assert (planes.unpacked(planes.moved(packed, to, 5), 160) == spread).all()
    assert (planes.transposed(np.ascontiguousarray(packed.T)) == packed).all()
    assert (planes.unpacked(planes.ones(len(to), 9), 32 * len(packed)).sum(axis=1) == len(to)).all()
    for weights in (rng.integers(-(2**54), 2**54, len(to)), np.full(len(to), 3600)):
        expected = [sum(w for w, a in zip(weights.tolist(), row, strict=True) if a) for row in answers]
        assert planes.weighed(packed, weights).tolist() == expected
    sun = int(rng.integers(len(to)))
    assert (planes.of_sun(packed, sun) == answers[:, sun]).all()
    planes.clear(packed, sun, answers[:, 0])
    answers[answers[:, 0].copy(), sun] = False
    assert (planes.unpacked(packed, len(to)) == answers).all()


def test_signs_that_float64_cannot_tell():
    """n . d is -1, 0 or 1, a sum of terms near 2^70: n solves it in whole numbers."""
    rng = np.random.default_rng(5)
    inside = np.ones((1, 1), bool)
    grid = GridFacing(np.arange(3.0), np.arange(3.0)[::-1], np.zeros((3, 3)), inside)
    wrong = 0
    for i in range(60):
        d = rng.integers(2**23, 2**24, 3).tolist()
        if math.gcd(d[0], d[1]) != 1:
            continue
        a = pow(d[0], -1, d[1])  # a d0 + b d1 = 1
        want = i % 3 - 1
        k, m = rng.integers(2**22, 2**23, 2).tolist()
        n = [want * a + k * d[1] + m * d[2], want * (1 - a * d[0]) // d[1] - k * d[0], -m * d[0]]
        assert sum(x * y for x, y in zip(n, d, strict=True)) == want and max(map(abs, n)) < 2**53
        grid._normals[0][:] = n
        grid._largest[0][:] = max(map(abs, n))
        assert grid._above(0, np.array([d], float), slice(None))[0, 0] == (want > 0)
        wrong += (float(np.dot(np.array(n, float), np.array(d, float))) > 0) != (want > 0)
    assert wrong > 5, "float64 alone is wrong"


def test_facing_beside_a_plane():
    """A plane of whole steps and a sun that is one rounding of float32 above it, in it, and below it."""
    x, y = np.arange(3.0) * 999_983, np.arange(3.0)[::-1] * 999_979
    heights = np.add.outer(-7.0 * np.arange(3), 3.0 * np.arange(3)) * 1000
    nx, ny, nz = np.float64([999_979 * -3000.0, 999_983 * -7000.0, 999_983.0 * 999_979])  # n . d = 0 in the plane
    suns = []
    for a in (0.3, 0.7, 2.2):
        d = np.float32([math.cos(a), math.sin(a), 0])
        d[2] = -(nx * d[0] + ny * d[1]) / nz
        if d[2] > 0:
            suns += [d, d + np.float32([0, 0, np.spacing(d[2])]), d - np.float32([0, 0, np.spacing(d[2])])]
    at = np.stack([*np.meshgrid(x, y), heights], axis=-1)
    triangles = at.reshape(-1, 3)[faces_of_grid(3, 3)]
    got = facing(x, y, heights, suns)[1, 1]
    expected = [oracle.above_height_field(triangles, at[1, 1], s)[0] for s in suns]
    assert got.tolist() == expected and len({*expected}) == 2


def test_the_diagonals_face_up_and_run_from_south_west_to_north_east():
    at = np.array([[0, 1, 0], [1, 1, 0], [0, 0, 0], [1, 0, 0]], float)  # nw, ne, sw, se
    triangles = at[faces_of_grid(2, 2)]
    assert len(triangles) == 2
    for t in triangles:
        assert np.cross(t[1] - t[0], t[2] - t[0])[2] == 1
        assert (t == at[1]).all(axis=1).any() and (t == at[2]).all(axis=1).any()


def test_steps_are_those_of_the_lattice():
    values = np.array([[4.5e6 + 0.5 / 1024, -6e6 - 0.5 / 1024, 0.49999999999999994 / 1024], [0, 1 / 3, -1 / 3]])
    lattice = gnomon._gnomon.WorldLattice.around(np.zeros((1, 3)), -10)
    near = np.random.default_rng(1).integers(-(2**20), 2**20, (999, 3)) / 4096  # a quarter of them half-way
    assert (steps_of(near, -10) / 1024 == lattice.snap(near)[0]).all()
    assert steps_of(values, -10)[0].tolist() == [4.5e6 * 1024 + 1, -6e6 * 1024, 0]


# ---- Suns ------------------------------------------------------------------------------------------------------------


def made_suns(**more):
    values = dict(raster=__file__, start="2026-03-20", end="2026-03-21", step=60) | more
    return suns_of(settings_of(values), UTM, (512_000.0, 5_000_000.0, 530_000.0, 5_010_000.0))


def test_azimuths_on_the_map():
    """At noon of the sun the shadow points along the meridian: found on the map by two points of one longitude, with no
    use of the convergence. At 9 degrees of longitude and 3.9 more, so that it is 2.8 degrees."""
    to_map = pyproj.Transformer.from_crs("EPSG:4326", UTM, always_xy=True)
    x, y = to_map.transform(12.9, 46.5)
    suns = suns_of(
        settings_of(dict(raster=__file__, start="2026-06-21", end="2026-06-22", step="1min", zone=100)),
        UTM,
        (x, y, x, y),
    )
    zone = tuple(suns.zones[0])
    longitude, latitude = pyproj.Transformer.from_crs(UTM, "EPSG:4326", always_xy=True).transform(*suns.centre(zone))
    a, b = (np.array(to_map.transform(longitude, latitude + d)) for d in (-1e-4, 1e-4))
    south = (a - b) / np.linalg.norm(a - b)
    towards = suns.towards[0].astype(float)
    highest = towards[np.nanargmax(towards[:, 2])]
    angle = math.degrees(math.atan2(highest[0], highest[1]) - math.atan2(south[0], south[1]))
    assert abs(angle) < 0.4, "one minute is a quarter of a degree, doubled by the sun's height"
    assert abs(math.degrees(math.atan2(south[0], -south[1]))) > 2.7
    declination = 23.43
    assert abs(math.degrees(math.asin(highest[2])) - (90 - latitude + declination)) < 0.02
    length = np.linalg.norm(towards[np.isfinite(towards[:, 0])], axis=1)
    assert np.allclose(length, 1, atol=1e-6)


def test_refraction_raises_low_suns():
    true, apparent = made_suns(), made_suns(elevation="apparent")
    low = np.nanargmin(np.where(true.towards[0, :, 2] > 0, true.towards[0, :, 2], np.nan))
    raised = np.degrees(
        np.arcsin(apparent.towards[0, low, 2].astype(float)) - np.arcsin(true.towards[0, low, 2].astype(float))
    )
    h = math.degrees(math.asin(true.towards[0, low, 2]))
    saemundsson = 1.02 / math.tan(math.radians(h + 10.3 / (h + 5.11))) / 60
    assert abs(raised - saemundsson) < 0.004 and raised > 0.03


def test_zones_are_fixed_in_the_world_and_their_error_is_stated():
    assert zone_of(np.array([-0.1, 0, 9999.9, 10000]), np.array([0, 0, 0, -1e-9]), 1e4)[0].tolist() == [-1, 0, 0, 1]
    suns = made_suns(zone=10_000)
    assert suns.zones.tolist() == [[51, 500], [51, 501], [52, 500], [52, 501], [53, 500], [53, 501]]
    worst = suns.notes["error_across_a_zone_degrees"]
    assert 0.05 < worst < 0.08, "half a diagonal of 10 km is .0636 degrees of the Earth"
    assert not np.array_equal(suns.towards[0], suns.towards[1], equal_nan=True)


def test_packed_hours_follow_the_solar_api():
    suns = made_suns(utc_offset=1, start="2026-01-31", end="2026-02-02")
    assert suns.is_hourly and suns.word_count == 288
    for i, text in enumerate(suns.times):
        t = datetime.datetime.fromisoformat(text)
        assert suns.word[i] == 24 * (t.month - 1) + t.hour and suns.bit[i] == t.day - 1 and t.minute == 30
    assert sum(len(b) for b in suns.blocks(5)) == len({*suns.word[np.isfinite(suns.towards[0, :, 0])]})


def test_saved_suns_are_the_same(tmp_path):
    suns = made_suns()
    suns.save(tmp_path / "suns.npz")
    again = Suns.load(tmp_path / "suns.npz")
    assert np.array_equal(again.towards, suns.towards, equal_nan=True) and again.times == suns.times
    assert (again.word == suns.word).all() and again.notes.keys() == suns.notes.keys()


def test_whole_weights():
    whole, exponent = gnomon._gnomon.round_weights(np.array([0.1, 1e-9, 3.5]))
    assert np.abs(np.ldexp(whole.astype(float), exponent) - [0.1, 1e-9, 3.5]).max() < 1e-15
    assert 2**59 < int(np.abs(whole).sum()) <= 2**62
    assert gnomon._gnomon.round_weights(np.zeros(3))[0].tolist() == [0, 0, 0]


def test_the_disk_of_the_sun():
    towards = np.array([[0.6, 0.0, 0.8], [0.0, 0.0, 1.0]])
    found = samples_of_disks(towards, 200).astype(float).reshape(2, 200, 3)
    found /= np.linalg.norm(found, axis=2, keepdims=True)
    angle = np.degrees(np.arccos(np.minimum((found * towards[:, None]).sum(axis=2), 1)))
    assert angle.max() < 0.533 / 2 and angle.max() > 0.26
    assert np.allclose((angle < 0.533 / 2 / math.sqrt(2)).mean(axis=1), 0.5, atol=0.01), "half of them on half the area"


# ---- Rasters and settings ----------------------------------------------------------------------------------------


def test_a_mosaic_reads_like_one_file(tmp_path):
    heights = np.arange(12.0 * 20).reshape(12, 20)
    heights[5, 7] = np.nan
    whole = open_mosaic((write_raster(tmp_path / "whole.tif", heights),))
    parts = []
    for i, (rows, columns) in enumerate([((0, 7), (0, 20)), ((7, 12), (0, 9)), ((6, 12), (9, 20))]):
        part = heights[slice(*rows), slice(*columns)]
        parts.append(
            write_raster(tmp_path / f"{i}.tif", part, west=512_000 + 25 * columns[0], north=5_002_400 - 25 * rows[0])
        )
    mosaic = open_mosaic(tuple(parts))
    assert (mosaic.rows, mosaic.columns, mosaic.west, mosaic.north) == (12, 20, whole.west, whole.north)
    for window in [(0, 12, 0, 20), (-1, 13, -1, 21), (5, 8, 7, 12)]:
        assert np.array_equal(mosaic.heights(*window), whole.heights(*window), equal_nan=True)
    assert np.isnan(mosaic.heights(-1, 13, -1, 21)[0]).all()


@pytest.mark.parametrize(
    "more, text",
    [
        (dict(raster="nothing.tif"), "nothing.tif: there is no such file"),
        (dict(min_elevation=0), "min_elevation: 0.0 is not between"),
        (dict(step="2 weeks"), "step: '2 weeks' is not a number of minutes"),
        (dict(colour="red"), "colour: there is no such setting"),
        (dict(directions=__file__), "suns: give start and end, or directions, or sky"),
        (dict(outputs=["hours", "pictures"]), r"outputs: \['pictures'\]: must be any of hours, bits, weights"),
        (dict(lattice=0.001), "lattice: the step 0.001 is not a power of two"),
        (dict(end=None), "start, end: one needs the other"),
        (dict(sky=17, start=None, end=None), "sky: 17 is not between 0 and 16"),
        (dict(sun_disk=8, outputs=["bits"]), "a sun disk gives shares"),
        (dict(receivers="points"), 'receivers: "points" needs points='),
        (dict(raster=""), "raster: the name of a file is empty"),
        (dict(utc_offset=27), "utc_offset: 27.0 hours are not between -14 and 14"),
        (dict(utc_offset=float("nan")), "utc_offset: nan is not a finite number"),
        (dict(outside="high"), "outside: 'high' is not a finite number"),
        (dict(mesh_offset=[0, 0, float("nan")]), "mesh_offset: nan is not a finite number"),
        (dict(tile=12.5), "tile: 12.5 is not a whole number"),
        (dict(sky="2", start=None, end=None, tile="many"), "tile: 'many' is not a finite number"),
        (dict(curvature="no"), "curvature: 'no' is neither true nor false"),
        (dict(refraction_of_ground=1), "refraction_of_ground: 1 is not below 1"),
        (dict(pressure=-1), "pressure: -1.0 Pa must not be below 0"),
        (dict(temperature=-300), "temperature: -300.0 C is below absolute zero"),
    ],
)
def test_wrong_settings_are_named(more, text):
    with pytest.raises(ValueError, match=text):
        settings_of(dict(raster=__file__, start="2026-03-20", end="2026-03-21") | more)


def test_a_file_of_settings(tmp_path):
    raster = write_raster(tmp_path / "dsm.tif", np.zeros((3, 3)))
    (tmp_path / "s.toml").write_text('raster = "*.tif"\nstart = 2026-03-20\nend = 2026-03-21\n[run]\nworkers = 2\n')
    settings, of_run = read_toml(tmp_path / "s.toml")
    assert settings == settings_of(dict(raster=raster, start="2026-03-20", end="2026-03-21")) and of_run == {
        "workers": 2
    }
    assert isinstance(settings, Settings) and Path(settings.raster[0]).is_absolute()
    with pytest.raises(ValueError, match="nothing.toml: there is no such file"):
        read_toml(tmp_path / "nothing.toml")
    with pytest.raises(ValueError, match="dsm.tif: is no text in UTF-8"):
        read_toml(raster)


@pytest.mark.parametrize(
    "make, text",
    [
        (lambda f: write_raster(f / "r.tif", np.zeros((3, 3)), crs="EPSG:4326", cell=0.1, west=9, north=47),
         "not metres on a map"),
        (lambda f: write_raster(f / "r.tif", np.zeros((3, 3)), crs=None), "crs: the suns' positions need a CRS"),
        (lambda f: write_suns(f / "r.tif", [(0, 3)]), "r.tif"),
    ],
    ids=["degrees", "no CRS", "no raster"],
)  # fmt: skip
def test_rasters_that_do_not_fit(tmp_path, make, text):
    with pytest.raises(ValueError, match=text):
        gnomon.study(tmp_path / "s", raster=make(tmp_path), start="2026-03-20", end="2026-03-21")
    assert not (tmp_path / "s" / "study.json").exists()


def test_arguments_that_have_no_effect_are_named(tmp_path):
    """min_elevation=60 over a table of suns is meant for something, and does nothing."""
    (tmp_path / "s.csv").write_text("x,y,z\n0,0,-1\n")
    table = dict(raster=__file__, directions=str(tmp_path / "s.csv"))
    for more in (dict(min_elevation=60), dict(step="30min"), dict(utc_offset=1), dict(elevation="apparent"),
                 dict(pressure=9e4), dict(temperature=0)):  # fmt: skip
        (name,) = more
        with pytest.raises(ValueError, match=f"^{name}: is of suns by time, .* no effect on others: leave it out"):
            settings_of(table | more)
    with pytest.raises(ValueError, match="^spacing: is of points on faces"):
        settings_of(table | dict(spacing=2))
    assert settings_of(table | dict(min_elevation=3, spacing=1)).spacing == 1, "the defaults"
    for text, kind in ((dict(step="1.5h"), 90), (dict(step=datetime.timedelta(hours=2)), 120)):
        day = dict(raster=__file__, start="2026-06-21", end="2026-06-22")
        assert settings_of(day | text).step == kind
    with pytest.raises(ValueError, match="utc_offset: '.01:00' is not a finite number: give hours, such as 1 or 5.5"):
        settings_of(day | dict(utc_offset="+01:00"))


def test_folders_and_workers_that_are_none_are_named(tmp_path):
    (tmp_path / "s.csv").write_text("x,y,z\n0,0,-1\n")
    raster = write_raster(tmp_path / "dsm.tif", np.zeros((4, 4)))
    given = dict(raster=raster, directions=str(tmp_path / "s.csv"))
    with pytest.raises(ValueError, match="folder: .*dsm.tif is a file: name a folder"):
        studies.study(raster, **given)
    with pytest.raises(ValueError, match="folder: must be the name of a folder for the study, not None"):
        studies.study(None, **given)
    for workers in (-1, 2.0, True, [1], {"a": 1}):
        with pytest.raises(ValueError, match="workers: .* is no number of processes, nor"):
            studies.study(tmp_path / "study", **given, workers=workers)
    for tiles in (3, (0, 4), "0:4"):
        with pytest.raises(ValueError, match=r"tiles: .* is no slice: slice\(16, 32\) are"):
            studies.study(tmp_path / "study", **given, tiles=tiles)
    assert not (tmp_path / "study").exists()


@pytest.mark.parametrize("unit, high, metres", [("millimetre", 60_000, 60), ("centimetre", 13_000, 130)])
def test_heights_that_no_ground_has_ask_for_their_unit(tmp_path, unit, high, metres):
    """Undeclared millimetres: as metres they cast the shadow of a tower of 60 km, which the lattice must hold."""
    heights = np.zeros((5, 9))
    heights[2, 2] = high
    raster = write_raster(tmp_path / "dsm.tif", heights)
    (tmp_path / "s.csv").write_text("x,y,z\n1,0,-1\n")
    asked = dict(raster=raster, directions=str(tmp_path / "s.csv"), outputs=["bits"])
    with pytest.warns(UserWarning, match="heights: reach .*000 m: if they are no metres, height_unit= says their unit"):
        study = run(tmp_path / "a", **asked)
    assert (study.dataset().lit.values[0, 2] & 1).tolist() == [1] * 3 + [0] * 6
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        study = run(tmp_path / "b", **asked, height_unit=unit)
    dark = metres // 25
    assert (study.dataset().lit.values[0, 2] & 1).tolist() == [1] * 3 + [0] * dark + [1] * (6 - dark)
