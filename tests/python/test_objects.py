# SPDX-License-Identifier: MIT
"""Objects that people have: what is taken answers as its triangles do, and what is not taken says what to call."""

import io
import os
import types
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
    return {"one": p.MultiBlock([mesh]), "two": p.MultiBlock([low, high]), "nested": p.MultiBlock([p.MultiBlock([low]), high]),
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


def raster():
    return pytest.importorskip("xarray").DataArray(np.zeros((4, 5)), dims=("y", "x"), coords={"x": range(5), "y": range(4)})


REFUSED = {
    "a path to glTF": (lambda: Path("town.glb"), "gnomon.Scene.from_gltf"),
    "a name of a glTF file": (lambda: "town.GLTF", "gnomon.Scene.from_gltf"),
    "a path to another mesh": (lambda: Path("town.obj"), "trimesh.load"),
    "an open file": (lambda: io.BytesIO(b"glTF"), "trimesh.load"),
    "a dictionary": (lambda: {"vertices": VERTICES, "faces": FACES}, "gnomon.Scene.vertices, faces"),
    "a raster of xarray": (raster, "gnomon.study.*raster="),
    "an xarray dataset": (lambda: raster().to_dataset(name="dsm"), "gnomon.study.*raster="),
    "a cloud of trimesh": (lambda: trimesh().PointCloud(VERTICES), "no faces"),
    "meshes in a list": (lambda: [trimesh().Trimesh(VERTICES, FACES)] * 2, "trimesh.util.concatenate"),
    "meshio tetrahedra": (lambda: meshio([("tetra", [[0, 1, 2, 3]])]), "pyvista.wrap.*extract_surface"),
    "a polygon": (lambda: types.SimpleNamespace(geom_type="Polygon"), "extrude_polygon"),
    "a table of geometries": (lambda: types.SimpleNamespace(geometry=[]), "extrude_polygon"),
    "a mesh of VTK": (lambda: types.SimpleNamespace(GetPoints=None, GetNumberOfCells=None), "pyvista.wrap"),
}


@pytest.mark.parametrize("member", REFUSED)
def test_not_taken_says_what_to_call(member):
    make, remedy = REFUSED[member]
    with pytest.raises(TypeError, match=f"^vertices: .*{remedy}"):
        gnomon.Scene(make())


def test_the_remedy_for_a_cell_of_a_volume_helps():
    mesh = meshio([("tetra", [[0, 1, 2, 3]])], VERTICES - [[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 1]])
    assert len(gnomon.Scene(pyvista().wrap(mesh).extract_surface())) == 4


def test_files_of_gltf(tmp_path):
    leaves = Path(__file__).parents[2] / "scenes" / "leaves.glb"
    try:
        count = len(gnomon.Scene.from_gltf(leaves))
    except RuntimeError as error:
        pytest.skip(str(error))
    assert len(gnomon.Scene.from_gltf(str(leaves))) == count
    with open(leaves, "rb") as file, pytest.raises(TypeError, match="path: must be a file's name"):
        gnomon.Scene.from_gltf(file)
    with pytest.raises(FileNotFoundError, match=os.fspath(tmp_path)):
        gnomon.Scene.from_gltf(tmp_path / "none.glb")
