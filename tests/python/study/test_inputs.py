# SPDX-License-Identifier: MIT
"""Files as people have them, each with the right answer and its reason. A table a kind: mesh files, CityJSON, units of
heights, grids, projections. Members that are no trouble stand there too, so that they stay none."""

import json
import re
import shlex
import shutil
import struct
import warnings
import zipfile

import gltf_made
import numpy as np
import pandas
import pyproj
import pytest
import rasterio
import trimesh
import xarray
from gnomon.studies import StudyStoppedError, meshes, rasters, suns, units
from gnomon.studies.settings import settings_of
from made import run
from rasterio.rio.main import main_group

DOWN, WEST = [[0, 0, -1]], [[1, 0, -1]]  # travelling straight down; from the west, 45 degrees high


def answers(folder, travelling=DOWN, points=None, **settings):
    """(N,) or (R, C) bool of one direction; the study; and its warnings."""
    np.savetxt(folder / "suns.csv", travelling, delimiter=",", header="x,y,z", comments="")
    if points is not None:
        np.savetxt(folder / "points.csv", points, delimiter=",", header="x,y,z", comments="")
        settings |= dict(receivers="points", points=str(folder / "points.csv"))
    shutil.rmtree(folder / "study", ignore_errors=True)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        study = run(folder / "study", directions=str(folder / "suns.csv"), outputs=["bits"], **settings)
    lit = study.plan.store.array("results.zarr/lit")[:][0] & 1
    return lit.astype(bool), study, [str(w.message) for w in caught]


# ---- glTF: by gnomon's own loader ----------------------------------------------------------------------------------
# A roof of 20 x 20 m in 10 m: point 0 in its middle and point 2 near its edge are dark, point 1 beside it is lit.

ROOF = np.array([[-10, 10, -10], [10, 10, 10], [10, 10, -10], [-10, 10, -10], [-10, 10, 10], [10, 10, 10]], np.float32)
ON_GROUND = ROOF * np.float32([1, 0, 1])
UNDER_ROOF = [[0, 0, 0], [50, 0, 0], [-9, 0, 0]]


def node(made, mesh, **more):
    """A root of the scene."""
    index = made.add("nodes", **({} if mesh is None else dict(mesh=mesh)), **more)
    made.json.setdefault("scenes", [{"nodes": []}])[0]["nodes"].append(index)
    return index


def plain(made):
    node(made, made.mesh(made.accessor(ROOF)))


def quantised(made):
    values = np.zeros((6, 4), np.int16)
    values[:, :3] = np.round(ROOF / 10 * 32767)
    positions = made.accessor(values[:, :3], "int16", 8, normalized=True)
    node(made, made.mesh(positions), scale=[10, 10, 10])
    made.json["extensionsUsed"] = made.json["extensionsRequired"] = ["KHR_mesh_quantization"]


def sparse(made):
    node(made, made.mesh(made.sparse((6, 3), list(range(6)), ROOF)))


def instanced(made):
    half = made.mesh(made.accessor(ROOF * np.float32([0.5, 1, 1])))
    at = made.accessor([[-5, 0, 0], [5, 0, 0]])
    node(made, half, extensions={"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": at}}})
    made.json["extensionsUsed"] = ["EXT_mesh_gpu_instancing"]


def morphed(made):
    lift = made.accessor(ROOF - ON_GROUND)
    node(made, made.mesh(made.accessor(ON_GROUND), targets=[{"POSITION": lift}], weights=[1.0]))


def strip(made):
    node(made, made.mesh(made.accessor(ROOF[[0, 4, 2, 1]])))
    made.json["meshes"][0]["primitives"][0]["mode"] = 5


def fan(made):
    node(made, made.mesh(made.accessor(ROOF[[0, 4, 1, 2]])))
    made.json["meshes"][0]["primitives"][0]["mode"] = 6


def interleaved(made):
    node(made, made.mesh(made.accessor(ROOF, stride=32)))


def skinned(made):
    joints = made.accessor(np.zeros((6, 4)), "uint8")
    weights = made.accessor(np.tile([1, 0, 0, 0], (6, 1)))
    mesh = made.mesh(made.accessor(ON_GROUND), {"JOINTS_0": joints, "WEIGHTS_0": weights})
    node(made, mesh, skin=0)
    made.add("skins", joints=[node(made, None, translation=[0, 10, 0])])


def second_scene(made):
    mesh = made.mesh(made.accessor(ROOF))
    node(made, mesh, translation=[100, 0, 0])
    node(made, mesh)
    made.json["scenes"], made.json["scene"] = [{"nodes": [0]}, {"nodes": [1]}], 1


def hierarchy(made):
    made.add("nodes", children=[1], translation=[50, 0, 0])
    made.add("nodes", mesh=made.mesh(made.accessor(ROOF)), translation=[-50, 0, 0])
    made.json["scenes"] = [{"nodes": [0]}]


def mirrored(made):
    node(made, made.mesh(made.accessor(ROOF)), scale=[-1, 1, 1])


def hidden_beside(made):
    plain(made)
    node(made, made.mesh(made.accessor(ROOF)), translation=[50, 0, 0],
              extensions={"KHR_node_visibility": {"visible": False}})  # fmt: skip
    made.json["extensionsUsed"] = ["KHR_node_visibility"]


GLTF = [plain, quantised, sparse, instanced, morphed, strip, fan, interleaved, skinned, second_scene, hierarchy,
        mirrored, hidden_beside]  # fmt: skip


@pytest.mark.parametrize("make", GLTF, ids=[f.__name__ for f in GLTF])
def test_gltf(tmp_path, make):
    made = gltf_made.Made()
    make(made)
    (tmp_path / "roof.glb").write_bytes(made.glb())
    lit, study, notes = answers(tmp_path, points=UNDER_ROOF, meshes=str(tmp_path / "roof.glb"))
    assert lit.tolist() == [False, True, False] and study.record["undecided"] == 0 and not notes
    import gnomon

    own = gnomon.Scene.from_gltf(tmp_path / "roof.glb").lit(UNDER_ROOF, direction=(0, -1, 0))
    assert own.tolist() == [False, True, False], "Scene.from_gltf() answers the same; y is up there"


def test_what_a_gltf_file_leaves_out_is_said(tmp_path):
    made = gltf_made.Made()
    plain(made)
    made.mesh(made.accessor(ROOF))
    made.json["meshes"][1]["primitives"][0]["mode"] = 1
    node(made, 1)
    (tmp_path / "lines.glb").write_bytes(made.glb())
    lit, _, notes = answers(tmp_path, points=UNDER_ROOF, meshes=str(tmp_path / "lines.glb"))
    assert lit.tolist() == [False, True, False]
    assert notes == [f"{tmp_path}/lines.glb: points and lines are left out: primitive 0 of mesh 1 (lines)"]


# ---- Other mesh files ----------------------------------------------------------------------------------------------
# An L in 10 m, whose notch is over point (3, 3): a fan from the wrong corner covers it. Point (-9, 0) is under the L.

L_CORNERS = [[-10, -10, 10], [10, -10, 10], [10, -1, 10], [-1, -1, 10], [-1, 10, 10], [-10, 10, 10]]
UNDER_L = [[3, 3, 0], [50, 0, 0], [-9, 0, 0], [9, -5, 0]]
IN_L = [True, True, False, False]


def rows(prefix=""):
    return "".join(prefix + " ".join(map(str, corner)) + "\n" for corner in L_CORNERS)


def ply(kind="float", faces="6 2 3 4 5 0 1\n", count=1, element="face"):
    head = f"ply\nformat ascii 1.0\nelement vertex 6\nproperty {kind} x\nproperty {kind} y\nproperty {kind} z\n"
    return head + f"element {element} {count}\nproperty list int int vertex_indices\nend_header\n" + rows() + faces


MESHES = {
    "concave.obj": (rows("v ") + "f 3 4 5 6 1 2\n", ""),
    "backwards.obj": (rows("v ") + "f -4 -3 -2 -1 -6 -5\n", ""),
    "continued.obj": (rows("v ") + "f 3 4 5 \\\n6 1 2 # the roof\n", ""),
    "textured.obj": (rows("v ") + "vt 0 0\nvn 0 0 1\nf 3/1/1 4/1/1 5//1 6/1 1 2\n", ""),
    "mark.obj": ("\ufeff" + rows("v ") + "f 1 2 3\nf 1 3 4\nf 1 4 5\nf 1 5 6\n", ""),
    "utf16.obj": (rows("v ") + "f 3 4 5 6 1 2\n", ""),
    "parts.obj": (rows("v ") + "f -6 -5 -4\nf -6 -4 -3\nf -6 -3 -2\nf -6 -2 -1\n" + 9 * "v 900 900 900\n", ""),
    "lines.obj": (rows("v ") + "l 1 2\np 3\nf 3 4 5 6 1 2\n", "2 points, lines, curves or free-form surfaces are left"),
    "triangles.obj": (rows("v ") + "f 1 2 3\nf 1 3 4\nf 1 4 5\nf 1 5 6\n", ""),
    "concave.ply": (ply(), ""),
    "doubles.ply": (ply("double"), ""),
    "blender.ply": (ply().replace("element vertex", "Created by Blender3D 247\nelement vertex"), ""),
    "mixed.ply": (ply(faces="3 0 1 2\n5 3 4 5 0 2\n", count=2), ""),
    "concave.off": ("OFF\n6 1 0\n" + rows() + "6 2 3 4 5 0 1\n", ""),
    "one_line.off": ("OFF 6 1 0 # an L\n" + rows() + "6 2 3 4 5 0 1 255 0 0\n", ""),
}


@pytest.mark.parametrize("name", MESHES)
def test_mesh_files(tmp_path, name):
    text, note = MESHES[name]
    (tmp_path / name).write_text(text, encoding="utf-16" if name.startswith("utf16") else "utf-8")
    lit, study, notes = answers(tmp_path, points=UNDER_L, meshes=str(tmp_path / name))
    assert lit.tolist() == IN_L and study.record["undecided"] == 0
    assert len(notes) == bool(note) and all(note in text for text in notes)


#: A property is a name, its type (of struct) and the values of a face's row: a list's stand behind their number.
BEFORE, AFTER, LIST = (
    ("flag", "uchar", "B", [7]),
    ("quality", "float", "f", [0.5]),
    ("uv", "list uchar float", "f", None),
)
#: 4 + 3 + 5 corners take as many bytes as three faces of 4.
FACES = {"mixed": [[0, 1, 2], [3, 4, 5, 0, 2]], "of 4, 3 and 5": [[0, 1, 2, 3], [3, 4, 5], [3, 5, 0, 1, 2]]}


@pytest.mark.parametrize("faces", FACES)
@pytest.mark.parametrize("others", [[], [BEFORE], [AFTER], [BEFORE, AFTER], [LIST], [AFTER, LIST]],
                         ids=lambda others: "+".join(one[0] for one in others) or "alone")  # fmt: skip
@pytest.mark.parametrize("order", "<>")
def test_binary_ply_with_faces_of_many_kinds(tmp_path, order, others, faces):
    corners = FACES[faces]
    head = (
        f"ply\r\nformat binary_{'little' if order == '<' else 'big'}_endian 1.0\r\ncomment by hand\r\nelement vertex 6"
    )
    head += "".join(f"\r\nproperty double {axis}" for axis in "xyz") + f"\r\nelement face {len(corners)}"
    before, after = [one for one in others if one is BEFORE], [one for one in others if one is not BEFORE]
    for name, kind, *_ in [*before, ("vertex_index", "list uchar int"), *after]:
        head += f"\r\nproperty {kind} {name}"
    data = b"".join(struct.pack(order + "3d", *corner) for corner in L_CORNERS)
    for face in corners:
        uvs = [0.25] * 2 * len(face)
        data += b"".join(struct.pack(order + code, *values) for _, _, code, values in before)
        data += struct.pack(f"{order}B{len(face)}i", len(face), *face)
        for _, _, code, values in after:
            data += (
                struct.pack(order + code, *values) if values else struct.pack(f"{order}B{len(uvs)}f", len(uvs), *uvs)
            )
    (tmp_path / "m.ply").write_bytes((head + "\r\nend_header\r\n").encode() + data)
    lines = "".join(f"{len(face)} {' '.join(map(str, face))}\n" for face in corners)
    (tmp_path / "text.ply").write_text(ply("double", lines, len(corners)))
    found, expected = (meshes.load(str(tmp_path / name)) for name in ("m.ply", "text.ply"))
    first, last = np.diff(found.triangles, axis=1).transpose(1, 0, 2)
    rings = [np.array(L_CORNERS)[face] for face in corners]
    areas = [np.cross(ring, np.roll(ring, -1, axis=0))[:, 2].sum() for ring in rings]  # twice the faces'
    assert np.array_equal(found.triangles, expected.triangles) and found.notes == ()
    assert np.cross(first, last)[:, 2].sum() == sum(areas)
    assert len(found.triangles) == sum(len(face) - 2 for face in corners)
    for cut in (1, 9, 30):
        (tmp_path / f"{cut}.ply").write_bytes((tmp_path / "m.ply").read_bytes()[:-cut])
        with pytest.raises(meshes.UnreadableError, match=f"{cut}.ply: .*is cut off: it .* . rows of face"):
            meshes.load(str(tmp_path / f"{cut}.ply"))


NO_MESHES = {
    "headless.ply": ("ply\nformat ascii 1.0\nelement vertex 6\n", "has no whole header of a PLY file"),
    "cut_off.off": ("OFF\n6 2 0\n" + rows() + "3 0 1 2\n", "is cut off: it says that it has 6 vertices and 2 faces"),
    "cut_row.off": ("OFF\n6 1 0\n" + rows() + "6 2 3 4\n", "a face says that it has 6 corners, and has 3"),
    "four.off": ("4OFF\n1 0 0\n0 0 0 1\n", "begins with '4OFF' and not with OFF"),
    "typed.ply": (ply("half"), 'its header has the type "half", which is not known'),
    "beyond.ply": (ply(faces="3 0 1 6\n"), "a face names a vertex that is not among its 6"),
    "empty.ply": ("", "empty.ply"),
    "points.ply": (ply(count=0, faces=""), "left out.*has no triangles"),
    "strips.ply": (ply(element="tristrips", faces="4 0 1 5 2\n"), "triangle strips, which are not read"),
    "bad.obj": (rows("v ") + "f 1 2 3 9\n", "names a vertex that is not among its 6"),
    "zero.obj": (rows("v ") + "f 0 1 2\n", "names vertex 0, and they count from 1"),
    "no_face.ply": (
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty list uchar uint vertex_indices\n"
        "end_header\n0\n",
        'its header has the list "vertex_indices" without the line "element face N" above it',
    ),
    "short.off": ("OFF\n9 1 0\n" + rows("") + "3 0 1 2\n", "is cut off: it says that it has 9 vertices .*has 7 lines"),
    "empty.off": ("", "empty.off: the file is empty"),
    "text.stl": (
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n",
        "is cut off: its last line is no endsolid",
    ),
    "short.stl": ("x".ljust(80) + "\x05\0\0\0" + "\0" * 100, "is cut off: it says that it has 5 triangles, and has 2"),
    "wires.obj": (rows("v ") + "l 1 2 3\n", "1 points, lines.*has no triangles"),
    "model.foo": ("x", "'foo' not supported"),
    "lines.dxf": ("0\nSECTION\n", r"of a drawing \(.dxf\) lines alone are read, and no faces: write its faces as .ply"),
}


@pytest.mark.parametrize("name", NO_MESHES)
def test_files_without_triangles_say_why(tmp_path, name):
    text, note = NO_MESHES[name]
    (tmp_path / name).write_text(text)
    with pytest.warns(UserWarning, match=note):
        np.savetxt(tmp_path / "suns.csv", DOWN, delimiter=",", header="x,y,z", comments="")
        np.savetxt(tmp_path / "points.csv", UNDER_L, delimiter=",", header="x,y,z", comments="")
        run(tmp_path / "study", meshes=str(tmp_path / name), receivers="points", points=str(tmp_path / "points.csv"),
            directions=str(tmp_path / "suns.csv"), outputs=["bits"])  # fmt: skip


@pytest.mark.parametrize("error, said", [
    (IndexError("tuple index out of range"), r"cannot be read: its parts do not fit together \(IndexError: tuple index "
     r"out of range\); write it as .ply, .obj or .glb, and give that"),
    (ModuleNotFoundError("No module named 'cascadio'"), "needs the Python package cascadio: pip install cascadio, or"),
])  # fmt: skip
def test_what_a_library_raises_is_one_sentence(error, said):
    with pytest.raises(meshes.UnreadableError, match=f"^m.foo: {said}"), meshes.reading("m.foo"):
        raise error


def test_a_file_of_3mf(tmp_path):
    """Read by trimesh with the packages that gnomon[study] brings; its unit is a thousandth."""
    trimesh.creation.box((1, 2, 3)).export(tmp_path / "box.3mf")
    mesh = meshes.load(str(tmp_path / "box.3mf"))
    assert len(mesh.triangles) == 12
    assert np.allclose(np.ptp(mesh.triangles.reshape(-1, 3), axis=0), [0.001, 0.002, 0.003])
    assert mesh.notes == ("its unit is millimeter: its coordinates are multiplied by 0.001",)


def test_what_has_no_triangles_says_so_once(tmp_path):
    (tmp_path / "empty.gltf").write_text('{"asset": {"version": "2.0"}, "scenes": [{}], "scene": 0}')
    assert meshes.load(str(tmp_path / "empty.gltf")).notes == ("has no triangles",)


def test_faces_of_files_without_triangles_name_the_file(tmp_path):
    text, _ = NO_MESHES["points.ply"]
    (tmp_path / "cloud.ply").write_text(text)
    np.savetxt(tmp_path / "suns.csv", DOWN, delimiter=",", header="x,y,z", comments="")
    with pytest.raises(ValueError, match=r"receivers: .*cloud\.ply: no triangle has an area"):
        run(tmp_path / "study", meshes=str(tmp_path / "cloud.ply"), receivers="faces",
            directions=str(tmp_path / "suns.csv"))  # fmt: skip


def test_a_unit_that_a_mesh_declares(tmp_path):
    """3MF in millimetres, its default."""
    pytest.importorskip("networkx")
    pytest.importorskip("lxml")
    core = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
    corners = "".join(f'<vertex x="{x}" y="{y}" z="10000"/>' for x, y in [(-9e3, -9e3), (9e3, -9e3), (0, 9e3)])
    mesh = f'<mesh><vertices>{corners}</vertices><triangles><triangle v1="0" v2="1" v3="2"/></triangles></mesh>'
    objects = f'<resources><object id="1">{mesh}</object></resources><build><item objectid="1"/></build>'
    model = f'<model xmlns="{core}">{objects}</model>'
    with zipfile.ZipFile(tmp_path / "roof.3mf", "w") as archive:
        archive.writestr("3D/3dmodel.model", model)
    lit, _, notes = answers(tmp_path, points=[[0, 0, 0], [50, 0, 0]], meshes=str(tmp_path / "roof.3mf"))
    assert lit.tolist() == [False, True] and "its unit is millimeter" in notes[0]


def test_a_file_that_is_written_again_is_read_again(tmp_path):
    """Files stay open between studies of one process."""
    for height, dark in ((10, True), (0, False)):
        (tmp_path / "roof.obj").write_text(rows("v ").replace(" 10\n", f" {height}\n") + "f 1 2 4 6\n")
        lit = answers(tmp_path, points=[[-5, -5, 5]], meshes=str(tmp_path / "roof.obj"))[0]
        assert lit.tolist() == [not dark], height
    for height, length in ((100, 100), (50, 50)):
        assert shadow(tmp_path, ridge(tmp_path, height=height)) == length


def test_a_stray_triangle_that_makes_the_lattice_coarse(tmp_path):
    (tmp_path / "stray.obj").write_text(rows("v ") + "v 9e6 0 0\nv 9e6 1 0\nv 9e6 0 1\nf 1 2 3 4 5 6\nf 7 8 9\n")
    notes = answers(tmp_path, points=UNDER_L, meshes=str(tmp_path / "stray.obj"))[2]
    assert len(notes) == 1 and "stray.obj): leave out what lies far away" in notes[0]


# ---- CityJSON ------------------------------------------------------------------------------------------------------

SQUARE = [[-10, -10, 10], [10, -10, 10], [10, 10, 10], [-10, 10, 10], [50, 0, 10]]


def surface(lod="2", **more):
    return dict(type="MultiSurface", lod=lod, boundaries=[[[0, 1, 2, 3]]], **more)


def city(path, *geometries, crs=None, **more):
    """A building of these geometries over SQUARE."""
    text = dict(type="CityJSON", version="2.0", transform=dict(scale=[1, 1, 1], translate=[0, 0, 0]), vertices=SQUARE,
                CityObjects={"a": dict(type="Building", geometry=list(geometries) or [surface()])}, **more)  # fmt: skip
    if crs is not None:
        text["metadata"] = dict(referenceSystem=crs)
    path.write_text(json.dumps(text))
    return str(path)


OGC = "https://www.opengis.net/def/crs/EPSG/0/"
TREE = {"templates": [dict(type="MultiSurface", lod="3", boundaries=[[[0, 1, 2]]])],
        "vertices-templates": [[-1, -1, 0], [1, -1, 0], [0, 1, 0]]}  # fmt: skip
STANDS = dict(type="GeometryInstance", template=0, boundaries=[4],
              transformationMatrix=[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])  # fmt: skip
CLOSURE = dict(semantics=dict(surfaces=[dict(type="ClosureSurface")], values=[0]))
# geometries, its CRS, the study's CRS, more: whether (0, 0, 0) and (50, 0, 0) are lit, and a part of the warning
CITIES = {
    "without a CRS": ((), None, None, {}, [False, True], ""),
    "RD New in a study without a CRS": ((), OGC + "7415", None, {}, [False, True], ""),
    "RD New with heights in a study of RD New": ((), "urn:ogc:def:crs:EPSG::7415", "EPSG:28992", {}, [False, True], ""),
    "levels 0, 1 and 2.2": ((surface("0"), surface("1"), surface("2.2")), None, None, {}, [False, True], ""),
    "an instance of level 3 over a solid of 1": ((surface("1"), STANDS), None, None, {"geometry-templates": TREE},
                                                 [True, False], ""),
    "a closure surface": ((surface(**CLOSURE),), None, None, {}, [True, True], "left out: 1 ClosureSurface"),
    "points beside a surface": ((surface(), dict(type="MultiPoint", lod="9", boundaries=[0])), None, None, {},
                                [False, True], ""),
    "points alone": ((dict(type="MultiPoint", lod="2", boundaries=[0]),), None, None, {}, [True, True], "1 MultiPoint"),
    "textures": ((surface(texture={"t": {"values": [[[0, 0, 0, 0]]]}}),), None, None, {"appearance": {}}, [False, True],
                 ""),
}  # fmt: skip


@pytest.mark.parametrize("name", CITIES)
def test_cityjson(tmp_path, name):
    geometries, crs, of_study, more, lit, note = CITIES[name]
    path = city(tmp_path / "a.city.json", *geometries, crs=crs, **more)
    found, _, notes = answers(tmp_path, points=[[0, 0, 0], [50, 0, 0]], meshes=path, crs=of_study)
    assert found.tolist() == lit and len(notes) == bool(note) and all(note in text for text in notes)


def test_heights_of_a_city_in_feet(tmp_path):
    """UTM 13N with heights in US survey feet: the roof stands in 3.05 m."""
    path = city(tmp_path / "a.city.json", crs="EPSG:26913+6360")
    found = answers(tmp_path, points=[[0, 0, 3.04], [0, 0, 3.05]], meshes=path)[0]
    assert found.tolist() == [False, True]


@pytest.mark.parametrize("crs, of_study, text", [
    (OGC + "4979", None, "a.city.json: its reference system, WGS 84, is not a map in metres: reproject it first"),
    (OGC + "2229", None, "California zone 5 .ftUS., is not a map in metres"),
    (OGC + "7415", "EPSG:25832", "RD New, is not the study's, ETRS89 / UTM zone 32N: reproject it first .cjio"),
    (OGC + "25833", "EPSG:25832", "UTM zone 33N, is not the study's"),
    (OGC + "2065", "EPSG:5514", "or, if its numbers are of S-JTSK / Krovak East North already, name that .crs_assign"),
    ("https://example.org/1", "EPSG:25832", "a.city.json: its reference system 'https://example.org/1'"),
])  # fmt: skip
def test_cities_elsewhere(tmp_path, crs, of_study, text):
    with pytest.raises((StudyStoppedError, ValueError), match=text) as error:
        answers(tmp_path, points=[[0, 0, 0]], meshes=city(tmp_path / "a.city.json", crs=crs), crs=of_study)
    assert "run the same study again" not in str(error.value)


def tmerc(k=0.9996, same_at=None):
    """UTM 32N with another scale; same_at: the place of both that has the same numbers."""
    x_0, y_0 = (500_000, 0) if same_at is None else np.array(same_at) - k / 0.9996 * (same_at - np.array([500_000, 0]))
    return f"+proj=tmerc +lat_0=0 +lon_0=9 +k={k} +x_0={x_0:.6f} +y_0={y_0:.6f} +ellps=GRS80 +units=m"


def test_maps_that_have_other_numbers(tmp_path):
    """By where they put the mesh, not by their names; a mesh that mesh_offset= moves may count from anywhere."""
    path = city(tmp_path / "a.city.json", crs=OGC + "25832")
    given = dict(points=[[0, 0, 0], [50, 0, 0]], meshes=path)
    assert answers(tmp_path, **given, crs=tmerc())[0].tolist() == [False, True]
    for other in (tmerc().replace("500000", "500100"), tmerc(0.5, (-10, -10)), tmerc(0.5, (10, 10))):
        with pytest.raises(StudyStoppedError, match="is not the study's, unknown: reproject it first .task"):
            answers(tmp_path, **given, crs=other)
    moved = answers(tmp_path, **given, crs="EPSG:25833", mesh_offset=(50, 0, 0))[0]
    assert moved.tolist() == [True, False]


# ---- Units of heights and grids ------------------------------------------------------------------------------------
# A ridge of 100 units from south to north, the sun in the west at 45 degrees: the shadow is as long as it is high.

FOOT, US_FOOT = 0.3048, 1200 / 3937
AFFINE = rasterio.Affine(5, 0, 500_000, 0, -5, 4_000_000)


def ridge(folder, unit="", crs="EPSG:26913", transform=AFFINE, height=100, name="dsm.tif", dtype="float32", scale=None,
          tag="", tags=None, count=1, columns=(0, 81), **more):  # fmt: skip
    heights = np.zeros((11, 81), dtype)
    heights[:, 20] = height
    heights = heights[:, slice(*columns)]
    place = {} if transform is None else dict(transform=transform)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of rasters without a place
        with rasterio.open(folder / name, "w", driver="GTiff", width=heights.shape[1], height=11, count=count,
                           dtype=dtype, crs=crs, **place, **more) as file:  # fmt: skip
            for band in range(count):
                file.write(heights, band + 1)
            if unit:
                file.units = (unit,) * count
            if tag or tags:
                file.update_tags(1, **(tags or dict(units=tag)))
            if scale is not None:
                file.scales = (scale,) * count
    return str(folder / name)


def shadow(folder, raster, **settings):
    """Metres from the crest to the last dark cell."""
    lit = answers(folder, WEST, raster=raster, **settings)[0]
    return 5 * (int(np.flatnonzero(~lit[5]).max(initial=20)) - 20)


UNITS = [
    (dict(), None, 1), (dict(unit="m"), None, 1), (dict(unit="metre"), None, 1), (dict(unit="Meters"), None, 1),
    (dict(unit="ft"), None, FOOT), (dict(unit="feet"), None, FOOT), (dict(unit="Foot"), None, FOOT),
    (dict(unit="US survey foot"), None, US_FOOT), (dict(unit="us-ft"), None, US_FOOT),
    (dict(unit="ftUS"), None, US_FOOT), (dict(unit="Foot_US"), None, US_FOOT),
    (dict(unit="cm", height=10_000), None, 0.01), (dict(unit="dm", height=1000), None, 0.1),
    (dict(unit="mm", dtype="int32", height=100_000), None, 0.001), (dict(unit="km", height=0.1), None, 1000),
    (dict(crs="EPSG:26913+5703"), None, 1), (dict(crs="EPSG:26913+6360"), None, US_FOOT),
    (dict(crs="EPSG:26913+8228"), None, FOOT), (dict(), "feet", FOOT), (dict(unit="furlong"), "metre", 1),
    (dict(dtype="int16", height=1000, scale=0.1, unit="ft"), None, FOOT / 10),
    (dict(tags=dict(standard_name="surface_altitude")), None, 1),
    (dict(unit="mm", tags=dict(NETCDF_VARNAME="z"), height=100_000), "mm", 0.001),
    (dict(unit="ft", crs="EPSG:26913+5703"), None, FOOT), (dict(unit="m", crs="EPSG:26913+6360"), None, 1),
    (dict(tag="feet"), None, FOOT), (dict(tag="degrees"), None, 1), (dict(tag="feet", unit="m"), None, 1),
]  # fmt: skip


@pytest.mark.parametrize("made, named, metres", UNITS, ids=[f"{m} {n}" for m, n, _ in UNITS])
def test_units_of_heights(tmp_path, made, named, metres):
    length = made.get("height", 100) * metres
    assert shadow(tmp_path, ridge(tmp_path, **made), height_unit=named) == 5 * int(length / 5 + 1e-9)


def test_packed_heights_in_feet(tmp_path):
    """value * scale + offset, then feet; an offset alone, too."""
    raster = ridge(tmp_path, dtype="int16", unit="ft")
    for scale, offset, expected in [(0.5, 1000, 1050), (1, 1000, 1100), (0.5, 0, 50)]:
        with rasterio.open(raster, "r+") as file:
            file.scales, file.offsets = (scale,), (offset,)
        crest = rasters.open_mosaic((raster,)).heights(5, 6, 20, 21)
        assert crest.tolist() == [[expected * FOOT]]


def test_tiles_in_any_order_lie_where_they_say(tmp_path):
    """Cells of 5 x 2 m; the first tile lies in the south-east, and where two overlap the one named first counts."""
    whole = np.arange(12 * 16, dtype=np.float32).reshape(12, 16)
    parts = {"se": (6, 8, 6, 8), "ne": (0, 8, 7, 8), "nw": (0, 0, 6, 9), "sw": (5, 0, 7, 8)}
    expected = np.empty_like(whole)
    for added, (name, (row, column, rows, columns)) in reversed(list(enumerate(parts.items()))):
        window = (slice(row, row + rows), slice(column, column + columns))
        grid = rasterio.Affine(5, 0, 500_000 + 5 * column, 0, -2, 4_000_000 - 2 * row)
        with rasterio.open(tmp_path / f"{name}.tif", "w", driver="GTiff", width=columns, height=rows, count=1,
                           dtype="float32", crs="EPSG:26913", transform=grid) as file:  # fmt: skip
            file.write(whole[window] + added / 8, 1)
        expected[window] = whole[window] + added / 8
    mosaic = rasters.open_mosaic(tuple(str(tmp_path / f"{name}.tif") for name in parts))
    assert (mosaic.rows, mosaic.columns, mosaic.dx, mosaic.dy) == (12, 16, 5, 2)
    assert (mosaic.heights(0, 12, 0, 16) == expected).all()
    assert mosaic.x(15, 16) == 500_077.5 and mosaic.y(11, 12) == 3_999_977


def test_each_tile_has_its_own_unit(tmp_path):
    """The second one is in feet, and lies west of the first."""
    more = dict(transform=rasterio.Affine(5, 0, 500_205, 0, -5, 4_000_000), columns=(41, 81), height=0)
    east, west = ridge(tmp_path, name="east.tif", **more), ridge(tmp_path, name="west.tif", unit="ft", columns=(0, 41))
    for tiles in ((east, west), (west, east)):
        mosaic = rasters.open_mosaic(tiles)
        assert mosaic.heights(5, 6, 20, 21) == 100 * FOOT and mosaic.west == 500_000


def test_all_names_of_feet_are_known():
    for name in ["ft", "FT", "feet", "foot", "Foot", "International Foot"]:
        assert units.metres_of(name) == FOOT, name
    for name in ["us-ft", "US survey foot", "US Survey Feet", "ftUS", "ft_US", "foot_us", "U.S. survey foot"]:
        assert abs(units.metres_of(name) - US_FOOT) < 1e-15, name
    assert units.metres_of("dm") == 0.1 and units.metres_of("degree") is None


GRIDS = {
    "no CRS": dict(crs=None),
    "a site's own grid": dict(crs='LOCAL_CS["site",UNIT["metre",1]]'),
    "web Mercator": dict(crs="EPSG:3857"),
    "several bands": dict(count=2),
}


@pytest.mark.parametrize("name", GRIDS)
def test_grids(tmp_path, name):
    assert shadow(tmp_path, ridge(tmp_path, **GRIDS[name])) == 100


def test_a_raster_in_an_archive(tmp_path):
    with zipfile.ZipFile(tmp_path / "dsm.zip", "w") as archive:
        archive.write(ridge(tmp_path), "dsm.tif")
    assert shadow(tmp_path, f"/vsizip/{tmp_path}/dsm.zip/dsm.tif") == 100


def test_what_stands_far_from_all_else_is_named(tmp_path):
    """A mesh around its own origin, or places in degrees, in a study in national coordinates."""
    raster = ridge(tmp_path)
    (tmp_path / "roof.obj").write_text(rows("v ") + "f 3 4 5 6 1 2\n")
    notes = answers(tmp_path, raster=raster, meshes=str(tmp_path / "roof.obj"))[2]
    assert re.search(r"roof\.obj: stands 40\d\d km away from all receivers, .*: mesh_offset= moves it", notes[0])
    near = dict(meshes=str(tmp_path / "roof.obj"), mesh_offset=(500_200, 3_999_970, 0))
    assert not answers(tmp_path, raster=raster, **near)[2]
    places = [[500_200, 3_999_970, 1], [-105.0, 36.1, 1]]
    notes = answers(tmp_path, points=places, raster=raster)[2]
    assert len(notes) == 1 and "points.csv: 1 of 2 points lie far from all casters" in notes[0]
    assert "the first at (-105, 36.1);" in notes[0]
    assert not answers(tmp_path, points=[[500_200, 3_999_970, 1], [500_900, 3_999_970, 1]], raster=raster)[2]


TILES = {
    "cells that differ by rounding": dict(transform=rasterio.Affine(5.0000000001, 0, 500_205, 0, -5, 4_000_000)),
    "the same zone as a PROJ string": dict(crs="+proj=utm +zone=13 +datum=NAD83 +units=m"),
    "with a vertical CRS": dict(crs="EPSG:26913+5703"),
}


@pytest.mark.parametrize("name", TILES)
def test_tiles_of_one_product(tmp_path, name):
    more = dict(transform=rasterio.Affine(5, 0, 500_205, 0, -5, 4_000_000)) | TILES[name]
    tiles = [ridge(tmp_path, name="a.tif", columns=(0, 41)), ridge(tmp_path, name="b.tif", columns=(41, 81), **more)]
    assert shadow(tmp_path, tiles) == 100


REFUSED = {
    "degrees": (dict(crs="EPSG:4326", transform=rasterio.Affine(5e-5, 0, 11, 0, -5e-5, 48)),
                "dsm.tif: its coordinates are degrees .WGS 84., not metres on a map: warp it .* .rio warp.*EPSG:32632"),
    "degrees of Colorado": (dict(crs="EPSG:4269", transform=rasterio.Affine(5e-5, 0, -105.9, 0, -5e-5, 40.5)),
                            "degrees .NAD83.*--dst-crs EPSG:32613"),
    "degrees of Wellington": (dict(crs="EPSG:4326", transform=rasterio.Affine(5e-5, 0, 174.8, 0, -5e-5, -41.3)),
                              "--dst-crs EPSG:32760"),
    "degrees of Svalbard's north": (dict(crs="EPSG:4326", transform=rasterio.Affine(5e-5, 0, 20, 0, -5e-5, 84.5)),
                                    "--dst-crs EPSG:32661"),
    "degrees of Antarctica": (dict(crs="EPSG:4326", transform=rasterio.Affine(5e-5, 0, 20, 0, -5e-5, -84.5)),
                              "--dst-crs EPSG:32761"),
    "degrees beyond the antimeridian": (
        dict(crs="EPSG:4326", transform=rasterio.Affine(5e-5, 0, 183, 0, -5e-5, -17)), "--dst-crs EPSG:32701"),
    "feet": (dict(crs="EPSG:2229", transform=rasterio.Affine(5, 0, 6_480_000, 0, -5, 1_840_000)),
             "not metres on a map but US survey foot .NAD83.*: warp it .*EPSG:32611.* height_unit="),
    "a site's grid in feet": (dict(crs='LOCAL_CS["site",UNIT["foot",0.3048]]'), "not metres on a map but foot"),
    "the Earth's centre": (dict(crs="EPSG:4978"), "count from the Earth's centre .WGS 84., not on a map"),
    "an unknown unit": (dict(unit="furlong"), "dsm.tif: its heights are in \"furlong\".*give height_unit="),
    "rain in metres": (dict(tags=dict(standard_name="lwe_thickness_of_precipitation_amount")),
                       "its values are 'lwe_thickness_of_.*standard_name., and no heights; .*give height_unit='metre'"),
    "rain of netCDF": (dict(unit="mm", tags=dict(NETCDF_VARNAME="tp")),
                       "its values are in mm, as rain is, and no heights; if they are, give height_unit='mm'"),
    "nearly flat degrees without a CRS": (
        dict(crs=None, height=0.001, transform=rasterio.Affine(5e-5, 0, 11, 0, -5e-5, 48)),
        "dsm.tif: has no CRS, and its coordinates look like degrees .cells of 5e-05, from 11, 48 on.: say so .rio"),
    "depths": (dict(crs="EPSG:26913+5715"), "points down, and a study needs heights"),
    "no place": (dict(crs=None, transform=None), "has no place on a map .no geotransform.*rio edit-info"),
    "south up": (dict(transform=rasterio.Affine(5, 0, 500_000, 0, 5, 4_000_000)), "not north up .*rio warp"),
    "mirrored": (dict(transform=rasterio.Affine(-5, 0, 500_405, 0, -5, 4_000_000)), "not north up .*rio warp"),
    "rotated": (dict(transform=AFFINE * rasterio.Affine.rotation(10)), "is rotated .*rio warp"),
    "colours": (dict(count=3, dtype="uint8", photometric="RGB"), "is no band of heights .red, uint8; 3 in all"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_grids_that_are_refused(tmp_path, name):
    made, text = REFUSED[name]
    with pytest.raises(ValueError, match=text):
        shadow(tmp_path, ridge(tmp_path, **made))


@pytest.mark.parametrize("transform, crs", [
    (rasterio.Affine(5, 0, 500_000, 0, 5, 3_999_945), "EPSG:26913"),
    (rasterio.Affine(-5, 0, 500_405, 0, -5, 4_000_000), "+proj=utm +zone=13 +datum=NAD83"),
    (AFFINE * rasterio.Affine.rotation(0.1), "EPSG:26913+5703"),
])  # fmt: skip
def test_the_remedy_for_a_raster_that_is_not_north_up_helps(tmp_path, transform, crs):
    with pytest.raises(ValueError, match="not north up") as error:
        shadow(tmp_path, ridge(tmp_path, crs=crs, transform=transform))
    words = shlex.split(re.search(r"\(rio (.*)\)$", str(error.value))[1])
    names = {"IN.tif": str(tmp_path / "dsm.tif"), "OUT.tif": str(tmp_path / "out.tif")}
    main_group([names.get(word, word) for word in words], standalone_mode=False)
    heights = rasters.open_mosaic((names["OUT.tif"],)).heights(5, 6, 0, 81)
    assert np.abs(np.argwhere(heights[0] == 100) - (60 if transform.a < 0 else 20)).max() <= 1


def test_the_remedy_for_degrees_that_run_northwards_is_a_map(tmp_path):
    south_up = rasterio.Affine(5e-5, 0, 11, 0, 5e-5, 48)
    with pytest.raises(
        ValueError, match="not north up .*rio warp IN.tif OUT.tif --dst-crs EPSG:32632 --src-nodata nan"
    ):
        shadow(tmp_path, ridge(tmp_path, crs="EPSG:4326", transform=south_up))


@pytest.mark.parametrize("scale", [0, np.nan])
def test_a_scale_that_makes_all_heights_alike(tmp_path, scale):
    """Of two bands; its remedy is tried."""
    raster = ridge(tmp_path, scale=scale, dtype="int16", count=2)
    with pytest.raises(ValueError, match="dsm.tif: its values times its scale of .* are no heights: give it") as error:
        shadow(tmp_path, raster)
    exec(str(error.value).split("as in: ")[1])
    assert shadow(tmp_path, raster) == 100


@pytest.mark.parametrize("dtype, nodata", [("int16", -32768), ("uint16", 65535), ("float32", np.nan)])
def test_the_remedy_for_degrees_leaves_no_cell_of_height_0(tmp_path, dtype, nodata):
    """The file declares no nodata: what the warped one has beside it must be no ground."""
    place = dict(crs="EPSG:4326", transform=rasterio.Affine(0.01, 0, 10.4, 0, -0.01, 47.5))
    with rasterio.open(tmp_path / "in.tif", "w", width=40, height=30, count=1, dtype=dtype, **place) as file:
        file.write(np.full((1, 30, 40), 900, dtype))
    with pytest.raises(ValueError, match="rio warp") as error:
        shadow(tmp_path, str(tmp_path / "in.tif"))
    words = re.search(r"\(rio (.*)\)", str(error.value))[1].split()
    names = {"IN.tif": str(tmp_path / "in.tif"), "OUT.tif": str(tmp_path / "out.tif")}
    main_group([names.get(word, word) for word in words], standalone_mode=False)
    with rasterio.open(tmp_path / "out.tif") as file:
        heights = file.read(1, masked=True)
        assert np.array_equal(file.nodata, nodata, equal_nan=True)
    assert heights.mask.any() and set(heights.compressed()) == {900}


def test_degrees_that_no_crs_declares(tmp_path):
    """Hills in an .asc file without a .prj: cells of three seconds of arc would be .8 mm wide. Both remedies help."""
    hills = np.float32(500 + 300 * np.add.outer(np.sin(np.arange(30)), np.cos(np.arange(40))))
    file = tmp_path / "in.asc"
    head = "ncols 40\nnrows 30\nxllcorner 10.4\nyllcorner 47.5\ncellsize {}\n"
    file.write_text(head.format(1 / 1200) + "\n".join(" ".join(map(str, row)) for row in hills))
    with pytest.raises(
        ValueError, match="in.asc: has no CRS, and its coordinates look like degrees .cells of"
    ) as error:
        shadow(tmp_path, str(file))
    degrees, metres = (shlex.split(text)[1:] for text in re.findall(r"\((rio .*?\S)\)(?:,|$)", str(error.value)))
    main_group(degrees, standalone_mode=False)
    with pytest.raises(ValueError, match="its coordinates are degrees .WGS 84.*EPSG:32632"):
        shadow(tmp_path, str(file))
    file.write_text(head.format(0.5) + "\n".join(" ".join(map(str, row)) for row in hills))
    (tmp_path / "in.prj").unlink()
    with pytest.raises(ValueError, match="look like degrees"):
        shadow(tmp_path, str(file))
    main_group(metres, standalone_mode=False)
    shadow(tmp_path, str(file))


def test_a_raster_that_gets_another_crs_has_it(tmp_path):
    """A process keeps what it read of a file while the file stays as it is."""
    day = dict(start="2026-06-21T17:00", end="2026-06-21T19:00", step="1h")
    found = []
    for crs in ("EPSG:26913", "EPSG:26912"):
        settings = settings_of(day | dict(raster=ridge(tmp_path, crs=crs)))
        found.append(suns.suns_of(settings, rasters.crs_of(settings), (500_000, 4e6, 500_001, 4e6)).towards)
    assert np.abs(found[0] - found[1]).max() > 0.02  # 6 degrees of longitude


def test_a_mast_in_a_site_of_metres_makes_it_no_degrees(tmp_path):
    """One cell of 500 m, higher than the site is wide."""
    site = rasterio.Affine(1, 0, 10, 0, -1, 50)
    rasters.open_mosaic((ridge(tmp_path, crs=None, transform=site, height=0.5, columns=(0, 21)),))
    with rasterio.open(tmp_path / "dsm.tif", "r+") as file:
        heights = file.read(1)
        heights[3, 3] = 500
        file.write(heights, 1)
    rasters.open_mosaic((str(tmp_path / "dsm.tif"),))


def test_rasters_inside_of_a_file(tmp_path):
    x, y = 500_002.5 + 5 * np.arange(81), 3_999_997.5 - 5 * np.arange(11)
    heights = np.zeros((11, 81), np.float32)
    heights[:, 20] = 100
    rasters = {"low": (("y", "x"), heights / 2), "dsm": (("y", "x"), heights)}
    axes = {name: (name, values, {"standard_name": f"projection_{name}_coordinate", "units": "m"})
            for name, values in (("x", x), ("y", y))}  # fmt: skip
    xarray.Dataset(rasters, axes).to_netcdf(tmp_path / "two.nc", engine="scipy")
    with pytest.raises(ValueError, match="two.nc: has 2 rasters in it: give one of them, such as 'net") as error:
        shadow(tmp_path, str(tmp_path / "two.nc"))
    low = re.search("'(.*)'", str(error.value))[1]
    assert shadow(tmp_path, low) == 50
    assert shadow(tmp_path, low.replace(":low", ":dsm")) == 100
    (tmp_path / "text.gri").write_text("no raster")
    with pytest.raises(ValueError, match="text.gri: GDAL cannot read it .*write it as a GeoTIFF"):
        shadow(tmp_path, str(tmp_path / "text.gri"))


@pytest.mark.parametrize("more, text", [
    (dict(crs="EPSG:26914"), "b.tif: its CRS .NAD83 / UTM zone 14N. is not that of .*a.tif .NAD83 / UTM zone 13N."),
    (dict(transform=rasterio.Affine(5, 0, 500_206.3, 0, -5, 4_000_000)), "b.tif: its grid .cells of 5.0 x 5.0, from"),
    (dict(transform=rasterio.Affine(5.01, 0, 500_205, 0, -5, 4_000_000)), "b.tif: its grid .cells of 5.01 x 5.0"),
    (dict(transform=rasterio.Affine(5, 0, 500_205, 0, -5, 4_000_001.3)), "b.tif: its grid .* 4000001.3 on. is not"),
    (dict(transform=rasterio.Affine(5, 0, 500_205, 0, -5.01, 4_000_000)), "b.tif: its grid .cells of 5.0 x 5.01"),
])  # fmt: skip
def test_tiles_that_do_not_fit(tmp_path, more, text):
    more = dict(transform=rasterio.Affine(5, 0, 500_205, 0, -5, 4_000_000)) | more
    tiles = [ridge(tmp_path, name="a.tif", columns=(0, 41)), ridge(tmp_path, name="b.tif", columns=(41, 81), **more)]
    with pytest.raises(ValueError, match=text):
        shadow(tmp_path, tiles)


# ---- A map metre against a true metre ------------------------------------------------------------------------------
# The shadow of a wall of 100 m at 60 degrees north, measured on the ellipsoid: it is as long on every map.

MAPS = ["EPSG:32632", "EPSG:3857", "EPSG:3035", "EPSG:6933", "EPSG:3395", "EPSG:27700", "EPSG:2154", "EPSG:32661",
        "+proj=laea +lat_0=60 +lon_0=9", "+proj=sinu", "+proj=eqc +lat_ts=30"]  # fmt: skip


@pytest.mark.parametrize("crs", MAPS)
def test_directions_on_the_map(crs):
    """A sun at azimuth a and elevation e: the end of its shadow on the ground, walked on the ellipsoid, is where the
    direction on the map leads."""
    place = suns.Map(crs)
    longitude, latitude = 9.0, 60.0
    x, y = pyproj.Transformer.from_crs("EPSG:4326", crs, always_xy=True).transform(longitude, latitude)
    geod, projection = pyproj.CRS(crs).get_geod(), pyproj.Proj(crs)
    own = projection(x, y, inverse=True)
    for azimuth in range(0, 360, 30):
        towards = suns._on_map(np.array([float(azimuth)]), np.array([20.0]), place.jacobian(x, y))[0]
        length = 100 / np.tan(np.radians(20))
        end = np.array(projection(*geod.fwd(*own, azimuth + 180, length)[:2])) - [x, y]
        assert np.abs(end + towards[:2] / towards[2] * 100).max() < 0.03, azimuth


@pytest.mark.parametrize("crs", ["EPSG:3857", "EPSG:3035", "+proj=sinu", "EPSG:5513"])
def test_suns_by_time_on_the_map(crs):
    """Those of pvlib over the zone's centre, with the ends of their shadows walked on the ellipsoid; numbers that grow
    to the south and west (5513) are a map, too."""
    pvlib = pytest.importorskip("pvlib")
    x, y = pyproj.Transformer.from_crs("EPSG:4326", crs, always_xy=True).transform(18.0, 49.0)
    found = suns_by_time(crs, x, y, zone=100)
    x, y = found.centre(tuple(found.zones[0]))
    longitude, latitude = pyproj.Transformer.from_crs(crs, "EPSG:4326", always_xy=True).transform(x, y)
    position = pvlib.solarposition.spa_python(pandas.DatetimeIndex(found.times), latitude, longitude, delta_t=None)
    geod, projection = pyproj.CRS(crs).get_geod(), pyproj.Proj(crs)
    own = projection(x, y, inverse=True)
    for towards, azimuth, elevation in zip(found.towards[0], position["azimuth"], position["elevation"], strict=True):
        end = np.array(projection(*geod.fwd(*own, azimuth + 180, 100 / np.tan(np.radians(elevation)))[:2])) - [x, y]
        assert np.abs(end + towards[:2] / towards[2] * 100).max() < 0.03


def suns_by_time(crs, x, y, **more):
    day = dict(raster=__file__, start="2026-06-21T10:00+02:00", end="2026-06-21T15:00+02:00", step="1h")
    return suns.suns_of(settings_of(day | more | dict(crs=crs)), None, (x, y, x, y))


#: Numbers of a place, and a CRS to which they do not belong.
ELSEWHERE = {
    "east and north for south and west": ("EPSG:2065", -740_000, -1_040_000),
    "the same of S-JTSK": ("EPSG:5513", -740_000, -1_040_000),
    "south and west for east and north": ("EPSG:5514", 740_000, 1_040_000),
    "east and north of Lo19 for west and south": ("EPSG:2048", -30_000, -3_750_000),
    "northing first": ("EPSG:25832", 5_335_000, 691_000),
    "northing first in New Zealand": ("EPSG:2193", 5_492_760, 1_557_769),
    "the zone of the other hemisphere": ("EPSG:32633", 500_000, -5_335_000),
    "the zone before the number": ("EPSG:25832", 32_691_000, 5_335_000),
    "the wrong strip": ("EPSG:31467", 4_468_000, 5_335_000),
    "feet for metres": ("EPSG:26913", 3_000_000, 14_000_000),
}


@pytest.mark.parametrize("name", ELSEWHERE)
def test_numbers_of_another_crs(name):
    """A mistake would give the suns of another place, without a word."""
    with pytest.raises(ValueError, match="^crs: .*(at longitude|has no longitude)") as error:
        suns_by_time(*ELSEWHERE[name])
    if plain := re.search("give crs='(.*)'$", str(error.value)):
        krovak = ELSEWHERE[name][0] != "EPSG:2048"
        expected = suns_by_time("EPSG:5514" if krovak else "+proj=tmerc +lon_0=19", *ELSEWHERE[name][1:]).towards
        assert np.abs(suns_by_time(plain[1], *ELSEWHERE[name][1:]).towards - expected).max() < 1e-4


def test_places_beside_the_area_of_a_crs():
    """Neighbours of a zone, and maps of the whole Earth or across the antimeridian, are no mistake."""
    for crs in ("EPSG:3857", "EPSG:3832", "EPSG:3413"):
        suns_by_time(crs, 0, 0)
    suns_by_time("EPSG:25832", -200_000, 5_335_000)
    suns_by_time("EPSG:32701", 200_000, 8_000_000)
    suns_by_time("EPSG:2193", 1_557_769, 5_492_760)
