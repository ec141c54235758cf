# SPDX-License-Identifier: MIT
"""Meshes by tile, receivers that are points or lie on faces, weights, the sun's disk and the sky."""

import json
import math
from pathlib import Path

import gnomon
import numpy as np
import oracle
import pytest
import trimesh
from gnomon.studies.command import main
from gnomon.studies.receivers import points_on_faces
from made import bits, city, run, snapped, triangles_of, write_raster, write_suns
from meshes import box

OFFSET = (512_000.0, 5_000_000.0, 0.0)
SUNS = [(110 + 7 * i, 5 + 3 * i) for i in range(12)]


def houses():
    """Four files of boxes, each 300 m from the next, and a tower of 470 m that stands apart in the fifth."""
    places = [(100, 100), (400, 100), (100, 400), (400, 400)]
    rng = np.random.default_rng(4)
    groups = []
    for x, y in places:
        of_tile = [box(x + 40 * i, y + 37 * j, 20, 15, float(rng.integers(10, 50))) for i in range(3) for j in range(3)]
        groups.append(np.concatenate(of_tile))
    return [*groups, box(2500, 250, 30, 30, 470)]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("meshes")
    for i, (triangles, kind) in enumerate(zip(houses(), ("obj", "ply", "glb", "stl", "obj"), strict=True)):
        corners = triangles.reshape(-1, 3)
        if kind == "glb":  # y is up there
            corners = np.stack([corners[:, 0], corners[:, 2], -corners[:, 1]], axis=1)
        mesh = trimesh.Trimesh(corners, np.arange(len(corners)).reshape(-1, 3), process=False)
        mesh.export(folder / f"{i}.{kind}")
    return folder, [str(p) for p in sorted(folder.glob("[0-4].*"))], write_suns(folder / "suns.csv", SUNS)


@pytest.fixture(scope="module")
def faces(files):
    folder, meshes, suns = files
    return run(
        folder / "faces", meshes=meshes, mesh_offset=OFFSET, receivers="faces", spacing=12, directions=suns, tile=16
    )


def test_points_on_faces_lie_evenly():
    triangle = np.array([[[0, 0, 0], [9, 0, 0], [0, 12, 0]]], float)
    found = points_on_faces(triangle, 4.0)
    assert len(found) == 16, "the longest edge is 15: 4 x 4 equal triangles"
    assert np.allclose(found[:, :3].mean(axis=0), [3, 4, 0]) and (found[:, 3:] == [0, 0, 108]).all()
    assert len(np.unique(found[:, :3], axis=0)) == 16
    assert len(points_on_faces(np.zeros((1, 3, 3)), 1.0)) == 0


def test_faces_equal_a_whole_scene(files, faces):
    """Scene.lit(lift=True) on all files as one mesh answers the same; the tower reaches over 2 km."""
    triangles = np.concatenate(houses()) + OFFSET
    points = np.load(faces.folder / "points.npy")
    assert len(points) > 256 * 2 and len(faces.plan.receivers) >= 3
    lattice = 2.0**faces.plan.exponent
    # STL and glTF hold float32, and so do the boxes' coordinates: the same triangles.
    scene = gnomon.Scene(triangles, lattice=lattice)
    lit = bits(faces)
    for sun in range(len(SUNS)):
        d = -faces.plan.suns.towards[0, sun]
        expected = scene.lit(points[:, :3], direction=d, side=gnomon.Side.normals(points[:, 3:]), lift=True)
        assert (lit[sun] == expected).all(), sun
    assert 0.1 < lit.mean() < 0.9


def test_the_same_bits_for_other_tiles_of_points(files, faces):
    folder, meshes, suns = files
    settings = dict(meshes=meshes[::-1], mesh_offset=OFFSET, receivers="faces", spacing=12, directions=suns)
    again = run(folder / "again", tile=9, zone=300, **settings)
    ours, theirs = (np.load(s.folder / "points.npy") for s in (faces, again))
    one, two = (np.lexsort(p.T) for p in (ours, theirs))
    assert (ours[one] == theirs[two]).all() and (bits(faces)[:, one] == bits(again)[:, two]).all()


def test_a_file_that_cannot_be_read_later(files, faces, monkeypatch):
    """Found by the survey, lost afterwards: what it may shadow is undecided."""
    from gnomon.studies import meshes as mesh_files
    from gnomon.studies.rasters import UnreadableError

    folder, meshes, suns = files
    load = mesh_files.load

    def lost(name):
        if name.endswith("4.obj") and (folder / "lost" / "study.json").exists():
            raise UnreadableError(f"{name}: is lost")
        return load(name)

    points = folder / "points.csv"
    values = [[x, 265.0, 0.5] for x in range(100, 2400, 50)] + np.array(OFFSET)
    np.savetxt(points, values, delimiter=",", header="x,y,z", comments="", fmt="%.17g")
    settings = dict(meshes=meshes, mesh_offset=OFFSET, receivers="points", points=str(points), outputs=["bits"],
                    directions=write_suns(folder / "low.csv", [(90, 15), (270, 40)]))  # fmt: skip
    whole = run(folder / "found", **settings)
    monkeypatch.setattr(mesh_files, "load", lost)
    study = run(folder / "lost", **settings)
    away = 2500 - np.arange(100, 2400, 50)
    shadow = away * math.tan(math.radians(15)) <= 470
    undecided = bits(study, "undecided")
    assert (~bits(whole)[0] & shadow).sum() == shadow.sum() and (undecided[0] >= shadow).all()
    assert not undecided[1].any() and study.record["unread_casters"] == [meshes[4]]
    assert (bits(study)[0] == (bits(whole)[0] & ~undecided[0])).all()


def test_a_file_that_the_survey_cannot_read(files, faces, capsys):
    """It may stand anywhere: no answer is lit, shadows of the others stay, --strict fails. Once it is mended the same
    study ends with the bytes of one that always had it."""
    folder, meshes, suns = files
    points = folder / "anywhere.npy"
    np.save(points, np.load(faces.folder / "points.npy"))
    tower = folder / "tower.obj"
    intact = Path(meshes[4]).read_bytes()
    tower.write_bytes(intact[: len(intact) // 2] + b"\nf 1 2 900")
    settings = dict(meshes=[*meshes[:4], str(tower)], mesh_offset=list(OFFSET), receivers="points", points=str(points),
                    directions=suns, outputs=["bits"])  # fmt: skip
    with pytest.warns(UserWarning, match="tower.obj: cannot be read: .*undecided until it can be read"):
        study = run(folder / "anywhere", **settings)
    assert study.record["unread_casters"] == [str(tower)] and study.plan.exponent == faces.plan.exponent
    without = bits(run(folder / "without", **(settings | dict(meshes=meshes[:4]))))
    assert not bits(study).any() and (bits(study, "undecided") == without).all() and 0.1 < without.mean() < 0.9
    (folder / "anywhere.toml").write_text("\n".join(f"{k} = {json.dumps(v)}" for k, v in settings.items()))
    with pytest.warns(UserWarning, match="tower.obj: cannot be read"):
        assert main(["run", str(folder / "anywhere.toml"), "--strict", "--quiet"]) == 1
    assert "could not read" in capsys.readouterr().err
    tower.write_bytes(intact)
    again = run(folder / "anywhere", **settings)
    assert (bits(again) == bits(faces)).all() and not again.record["undecided"] and not again.record["unread_casters"]


def test_houses_that_stand_on_a_raster(tmp_path):
    """A raster's vertices near walls that stand between them; those within a step of a wall are lifted off it as by
    Scene.lit(side=Side.vertices()). The same for other tiles."""
    heights = np.zeros((24, 30))
    raster = write_raster(tmp_path / "flat.tif", heights, cell=2.0, west=1000.0, north=2000.0, crs=None)
    triangles, vertices = triangles_of(heights, 2.0, 1000.0, 2000.0)
    house = np.concatenate(
        [box(1011, 1971, 10, 8, 12), box(1031.5, 1965.3, 6, 9, 20)]
    )  # its walls pass through vertices
    sheet = np.array(
        [[[1041, 1958, 0], [1041, 1990, 0], [1041, 1990, 5]], [[1041, 1958, 0], [1041, 1990, 5], [1041, 1958, 5]]]
    )
    house = np.concatenate([house, sheet, sheet[:, ::-1] + [8, 0, 0]])  # two thin walls, one with its front to the east
    corners = house.reshape(-1, 3)
    trimesh.Trimesh(corners, np.arange(len(corners)).reshape(-1, 3), process=False).export(tmp_path / "house.ply")
    suns = write_suns(tmp_path / "suns.csv", SUNS)
    settings = dict(raster=raster, meshes=[str(tmp_path / "house.ply")], directions=suns, outputs=["bits"])
    one = run(tmp_path / "one", **settings)
    two = run(tmp_path / "two", tile=7, caster_tile=5, **settings)
    assert one.digests() == two.digests()
    scene = gnomon.Scene(np.concatenate([triangles, house]), lattice=2**-10)
    inside = ((vertices[..., :2] > [1011, 1971]) & (vertices[..., :2] < [1021, 1979])).all(axis=2)
    for sun in range(len(SUNS)):
        d = -one.plan.suns.towards[0, sun]
        expected = scene.lit(vertices, direction=d, side=gnomon.Side.vertices((0, 0, 1)))
        assert (bits(one)[sun] == expected.values).all(), sun
        assert not bits(one)[sun][inside].any()
    assert len(expected.touching) > 10


def test_weights_and_a_year_of_irradiation(tmp_path):
    """Sums of weights are those of the bits; both may be asked for, and a weight that is 0 at night counts nothing."""
    raster = write_raster(tmp_path / "dsm.tif", city(20))
    count = 24 * 3
    weights = np.random.default_rng(1).random(count) * 800
    np.savetxt(tmp_path / "dni.csv", weights, header="dni", comments="", fmt="%.17g")
    study = run(tmp_path / "s", raster=raster, start="2026-04-01", end="2026-04-04", weights=str(tmp_path / "dni.csv"),
                outputs=["bits", "hours", "weights"], block=10)  # fmt: skip
    expected = (bits(study) * weights[:, None, None]).sum(axis=0)
    data = study.dataset()
    assert np.allclose(data.sum_of_weights.values[np.isfinite(data.sum_of_weights.values)],
                       expected[np.isfinite(city(20))], rtol=1e-14)  # fmt: skip
    assert len(study.plan.blocks) > 2 and float(data.undecided_weights.max()) == 0


def test_the_suns_disk_makes_a_penumbra(tmp_path):
    """Behind a straight wall of 100 m the share of the disk that is seen grows over the penumbra's width."""
    heights = np.zeros((60, 8))
    heights[48:50] = 100  # the wall is 24.5 m high above cells of 1 m; the sun is in the south
    raster = write_raster(tmp_path / "wall.tif", heights, cell=4.0)
    settings = dict(raster=raster, start="2026-03-20T11:15Z", end="2026-03-20T11:25Z", step="10min", min_elevation=20)
    point = run(tmp_path / "point", outputs=["hours"], **settings).dataset().sun_hours.values[:, 4]
    study = run(tmp_path / "disk", sun_disk=256, **settings)
    disk = study.dataset().sun_hours.values[:, 4]
    assert set(np.unique(point)) <= {0, np.float32(1 / 6)} and set(point) <= set(np.unique(disk))
    between = (disk > 0) & (disk < 1 / 6 - 1e-6)
    elevation = math.asin(study.plan.suns.towards[0, :, 2].astype(float).mean())
    width = 100 * math.radians(0.533) / math.sin(elevation) ** 2
    assert 0 < between.sum() <= math.ceil(width / 4) + 1
    assert (np.abs(disk - point)[~between] < 1e-6).all()


def test_the_sky_above_flat_ground_and_beside_a_wall(tmp_path):
    """High flat ground sees all of Tregenza's sky; a wall as high as the sky hides its share of the azimuths."""
    heights = np.zeros((41, 41))
    heights[:20] = 3000
    raster = write_raster(tmp_path / "wall.tif", heights, cell=1.0)
    study = run(tmp_path / "sky", raster=raster, sky=2)
    share = study.dataset().sum_of_weights.values
    whole = np.ldexp(float(study.plan.suns.weights.sum()), study.plan.suns.exponent)
    assert 0.999 < whole <= 1.0001 and np.allclose(share[:19], whole)
    for away in (3, 5, 10):  # the wall ends 20 m to both sides; it hides 2 atan(20 / away) of the azimuths
        assert abs(share[20 + away, 20] - (1 - math.atan(20 / away) / math.pi)) < 0.025, away
    assert (np.diff(share[21:40, 20]) >= 0).all()


def test_points_that_nothing_can_shadow_face_by_their_normals(tmp_path):
    """Points high above the only house: no caster is loaded. Whole numbers, so that suns lie in a point's plane."""
    corners = houses()[0].reshape(-1, 3)
    trimesh.Trimesh(corners, np.arange(len(corners)).reshape(-1, 3), process=False).export(tmp_path / "m.obj")
    rng = np.random.default_rng(12)
    normals = rng.integers(-3, 4, (70, 3))
    normals = normals[normals.any(axis=1)]
    towards = np.concatenate([rng.integers(-4, 5, (45, 2)), rng.integers(1, 5, (45, 1))], axis=1)
    np.savetxt(tmp_path / "suns.csv", -towards, delimiter=",", fmt="%d")
    points = np.array(OFFSET) + [100, 100, 5000] + rng.integers(0, 99, normals.shape)
    np.save(tmp_path / "p.npy", np.concatenate([points, normals], axis=1).astype(float))
    study = run(tmp_path / "s", meshes=[str(tmp_path / "m.obj")], mesh_offset=OFFSET, receivers="points",
                points=str(tmp_path / "p.npy"), directions=str(tmp_path / "suns.csv"))  # fmt: skip
    expected = towards @ normals.T
    assert (bits(study) == (expected > 0)).all() and (expected == 0).sum() > 100


def test_bare_points_equal_the_oracle(tmp_path):
    rng = np.random.default_rng(2)
    triangles = houses()[0] + OFFSET
    corners = triangles.reshape(-1, 3) - OFFSET
    trimesh.Trimesh(corners, np.arange(len(corners)).reshape(-1, 3), process=False).export(tmp_path / "m.obj")
    points = np.array(OFFSET) + [90, 90, 0] + rng.random((40, 3)) * [130, 130, 30]
    np.save(tmp_path / "p.npy", points)
    suns = write_suns(tmp_path / "suns.csv", SUNS[::3])
    study = run(tmp_path / "s", meshes=[str(tmp_path / "m.obj")], mesh_offset=OFFSET, receivers="points",
                points=str(tmp_path / "p.npy"), directions=suns)  # fmt: skip
    for sun, d in enumerate(study.plan.suns.towards[0]):
        expected = oracle.lit(snapped(triangles), snapped(points), direction=-d)
        assert bits(study)[sun].tolist() == expected.tolist()
