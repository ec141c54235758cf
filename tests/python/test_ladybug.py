# SPDX-License-Identifier: MIT
"""gnomon.integrations.ladybug in the place of ladybug-radiance's function: its studies, its own Radiance (that of
pyradiance) as the witness, and exact arithmetic on every answer in which the two differ."""

import inspect
import os
import sys
from pathlib import Path

import numpy as np
import oracle
import pytest
from gnomon.integrations import ladybug

pyradiance = pytest.importorskip("pyradiance")
RADIANCE = Path(pyradiance.__file__).parent
with pytest.MonkeyPatch.context() as before_the_import:
    before_the_import.setenv("BINPATH", str(RADIANCE / "bin"))
    before_the_import.setenv("RAYPATH", str(RADIANCE / "lib"))
    intersection = pytest.importorskip("ladybug_radiance.intersection")
    from ladybug.location import Location
    from ladybug.sunpath import Sunpath
    from ladybug.wea import Wea
    from ladybug_geometry.geometry3d import Face3D, Mesh3D, Point3D, Vector3D
    from ladybug_radiance.skymatrix import SkyMatrix
    from ladybug_radiance.study import directsun, radiation

#: Radiance drops a coefficient below 1e-6. That of a source .533 degrees wide is its solid angle times the cosine.
LEAST_COSINE = 1e-6 / (np.pi * np.radians(0.533 / 2) ** 2)
THEIRS = intersection.intersection_matrix
#: Radiance reads float64, gnomon snaps to a lattice: a made scene of halves and quarters is the same for both.
QUARTER = 0.25


def points_of(rows):
    return [Point3D(*row) for row in np.asarray(rows, float).tolist()]


def vectors_of(rows):
    return [Vector3D(*row) for row in np.asarray(rows, float).tolist()]


def directions(count, seed):
    found = np.random.default_rng(seed).normal(size=(count, 3)).astype(np.float32).astype(float)
    return found


def square(low, high, z):
    return [(low, low, z), (high, low, z), (high, high, z), (low, high, z)]


def town(rng):
    """Boxes as meshes of quads, a wall with a window as a face, and a roof of triangles."""
    sides = [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7), (4, 5, 6, 7)]
    context = []
    for _ in range(6):
        x, y, w, d, h = np.round(rng.uniform([-12, -12, 2, 2, 3], [9, 9, 5, 5, 14]) / QUARTER) * QUARTER
        low = [(x, y, 0), (x + w, y, 0), (x + w, y + d, 0), (x, y + d, 0)]
        context.append(Mesh3D(points_of(low + [(a, b, h) for a, b, _ in low]), sides))
    wall = [(-6, 13, 0), (6, 13, 0), (6, 13, 8), (-6, 13, 8)]
    context.append(Face3D(points_of(wall), holes=[points_of([(-2, 13, 2), (2, 13, 2), (2, 13, 6), (-2, 13, 6)])]))
    context.append(Mesh3D(points_of([(-14, -14, 5), (-10, -14, 6), (-12, -10, 5)]), [(0, 1, 2)]))
    return context


def test_the_signature_is_ladybug_radiance_s():
    def shape(function):
        return [(p.name, p.default, p.kind) for p in inspect.signature(function).parameters.values()]

    assert shape(ladybug.intersection_matrix) == shape(THEIRS)


def test_nothing_of_ladybug_is_imported():
    text = Path(inspect.getfile(ladybug)).read_text()
    assert "import ladybug" not in text and "from ladybug" not in text
    code = "import sys, gnomon.integrations.ladybug; print([m for m in sys.modules if m.startswith('ladybug')])"
    assert os.popen(f'{sys.executable} -c "{code}"').read() == "[]\n"


@pytest.mark.parametrize("numericalize", [False, True])
def test_a_roof_is_as_its_edges_say(numericalize):
    roof = Face3D(points_of(square(-1, 1, 2)))
    sensors, up = points_of([(0, 0, 0), (1.125, 0, 0), (0, 0, 3)]), vectors_of([(0, 0, 2)] * 3)
    suns = vectors_of([(0, 0, 1), (3, 0, 3), (0, 0, -1)])
    matrix = ladybug.intersection_matrix(suns, sensors, up, [roof], 0, numericalize)
    expected = np.array([[0, np.sqrt(0.5), 0], [1, np.sqrt(0.5), 0], [1, np.sqrt(0.5), 0]])
    assert matrix.dtype == (np.float64 if numericalize else np.bool_)
    assert np.allclose(matrix, expected if numericalize else expected > 0, rtol=0, atol=1e-15)


@pytest.mark.parametrize("numericalize", [False, True])
def test_radiance_differs_where_it_rounds_alone(numericalize, tmp_path):
    rng = np.random.default_rng(3)
    context = town(rng)
    sensors = np.c_[rng.integers(-60, 60, (400, 2)) / 4 + 0.125, np.zeros(400)]
    up, towards = np.tile([0.0, 0, 1], (400, 1)), directions(300, seed=4)
    towards[:9, 2] = np.linspace(0.001, 0.014, 9) * np.linalg.norm(towards[:9, :2], axis=1)  # low suns
    arguments = vectors_of(towards), points_of(sensors), vectors_of(up), context, 0.0, numericalize
    ours, theirs = ladybug.intersection_matrix(*arguments), THEIRS(*arguments, sim_folder=str(tmp_path))
    assert ours.dtype == theirs.dtype and ours.shape == theirs.shape == (400, 300)
    cosine = towards[:, 2] / np.linalg.norm(towards, axis=1)
    is_dropped = (cosine > 0) & (cosine < LEAST_COSINE)
    assert is_dropped.sum() > 3 and not theirs[:, is_dropped].any() and ours[:, is_dropped].any()
    differs = (ours > 0) != (theirs > 0)
    differs[:, is_dropped] = False
    assert differs.mean() < 1e-3
    if numericalize:
        both = (ours > 0) & (theirs > 0)
        assert np.abs(ours - theirs)[both].max() < 2e-6
    triangles = np.concatenate([ladybug._triangles_of(geometry, 0) for geometry in context])
    step = 2.0**-18  # the finest that holds a scene of 32 m: a sensor stands less than 4 of them above the ground
    for row, column in np.argwhere(differs)[:40]:
        lifts = [oracle.lit(triangles, [sensors[row] + [0, 0, k * step]], direction=-towards[column]) for k in (0, 4)]
        assert ours[row, column] in np.concatenate(lifts) > 0
    at_random = np.argwhere(cosine > LEAST_COSINE)[:60, 0]
    rows = rng.integers(0, 400, 60)
    for row, column in zip(rows, at_random, strict=True):
        lit = [oracle.lit(triangles, [sensors[row] + [0, 0, k * step]], direction=-towards[column])[0] for k in (0, 4)]
        assert (ours[row, column] > 0) in lit


def test_a_study_of_direct_sun_runs_on_it(monkeypatch, tmp_path):
    path = Sunpath.from_location(Location("", latitude=48.2, longitude=16.4, time_zone=1))
    suns = [sun.sun_vector for hour in range(7, 18) if (sun := path.calculate_sun(6, 21, hour)).is_during_day]
    x, y = np.meshgrid(np.arange(-12, 13), np.arange(-12, 13), indexing="ij")
    corners = points_of(np.stack([x, y, 0 * x], -1).reshape(-1, 3))
    faces = [(25 * i + j, 25 * i + j + 25, 25 * i + j + 26, 25 * i + j + 1) for i in range(24) for j in range(24)]
    mesh = Mesh3D(corners, faces)
    context = [*town(np.random.default_rng(5)), mesh]  # the ground itself is context, as in Ladybug's components

    def hours():
        return np.array(directsun.DirectSunStudy(suns, mesh, context, offset_distance=0.01,
                                                 sim_folder=str(tmp_path)).direct_sun_hours)  # fmt: skip

    theirs = hours()
    monkeypatch.setattr(directsun, "intersection_matrix", ladybug.intersection_matrix)
    ours = hours()
    assert len(suns) == 11 and ours.max() == 11 and ours.min() < 6
    assert (ours != theirs).sum() <= 6 and np.abs(ours - theirs).max() <= 1
    study = directsun.DirectSunStudy(suns, mesh, context, by_vertex=True)
    assert study.draw() and len(study.direct_sun_hours) == 625  # no offset: the ground does not shadow itself
    assert np.max(study.direct_sun_hours) == 11


def test_a_slope_does_not_shadow_its_own_sensors():
    x, y = np.meshgrid(np.arange(31) / 7, np.arange(31) / 7, indexing="ij")
    corners = points_of(np.stack([x, y, 0.3 * x + 0.7 * y], -1).reshape(-1, 3))
    faces = [(31 * i + j, 31 * i + j + 31, 31 * i + j + 32, 31 * i + j + 1) for i in range(30) for j in range(30)]
    slope = Mesh3D(corners, faces)
    suns = directions(100, seed=6)
    towards = vectors_of(suns[suns @ [-0.3, -0.7, 1] > 0.2 * np.linalg.norm(suns, axis=1)])
    assert len(towards) > 20
    assert ladybug.intersection_matrix(towards, slope.face_centroids, slope.face_normals, [slope]).all()


def test_a_study_of_radiation_runs_on_it(monkeypatch, tmp_path):
    sky = SkyMatrix(Wea.from_ashrae_clear_sky(Location("", latitude=33.9, longitude=-118.4, time_zone=-8)))
    wall = Mesh3D(points_of([(0, 0, 0), (2, 0, 0), (2, 0, 2), (0, 0, 2), (4, 0, 0), (4, 0, 2)]),
                  [(0, 1, 2, 3), (1, 4, 5, 2)])  # fmt: skip
    context = [Face3D(points_of([(-1, -2, 3), (2, -2, 3), (2, 0, 3), (-1, 0, 3)]))]

    def values():
        return np.array(radiation.RadiationStudy(sky, wall, context, sim_folder=str(tmp_path)).radiation_values)

    theirs = values()
    monkeypatch.setattr(intersection, "intersection_matrix", ladybug.intersection_matrix)
    ours = values()
    assert np.allclose(ours, theirs, rtol=1e-5) and ours[0] < 0.9 * ours[1]


def test_nothing_to_see():
    sensors, up = points_of([(0, 0, 0)]), vectors_of([(0, 0, 1)])
    assert ladybug.intersection_matrix([], sensors, up, []).shape == (1, 0)
    assert ladybug.intersection_matrix(up, [], [], []).shape == (0, 1)
    assert ladybug.intersection_matrix(up, sensors, up, []).tolist() == [[True]]
    assert ladybug.intersection_matrix(up, sensors, vectors_of([(0, 0, 0)]), []).tolist() == [[False]]


def test_a_concave_quad_is_cut_inside():
    arrow = Mesh3D(points_of([(0, 0, 1), (2, 0, 1), (0.5, 0.5, 1), (0, 2, 1)]), [(0, 1, 2, 3)])
    dart = Mesh3D(points_of([(2, 0, 1), (0.5, 0.5, 1), (0, 2, 1), (0, 0, 1)]), [(0, 1, 2, 3)])
    sensors = points_of([(0.25, 0.25, 0), (1, 0.125, 0), (0.125, 1, 0), (0.75, 0.75, 0)])
    up = vectors_of([(0, 0, 1)] * 4)
    for shape in (arrow, dart):
        seen = ladybug.intersection_matrix(vectors_of([(0, 0, 1)]), sensors, up, [shape])
        assert seen[:, 0].tolist() == [False, False, False, True]


@pytest.mark.parametrize(
    "wrong, error, says",
    [
        (dict(points=[(0, 0, 0)]), TypeError, "points: must be ladybug_geometry's"),
        (dict(normals=[]), ValueError, "normals: 0 for 1 points"),
        (dict(points=[Point3D(0, float("nan"), 0)]), ValueError, "points: row 0"),
        (dict(context_geometry=["a roof"]), TypeError, "context_geometry: row 0 is a str"),
        (dict(vectors=[Vector3D(0, 0, 0)]), ValueError, "directions: row 0"),
    ],
)
def test_what_is_wrong_is_named(wrong, error, says):
    right = dict(vectors=vectors_of([(0, 0, 1)]), points=points_of([(0, 0, 0)]), normals=vectors_of([(0, 0, 1)]),
                 context_geometry=[])  # fmt: skip
    with pytest.raises(error, match=says):
        ladybug.intersection_matrix(**(right | wrong))
