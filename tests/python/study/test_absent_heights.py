# SPDX-License-Identifier: MIT
"""Every carrier of *no data* of rasters: declared ones are absent; others are one sentence with file, cell, value and a
remedy, which is tried here."""

import base64
import json
import struct
import subprocess
import sys

import numpy as np
import pytest
import rasterio
from gnomon import _arrays, studies
from made import UTM, write_suns

SUNS = [(180, 45)]
#: A flat ground at 10 with one hole.
HOLE = (5, 7)


def write(path, value, dtype, nodata=None, mask=None, alpha=False, **more):
    heights = np.full((24, 24), 10, dtype)
    heights[HOLE] = value
    with rasterio.open(
        path, "w", driver="GTiff", height=24, width=24, count=2 if alpha else 1, dtype=dtype, crs=UTM, nodata=nodata,
        transform=rasterio.Affine(25, 0, 512_000, 0, -25, 5_002_400), **more,
    ) as file:  # fmt: skip
        file.write(heights, 1)
        is_there = np.full(heights.shape, 255, np.uint8)
        is_there[HOLE] = 0
        if mask:
            file.write_mask(is_there)
        if alpha:
            top = np.iinfo(dtype).max if np.dtype(dtype).kind in "iu" else 255
            file.write((is_there // 255).astype(dtype) * np.array(top, dtype), 2)
            file.colorinterp = [rasterio.enums.ColorInterp.gray, rasterio.enums.ColorInterp.alpha]
    return str(path)


def hours(folder, raster, **more):
    suns = write_suns(folder / "suns.csv", SUNS)
    study = studies.study(folder / "study", raster=raster, directions=suns, outputs=["bits"], **more)
    return study.dataset()


def is_absent(dataset):
    """All of the flat ground is lit, but for the hole, where nothing stands and which shadows nothing."""
    lit = (dataset.lit.values[0] & 1).astype(bool)
    expected = np.ones(lit.shape, bool)
    expected[HOLE] = False
    return (lit == expected).all()


LOWEST = float(np.finfo(np.float32).min)
DECLARED = {
    "nodata in float32": dict(value=-9999, dtype="float32", nodata=-9999),
    "nodata in float64": dict(value=-1e300, dtype="float64", nodata=-1e300),
    "nodata in int16": dict(value=-32768, dtype="int16", nodata=-32768),
    "nodata in uint16": dict(value=65535, dtype="uint16", nodata=65535),
    "nodata in uint8": dict(value=255, dtype="uint8", nodata=255),
    "nodata in int32": dict(value=-(2**31), dtype="int32", nodata=-(2**31)),
    "nodata is the lowest float": dict(value=LOWEST, dtype="float32", nodata=LOWEST),
    "nodata is 0": dict(value=0, dtype="float32", nodata=0),
    "nodata is NaN": dict(value=np.nan, dtype="float32", nodata=np.nan),
    "NaN, undeclared": dict(value=np.nan, dtype="float32"),
    "NaN, and nodata is another": dict(value=np.nan, dtype="float64", nodata=-9999),
    "infinity": dict(value=np.inf, dtype="float32"),
    "minus infinity": dict(value=-np.inf, dtype="float32"),
    "a mask in the file": dict(value=0, dtype="float32", mask=True),
    "a mask over a fill value": dict(value=-32768, dtype="int16", mask=True),
    "an alpha band": dict(value=0, dtype="uint16", alpha=True),
    "tiled and deflated": dict(value=-9999, dtype="float32", nodata=-9999, tiled=True, blockxsize=16, blockysize=16,
                               compress="deflate"),
}  # fmt: skip


@pytest.mark.parametrize("carrier", DECLARED)
def test_declared(carrier, tmp_path):
    raster = write(tmp_path / "dsm.tif", **DECLARED[carrier])
    assert is_absent(hours(tmp_path, raster))


def test_a_hole_in_low_ground(tmp_path):
    """Its corners are no vertices at height 0, which would stand 300 m above the ground."""
    heights = np.full((24, 24), -300, "float32")
    heights[HOLE] = -9999
    raster = write(tmp_path / "dsm.tif", -9999, "float32", -9999)
    with rasterio.open(raster, "r+") as file:
        file.write(heights, 1)
    assert is_absent(hours(tmp_path, raster))


def test_declared_elsewhere(tmp_path):
    """In a file beside the raster, and in a VRT around it."""
    raster = write(tmp_path / "dsm.tif", -9999, "float32")
    with rasterio.open(raster) as file:
        west, north = file.bounds.left, file.bounds.top
    vrt = tmp_path / "dsm.vrt"
    vrt.write_text(
        f'<VRTDataset rasterXSize="24" rasterYSize="24"><SRS>{UTM}</SRS>'
        f"<GeoTransform>{west},25,0,{north},0,-25</GeoTransform>"
        '<VRTRasterBand dataType="Float32" band="1"><NoDataValue>-9999</NoDataValue><SimpleSource>'
        '<SourceFilename relativeToVRT="1">dsm.tif</SourceFilename><SourceBand>1</SourceBand></SimpleSource>'
        "</VRTRasterBand></VRTDataset>"
    )
    assert is_absent(hours(tmp_path, str(vrt)))
    (tmp_path / "dsm.tif.aux.xml").write_text(
        '<PAMDataset><PAMRasterBand band="1"><NoDataValue>-9999</NoDataValue></PAMRasterBand></PAMDataset>'
    )
    assert is_absent(hours(tmp_path, raster, restart=True))


UNDECLARED = {
    "the lowest float": (LOWEST, "float32", None),
    "the lowest double": (float(np.finfo(np.float64).min), "float64", None),
    "the largest float": (-LOWEST, "float32", None),
    "netCDF's": (9.969209968386869e36, "float32", None),
    "1e20": (1e20, "float32", None),
    "-9999": (-9999, "float32", None),
    "-9999 in int16": (-9999, "int16", None),
    "-32768 in float32": (-32768, "float32", None),
    "-32768 in int16": (-32768, "int16", None),
    "-32767 in int16": (-32767, "int16", None),
    "32767 in int16": (32767, "int16", None),
    "65535 in uint16": (65535, "uint16", None),
    "the least int32": (-(2**31), "int32", None),
    "-9999.9 in float32": (-9999.9, "float32", None),
    "-999 in int16": (-999, "int16", None),
    "-99.9 in float64": (-99.9, "float64", None),
    "100 km deep": (-100_000, "float32", None),
    "9999 in int16": (9999, "int16", None),
    "99999 in float32": (99999, "float32", None),
    "another one is declared": (-32768, "int16", -9999),
}


def test_lows_that_are_heights(tmp_path):
    """A slope down to -999 has neighbours of its kind, and a file that says what its no data is may have a pit."""
    heights = np.linspace(-999, 10, 576).reshape(24, 24)
    assert _arrays.first_no_height(heights, np.ones(heights.shape, bool)) is None
    hours(tmp_path, write(tmp_path / "dsm.tif", -999, "float32", -9999))


@pytest.mark.parametrize("value", [-99, -999, -999.9, -9999, -32768, -100_000, -(2**31), LOWEST])
def test_a_whole_file_of_it(value, tmp_path):
    """Of two files side by side the eastern one has no ground, as a product's tile in the sea."""
    files = [str(tmp_path / name) for name in ("west.tif", "east.tif")]
    for nodata in (None, value):
        for column, (file, height) in enumerate(zip(files, (10, value), strict=True)):
            place = rasterio.Affine(25, 0, 512_000 + 25 * 16 * column, 0, -25, 5_002_400)
            with rasterio.open(file, "w", driver="GTiff", height=16, width=16, count=1, dtype="float32", crs=UTM,
                               nodata=nodata, transform=place) as raster:  # fmt: skip
                raster.write(np.full((16, 16), height, "float32"), 1)
        if nodata is None:
            with pytest.raises(ValueError, match="east.tif: the cell in row 0, column 0 is .*, which is no height"):
                hours(tmp_path, files)
    lit = hours(tmp_path, files).lit.values[0] & 1
    assert lit[:, :16].all() and not lit[:, 16:].any()


@pytest.mark.parametrize("carrier", UNDECLARED)
def test_undeclared_is_one_sentence_and_its_remedy_helps(carrier, tmp_path):
    value, dtype, nodata = UNDECLARED[carrier]
    raster = write(tmp_path / "dsm.tif", value, dtype, nodata)
    with pytest.raises(ValueError, match="row 5, column 7 is ") as error:
        hours(tmp_path, raster)
    text = str(error.value)
    assert "run the same study again" not in text and "\n" not in text and text.startswith(raster)
    absent, *ground = text[text.index("rio edit-info") :].split("; if the ground lies there, ")
    for remedy in ground + [absent]:
        code = "import sys; from rasterio.rio.main import main_group; sys.exit(main_group(sys.argv[1:]))"
        done = subprocess.run([sys.executable, "-c", code, *remedy.split()[1:]], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        assert is_absent(hours(tmp_path, raster, restart=True))  # a pit as deep is as dark
        with rasterio.open(raster) as file:
            assert (file.read_masks(1)[HOLE] == 0) == (remedy == absent)
    assert len(ground) == (-9999 < value < 0)


def test_a_raster_without_any_data_is_said(tmp_path):
    raster = write(tmp_path / "dsm.tif", 10, "float32", nodata=10)  # the ground's height
    with pytest.warns(UserWarning, match="no place of the study has data"):
        heights = hours(tmp_path, raster)
    assert not heights.lit.values.any()


def test_by_workers_it_is_the_same_sentence(tmp_path):
    raster = write(tmp_path / "dsm.tif", -32768, "int16")
    with pytest.raises(ValueError, match="row 5, column 7 is -32768, which is no height"):
        hours(tmp_path, raster, workers=1)


@pytest.mark.parametrize(
    ("value", "dtype"), [(-9998, "int16"), (0, "float32"), (0, "uint16"), (255, "uint8"), (8848, "float32")]
)
def test_heights_are_heights(value, dtype, tmp_path):
    heights = hours(tmp_path, write(tmp_path / "dsm.tif", value, dtype))
    assert (heights.lit.values[0] & 1)[0, 0] == 1


def test_a_mesh_with_a_fill_value(tmp_path):
    mesh = tmp_path / "mesh.obj"
    mesh.write_text("v 0 0 0\nv 1 0 0\nv 0 1 -3.4028234663852886e+38\nf 1 2 3\n")
    points = tmp_path / "points.csv"
    points.write_text("x,y,z\n0,0,5\n")
    suns = write_suns(tmp_path / "suns.csv", SUNS)
    with pytest.raises((ValueError, studies.StudyStoppedError), match="stands for no data"):
        studies.study(tmp_path / "study", meshes=[str(mesh)], receivers="points", points=str(points), directions=suns)


ROWS = [(0, 0, 4), (8, 0, 4), (8, 8, -9999), (0, 8, 4)]


def _off(rows):
    return "OFF\n4 2 0\n" + "".join("{} {} {}\n".format(*row) for row in rows) + "3 0 1 2\n3 0 2 3\n"


def _ply(rows):
    head = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    return head + "element face 2\nproperty list uchar int vertex_indices\nend_header\n" + _off(rows)[10:]


def _obj(rows):
    return "".join("v {} {} {}\n".format(*row) for row in rows) + "f 1 2 3\nf 1 3 4\n"


def _stl(rows):
    text = "solid a\n"
    for face in ((0, 1, 2), (0, 2, 3)):
        corners = "".join("vertex {} {} {}\n".format(*rows[i]) for i in face)
        text += f"facet normal 0 0 1\nouter loop\n{corners}endloop\nendfacet\n"
    return text + "endsolid a\n"


def _cityjson(rows):
    surface = dict(type="MultiSurface", lod="1", boundaries=[[[0, 1, 2]], [[0, 2, 3]]])
    objects = {"a": dict(type="Building", geometry=[surface])}
    transform = dict(scale=[1, 1, 1], translate=[0, 0, 0])
    return json.dumps(dict(type="CityJSON", version="2.0", transform=transform, vertices=rows, CityObjects=objects))


def _gltf(rows):
    positions = struct.pack("<18f", *(float(n) for face in ((0, 1, 2), (0, 2, 3)) for i in face for n in rows[i]))
    uri = "data:application/octet-stream;base64," + base64.b64encode(positions).decode()
    return json.dumps(dict(
        asset=dict(version="2.0"), buffers=[dict(byteLength=72, uri=uri)], bufferViews=[dict(buffer=0, byteLength=72)],
        accessors=[dict(bufferView=0, componentType=5126, count=6, type="VEC3")],
        meshes=[dict(primitives=[dict(attributes=dict(POSITION=0))])], nodes=[dict(mesh=0)], scenes=[dict(nodes=[0])],
    ))  # fmt: skip


WRITERS = {"obj": _obj, "ply": _ply, "off": _off, "stl": _stl, "city.json": _cityjson, "gltf": _gltf}


def study_below(mesh, points, **how):
    """Of two points under a mesh, with the sun in the zenith."""
    table = mesh.with_name("points.csv")
    table.write_text("x,y,z\n" + "".join(f"{x},{y},{z}\n" for x, y, z in points))
    up = dict(mesh_up="z") if mesh.suffix == ".gltf" else {}
    return studies.study(
        mesh.with_name("study"), meshes=[str(mesh)], receivers="points", points=str(table),
        directions=write_suns(mesh.with_name("suns.csv"), [(180, 89.9)]), outputs=["bits"], **up, **how,
    )  # fmt: skip


@pytest.mark.parametrize("suffix", WRITERS)
def test_a_mesh_with_a_height_of_no_data(suffix, tmp_path):
    """A roof of four corners, of which one stands for no data: its file is named, and the first place and value."""
    write_mesh, mesh, points = WRITERS[suffix], tmp_path / f"roof.{suffix}", [(4, 4, 1), (50, 50, 1)]
    mesh.write_text(write_mesh(ROWS))
    with pytest.raises(ValueError, match=rf"roof.{suffix}: .*8.*, 8.*, -9999.* no data"):
        study_below(mesh, points)
    mesh.write_text(write_mesh([(x, y, 4) for x, y, _ in ROWS]))
    study = study_below(mesh, points, restart=True)
    assert (study.dataset().lit.values.reshape(-1) & 1).tolist() == [0, 1]


@pytest.mark.parametrize("suffix", WRITERS)
def test_a_plate_wholly_at_a_height_of_no_data(suffix, tmp_path):
    """A raster without data makes such a mesh: it is refused; moved a little, it is a place."""
    write_mesh, mesh, points = WRITERS[suffix], tmp_path / f"roof.{suffix}", [(4, 5, -9998), (4, 5, -10001)]
    mesh.write_text(write_mesh([(x, y, -9999) for x, y, _ in ROWS]))
    with pytest.raises(ValueError, match=rf"roof.{suffix}: .* stands for no data: .*if it is a place, move the mesh"):
        study_below(mesh, points)
    if suffix == "gltf":  # by its node
        file = json.loads(write_mesh([(x, y, 0) for x, y, _ in ROWS]))
        file["nodes"][0]["translation"] = [0, 0, -9999]
        mesh.write_text(json.dumps(file))
    elif suffix == "city.json":  # its corners are whole numbers
        file = json.loads(write_mesh([(x, y, 0) for x, y, _ in ROWS]))
        file["transform"]["translate"] = [0, 0, -9999.001]
        mesh.write_text(json.dumps(file))
    else:
        mesh.write_text(write_mesh([(x, y, -9999.001) for x, y, _ in ROWS]))
    study = study_below(mesh, points, restart=True)
    assert (study.dataset().lit.values.reshape(-1) & 1).tolist() == [1, 0]
