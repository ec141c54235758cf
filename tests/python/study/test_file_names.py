# SPDX-License-Identifier: MIT
"""A study reads its files again, in workers and in later runs: names of any kind are taken; of what is no name one
sentence says how to write it into a file, and that is tried."""

# ruff: noqa: SIM115  files are handed over open

import io
import os
import pathlib
import re

import numpy as np
import pytest

rasterio = pytest.importorskip("rasterio")
from gnomon import study  # noqa: E402
from made import city, write_raster, write_suns  # noqa: E402


class Place:
    """os.PathLike, and no pathlib.Path."""

    def __init__(self, path):
        self.path = path

    def __fspath__(self):
        return str(self.path)


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_raster(tmp_path / "dsm.tif", city(16))
    write_suns(tmp_path / "suns.csv", [(180, 40)])
    return tmp_path


NAMES = {
    "a name": "dsm.tif",
    "a Path": pathlib.Path("dsm.tif"),
    "bytes": b"dsm.tif",
    "any PathLike": Place("dsm.tif"),
    "a pattern": "*.tif",
    "a list": ["dsm.tif"],
    "a tuple of Paths": (pathlib.Path("dsm.tif"),),
    "a list of PathLike": [Place("dsm.tif")],
    "an absolute Path": lambda folder: folder / "dsm.tif",
    "glob's generator": lambda folder: folder.glob("*.tif"),
    "an array of names": np.array(["dsm.tif"]).tolist(),
    "scandir's entry": lambda folder: next(e for e in os.scandir(folder) if e.name == "dsm.tif"),
}


@pytest.mark.parametrize("member", NAMES)
def test_names(member, here):
    name = NAMES[member](here) if callable(NAMES[member]) else NAMES[member]
    done = study(here / "study", raster=name, directions=Place(here / "suns.csv"), outputs=["bits"])
    assert done.record["tasks_done"] == 1 and done.record["settings"]["raster"] == [str(here / "dsm.tif")]


def xarray_raster():
    xarray = pytest.importorskip("xarray")
    return xarray.DataArray(city(16), dims=("y", "x"), coords={"y": np.arange(16.0)[::-1], "x": np.arange(16.0)})


def trimesh_box():
    return pytest.importorskip("trimesh").creation.box()


def pyvista_box():
    return pytest.importorskip("pyvista", exc_type=ImportError).Cube()


def table():
    return pytest.importorskip("pandas").DataFrame({"x": [512_105.0], "y": [5_002_305.0], "z": [900.0]})


#: setting, what is given, and the remedy, as Python on `given`; None: it says where to go.
REFUSED = {
    "a file's bytes": ("raster", lambda: io.BytesIO(pathlib.Path("dsm.tif").read_bytes()),
                       "pathlib.Path(name).write_bytes(file.read())"),
    "an open file": ("raster", lambda: open("dsm.tif", "rb"), "pathlib.Path(name).write_bytes(file.read())"),
    "a dataset of rasterio": ("raster", lambda: rasterio.open("dsm.tif"), "give its name, 'dsm.tif'"),
    "a raster of xarray": ("raster", xarray_raster, "dem.gnomon.sun_hours()"),
    "heights": ("raster", lambda: city(16), "rasterio for heights"),
    "a list of files": ("raster", lambda: [io.BytesIO(b"")], "pathlib.Path(name).write_bytes(file.read())"),
    "a number": ("raster", lambda: 7, "a str or a pathlib.Path"),
    "a trimesh": ("meshes", trimesh_box, "mesh.export('name.ply')"),
    "a mesh of pyvista": ("meshes", pyvista_box, "mesh.save('name.ply')"),
    "a list of meshes": ("meshes", lambda: [trimesh_box()], "mesh.export('name.ply')"),
    "points in an array": ("points", lambda: np.zeros((1, 3)), "numpy.save('name.npy', array)"),
    "points in a table": ("points", table, "table.to_csv(name, index=False)"),
    "a table of suns": ("directions", lambda: np.array([[0, 0, -1.0]]), "numpy.save('name.npy', array)"),
    "weights": ("weights", lambda: np.ones(3), "numpy.save('name.npy', array)"),
}  # fmt: skip


@pytest.mark.parametrize("member", REFUSED)
def test_what_is_no_name_says_how_to_write_it(member, here):
    setting, make, remedy = REFUSED[member]
    arguments = {"raster": "dsm.tif", "directions": "suns.csv", setting: make()}
    with pytest.raises(ValueError, match=f"^{setting}: must be a file's name, .*{re.escape(remedy)}"):
        study(here / "study", **arguments)
    assert not (here / "study").exists()


def test_the_remedies_help(here):
    file, name = open("dsm.tif", "rb"), "copy.tif"
    pathlib.Path(name).write_bytes(file.read())
    file.close()
    table().to_csv("points.csv", index=False)
    np.save("suns.npy", np.array([[0, 0, -1.0]]))
    trimesh_box().export("a.ply")
    pyvista_box().save("b.ply")
    done = study("study", raster=name, meshes=["a.ply", "b.ply"], points="points.csv", receivers="points",
                 mesh_offset=(512_100, 5_002_300, 0), directions="suns.npy", outputs=["weights"])  # fmt: skip
    assert done.dataset().sum_of_weights.values.tolist() == [1.0]
    np.save("points.npy", table().to_numpy())
    done = study("again", raster=rasterio.open("dsm.tif").name, points="points.npy", receivers="points",
                 directions="suns.csv", outputs=["weights"])  # fmt: skip
    assert done.dataset().sum_of_weights.values.tolist() == [1.0]


def test_one_file_where_one_is_meant(here):
    with pytest.raises(ValueError, match="directions: must be one file, not 2"):
        study("study", raster="dsm.tif", directions=["suns.csv", "suns.csv"])
