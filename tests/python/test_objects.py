# SPDX-License-Identifier: MIT
"""Objects that people have: what is taken answers as its triangles do, and what is not taken says what to call."""

# ruff: noqa: SIM115  files are handed over open

import gzip
import io
import mmap
import os
import tarfile
import tempfile
import types
import zipfile
from pathlib import Path

import gnomon
import numpy as np
import pytest
from processes import DOWN, POINTS, RIGHT, ROOF

VERTICES = np.array([[-1, -1, 2], [1, -1, 2], [1, 1, 2], [-1, 1, 2]], float)
FACES = np.array([[0, 1, 2], [0, 2, 3]])


def trimesh():
    return pytest.importorskip("trimesh")


def pyvista():
    return pytest.importorskip("pyvista", exc_type=ImportError)


def moved_scene():
    """The roof lies 100 lower in its own coordinates, and is cut in two nodes."""
    t = trimesh()
    scene = t.Scene()
    up = np.eye(4)
    up[2, 3] = 100
    for face in FACES:
        scene.add_geometry(t.Trimesh(VERTICES - [0, 0, 100], [face], process=False), transform=up)
    return scene


def instanced_scene():
    """One half of the roof twice, the second time turned by half a turn."""
    t = trimesh()
    scene = t.Scene()
    scene.add_geometry(t.Trimesh(VERTICES, FACES[:1], process=False), geom_name="half", node_name="a")
    scene.graph.update(frame_to="b", matrix=np.diag([-1.0, -1, 1, 1]), geometry="half")
    return scene


def blocks():
    p = pyvista()
    mesh = p.PolyData(VERTICES, np.hstack([[4, 0, 1, 2, 3]]))
    low, high = p.PolyData(VERTICES, [3, 0, 1, 2]), p.PolyData(VERTICES, [3, 0, 2, 3])
    nested = p.MultiBlock([p.MultiBlock([low]), high])
    return {"one": p.MultiBlock([mesh]), "two": p.MultiBlock([low, high]), "nested": nested,
            "with an empty one": p.MultiBlock([low, None, high])}  # fmt: skip


def meshio(cells, points=VERTICES):
    pytest.importorskip("meshio")
    import meshio

    return meshio.Mesh(points, cells)


def open3d():
    """By its attributes: the package is large."""
    return types.SimpleNamespace(vertices=VERTICES.tolist(), triangles=FACES.tolist())


def open3d_tensors():
    def tensor(values):
        on_host = types.SimpleNamespace(numpy=lambda: values)
        return types.SimpleNamespace(cpu=lambda: on_host)

    return types.SimpleNamespace(
        vertex=types.SimpleNamespace(positions=tensor(VERTICES.astype(np.float32))),
        triangle=types.SimpleNamespace(indices=tensor(FACES)),
    )


TAKEN = {
    "arrays": lambda: (VERTICES, FACES),
    "lists": lambda: (VERTICES.tolist(), FACES.tolist()),
    "a list of triangles": lambda: (list(VERTICES[FACES]),),
    "a trimesh": lambda: (trimesh().Trimesh(VERTICES, FACES),),
    "a trimesh scene with transforms": lambda: (moved_scene(),),
    "a trimesh scene with instances": lambda: (instanced_scene(),),
    "a trimesh scene of one mesh": lambda: (trimesh().Trimesh(VERTICES, FACES).scene(),),
    "a pyvista mesh": lambda: (pyvista().PolyData(VERTICES, [4, 0, 1, 2, 3]),),
    "a pyvista unstructured grid": lambda: (pyvista().PolyData(VERTICES, [4, 0, 1, 2, 3]).cast_to_unstructured_grid(),),
    "a pyvista structured grid": lambda: (
        pyvista().StructuredGrid(*np.meshgrid([-1.0, 1], [-1.0, 1], [2.0], indexing="ij")),),
    "pyvista blocks": lambda: (blocks()["one"],),
    "two pyvista blocks": lambda: (blocks()["two"],),
    "nested pyvista blocks": lambda: (blocks()["nested"],),
    "pyvista blocks with an empty one": lambda: (blocks()["with an empty one"],),
    "meshio triangles": lambda: (meshio([("triangle", FACES)]),),
    "meshio quads and lines": lambda: (meshio([("line", [[0, 1]]), ("quad", [[0, 1, 2, 3]]), ("vertex", [[0]])]),),
    "meshio, two blocks": lambda: (meshio([("triangle", FACES[:1]), ("triangle", FACES[1:])]),),
    "Open3D, legacy": lambda: (open3d(),),
    "Open3D, tensors": lambda: (open3d_tensors(),),
    "a table": lambda: (pytest.importorskip("pandas").DataFrame(ROOF.reshape(2, 9)),),
    "two tables": lambda: tuple(map(pytest.importorskip("pandas").DataFrame, (VERTICES, FACES))),
    "a DataArray of triangles": lambda: (pytest.importorskip("xarray").DataArray(ROOF).values,),
}  # fmt: skip


@pytest.mark.parametrize("member", TAKEN)
def test_taken(member):
    scene = gnomon.Scene(*TAKEN[member]())
    assert len(scene) == 2
    assert scene.lit(POINTS, direction=DOWN).tolist() == RIGHT
    assert scene.lit(POINTS * [1, -1, 1] - [0.5, 0.25, 0], direction=DOWN).tolist() == [False, True, False]


@pytest.mark.parametrize("make", [lambda mesh: mesh, lambda mesh: pyvista().MultiBlock([mesh])])
def test_pyvista_faces_of_several_sizes(make):
    """A square roof in one face, and a triangle apart from it."""
    apart = [[90, 90, 2], [91, 90, 2], [90, 91, 2]]
    mesh = pyvista().PolyData(np.float32([*VERTICES, *apart]), [4, 0, 1, 2, 3, 3, 4, 5, 6])
    scene = gnomon.Scene(make(mesh))
    assert len(scene) == 3 and scene.lit(POINTS, direction=DOWN).tolist() == RIGHT
    strip = pyvista().PolyData(VERTICES.astype(np.float32), strips=[4, 1, 0, 2, 3])
    assert len(gnomon.Scene(make(strip))) == 2


def raster():
    coords = {"x": range(5), "y": range(4)}
    return pytest.importorskip("xarray").DataArray(np.zeros((4, 5)), dims=("y", "x"), coords=coords)


REFUSED = {
    "a path to glTF": (lambda: Path("town.glb"), "gnomon.Scene.from_gltf"),
    "a name of a glTF file": (lambda: "town.GLTF", "gnomon.Scene.from_gltf"),
    "a path to another mesh": (lambda: Path("town.obj"), "trimesh.load"),
    "an open file": (lambda: io.BytesIO(b"glTF"), r"gnomon.Scene.from_gltf\(file\).*trimesh.load"),
    "the bytes of a file": (lambda: b"glTF", r"gnomon.Scene.from_gltf\(io.BytesIO\(data\)\)"),
    "a path in a zip file": (lambda: types.SimpleNamespace(read_bytes=bytes), r"gnomon.Scene.from_gltf\(file\)"),
    "a dictionary": (lambda: {"vertices": VERTICES, "faces": FACES}, "gnomon.Scene.vertices, faces"),
    "a raster of xarray": (raster, "gnomon.study.*raster="),
    "an xarray dataset": (lambda: raster().to_dataset(name="dsm"), "gnomon.study.*raster="),
    "a cloud of trimesh": (lambda: trimesh().PointCloud(VERTICES), "no faces"),
    "a cloud of pyvista": (lambda: pyvista().PolyData(VERTICES), "points or lines and no faces"),
    "lines of pyvista": (lambda: pyvista().Line(), "points or lines and no faces"),
    "lines of meshio": (lambda: meshio([("line", [[0, 1]])]), "points or lines and no faces"),
    "a trimesh scene of paths": (
        lambda: trimesh().Scene(trimesh().load_path(VERTICES[:2].astype(float))),
        "points or lines and no faces",
    ),
    "meshes in a list": (lambda: [trimesh().Trimesh(VERTICES, FACES)] * 2, "trimesh.util.concatenate"),
    "meshio tetrahedra": (lambda: meshio([("tetra", [[0, 1, 2, 3]])]), "pyvista.wrap.*extract_surface"),
    "a flat meshio mesh": (lambda: meshio([("triangle", FACES)], VERTICES[:, :2]), "in two dimensions.*column_stack"),
    "a polygon": (lambda: types.SimpleNamespace(geom_type="Polygon"), "extrude_polygon"),
    "a table of geometries": (lambda: types.SimpleNamespace(geometry=[]), "extrude_polygon"),
    "vertices and faces in a tuple": (lambda: (VERTICES, FACES), r"apart, gnomon.Scene\(vertices, faces\)"),
    "a filter of VTK": (
        lambda: types.SimpleNamespace(GetOutput=None, Update=None),
        r"pyvista.wrap\(it.GetOutput\(\)\)",
    ),
    "a mesh of VTK": (lambda: types.SimpleNamespace(GetPoints=None, GetNumberOfCells=None), "pyvista.wrap"),
}


@pytest.mark.parametrize("member", REFUSED)
def test_not_taken_says_what_to_call(member):
    make, remedy = REFUSED[member]
    with pytest.raises(TypeError, match=f"^vertices: .*{remedy}"):
        gnomon.Scene(make())


def test_arrays_that_hold_no_numbers_say_what_to_call():
    """An iterator, and the records that readers of PLY and LAS files give."""
    with pytest.raises(ValueError, match=r"^vertices: .*list\(\)"):
        gnomon.Scene(iter(ROOF))
    records = np.array([tuple(v) for v in VERTICES], [(axis, "f4") for axis in "xyz"])
    with pytest.raises(ValueError, match="^vertices: .*records of x, y, z: .*structured_to_unstructured"):
        gnomon.Scene(records)
    assert gnomon.Scene(records, FACES).lit(POINTS, direction=DOWN).tolist() == RIGHT
    vertices = np.lib.recfunctions.structured_to_unstructured(records)
    assert gnomon.Scene(vertices, FACES).lit(POINTS, direction=DOWN).tolist() == RIGHT


def test_columns_of_a_table_go_by_their_names():
    """In any order, beside others, in a structured array, too: by their places they are other points."""
    pandas = pytest.importorskip("pandas")
    scene = gnomon.Scene(ROOF)
    points = np.asarray(POINTS, float)
    z_first = pandas.DataFrame({"Z": points[:, 2], "id": ["a"] * len(points), "Y": points[:, 1], "X": points[:, 0]})
    assert scene.lit(z_first, direction=DOWN).tolist() == RIGHT
    fields = np.zeros(len(points), [("z", "f8"), ("x", "f4"), ("y", "f8")])
    for k, field in enumerate("xyz"):
        fields[field] = points[:, k]
    assert scene.lit(fields, direction=DOWN).tolist() == RIGHT
    assert scene.lit(pandas.DataFrame(points), direction=DOWN).tolist() == RIGHT, "columns without names"
    for columns in (["a", "b", "c"], ["x", "y", "Y"], ["x", "y", "z", "X"]):
        with pytest.raises(ValueError, match="points: of the columns .* three must be x, y, z, each once"):
            scene.lit(pandas.DataFrame(np.zeros((2, len(columns))), columns=columns), direction=DOWN)


def test_lights_go_by_their_names():
    scene = gnomon.Scene(ROOF)
    for light in ({"z": -1, "x": 0, "y": 0}, pytest.importorskip("pandas").Series({"Z": -1.0, "Y": 0, "X": 0})):
        assert scene.lit([[0, 0, 0], [5, 0, 0]], direction=light).tolist() == [False, True]
    with pytest.raises(ValueError, match="direction: of the names a, b, c three must be x, y, z, each once"):
        scene.lit([[0, 0, 0]], direction={"a": 0, "b": 0, "c": -1})


def test_lights_of_a_table_have_its_weights():
    pandas = pytest.importorskip("pandas")
    scene, free = gnomon.Scene(ROOF), [[5, 0, 0]]
    suns = pandas.DataFrame({"Weight": [2.0, 3], "z": [-1.0, -1], "y": [0, 0.1], "x": [0, 0]})
    records = suns.to_records(index=False)
    for rows in (suns, records, suns.to_xarray()):
        assert scene.lit_by(free, gnomon.Lights.directions(rows)).sums.tolist() == [5]
    assert scene.lit_by(free, gnomon.Lights.directions(suns, [1, 1])).sums.tolist() == [2]
    lamps = pandas.DataFrame({"x": [5.0], "y": [0], "z": [9], "weight": [7]})
    assert scene.lit_by(free, gnomon.Lights.positions(lamps)).sums.tolist() == [7]
    with pytest.warns(UserWarning, match='^directions: "dni": not read, and every sun weighs 1'):
        scene.lit_by(free, gnomon.Lights.directions(suns.rename(columns={"Weight": "dni"})))


def test_techniques_and_settings_that_are_none_are_named():
    scene = gnomon.Scene(ROOF)
    lights = gnomon.Lights.directions([DOWN])
    with pytest.raises(TypeError, match=r"technique: must be a name of gnomon.techniques\(\) or .*, not 5"):
        scene.visibility(POINTS, direction=DOWN, technique=5)
    for ask in (lambda s: scene.lit_by(POINTS, lights, settings=s),
                lambda s: scene.visibility(POINTS, direction=DOWN, technique=gnomon.Technique("pcf", s))):  # fmt: skip
        with pytest.raises(TypeError, match="settings: must be a mapping of names to values, not .'map-size'.$"):
            ask(["map-size"])


def test_what_is_no_array_is_named():
    scene = gnomon.Scene(ROOF)
    with pytest.raises(ValueError, match="points: is no array: .*inhomogeneous"):
        scene.lit([[1, 2, 3], [1, 2]], direction=DOWN)
    iterator = (row for row in POINTS)
    for none, text in ((iterator, r"generator: give the list\(\)"), ({"x": 1}, "dict"), ({(1, 2)}, "set")):
        with pytest.raises(ValueError, match=f"points: must be real numbers, not {text}"):
            scene.lit(none, direction=DOWN)
    place = types.SimpleNamespace(x=1, y=2, z=3)
    with pytest.raises(ValueError, match="points: must be real numbers, not SimpleNamespace"):
        scene.lit([place], direction=DOWN)
    assert scene.lit([[10**25, 0, 0]], direction=(0, 0, -(10**25))).tolist() == [True]


def test_the_remedy_for_a_cell_of_a_volume_helps():
    mesh = meshio([("tetra", [[0, 1, 2, 3]])], VERTICES - [[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 1]])
    assert len(gnomon.Scene(pyvista().wrap(mesh).extract_surface())) == 4


LEAVES = Path(__file__).parents[2] / "scenes" / "leaves.glb"
needs_gltf = pytest.mark.skipif(
    not hasattr(gnomon._gnomon, "load_scene"), reason="this build reads no glTF files: a library was missing"
)


def member_of_zip(folder, data):
    with zipfile.ZipFile(folder / "a.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("scenes/leaves.glb", data)
    return zipfile.ZipFile(folder / "a.zip")


def unbuffered(folder, data):
    (folder / "a.glb").write_bytes(data)
    return open(folder / "a.glb", "rb", buffering=0)


def after_a_header(folder, data):
    file = io.BytesIO(b"header" + data)
    file.seek(6)
    return file


def mapped(folder, data):
    with open(folder / "a.glb", "w+b") as file:
        file.write(data)
        file.flush()
        return mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)


def packed(folder, data):
    (folder / "a.glb.gz").write_bytes(gzip.compress(data))
    return gzip.open(folder / "a.glb.gz", "rb")


def temporary(folder, data):
    file = tempfile.TemporaryFile(dir=folder)
    file.write(data)
    file.seek(0)
    return file


def member_of_tar(folder, data):
    with tarfile.open(folder / "a.tar", "w") as archive:
        entry = tarfile.TarInfo("leaves.glb")
        entry.size = len(data)
        archive.addfile(entry, io.BytesIO(data))
    return tarfile.open(folder / "a.tar").extractfile("leaves.glb")


class Response:
    """What urllib and requests hand over: read() and nothing else."""

    def __init__(self, data):
        self.read = lambda: data


FILES = {
    "a Path": lambda folder, data: LEAVES,
    "a name": lambda folder, data: str(LEAVES),
    "any PathLike": lambda folder, data: type("Place", (), {"__fspath__": lambda self: str(LEAVES)})(),
    "an open file": lambda folder, data: open(LEAVES, "rb"),
    "an unbuffered file": unbuffered,
    "BytesIO": lambda folder, data: io.BytesIO(data),
    "BytesIO that stands after a header": after_a_header,
    "a member of a zip file": lambda folder, data: member_of_zip(folder, data).open("scenes/leaves.glb"),
    "a path in a zip file": lambda folder, data: zipfile.Path(member_of_zip(folder, data), "scenes/leaves.glb"),
    "a member of a tar file": member_of_tar,
    "gzip": packed,
    "a temporary file": temporary,
    "mmap": mapped,
    "a response": lambda folder, data: Response(data),
    "a bytearray's": lambda folder, data: Response(bytearray(data)),
}


@needs_gltf
@pytest.mark.parametrize("member", FILES)
def test_files_of_gltf(member, tmp_path):
    given = FILES[member](tmp_path, LEAVES.read_bytes())
    scene, same = gnomon.Scene.from_gltf(given), gnomon.Scene.from_gltf(LEAVES)
    assert (scene.triangles == same.triangles).all() and scene.cut_out_counts == same.cut_out_counts
    if hasattr(given, "close"):
        given.close()


def seek_to_end(file):
    file.seek(0, os.SEEK_END)
    return file


def closed(file):
    file.close()
    return file


OTHER_FILES = {
    "bytes": (lambda: LEAVES.read_bytes(), TypeError, r"not bytes: io.BytesIO\(data\) is one"),
    "a file of text": (lambda: open(LEAVES, encoding="latin-1"), TypeError, "leaves.glb gives str.*mode 'rb'"),
    "StringIO": (lambda: io.StringIO("{}"), TypeError, "<StringIO> gives str, not bytes"),
    "a number": (lambda: 3, TypeError, r"not int: open\(name, 'rb'\) is one"),
    "None": (lambda: None, TypeError, "not NoneType"),
    "a name that is not there": (lambda: "none.glb", FileNotFoundError, "none.glb: does not exist"),
    "a URL": (lambda: "https://a.org/b.glb", FileNotFoundError, "https://a.org/b.glb: does not exist here: download"),
    "nothing": (io.BytesIO, ValueError, "^path: <BytesIO> gives no bytes: it is empty"),
    "a file at its end": (lambda: seek_to_end(io.BytesIO(b"glTF")), ValueError, r"read to its end \(seek\(0\)\)"),
    "a closed file": (lambda: closed(open(LEAVES, "rb")), ValueError, "leaves.glb cannot be read: read of closed file"),
    "a file for writing": (lambda: open(os.devnull, "wb"), ValueError, "^path: /dev/null cannot be read"),
    "a zip file": (lambda: zipfile.ZipFile(io.BytesIO(b"PK\5\6" + bytes(18))), TypeError, "ZipFile .*: open a member"),
    "a class": (lambda: io.BytesIO, TypeError, "^path: "),
    "no glTF": (lambda: io.BytesIO(b"no glTF at all"), ValueError, "^<BytesIO>: "),
    "half a file": (lambda: io.BytesIO(LEAVES.read_bytes()[:5000]), ValueError, "^<BytesIO>: "),
    "files beside it": (
        lambda: io.BytesIO(b'{"asset":{"version":"2.0"},"buffers":[{"uri":"a.bin","byteLength":4}]}'),
        ValueError, "^<BytesIO>: its file 'a.bin' does not exist .*give the file's name",
    ),
}  # fmt: skip


@needs_gltf
@pytest.mark.parametrize("member", OTHER_FILES)
def test_other_files_of_gltf(member):
    make, kind, says = OTHER_FILES[member]
    given = make()
    with pytest.raises(kind, match=says) as error:
        gnomon.Scene.from_gltf(given)
    if hasattr(given, "close") and member != "a class":
        given.close()  # else a later test that records warnings gets that of an unclosed file
    assert "\n" not in str(error.value) and "/gnomon-" not in str(error.value)


def test_arrays_are_not_read_from_files(tmp_path):
    scene = gnomon.Scene(VERTICES, FACES)
    np.savetxt(tmp_path / "a.csv", POINTS, delimiter=",")
    for file in (tmp_path / "a.csv", str(tmp_path / "a.csv"), io.BytesIO(b"1,2,3")):
        with pytest.raises(ValueError, match=r"^points: must be an array, not a file \(.*numpy.loadtxt"):
            scene.lit(file, direction=DOWN)
        with pytest.raises(ValueError, match=r"^heights: must be an array, not a file .*rasterio.open"):
            gnomon.viewshed(file, (0, 0))
    image = pytest.importorskip("PIL.Image")
    image.new("RGBA", (2, 2), (0, 0, 0, 7)).save(tmp_path / "leaf.png")
    uv = VERTICES[:, :2]
    with pytest.raises(ValueError, match=r"alpha: must be an array, not a file \(.*PIL.Image.open\(file\)"):
        gnomon.Scene(VERTICES, FACES, cut_outs=gnomon.CutOuts([0, 0], [gnomon.CutOut(tmp_path / "leaf.png")], uv))
    assert (np.asarray(image.open(tmp_path / "leaf.png").convert("RGBA"))[..., 3] == 7).all()
    with pytest.raises(ValueError, match="direction: must be three numbers, not 'down'"):
        scene.lit([[0, 0, 0]], direction="down")
    assert scene.lit(np.loadtxt(tmp_path / "a.csv", delimiter=","), direction=DOWN).tolist() == RIGHT


def test_labelled_arrays_go_by_their_labels():
    """Wherever the labels stand; three points along the other axis hide an exchange of axes from the shape."""
    xarray = pytest.importorskip("xarray")
    rows = np.array([[0, 0, 0], [5, 0, 0], [0.5, 0, 0]], float)
    right = gnomon.Scene(ROOF).lit(rows, direction=DOWN).tolist()
    assert right == [False, True, False]
    zyx = xarray.DataArray(rows[:, ::-1], dims=("point", "axis"), coords={"axis": list("zyx")})
    across = xarray.DataArray(rows.T, dims=("axis", "point"), coords={"axis": list("XYZ")})
    table = xarray.Dataset({name: ("point", rows[:, i]) for i, name in enumerate("xyz")})
    for points in (zyx, across, zyx.T, table[["z", "x", "y"]]):
        assert gnomon.Scene(ROOF).lit(points, direction=DOWN).tolist() == right
    with pytest.raises(ValueError, match="points: of the columns x, y three must be x, y, z"):
        gnomon.Scene(ROOF).lit(table[["x", "y"]], direction=DOWN)
    for cloud, part in ((pyvista().PolyData(rows), "points"), (trimesh().PointCloud(rows), "vertices")):
        with pytest.raises(TypeError, match=f"points: .* is no array: give its {part}, numpy.asarray"):
            gnomon.Scene(ROOF).lit(cloud, direction=DOWN)


def _hidden_roof(how):
    """A roof of 4 x 4 cells of 1, at height 2, without those of x below 0."""
    x, y = np.meshgrid(np.arange(5.0) - 2, np.arange(5.0) - 2, indexing="ij")
    grid = pyvista().StructuredGrid(x, y, np.full_like(x, 2.0))
    if how == "points":
        grid.hide_points(np.flatnonzero(grid.points[:, 0] < 0))
        return grid
    grid.hide_cells(np.flatnonzero(grid.cell_centers().points[:, 0] < 0), inplace=True)
    if how == "a surface":
        return grid.extract_surface()
    if how == "blocks":
        return pyvista().MultiBlock([None, grid])
    if how == "meshio":
        meshio = pytest.importorskip("meshio")
        surface = grid.extract_surface()
        quads = [("quad", surface.faces.reshape(-1, 5)[:, 1:])]
        return meshio.Mesh(surface.points, quads, cell_data={"vtkGhostType": [surface.cell_data["vtkGhostType"]]})
    return grid


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("how", ["cells", "points", "a surface", "blocks", "meshio"])
def test_hidden_cells_are_not_there(how):
    scene = gnomon.Scene(_hidden_roof(how))
    assert scene.lit([[-1.5, 0.1, 0], [0.5, 0.1, 0], [1.5, 0.1, 0]], direction=DOWN).tolist() == [True, False, False]


def test_an_empty_multi_block_is_said():
    with pytest.raises(TypeError, match="vertices: MultiBlock has no blocks: give it meshes first, by append"):
        gnomon.Scene(pyvista().MultiBlock())
