# SPDX-License-Identifier: MIT
"""CityJSON: a made file, read by gnomon and by hand."""

import json
from fractions import Fraction

import gnomon
import numpy as np
import pytest
from gnomon.studies import cityjson
from gnomon.studies.meshes import load
from gnomon.studies.rasters import UnreadableError
from made import bits, run, write_suns

SCALE, TRANSLATE = [0.001, 0.001, 0.01], [691_000.5, 5_334_000.25, 480.0]
SUNS = [(100 + 17 * i, 8 + 4 * i) for i in range(10)]


def ints(points):
    """Metres from (691 000, 5 334 000, 480) to the file's whole numbers."""
    near = np.array([691_000.0, 5_334_000.0, 480.0])
    return [[round((p + n - t) / s) for p, n, t, s in zip(q, near, TRANSLATE, SCALE, strict=True)] for q in points]


def prism(ring, bottom, top, hole=()):
    """A solid's shell over a ring (counter-clockwise from above) and a hole (clockwise): corners, then surfaces."""
    corners, surfaces, caps = [], [], ([], [])
    for loop in (ring, hole):
        n, first = len(loop), len(corners)
        corners += [(x, y, bottom) for x, y in loop] + [(x, y, top) for x, y in loop]
        low, high = range(first, first + n), range(first + n, first + 2 * n)
        surfaces += [[[low[i], low[(i + 1) % n], high[(i + 1) % n], high[i]]] for i in range(n)]
        if n:
            caps[0].append([*low][::-1])
            caps[1].append([*high])
    return corners, [*surfaces, *caps]


def shifted(boundaries, by):
    return [shifted(b, by) for b in boundaries] if isinstance(boundaries, list) else boundaries + by


RING = [(0, 0), (40, 0), (40, 25), (20, 25), (20, 40), (10, 40), (0, 40)]  # an L; (10, 40) lies on a straight edge
COURT = [(5, 5), (5, 15), (15, 15), (15, 5)]


def made_file():
    house, shell = prism(RING, 0, 12.5, COURT)
    tower, tower_shell = prism([(60, 10), (70, 10), (70, 20), (60, 20)], 0, 55)
    lower, lower_shell = prism(RING, 0, 99)  # a coarser level of the same house, which must not count
    corners = house + tower + lower + [(100, 0, 0), (130, 0, 0), (130, 30, 8), (100, 30, 8), (80, 50, 0)]
    n, m = len(house), len(house) + len(tower)
    end = m + len(lower)
    box, box_shell = prism([(0, 0), (1, 0), (1, 1), (0, 1)], 0, 1)
    turned = [0, -6, 0, 2, 6, 0, 0, 1, 0, 0, 10, 0, 0, 0, 0, 1]  # a quarter turn, 6 x 6 x 10 m, moved by (2, 1, 0)
    return {
        "type": "CityJSON",
        "version": "2.0",
        "transform": {"scale": SCALE, "translate": TRANSLATE},
        "geometry-templates": {
            "templates": [{"type": "MultiSurface", "lod": "2", "boundaries": box_shell}],
            "vertices-templates": [list(map(float, c)) for c in box],
        },
        "CityObjects": {
            "house": {"type": "Building", "children": ["part"], "geometry": [
                {"type": "Solid", "lod": "1.2", "boundaries": [shifted(lower_shell, m)]}]},
            "part": {"type": "BuildingPart", "parents": ["house"], "geometry": [
                {"type": "Solid", "lod": "1.3", "boundaries": [shifted(lower_shell, m)]},
                {"type": "Solid", "lod": "2.2", "boundaries": [shell]}]},
            "tower": {"type": "Building", "geometry": [
                {"type": "CompositeSolid", "lod": "2", "boundaries": [[shifted(tower_shell, n)]]}]},
            "slope": {"type": "TINRelief", "geometry": [
                {"type": "CompositeSurface", "lod": "1", "boundaries": [[[end, end + 1, end + 2, end + 3]]]}]},
            "tree": {"type": "SolitaryVegetationObject", "geometry": [
                {"type": "GeometryInstance", "template": 0, "boundaries": [end + 4], "transformationMatrix": turned}]},
            "line": {"type": "Road", "geometry": [{"type": "MultiLineString", "lod": "0", "boundaries": [[0, 1]]}]},
        },
        "vertices": ints(corners),
    }  # fmt: skip


def by_hand():
    """The same triangles without the file: rectangles cut by hand."""

    def quad(a, b, c, d):
        return [[a, b, c], [a, c, d]]

    found = []
    for ring, top in ((RING, 12.5), (COURT, 12.5), ([(60, 10), (70, 10), (70, 20), (60, 20)], 55)):
        for (x, y), (u, v) in zip(ring, [*ring[1:], ring[0]], strict=True):
            found += quad((x, y, 0), (u, v, 0), (u, v, top), (x, y, top))
    roofs = [(0, 0, 40, 5), (0, 5, 5, 15), (15, 5, 40, 15), (0, 15, 40, 25), (0, 25, 20, 40)]
    for x0, y0, x1, y1, z in [(*r, z) for r in roofs for z in (0, 12.5)] + [(60, 10, 70, 20, z) for z in (0, 55)]:
        found += quad((x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z))
    found += quad((100, 0, 0), (130, 0, 0), (130, 30, 8), (100, 30, 8))
    x0, y0, x1, y1 = 76, 51, 82, 57  # (0..6, 0..6) turned to (-6..0, 0..6), by (2, 1), from (80, 50)
    ring = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    for (x, y), (u, v) in zip(ring, [*ring[1:], ring[0]], strict=True):
        found += quad((x, y, 0), (u, v, 0), (u, v, 10), (x, y, 10))
    for z in (0, 10):
        found += quad(*((x, y, z) for x, y in ring))
    return np.array(found, float) + [691_000.0, 5_334_000.0, 480.0]


@pytest.fixture(scope="module")
def city(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cityjson")
    path = folder / "made.city.json"
    path.write_text(json.dumps(made_file()))
    return path


def area(triangles):
    return np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1) / 2


def test_coordinates_and_areas_are_those_by_hand(city):
    found, expected = cityjson.load(str(city)).triangles, by_hand()
    assert abs(area(found).sum() - area(expected).sum()) < 1e-4 and len(found) > 60
    exact = {
        tuple(Fraction(v) * Fraction(s) + Fraction(t) for v, s, t in zip(p, SCALE, TRANSLATE, strict=True))
        for p in made_file()["vertices"]
    }
    for corner in found.reshape(-1, 3)[:-36]:  # the instance comes last
        assert min(max(abs(float(a) - b) for a, b in zip(p, corner, strict=True)) for p in exact) < 2e-9
    roof = (found[..., 2] == 492.5).all(axis=1)
    assert abs(area(found[roof]).sum() - (40 * 25 + 20 * 15 - 100)) < 1e-5
    assert (np.cross(found[roof][:, 1] - found[roof][:, 0], found[roof][:, 2] - found[roof][:, 0])[:, 2] > 0).all()
    assert (np.abs(found[roof] - [691_010, 5_334_040, 492.5]).max(axis=2) < 1e-6).any(), (
        "a corner on a straight edge stays"
    )


def test_a_study_equals_a_scene_by_hand(city):
    """Points around and above the houses: the two surfaces are the same, however they are cut into triangles."""
    rng = np.random.default_rng(8)
    points = np.array([691_000.0, 5_334_000.0, 480.0]) + [-30, -20, -2] + rng.random((900, 3)) * [170, 90, 14]
    np.save(city.parent / "points.npy", points)
    study = run(city.parent / "study", meshes=[str(city)], receivers="points", points=str(city.parent / "points.npy"),
                directions=write_suns(city.parent / "suns.csv", SUNS), outputs=["bits"])  # fmt: skip
    scene = gnomon.Scene(by_hand(), lattice=2.0**study.plan.exponent)
    lit = bits(study)
    for sun, d in enumerate(study.plan.suns.towards[0]):
        assert (lit[sun] == scene.lit(points, direction=-d)).all(), sun
    assert 0.2 < lit.mean() < 0.9


def test_a_sequence_of_features_is_the_same(city):
    whole = made_file()
    lines = [{k: v for k, v in whole.items() if k != "CityObjects"} | {"CityObjects": {}, "vertices": []}]
    families = [["house", "part"], ["tower"], ["slope"], ["tree"], ["line"]]
    for names in families:
        objects = {name: whole["CityObjects"][name] for name in names}
        feature = {"type": "CityJSONFeature", "id": names[0], "CityObjects": objects, "vertices": whole["vertices"]}
        lines.append(feature)
    path = city.parent / "made.city.jsonl"
    path.write_text("\n".join(map(json.dumps, lines)) + "\n")
    assert (cityjson.load(str(path)).triangles == cityjson.load(str(city)).triangles).all()


@pytest.mark.parametrize(
    ("change", "text"),
    [(lambda f: f.update(type="FeatureCollection"), 'its "type" is not "CityJSON"'),
     (lambda f: f.update(version="3.0"), """its "version" is '3.0', and those from 1.0 to 2.0 are read"""),
     (lambda f: f.update(vertices=f["vertices"][:20]), "names no vertex of 20"),
     (lambda f: f.pop("CityObjects"), "CityObjects")],
)  # fmt: skip
def test_a_wrong_file_is_named(city, change, text):
    broken = made_file()
    change(broken)
    path = city.parent / "wrong.json"
    path.write_text(json.dumps(broken))
    with pytest.raises(UnreadableError, match=f"wrong.json: cannot be read: .*{text}"):
        load(str(path))


def test_polygons_without_an_area_have_no_triangles():
    assert len(cityjson.triangulated([])) == len(cityjson.triangulated([np.zeros((2, 3))])) == 0
    assert len(cityjson.triangulated([np.array([[0, 0, 0], [1, 1, 1], [2, 2, 2]], float)])) == 0
