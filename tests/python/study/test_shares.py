# SPDX-License-Identifier: MIT
"""gnomon-study shares: closed forms in every format, suns by table, place and weather file, and bad input."""

import csv
import json
import re
from pathlib import Path

import numpy as np
import pygltflib
import pyproj
import pytest
from gnomon.studies import polygons, shares
from gnomon.studies.command import main

WALL = [(-2, 0, 0), (2, 0, 0), (2, 0, 3), (-2, 0, 3)]  # looks south
ROOF = [(-64, -1, 3), (64, -1, 3), (64, 0, 3), (-64, 0, 3)]  # sticks out by 1 above it, as far to both sides as needed
SUNS = "time,x,y,z,up\nsteep,0,1,-4,z\nnoon,0,1,-1,z\nbehind,0,-1,-1,z\n"
YEAR = Path(pytest.importorskip("pvlib").__file__).parent / "data" / "723170TYA.CSV"


def hbjson_face(name, ring, **more):
    return {
        "type": "Face",
        "identifier": name,
        "geometry": {"type": "Face3D", "boundary": [list(p) for p in ring]},
    } | more


def write_obj(path):
    lines = [f"v {x} {y} {z}" for x, y, z in WALL + ROOF]
    path.write_text("\n".join([*lines, "f 1 2 3 4", "f 5 6 7 8"]) + "\n")


def write_off(path):
    lines = [f"{x} {y} {z}" for x, y, z in WALL + ROOF]
    path.write_text("\n".join(["OFF", "8 2 0", *lines, "4 0 1 2 3", "4 4 5 6 7"]) + "\n")


def write_ply(path):
    head = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
    head += "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    lines = [f"{x} {y} {z}" for x, y, z in WALL + ROOF]
    path.write_text(head + "\n".join([*lines, "4 0 1 2 3", "4 4 5 6 7"]) + "\n")


def write_hbjson(path):
    shade = hbjson_face("roof", ROOF, type="Shade")
    room = {"type": "Room", "identifier": "r", "faces": [hbjson_face("wall", WALL)], "outdoor_shades": [shade]}
    path.write_text(json.dumps({"type": "Model", "identifier": "m", "units": "Meters", "rooms": [room]}))


def write_cityjson(path):
    surface = {
        "type": "MultiSurface",
        "lod": "2",
        "boundaries": [[[0, 1, 2, 3]], [[4, 5, 6, 7]]],
        "semantics": {"surfaces": [{"type": f"{kind}Surface"} for kind in ("Wall", "Roof")], "values": [0, 1]},
    }
    path.write_text(json.dumps({"type": "CityJSON", "version": "1.1", "vertices": WALL + ROOF,
                                "transform": {"scale": [1, 1, 1], "translate": [0, 0, 0]},
                                "CityObjects": {"house": {"type": "Building", "geometry": [surface]}}}))  # fmt: skip


def write_gltf(path):
    """y up: the wall as two triangles, then the roof."""
    corners = np.array([ring[i] for ring in (WALL, ROOF) for i in (0, 1, 2, 0, 2, 3)], np.float32)
    corners = np.ascontiguousarray(np.stack([corners[:, 0], corners[:, 2], -corners[:, 1]], axis=1))
    gltf = pygltflib.GLTF2(
        scene=0, scenes=[pygltflib.Scene(nodes=[0])], nodes=[pygltflib.Node(mesh=0)],
        meshes=[pygltflib.Mesh(primitives=[pygltflib.Primitive(attributes=pygltflib.Attributes(POSITION=0))])],
        accessors=[pygltflib.Accessor(bufferView=0, componentType=pygltflib.FLOAT, count=len(corners), type="VEC3",
                                      max=corners.max(axis=0).tolist(), min=corners.min(axis=0).tolist())],
        bufferViews=[pygltflib.BufferView(buffer=0, byteLength=corners.nbytes)],
        buffers=[pygltflib.Buffer(byteLength=corners.nbytes)],
    )  # fmt: skip
    gltf.set_binary_blob(corners.tobytes())
    gltf.save(path)


WRITERS = {"obj": write_obj, "off": write_off, "ply": write_ply, "hbjson": write_hbjson, "json": write_cityjson}
NAMES = {"hbjson": ["wall", "roof"], "json": ["house WallSurface 0", "house RoofSurface 1"]}


def run(*words):
    return main(["shares", *map(str, words)])


def rows(path):
    with path.open() as file:
        return list(csv.reader(file))


@pytest.fixture
def suns(tmp_path):
    (tmp_path / "suns.csv").write_text(SUNS)
    return tmp_path / "suns.csv"


@pytest.fixture
def model(tmp_path):
    write_hbjson(tmp_path / "model.hbjson")
    return tmp_path / "model.hbjson"


@pytest.mark.parametrize("suffix", WRITERS)
def test_an_overhang_in_every_format(suffix, suns, tmp_path, capsys):
    """The roof's shadow on the wall is as deep as the sun is steep: 4, then 1 of 3."""
    WRITERS[suffix](tmp_path / f"model.{suffix}")
    out = tmp_path / "new" / "shares.csv"
    assert run(tmp_path / f"model.{suffix}", out, "--directions", suns, "--centroids") == 0
    head, *table = rows(out)
    wall, roof = NAMES.get(suffix, ["face 0", "face 1"])
    assert head == ["time", *(f"{name} {end}" for name in (wall, roof) for end in ("low", "high", "x", "y", "z"))]
    assert [row[0] for row in table] == ["steep", "noon", "behind"]
    for row, share in zip(table, (0, 2 / 3, 0), strict=True):
        low, high = float(row[1]), float(row[2])
        assert low <= share <= high <= low + 1e-6
        assert [row[6], row[7]] == ["1", "1"]  # nothing is above the roof
    assert np.allclose([float(v) for v in table[1][3:6]], [0, 0, 1], rtol=0, atol=1e-6)  # of what is lit, 2 high
    assert table[2][3:6] == ["", "", ""]
    record = json.loads(capsys.readouterr().out)
    assert (record["faces"], record["suns"], record["wider_than_within"]) == (2, 3, 0) and record["left_out"] == []
    assert record["widest"] < 1e-6 and list(out.parent.iterdir()) == [out]


def test_triangles_of_gltf_are_faces_and_centroids_have_its_axes(suns, tmp_path):
    write_gltf(tmp_path / "model.glb")
    out = tmp_path / "shares.csv"
    assert run(tmp_path / "model.glb", out, "--directions", suns, "--centroids", "--quiet") == 0
    head, *table = rows(out)
    assert len(head) == 1 + 4 * 5 and table[2][1] == "0"  # from behind
    # The lower triangle (-2, 0), (2, 0), (2, 3) is lit below 2: without the part of a ninth at its tip; the upper one
    # (-2, 0), (2, 3), (-2, 3) has its tip below, which is four ninths.
    lower, upper = ([float(v) for v in table[1][i : i + 5]] for i in (1, 6))
    assert lower[0] <= 8 / 9 <= lower[1] and upper[0] <= 4 / 9 <= upper[1]
    # Centroids: the whole triangle's (2/3, 1) less a ninth at (2 - 4/9, 2 + 1/3); and the tip's (-2 + 8/9, 4/3).
    assert np.allclose(lower[2:], [(2 / 3 - 14 / 81) / (8 / 9), (1 - 7 / 27) / (8 / 9), 0], rtol=0, atol=1e-6)
    assert np.allclose(upper[2:], [-2 + 8 / 9, 4 / 3, 0], rtol=0, atol=1e-6)


def test_a_wall_has_its_windows_as_holes_wherever_it_looks(tmp_path, suns):
    """An oblique wall whose window, by rounding, lies off its plane by some 1e-16: neither shadows the other."""
    turn = np.array([[np.cos(0.3), -np.sin(0.3), 0], [np.sin(0.3), np.cos(0.3), 0], [0, 0, 1]])
    wall, window, sill = (np.array(ring, float) @ turn.T for ring in (
        WALL, [(-1, 0, 1), (1, 0, 1), (1, 0, 2), (-1, 0, 2)],
        [(-64, -0.25, 1.5), (64, -0.25, 1.5), (64, 0, 1.5), (-64, 0, 1.5)]))  # fmt: skip
    part = hbjson_face(
        "wall",
        wall.tolist(),
        apertures=[
            hbjson_face("window", window.tolist(), type="Aperture", outdoor_shades=[hbjson_face("sill", sill.tolist())])
        ],
    )
    path = tmp_path / "model.hbjson"
    path.write_text(json.dumps({"type": "Model", "orphaned_faces": [part]}))
    towards = turn @ [0, -1, 1]
    suns.write_text("x,y,z\n{!r},{!r},{!r}\n".format(*(-towards).tolist()))
    assert run(path, tmp_path / "x.csv", "--directions", suns, "--quiet", "--within", "1e-4") == 0
    row = [float(v) for v in rows(tmp_path / "x.csv")[1][1:]]
    # The sill's shadow is .25 deep, from 1.25 to 1.5: of the window's 2 x 1 it takes a quarter, of the wall's other 10
    # what is beside the window, 2 x .25.
    for low, high, share in zip(row[::2], row[1::2], (1 - 0.5 / 10, 0.75, 1), strict=True):
        assert low - 1e-4 <= share <= high + 1e-4 and high - low < 1e-3


def test_faces_are_chosen_and_other_models_cast_shadows(tmp_path, suns, model):
    alone = {"type": "Model", "orphaned_faces": [hbjson_face("wall", WALL)]}
    (tmp_path / "alone.hbjson").write_text(json.dumps(alone))
    write_gltf(tmp_path / "roof.glb")  # with its own wall, which lies in the same plane
    for words in (["model.hbjson", "--faces", "wa*"], ["alone.hbjson", "--occluders", tmp_path / "roof.glb"]):
        assert run(tmp_path / words[0], tmp_path / "x.csv", *words[1:], "--directions", suns, "--quiet") == 0
        head, _, noon, _ = rows(tmp_path / "x.csv")
        assert head == ["time", "wall low", "wall high"] and float(noon[1]) <= 2 / 3 <= float(noon[2])


@pytest.mark.parametrize("place, north, expected", [
    ("48.2,16.4", 0, {"east": "08:05", "south": "12:05", "west": "16:05"}),
    ("-33.9,18.4", 0, {"east": "08:05", "north": "12:05", "west": "16:05"}),
    ("48.2,16.4", 90, {"south": "08:05", "west": "12:05", "north": "16:05"}),
])  # fmt: skip
def test_a_place_and_a_day(place, north, expected, tmp_path, capsys):
    """Four walls that stand free: which of them the sun of an equinox meets in the morning, at noon and afternoon; and
    those of a model that is turned."""
    front = {"north": (0, 1), "east": (1, 0), "south": (0, -1), "west": (-1, 0)}
    faces = []
    for name, (x, y) in front.items():
        left, right = (9 * x + y, 9 * y - x), (9 * x - y, 9 * y + x)
        faces.append(hbjson_face(name, [(*left, 0), (*right, 0), (*right, 2), (*left, 2)]))
    path = tmp_path / "walls.hbjson"
    path.write_text(json.dumps({"type": "Model", "orphaned_faces": faces}))
    words = ["--place", place, "--day", "2026-03-20", "--utc", 1, "--north", north, "--what", "shaded"]
    assert run(path, tmp_path / "x.csv", *words) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["suns"] + record["suns_left_out"] == 144 and 70 < record["suns"] < 75
    head, *table = rows(tmp_path / "x.csv")
    lit = {row[0]: {name for name, value in zip(head[1:], row[1:], strict=True) if float(value) < 0.5} for row in table}
    for name, time in expected.items():
        assert name in lit[f"2026-03-20T{time}:00+01:00"], (name, time)


def test_a_map_says_where_north_is(tmp_path):
    """Far in the east of its zone, where the meridian is turned: by PROJ's own convergence."""
    write_cityjson(tmp_path / "city.json")
    city = json.loads((tmp_path / "city.json").read_text())
    city["transform"]["translate"] = [900_000, 5_300_000, 0]
    city["metadata"] = {"referenceSystem": "https://www.opengis.net/def/crs/EPSG/0/25832"}
    (tmp_path / "city.json").write_text(json.dumps(city))
    (tmp_path / "suns.csv").write_text("azimuth,elevation\n180,45\n")
    settings = shares.ShareSettings(model=str(tmp_path / "city.json"), directions=str(tmp_path / "suns.csv"))
    found = shares.suns_of(settings, polygons.load(settings.model)).towards[0]
    proj = pyproj.Proj(25832)
    convergence = proj.get_factors(*proj(900_000, 5_300_000, inverse=True)).meridian_convergence
    assert abs(convergence) > 3
    assert np.degrees(np.arctan2(found[0], -found[1])) == pytest.approx(convergence, abs=1e-3)
    assert run(settings.model, tmp_path / "x.csv", "--directions", settings.directions, "--north", 5) == 1
    assert run(settings.model, tmp_path / "x.csv", "--epw", YEAR) == 1  # in America


def test_a_year_for_energyplus(model, tmp_path, capsys):
    out = tmp_path / "x.csv"
    assert run(model, out, "--epw", YEAR, "--what", "energyplus", "--faces", "wall") == 0
    record = json.loads(capsys.readouterr().out)
    lines = out.read_text().splitlines()
    assert lines[0] == "Surface Name,wall," and len(lines) == 1 + 8760
    assert (
        lines[1] == " 01/01 01:00,0.00000000," and lines[24].startswith(" 01/01 24:00,") and "12/31 24:00" in lines[-1]
    )
    values = np.array([float(line.split(",")[1]) for line in lines[1:]])
    assert record["suns"] + record["suns_left_out"] == 8760 and 0 < (values > 0).sum() < record["suns"]
    noons = values.reshape(365, 24)[:, 11]
    assert noons[0] > 0.6 and noons[170] == 0  # under a low sun, and one that is 77 degrees high: tan is above 3


def test_the_limit_of_work_is_said(model, suns, tmp_path, capsys):
    words = [model, tmp_path / "x.csv", "--directions", suns, "--faces", "wall", "--limit", 0]
    assert run(*words, "--quiet") == 0
    said = capsys.readouterr()
    assert said.out == "" and "2 intervals are wider than 0.01: give a greater --limit" in said.err
    assert rows(tmp_path / "x.csv")[2][1:] == ["0", "1"]
    assert run(*words, "--quiet", "--strict") == 1


def test_what_has_no_area_or_is_bent_is_named(suns, tmp_path, capsys):
    bent = [*WALL[:3], (-2, 0.5, 3)]
    bow = [(0, 0, 9), (1, 1, 9), (1, 0, 9), (0, 1, 9.0)]
    faces = [hbjson_face(name, ring) for name, ring in (("flat, line", [WALL[0]] * 3), ("bent", bent), ("bow", bow))]
    (tmp_path / "model.hbjson").write_text(json.dumps({"type": "Model", "orphaned_faces": faces}))
    assert run(tmp_path / "model.hbjson", tmp_path / "x.csv", "--directions", suns, "--quiet") == 0
    said = capsys.readouterr().err
    assert "left out: flat; line has no area; bow has" in said and "not planar, taken as their triangles: bent" in said
    assert rows(tmp_path / "x.csv")[0] == ["time", "bent low", "bent high"]


@pytest.mark.parametrize(
    ("words", "text"),
    [
        ([], "suns: give --directions, --epw or --place: one of them"),
        (["--directions", "{suns}", "--place", "48,16", "--day", "2026-01-01"], "one of them"),
        (["--directions", "{suns}", "--day", "2026-01-01"], "--day: needs --place"),
        (["--place", "48,16"], "place: needs --day or --year"),
        (["--place", "98,16", "--year", "2026"], "latitude 98 is beyond 90 degrees"),
        (["--place", "48,46", "--day", "2026-02-30"], "day, year, utc: 2026-02-30 at 3 hours ahead is no"),
        (["--place", "48,46", "--day", "20.3.2026"], "20.3.2026 at 3 hours ahead is no date such as 2026-03-20"),
        (["--place", "48,46", "--day", "2026-03-20T12:00"], "no date such as"),
        (["--place", "48,46", "--year", "9999"], "no year from 1 to 9998"),
        (["--directions", "{suns}", "--north", "nan"], "north: nan is not a number of degrees"),
        (["--place", "48,16", "--day", "2026-02-03", "--utc", "30"], "day, year, utc"),
        (["--place", "48,16", "--day", "2026-02-03", "--step", "7"], "step: 7 minutes do not divide a day"),
        (["--place", "48,16", "--day", "2026-02-03", "--what", "energyplus"], "energyplus needs each step of a year"),
        (["--directions", "{suns}", "--within", "0"], "within: 0 is not above 0 and at most 1"),
        (["--directions", "{suns}", "--limit", "-1"], "limit: -1 is negative"),
        (
            ["--directions", "{suns}", "--faces", "door*"],
            r"faces: 'door\*' matches none of the names in .*, such as 'wall'",
        ),
        (["--directions", "{suns}", "--occluders", "none.obj"], "none.obj: there is no such file"),
        (["--directions", "none.csv"], "none.csv"),
        (["--epw", "{suns}"], "suns.csv"),
        (["--directions", "{suns}", "--what", "shaded", "--centroids"], "centroids: are not in the file of shaded"),
    ],
)
def test_wrong_words_are_named(words, text, model, suns, tmp_path, capsys):
    assert run(model, tmp_path / "x.csv", *(word.format(suns=suns) for word in words)) == 1
    said = capsys.readouterr().err
    assert re.search(text, said) and len(said.splitlines()) == 1 and not (tmp_path / "x.csv").exists()


@pytest.mark.parametrize(
    ("name", "content", "text"),
    [
        (
            "a.hbjson",
            '{"type": "Model", "orphaned_faces": [{"identifier": "a", "geometry": {"type": "Arc2D"}}]}',
            "Arc2D",
        ),
        ("a.hbjson", '{"type": "Room"}', "type"),
        ("a.hbjson", "{", "cannot be read"),
        ("a.hbjson", '{"type": "Model"}', "none of its 0 polygons has an area"),
        ("a.obj", "v 0 0 0\nf 1 2 3 4\n", "names a vertex that is not among its 1"),
        ("a.obj", "v 0 0 0\nv 1 0 nan\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n", "not finite"),
        ("a.xyz", "nothing", "cannot be read"),
    ],
)
def test_broken_models_are_named(name, content, text, suns, tmp_path, capsys):
    (tmp_path / name).write_text(content)
    assert run(tmp_path / name, tmp_path / "x.csv", "--directions", suns) == 1
    said = capsys.readouterr().err
    assert name in said and re.search(text, said) and len(said.splitlines()) == 1


def test_no_input_is_overwritten(model, suns, tmp_path, capsys):
    kept = model.read_bytes()
    assert run(model, tmp_path / "." / "model.hbjson", "--directions", suns) == 1 and model.read_bytes() == kept
    assert run(model, suns, "--directions", suns) == 1 and suns.read_text() == SUNS
    assert run(model, tmp_path, "--directions", suns) == 1
    assert run(model, model / "x.csv", "--directions", suns) == 1
    assert capsys.readouterr().err.count("it is a file that this run reads") == 2


def test_a_killed_write_leaves_the_file_that_was_there(model, suns, tmp_path, monkeypatch):
    (tmp_path / "x.csv").write_text("before")
    monkeypatch.setattr("os.replace", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt()))
    assert run(model, tmp_path / "x.csv", "--directions", suns, "--quiet") == 130
    assert (tmp_path / "x.csv").read_text() == "before" and not list(tmp_path.glob("*.partial"))
