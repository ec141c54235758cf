# SPDX-License-Identifier: MIT
"""gnomon.weather: files as they are and as they break; planes against an integral of the patches' radiance and against
pvlib's transposition; obstructed points against rational arithmetic."""

import json
from pathlib import Path

import gnomon
import meshes
import numpy as np
import oracle
import pytest

pvlib = pytest.importorskip("pvlib")
pytest.importorskip("pyradiance")
pandas = pytest.importorskip("pandas")
from gnomon import weather  # noqa: E402
from weather_made import write_epw  # noqa: E402

TMY3 = Path(pvlib.__file__).parent / "data" / "723170TYA.CSV"  # Greensboro, North Carolina
PLANES = [(0, 0), (35, 180), (90, 180), (90, 97), (60, 300), (20, 45), (110, 10)]  # tilt, azimuth


def patches_of_rows():
    """The ends in degrees of each patch, (145, 4): azimuth and elevation, lowest and highest."""
    ends = []
    for row, count in enumerate([30, 30, 24, 24, 18, 12, 6, 1]):
        width = 360 / count
        ends += [(k * width - width / 2, k * width + width / 2, 12 * row, min(12 * row + 12, 90)) for k in range(count)]
    return np.array(ends)


def integrated(radiance, normal, n=20):
    """(T,) what a plane gets of patches of even radiance: an integral by n x n points of equal solid angle."""
    share = (np.arange(n) + 0.5) / n
    of_patch = []
    for west, east, low, high in patches_of_rows():
        s0, s1 = np.sin(np.radians([low, high]))
        elevation = np.degrees(np.arcsin(s0 + share * (s1 - s0)))
        a, e = np.meshgrid(west + share * (east - west), elevation)
        size = np.radians(east - west) * (s1 - s0)
        of_patch.append(size * np.maximum(weather.towards(a, e) @ normal, 0).mean())
    return np.array(of_patch) @ radiance


@pytest.fixture(scope="module")
def greensboro():
    return weather.read(TMY3)


def test_a_tmy3_table_is_read_at_mid_interval(greensboro):
    assert repr(greensboro) == ("<gnomon.weather.Weather of GREENSBORO PIEDMONT TRIAD INT, 36.1, -79.95: 8,760 hours, "
                                "months of 1980 to 2003, UTC-05:00>")  # fmt: skip
    assert str(greensboro.times[0]) == "1988-01-01 00:30:00-05:00"
    assert str(greensboro.times[-1]) == "1980-12-31 23:30:00-05:00"
    # The file's row "01/01/1988,13:00" holds the hour from 12 to 13 o'clock.
    row = next(line for line in TMY3.read_text().splitlines() if line.startswith("01/02/1988,13:00")).split(",")
    at = list(map(str, greensboro.times)).index("1988-01-02 12:30:00-05:00")
    assert [greensboro.ghi[at], greensboro.dni[at], greensboro.dhi[at]] == [float(row[i]) for i in (4, 7, 10)]


def test_noon_is_where_the_sun_culminates(tmp_path):
    made = weather.read(write_epw(tmp_path / "a.epw", longitude=15.0, days=1))
    azimuth, elevation = made.suns()
    assert elevation.argmax() in (11, 12) and 170 < azimuth[elevation.argmax()] < 190


def test_a_southern_site_has_the_sun_in_the_north(tmp_path):
    made = weather.read(write_epw(tmp_path / "a.epw", latitude=-33.9, longitude=18.4, zone=2, days=181))
    north, south = (made.on_plane((0, y, 0)).direct.sum() for y in (1, -1))
    azimuth, elevation = made.suns()
    assert north > 2 * south and abs((azimuth[elevation.argmax()] + 180) % 360 - 180) < 30


def test_a_leap_day_counts(tmp_path):
    leap = weather.read(write_epw(tmp_path / "a.epw", year=2020, days=366))
    assert len(leap.times) == 8784 and str(leap.times[59 * 24]) == "2020-02-29 00:30:00+01:00"
    horizontal = leap.on_plane((0, 0, 1))
    assert np.allclose(horizontal.diffuse, leap.dhi, rtol=1e-6, atol=1e-6)
    assert horizontal.diffuse[59 * 24 : 60 * 24].any()


def test_a_zone_of_half_an_hour(tmp_path):
    """At its longitude the Sun of 12:30 stands half an hour past noon, in pvlib and in gendaymtx."""
    path = write_epw(tmp_path / "a.epw", zone=5, longitude=82.5, days=1)
    path.write_text(path.read_text().replace(",5,170.0", ",5.5,170.0").replace(",5.0,170.0", ",5.5,170.0"))
    made = weather.read(path)
    assert str(made.times[12]) == "2019-01-01 12:30:00+05:30"
    azimuth, elevation = made.suns()
    assert 180 < azimuth[12] < 190
    parts, patch = weather.tregenza()
    brightest = parts[patch == made.radiance()[1:, 12].argmax()].sum(axis=0)
    towards = weather.towards(azimuth[12], elevation[12])
    assert brightest @ towards > np.cos(np.radians(10)) * np.linalg.norm(brightest)


def test_names_with_accents(tmp_path):
    path = write_epw(tmp_path / "a.epw", days=1)
    text = path.read_text().replace("Made", "S\u00e3o Paulo")
    for data in (text.encode("latin-1"), text.encode(), b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode()):
        path.write_bytes(data)
        assert weather.read(path).name == "S\u00e3o Paulo"


def test_the_sky_is_brightest_at_the_sun(greensboro):
    azimuth, elevation = greensboro.suns()
    is_clear = (greensboro.dni > 700) & (elevation > 15)
    radiance = greensboro.radiance()[1:, is_clear]
    west, east, low, high = patches_of_rows()[radiance.argmax(axis=0)].T
    brightest = weather.towards((west + east) / 2, (low + high) / 2)
    off = (brightest * weather.towards(azimuth, elevation)[is_clear]).sum(axis=1)
    assert is_clear.sum() > 500 and np.degrees(np.arccos(off.min())) < 15


def test_the_parts_of_the_patches_fill_the_sky():
    parts, patch = weather.tregenza()
    size = [np.radians(east - west) * (np.sin(np.radians(high)) - np.sin(np.radians(low)))
            for west, east, low, high in patches_of_rows()]  # fmt: skip
    assert np.isclose(parts[:, 2].sum(), np.pi, rtol=1e-12) and np.abs(parts[:, :2].sum(axis=0)).max() < 1e-12
    lengths = np.bincount(patch, np.linalg.norm(parts, axis=1)) / size
    assert lengths.shape == (145,) and (lengths < 1).all() and (lengths > 0.99).all()


@pytest.mark.parametrize("tilt, azimuth", PLANES)
def test_planes_get_the_integral_of_the_sky(greensboro, tilt, azimuth):
    normal = weather.towards(azimuth, 90 - tilt)
    found, expected = greensboro.on_plane(normal), integrated(greensboro.radiance()[1:], normal)
    assert (np.abs(found.diffuse - expected) <= np.maximum(1.0, 0.005 * expected)).all()
    assert np.abs(found.diffuse - expected).max() < 0.3


@pytest.mark.parametrize("tilt, azimuth", PLANES)
def test_planes_against_pvlib(greensboro, tilt, azimuth):
    """Direct is the same where the Sun is up in the middle of the hour. pvlib has Perez' model of tilted planes of
    1990, a sky with three parts; gendaymtx distributes Perez' luminance of 1993 over the patches."""
    sun, elevation = greensboro.suns()
    found = greensboro.on_plane(weather.towards(azimuth, 90 - tilt), albedo=0.2)
    theirs = pvlib.irradiance.get_total_irradiance(
        tilt, azimuth, 90 - elevation, sun, greensboro.dni, greensboro.ghi, greensboro.dhi, model="perez", albedo=0.2,
        dni_extra=pvlib.irradiance.get_extra_radiation(greensboro.times).to_numpy(),
        airmass=pvlib.atmosphere.get_relative_airmass(90 - elevation),
    )  # fmt: skip
    assert np.allclose(found.direct, np.where(elevation > 0, theirs["poa_direct"], 0), rtol=1e-9, atol=1e-9)
    assert np.isclose(found.diffuse.sum(), np.nansum(theirs["poa_sky_diffuse"]), rtol=0.07)
    assert np.isclose(found.ground.sum(), np.nansum(theirs["poa_ground_diffuse"]), rtol=0.03, atol=1000)


@pytest.mark.parametrize("up, north", [("z", 0.0), ("y", 0.0), ("z", 30.0)])
def test_open_points_get_what_planes_get(greensboro, up, north):
    scene = gnomon.Scene([[[0, 0, -900], [1, 0, -900], [0, 1, -900]]])
    normals = weather.towards(np.array([a for _, a in PLANES]), 90.0 - np.array([t for t, _ in PLANES]))
    angle = np.radians(north)
    turned = normals @ np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    in_scene = turned if up == "z" else turned[:, [0, 2, 1]] * [1, 1, -1]
    found = weather.irradiation(scene, np.zeros((len(PLANES), 3)), in_scene, greensboro, albedo=0.3, up=up, north=north)
    for row, normal in enumerate(normals):
        plane = greensboro.on_plane(normal, albedo=0.3)
        parts = [part[row] for part in (found.direct, found.diffuse, found.ground)]
        assert np.allclose(parts, [values.sum() / 1000 for values in plane], rtol=2e-5, atol=1e-3)
        assert found.total[row] == sum(parts)
    azimuth, elevation = greensboro.suns()
    assert np.isclose(found.left_out, greensboro.dni[elevation <= 0].sum() / 1000) and 0 < found.left_out < 20


def test_behind_walls_each_sun_and_part_counts_as_exact_arithmetic_says(tmp_path):
    made = weather.read(write_epw(tmp_path / "a.epw", days=2, year=2021))
    wall = np.array([[[-2, -1, -1], [2, -1, -1], [2, -1, 3]], [[1, -4, 1], [1, 4, 1], [1, 0, 4]]], float)
    points = np.array([[0, 0, 0], [0.5, 0.25, 1], [0.1, -3.2, 0]], float)
    normals = np.array([[0, 0, 1], [0, -0.6, 0.8], [1, 0, 0]])
    found = weather.irradiation(gnomon.Scene(wall), points, normals, made)
    azimuth, elevation = made.suns()
    parts, patch = weather.tregenza()
    sky = made.radiance()[1:].sum(axis=1)[patch]
    size = np.linalg.norm(parts, axis=1)
    directions = [weather.towards(azimuth, elevation)[elevation > 0], parts / size[:, None]]
    energy = [made.dni[elevation > 0], sky * size]
    for values, towards, weights in zip((found.direct, found.diffuse), directions, energy, strict=True):
        for point, normal, value in zip(points, normals, values, strict=True):
            is_lit = [oracle.lit(wall, [point], direction=-d, normals=[normal])[0] for d in towards]
            assert 0 < np.sum(is_lit) < len(is_lit)
            expected = (weights * np.maximum(towards @ normal, 0) * is_lit).sum() / 1000
            assert np.isclose(value, expected, rtol=1e-6)


def test_a_slope_does_not_shadow_itself(tmp_path):
    made = weather.read(write_epw(tmp_path / "a.epw", days=1, year=2021))
    vertices, faces = meshes.grid(20, (1 / 7, 1 / 7), height=lambda x, y: 0.1 * x + 0.2 * y)
    found = weather.irradiation(gnomon.Scene(vertices, faces), vertices[faces].mean(axis=1), [-0.1, -0.2, 1], made)
    plane = made.on_plane([-0.1, -0.2, 1])
    assert np.allclose(found.diffuse, plane.diffuse.sum() / 1000, rtol=1e-5)
    assert np.allclose(found.direct, plane.direct.sum() / 1000, rtol=1e-5) and found.direct.min() > 0


def test_points_of_the_sky_of_a_picture_have_no_energy(tmp_path):
    made = weather.read(write_epw(tmp_path / "a.epw", days=1))
    points = np.array([[0.25, 0.25, 0], [np.nan] * 3])
    found = weather.irradiation(gnomon.Scene([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]]), points, [[0, 0, 1], [0, 0, 0]], made)
    assert np.isfinite(found.total).tolist() == [True, False] and found.total[0] > 0


def test_a_polar_night_has_no_energy(tmp_path):
    made = weather.read(write_epw(tmp_path / "a.epw", latitude=78.2, longitude=15.6, days=5))
    found = weather.irradiation(gnomon.Scene([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]]), [[0.25, 0.25, 0]], [[0, 0, 1]], made)
    assert found.total.tolist() == [0.0] and found.left_out == 0


def test_the_table_of_suns_weighs_direct_irradiation(tmp_path):
    made = weather.read(write_epw(tmp_path / "a.epw", days=3))
    made.write_suns(tmp_path / "suns.csv")
    table = np.genfromtxt(tmp_path / "suns.csv", delimiter=",", names=True, usecols=(0, 1, 2))
    azimuth, elevation = made.suns()
    assert np.allclose(table["weight"], made.dni[elevation > 0])
    assert np.allclose(table["azimuth"], azimuth[elevation > 0])
    rasterio = pytest.importorskip("rasterio")
    with rasterio.open(tmp_path / "flat.tif", "w", driver="GTiff", width=9, height=9, count=1, dtype="float32",
                       transform=rasterio.Affine(1, 0, 0, 0, -1, 9)) as file:  # fmt: skip
        file.write(np.zeros((9, 9), np.float32), 1)
    flat = gnomon.study(tmp_path / "flat", raster=str(tmp_path / "flat.tif"), directions=str(tmp_path / "suns.csv"))
    assert np.allclose(flat.dataset().sum_of_weights.to_numpy()[4, 4], made.dni[elevation > 0].sum(), rtol=1e-6)


def test_a_place_far_away_is_named(greensboro):
    greensboro.require_near(36.3, -80.1)
    there, here = weather.towards([-79.95, 16.4], [36.1, 48.2])
    km = 6371 * np.arccos(there @ here)
    with pytest.raises(ValueError, match=rf"GREENSBORO .* is {km:,.0f} km from the site \(48.2, 16.4\), more than 50"):
        greensboro.require_near(48.2, 16.4)
    with pytest.raises(ValueError, match="nan km from the site"):
        greensboro.require_near(float("nan"), 0)


def off(made, minutes=0):
    """The mean of |ghi - dhi - dni x sin(elevation)|, W/m2, with all moments moved: least where they are right."""
    moved = weather.Weather(**{**vars(made), "times": made.times + pandas.Timedelta(minutes=minutes)})
    _, elevation = moved.suns()
    bright = (elevation > 0) & (made.ghi > 50)
    return np.abs(made.ghi - made.dhi - made.dni * np.sin(np.radians(elevation)))[bright].mean()


def write_pvgis(path, kind, lag=0.1761):
    """A typical year of PVGIS as it writes them: UTC, values of a moment some time after the label."""
    labels = pandas.date_range("2019-01-01", periods=8760, freq="h", tz="UTC")
    zenith = pvlib.solarposition.get_solarposition(labels + pandas.Timedelta(hours=lag), 45, 8)["zenith"]
    beam, sky = np.where(zenith < 88, 600.0, 0), np.where(zenith < 88, 80.0, 0)
    level = beam * np.maximum(np.cos(np.radians(zenith)), 0) + sky
    rows = [{"time(UTC)": f"{t:%Y%m%d:%H%M}", "G(h)": float(g), "Gb(n)": float(b), "Gd(h)": float(d)}
            for t, g, b, d in zip(labels, level, beam, sky, strict=True)]  # fmt: skip
    months = [{"month": month, "year": 2019} for month in range(1, 13)]
    if kind == "json":
        place = {"latitude": 45.0, "longitude": 8.0, "elevation": 250.0, "irradiance_time_offset": lag}
        whole = {"inputs": {"location": place}, "meta": {"inputs": {}},
                 "outputs": {"months_selected": months, "tmy_hourly": rows}}  # fmt: skip
        path.write_text(json.dumps(whole))
    else:
        head = ["Latitude (decimal degrees): 45.000", "Longitude (decimal degrees): 8.000", "Elevation (m): 250.0",
                f"Irradiance Time Offset (h): {lag}", "month,year", *(f"{m},2019" for m in range(1, 13))]  # fmt: skip
        lines = [",".join(map(str, row.values())) for row in rows]
        path.write_text("\n".join([*head, ",".join(rows[0]), *lines, "", "PVGIS (c) European Union"]) + "\n")
    return path


def write_nsrdb(path, minutes=30):
    labels = pandas.date_range("2023-01-01", periods=30 * 1440 // minutes, freq=f"{minutes}min", tz="Etc/GMT+7")
    zenith = pvlib.solarposition.get_solarposition(labels, 40.53, -108.54)["zenith"].to_numpy()
    beam = np.where(zenith < 88, 700, 0)
    level = beam * np.maximum(np.cos(np.radians(zenith)), 0)
    head = ("Source,Location ID,City,State,Country,Latitude,Longitude,Time Zone,Elevation,Local Time Zone\n"
            "NSRDB,401182,-,-,-,40.53,-108.54,-7,1984,-7\nYear,Month,Day,Hour,Minute,DHI,DNI,GHI\n")  # fmt: skip
    rows = [f"{t.year},{t.month},{t.day},{t.hour},{t.minute},0,{b},{g:.3f}\n"
            for t, b, g in zip(labels, beam, level, strict=True)]  # fmt: skip
    path.write_text(head + "".join(rows))
    return path


def test_every_format_has_its_suns_at_the_moments_of_its_values(tmp_path, greensboro):
    tm2 = weather.read(TMY3.with_name("12839.tm2"))
    assert repr(tm2).startswith("<gnomon.weather.Weather of MIAMI, 25.8, -80.2667: 8,760 hours, months of 1961 to 1988")
    assert str(tm2.times[0]) == "1962-01-01 00:30:00-05:00"
    pvgis = [weather.read(write_pvgis(tmp_path / f"tmy.{kind}", kind)) for kind in ("csv", "json")]
    assert str(pvgis[0].times[0])[:19] == "2019-01-01 00:10:33" and (pvgis[0].times == pvgis[1].times).all()
    nsrdb = weather.read(write_nsrdb(tmp_path / "nsrdb.csv"))
    assert nsrdb.step == 0.5 and "1,440 intervals of 30 minutes" in repr(nsrdb)
    for made in (greensboro, tm2, *pvgis, nsrdb):
        at = [off(made, minutes) for minutes in (-30, -5, 0, 5, 30)]
        assert at[2] == min(at) and at[2] < 0.7 * min(at[1], at[3]) and at[2] < 5, repr(made)
    with (tmp_path / "tmy.json").open("rb") as file:
        assert (weather.read(file).dni == pvgis[0].dni).all(), "by what it holds, not by its name"


def test_epw_of_quarters_of_hours(tmp_path):
    def quarters(rows):
        return [[*r[:4], str(15 * (k + 1)), *r[5:]] for r in rows for k in range(4)]

    whole = weather.read(write_epw(tmp_path / "a.epw", days=2))
    made = weather.read(write_epw(tmp_path / "b.epw", days=2, change=quarters))
    assert made.step == 0.25 and str(made.times[5]) == "2019-01-01 01:22:30+01:00"
    level, expected = (w.on_plane((0, 0, 1)).diffuse.sum() * w.step for w in (made, whole))
    assert np.isclose(level, expected, rtol=1e-6) and expected > 0

    def broken(rows):
        rows = quarters(rows)
        rows[6][4] = "50"
        return rows

    with pytest.raises(ValueError, match="row 7 has minute 50, where intervals of 15 minutes end at 45: mend the row"):
        weather.read(write_epw(tmp_path / "c.epw", days=2, change=broken))


def test_files_whose_hours_cannot_be_known_are_refused(tmp_path):
    path = write_epw(tmp_path / "a.epw", days=1)
    path.write_text(path.read_text().replace("COMMENTS 2,", "COMMENTS 2,Irradiance Time Offset (h):-0.8239"))
    with pytest.raises(ValueError, match="PVGIS's EPW files give hours of UTC another time zone: take its CSV or JSON"):
        weather.read(path)
    path.write_text('{"outputs": {"hourly": []}}')
    with pytest.raises(ValueError, match="cannot be read as an EPW file"):
        weather.read(path)
    with pytest.raises(ValueError, match="is no typical year of PVGIS, .*: take its TMY"):
        weather.read(path.rename(tmp_path / "a.json"))
    two_words = TMY3.with_name("12839.tm2").read_text().replace("MIAMI", "MIAMI BEACH")
    (tmp_path / "a.tm2").write_text(two_words)
    with pytest.raises(ValueError, match="write the city's name as one"):
        weather.read(tmp_path / "a.tm2")


def changed(column, row, value):
    def change(rows):
        rows[row][column] = value
        return rows

    return change


@pytest.mark.parametrize(
    "change, says",
    [
        (changed(14, 12, "9999"), r"column dni has 9999 at 2019-01-01 12:00:00\+01:00.*1 of 48 rows"),
        (changed(15, 30, "-3"), "column dhi has -3 at 2019-01-02 06:00"),
        (changed(15, 30, ""), "column dhi has nan at 2019-01-02 06:00"),
        (changed(13, 30, "much"), "column ghi: could not convert"),
        (lambda rows: rows[:-1], "has 47 rows, which are not whole days"),
        (lambda rows: [*rows[:10], rows[9], *rows[11:]], r"the day of row 1 \(01 January\) has not hours 1 to 24"),
        (lambda rows: [*rows, *rows[:24]], "has 01 January 2019 twice, again from row 49 on"),
        (lambda rows: [*rows[:24], *([r[0], "2", "29", *r[3:]] for r in rows[24:])], "day is out of range for month"),
        (lambda rows: [], "has 0 rows"),
        (lambda rows: [row[:9] for row in rows], "cannot be read as an EPW file|column"),
    ],
)
def test_a_broken_file_is_one_sentence(tmp_path, change, says):
    with pytest.raises(ValueError, match=says) as error:
        weather.read(write_epw(tmp_path / "broken.epw", days=2, change=change))
    assert str(error.value).startswith(str(tmp_path)) and "\n" not in str(error.value)


def test_what_is_no_weather_file_is_named(tmp_path):
    with pytest.raises(FileNotFoundError, match="nowhere.epw: does not exist"):
        weather.read("nowhere.epw")
    for name in ("a.epw", "a.csv"):
        (tmp_path / name).write_bytes(b"\0\1\2 nothing\n")
        with pytest.raises(ValueError, match="cannot be read as"):
            weather.read(tmp_path / name)
    scene = gnomon.Scene([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]])
    made = weather.read(write_epw(tmp_path / "b.epw", days=1))
    with pytest.raises(ValueError, match="up: must be 'y' or 'z', not 'x'"):
        weather.irradiation(scene, [[0, 0, 0]], [[0, 0, 1]], made, up="x")
    with pytest.raises(TypeError, match="must be a gnomon.Scene and a Weather of read.*, not Scene and str"):
        weather.irradiation(scene, [[0, 0, 0]], [[0, 0, 1]], "b.epw")
    with pytest.raises(ValueError, match=r"points and normals: shapes \(1, 2\) and \(1, 3\)"):
        weather.irradiation(scene, [[0, 0]], [[0, 0, 1]], made)
    with pytest.raises(ValueError, match="normals: row 0 is zero"):
        weather.irradiation(scene, [[0, 0, 0]], [[0, 0, 0]], made)
    with pytest.raises(ValueError, match="normal: must be three finite numbers"):
        made.on_plane((0, 0, 0))
    with pytest.raises(ValueError, match="albedo: must be from 0 to 1, not 20"):
        weather.irradiation(scene, [[0, 0, 0]], [[0, 0, 1]], made, albedo=20)


def test_files_that_hold_nothing_are_named(tmp_path):
    for data in (b"", b"\0" * 100, b"\r\n \n"):
        (tmp_path / "a.epw").write_bytes(data)
        with pytest.raises(ValueError, match="a.epw: the file is empty: download it again"):
            weather.read(tmp_path / "a.epw")
    with pytest.raises(ValueError, match=f"{tmp_path.name}: is a folder: name the weather file in it"):
        weather.read(tmp_path)
