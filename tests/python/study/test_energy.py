# SPDX-License-Identifier: MIT
"""Studies with a weather file: open planes on several maps, walls and houses by rational arithmetic, tiles, errors."""

import json
import sys

import numpy as np
import pytest
import rasterio
from made import city, exactly_lit, run, triangles_of, write_raster

pvlib = pytest.importorskip("pvlib")
pytest.importorskip("pyradiance")
pyproj = pytest.importorskip("pyproj")
from gnomon import weather  # noqa: E402
from gnomon.studies.command import main  # noqa: E402
from weather_made import write_epw  # noqa: E402

VIENNA = {"latitude": 48.2, "longitude": 16.4}
#: A CRS, and a place with its time zone.
MAPS = [("EPSG:32633", 48.2, 16.4, 1), ("EPSG:3857", 64.1, -21.9, 0), ("EPSG:32734", -33.9, 18.4, 2)]


def plane_on(tmp_path, crs, latitude, longitude, slope=(-0.25, 0.5)):
    """The file of a plane whose height grows by `slope` for a metre east and north on the map; and its normal on the
    true ground, by PROJ's factors: a conformal map turns by the convergence and stretches."""
    west, north = pyproj.Transformer.from_crs("EPSG:4326", crs, always_xy=True).transform(longitude, latitude)
    west, north = 25 * np.floor(west / 25), 25 * np.floor(north / 25)
    row, column = np.mgrid[:7, :9]
    heights = 400 + 25 * (slope[0] * column - slope[1] * row)
    assert (heights == heights.astype(np.float32)).all()
    raster = write_raster(tmp_path / "plane.tif", heights, west=west, north=north, crs=crs)
    projection = pyproj.Proj(crs)
    factors = projection.get_factors(longitude, latitude)
    turn, stretch = np.radians(factors.meridian_convergence), factors.meridional_scale
    if crs == "EPSG:3857":  # PROJ's factors are those of its sphere; on the ellipsoid east and north differ a little
        e2, sine = 0.00669437999014, np.sin(np.radians(latitude))
        n = np.sqrt(1 - e2 * sine**2)
        stretches = np.array([n, n**3 / (1 - e2)]) / np.cos(np.radians(latitude))
    else:
        stretches = np.array([stretch, stretch])
    east = slope[0] * np.cos(turn) + slope[1] * np.sin(turn)
    up = slope[1] * np.cos(turn) - slope[0] * np.sin(turn)
    return raster, np.array([-east * stretches[0], -up * stretches[1], 1])


@pytest.mark.parametrize("crs, latitude, longitude, zone", MAPS)
def test_open_planes_get_what_weather_and_pvlib_say(tmp_path, crs, latitude, longitude, zone):
    raster, normal = plane_on(tmp_path, crs, latitude, longitude)
    epw = write_epw(tmp_path / "a.epw", latitude=latitude, longitude=longitude, zone=zone)
    found = run(tmp_path / "study", raster=raster, weather=str(epw), zone=1000.0).dataset()  # as north turns on the map
    made = weather.read(epw)
    plane = made.on_plane(normal)
    for name, expected in (("direct", plane.direct.sum()), ("diffuse", plane.diffuse.sum()),
                           ("irradiation", plane.direct.sum() + plane.diffuse.sum())):  # fmt: skip
        assert np.allclose(found[name].values[1:-1, 1:-1], expected / 1000, rtol=5e-5), name
        assert (found[f"undecided_{name}"].values == 0).all()
    azimuth, elevation = made.suns()
    tilt = np.degrees(np.arccos(normal[2] / np.linalg.norm(normal)))
    beam = pvlib.irradiance.beam_component(
        tilt, np.degrees(np.arctan2(normal[0], normal[1])), 90 - elevation, azimuth, made.dni
    )
    assert np.isclose(found.direct.values[3, 4], beam[elevation > 0].sum() / 1000, rtol=1e-4)


@pytest.mark.parametrize("hour, slope", [(9, (0.0, 0.0)), (12, (-0.25, 0.5)), (14, (0.25, 0.0))])
def test_hour_by_hour(tmp_path, hour, slope):
    """A file with the power of one hour alone: within .1 Wh/m2 of what the library says of its plane."""
    raster, normal = plane_on(tmp_path, "EPSG:32633", **VIENNA, slope=slope)

    def dark(rows):
        for row in rows:
            row[13:16] = row[13:16] if int(row[3]) == hour + 1 else ["0", "0", "0"]
        return rows

    epw = write_epw(tmp_path / "a.epw", days=1, change=dark)
    found = run(tmp_path / "study", raster=raster, weather=str(epw)).dataset()
    plane = weather.read(epw).on_plane(normal)
    assert plane.diffuse[hour] > 5 and plane.direct[hour] > 50
    assert np.abs(1000 * found.direct.values[1:-1, 1:-1] - plane.direct[hour]).max() < 0.1
    assert np.abs(1000 * found.diffuse.values[1:-1, 1:-1] - plane.diffuse[hour]).max() < 0.1


def test_a_town_by_rational_arithmetic(tmp_path):
    heights = city(16)
    raster = write_raster(tmp_path / "dsm.tif", heights, crs=None)
    epw = write_epw(tmp_path / "a.epw", days=172, change=lambda rows: rows[-24:])
    found = run(tmp_path / "study", raster=raster, weather=str(epw)).dataset()
    made = weather.read(epw)
    azimuth, elevation = made.suns()
    parts, patch = weather.tregenza()
    size = np.linalg.norm(parts, axis=1)
    lights = {
        "direct": (weather.towards(azimuth, elevation)[elevation > 0], made.dni[elevation > 0]),
        "diffuse": (parts / size[:, None], made.radiance()[1:].sum(axis=1)[patch] * size),
    }
    triangles, vertices = triangles_of(heights, 25.0, 512_000.0, 5_002_400.0)
    some = dict.fromkeys(lights, 0)
    for r, c in ((4, 5), (9, 12)):
        around = triangles[(triangles == vertices[r, c]).all(axis=2).any(axis=1)]
        assert len(around) == 6
        normal = np.cross(around[:, 1] - around[:, 0], around[:, 2] - around[:, 0]).sum(axis=0)
        for name, (towards, energy) in lights.items():
            cosines = np.maximum(towards @ normal / np.linalg.norm(normal), 0)
            is_lit = [cos > 0 and w > 0 and exactly_lit(triangles, vertices[r, c], t.astype(np.float32))
                      for t, cos, w in zip(towards, cosines, energy, strict=True)]  # fmt: skip
            some[name] += 0 < np.sum(is_lit) < (cosines > 0).sum()
            assert np.isclose(found[name].values[r, c], (energy * cosines)[is_lit].sum() / 1000, rtol=1e-5)
    assert min(some.values()) > 0


def test_points_and_faces_have_their_normals(tmp_path):
    raster, _ = plane_on(tmp_path, "EPSG:32633", slope=(0.0, 0.0), **VIENNA)
    with rasterio.open(raster) as file:
        x, y = file.xy(3, 4)
    normals = np.array([[0, 0, 1], [0, -1, 0], [0, 1, 0], [1, 0, 1]], float)
    points = np.column_stack([np.full(4, x), np.full(4, y), np.full(4, 900.0), normals])
    np.save(tmp_path / "points.npy", points)
    epw = write_epw(tmp_path / "a.epw", days=31)
    common = {"raster": raster, "weather": str(epw), "receivers": "points"}
    found = run(tmp_path / "points", points=str(tmp_path / "points.npy"), **common).dataset()
    made = weather.read(epw)
    turn = np.radians(pyproj.Proj("EPSG:32633").get_factors(*pyproj.Proj("EPSG:32633")(x, y, inverse=True))
                      .meridian_convergence)  # fmt: skip
    for i, (east, north, up) in enumerate(normals):
        true = (east * np.cos(turn) + north * np.sin(turn), north * np.cos(turn) - east * np.sin(turn), up)
        plane = made.on_plane(true)
        assert np.isclose(found.direct.values[i], plane.direct.sum() / 1000, rtol=3e-4, atol=1e-4)
        if up:  # the wall's ground lies below it, and the sky reaches down to the horizon
            assert np.isclose(found.diffuse.values[i], plane.diffuse.sum() / 1000, rtol=1e-2)
    np.save(tmp_path / "bare.npy", points[:, :3])
    bare = run(tmp_path / "bare", points=str(tmp_path / "bare.npy"), **common).dataset()
    assert (bare.irradiation.values == found.irradiation.values[0]).all(), "they look up"


def test_tiles_and_blocks_change_no_bit(tmp_path):
    raster = write_raster(tmp_path / "dsm.tif", city(16), crs=None)
    epw = write_epw(tmp_path / "a.epw", days=2)
    whole = run(tmp_path / "whole", raster=raster, weather=str(epw))
    parts = run(tmp_path / "parts", raster=raster, weather=str(epw), tile=7, caster_tile=9, block=100)
    assert whole.digests() == parts.digests()
    assert len(parts.plan.tasks) > 2 * len(whole.plan.tasks)
    assert parts.verify(share=0.2).is_good
    for output in ("direct", "irradiation"):
        alone = run(tmp_path / output, raster=raster, weather=str(epw), outputs=[output])
        assert alone.digests() == {k: v for k, v in whole.digests().items() if k.endswith(output)}


def test_a_polar_night_and_a_changed_file(tmp_path):
    """Nothing, and not an error; another file under the same name is one."""
    raster, _ = plane_on(tmp_path, "EPSG:32633", 78.2, 15.6)
    epw = write_epw(tmp_path / "a.epw", latitude=78.2, longitude=15.6, days=2)
    for outputs in (["direct"], ["irradiation"]):
        night = run(tmp_path / outputs[0], raster=raster, weather=str(epw), outputs=outputs)
        assert (night.dataset()[outputs[0]].values == 0).all()
    write_epw(epw, latitude=78.2, longitude=15.6, days=3)
    with pytest.raises(ValueError, match="a.epw: has changed since the study began"):
        run(tmp_path / "direct", raster=raster, weather=str(epw), outputs=["direct"])


def test_undecided_light_is_a_sum_of_its_own(tmp_path):
    raster = write_raster(tmp_path / "dsm.tif", city(24), crs=None)
    epw = write_epw(tmp_path / "a.epw", days=2)
    free = run(tmp_path / "free", raster=raster, weather=str(epw)).dataset()
    bound = run(tmp_path / "bound", raster=raster, weather=str(epw), outside=900.0).dataset()
    low, more = bound.irradiation.values, bound.undecided_irradiation.values
    there = np.isfinite(low)
    assert (more[there] > 0).any()
    assert np.allclose((low + more)[there], free.irradiation.values[there], rtol=0, atol=1e-9)


def test_the_command_writes_a_map_and_a_picture(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    plane_on(tmp_path, "EPSG:32633", slope=(0.0, 0.0), **VIENNA)
    (tmp_path / "roof.toml").write_text('raster = "plane.tif"\n')
    write_epw(tmp_path / "a.epw", days=1)
    assert main(["run", "roof.toml", "--epw", "a.epw"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["suns"]["weather"] == "'Made, 48.2, 16.4: 24 hours, 2019, UTC+01:00'"
    assert main(["export", "roof", "roof.tif"]) == 0 and main(["picture", "roof", "roof.png"]) == 0
    assert main(["export", "roof", "diffuse.tif", "--what", "diffuse"]) == 0
    assert main(["export", "roof", "suns.csv", "--what", "suns"]) == 0
    with rasterio.open(tmp_path / "roof.tif") as file, rasterio.open(tmp_path / "diffuse.tif") as other:
        assert "kWh/m²" in file.descriptions[0] and (file.read(1) > other.read(1)).all()
    suns = (tmp_path / "suns.csv").read_text().splitlines()
    assert len(suns) == 1 + int((weather.read(tmp_path / "a.epw").dni > 0).sum())
    assert (tmp_path / "roof.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    "more, says",
    [
        ({"start": "2026-01-01", "end": "2026-01-02"}, "start and end, or directions, or sky, or weather: one of them"),
        ({"outputs": ["hours"]}, 'outputs: weather= gives "irradiation", "direct" and "diffuse"'),
        ({"weather": None, "directions": "a.epw", "outputs": ["direct"]}, "and these need weather="),
        ({"weather": "none.epw"}, "none.epw: there is no such file"),
        ({"weights": "a.epw"}, "weights: one per sun of start..end"),
    ],
)
def test_settings_without_a_meaning(tmp_path, monkeypatch, more, says):
    monkeypatch.chdir(tmp_path)
    raster, _ = plane_on(tmp_path, "EPSG:32633", **VIENNA)
    write_epw(tmp_path / "a.epw", days=1)
    with pytest.raises(ValueError, match=says) as error:
        run(tmp_path / "study", **{"raster": raster, "weather": "a.epw"} | more)
    assert "\n" not in str(error.value)


def test_a_far_or_broken_file_and_no_pyradiance_are_one_sentence(tmp_path, monkeypatch):
    raster, _ = plane_on(tmp_path, "EPSG:32633", **VIENNA)
    far = write_epw(tmp_path / "far.epw", latitude=-48.2, longitude=16.4, days=1)
    with pytest.raises(ValueError, match=r"Made \(-48.2, 16.4\) is 10,7\d\d km from the site \(48.1992, 16.4"):
        run(tmp_path / "far", raster=raster, weather=str(far))
    broken = write_epw(tmp_path / "broken.epw", days=1, change=lambda rows: rows[:-1])
    with pytest.raises(ValueError, match="has 23 rows, which are not whole days"):
        run(tmp_path / "broken", raster=raster, weather=str(broken))
    near = write_epw(tmp_path / "near.epw", days=1)
    monkeypatch.setitem(sys.modules, "pyradiance", None)
    with pytest.raises(ValueError, match=r'needs pyradiance: pip install .*, or give outputs=\["direct"\]'):
        run(tmp_path / "near", raster=raster, weather=str(near))
    alone = run(tmp_path / "near", raster=raster, weather=str(near), outputs=["direct"])
    assert (alone.dataset().direct.values > 0).all()
