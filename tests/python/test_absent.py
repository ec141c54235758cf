# SPDX-License-Identifier: MIT
"""Every carrier of *no data* of arrays: it is absent, or an error with the first row; never a place or a triangle."""

import decimal

import gnomon
import numpy as np
import pytest
from processes import DOWN, ROOF

NAN = float("nan")
LARGEST = float(np.finfo(np.float32).max)


def masked(rows, dtype=np.float64):
    """The rows, with NaN masked over a value that looks like ground."""
    values = np.array(rows, float)
    return np.ma.MaskedArray(np.nan_to_num(values, nan=0).astype(dtype), np.isnan(values))


def pandas_table(dtype):
    def table(rows):
        pandas = pytest.importorskip("pandas")
        return pandas.DataFrame(rows, columns=list("xyz")).astype(dtype)

    return table


def objects(absent):
    return lambda rows: np.array([[absent if np.isnan(n) else n for n in row] for row in rows], object)


def data_array(key):
    def made(rows):
        xarray = pytest.importorskip("xarray")
        return xarray.DataArray(np.nan_to_num(np.array(rows), nan=-9999), dims=("point", "axis"), attrs={key: -9999.0})

    return made


def na(rows):
    return objects(pytest.importorskip("pandas").NA)(rows)


#: Makes an array of rows, in which NaN stands for what is absent, in the way that a package says so.
CARRIERS = {
    "NaN": lambda rows: np.array(rows),
    "NaN in float32": lambda rows: np.array(rows, np.float32),
    "NaN in float16": lambda rows: np.array(rows, np.float16),
    "infinity": lambda rows: np.where(np.isnan(rows), np.inf, rows),
    "minus infinity": lambda rows: np.where(np.isnan(rows), -np.inf, rows),
    "a masked array": masked,
    "a masked array of float32": lambda rows: masked(rows, np.float32),
    "a masked array of integers": lambda rows: masked(rows, np.int16),
    "a hard mask": lambda rows: (lambda m: (m.harden_mask(), m)[1])(masked(rows)),
    "a list of masked rows": lambda rows: list(masked(rows)),
    "masked_values": lambda rows: np.ma.masked_values(np.nan_to_num(rows, nan=-9999), -9999),
    "None in a list": lambda rows: [[None if np.isnan(n) else n for n in row] for row in rows],
    "None in an array of objects": objects(None),
    "pandas.NA": na,
    "a decimal NaN": objects(decimal.Decimal("NaN")),
    "a table of float64": pandas_table("float64"),
    "a table of Float64": pandas_table("Float64"),
    "a table of Float32": pandas_table("Float32"),
    "a table of Int64": pandas_table("Int64"),
    "a DataArray, _FillValue": data_array("_FillValue"),
    "a DataArray, missing_value": data_array("missing_value"),
    "a DataArray, nodata": data_array("nodata"),
}
#: Values that mean no data, and are numbers: nobody declares them, so they are errors.
NUMBERS = {
    "-FLT_MAX": -LARGEST,
    "FLT_MAX": LARGEST,
    "-DBL_MAX": -float(np.finfo(np.float64).max),
    "DBL_MAX": float(np.finfo(np.float64).max),
    "netCDF's": 9.969209968386869e36,
    "Surfer's": 1.70141e38,
    "FLT_MAX, as it is printed": 3.402823e38,
    "-FLT_MAX, as it is printed": -3.4e38,
    "netCDF's, as it is printed": 9.96921e36,
}
ROWS = [[0.0, 0, 0], [5, 0, NAN], [5, 0, 0]]


@pytest.fixture(scope="module")
def scene():
    return gnomon.Scene(ROOF)


@pytest.mark.parametrize("carrier", CARRIERS)
def test_points(scene, carrier):
    points = CARRIERS[carrier](ROWS)
    answer = scene.lit(points, direction=DOWN, nan="absent")
    assert np.ma.getmaskarray(answer).tolist() == [False, True, False]
    assert answer.filled().tolist() == [False, False, True]
    with pytest.raises(ValueError, match="points: row 1 .*not finite, or is masked"):
        scene.lit(points, direction=DOWN)
    with pytest.raises(ValueError, match="points: row 1 .*not finite, or is masked"):
        scene.lit_by(points, gnomon.Lights.directions([DOWN]))


@pytest.mark.parametrize("carrier", CARRIERS)
def test_vertices(carrier):
    """The third vertex of the second triangle is absent."""
    rows = [[0.0, 0, 2], [1, 0, 2], [1, 1, 2], [0, 1, NAN]]
    with pytest.raises(ValueError, match="vertices: row 3 .*not finite, or is masked"):
        gnomon.Scene(CARRIERS[carrier](rows), [[0, 1, 2], [0, 2, 3]])


@pytest.mark.parametrize("carrier", CARRIERS)
def test_what_goes_with_points(scene, carrier):
    rows = CARRIERS[carrier](ROWS)
    at = np.array([[0.0, 0, 0]] * 3)
    with pytest.raises(ValueError, match="normals: row 1"):
        scene.lit(at, direction=DOWN, side=gnomon.Side.normals(rows))
    for lights in (gnomon.Lights.directions(rows), gnomon.Lights.positions(rows)):
        with pytest.raises(ValueError, match="row 1"):
            scene.lit_by(at, lights)
    with pytest.raises(ValueError, match="weights: row 1 nan"):
        scene.lit_by(at, gnomon.Lights.directions([DOWN] * 3, np.ma.MaskedArray([1.0, 2, 3], [0, 1, 0])))


@pytest.mark.parametrize("carrier", ["a masked array", "None in a list", "pandas.NA", "a list of masked rows"])
def test_a_light(scene, carrier):
    light = CARRIERS[carrier]([[0, NAN, -1]])[0]
    with pytest.raises(ValueError, match="direction:"):
        scene.lit([[0.0, 0, 0]], direction=light)
    with pytest.raises(ValueError, match="position:"):
        scene.lit([[0.0, 0, 0]], position=light)


@pytest.mark.parametrize("nan", ["error", "absent"])
@pytest.mark.parametrize("number", NUMBERS)
def test_numbers_that_mean_no_data(scene, number, nan):
    rows = np.nan_to_num(np.array(ROWS), nan=NUMBERS[number])
    for values in [rows, rows.astype(np.float32)] if abs(NUMBERS[number]) <= LARGEST else [rows]:
        with pytest.raises(ValueError, match="points: row 1 .* stands for no data"):
            scene.lit(values, direction=DOWN, nan=nan)
        for arguments in ((values, [[0, 1, 2]]), (values[None],)):
            with pytest.raises(ValueError, match="vertices: row 1 .* stands for no data"):
                gnomon.Scene(*arguments)


@pytest.mark.parametrize("number", [-9999, -99999, -32768, 1e20, -1e20])
def test_a_place_of_two_coordinates_that_mean_no_data(scene, number):
    rows = np.array([[0, 0, 0], [number, number, 5], [5, 0, 0]], float)
    for nan in ("error", "absent"):
        with pytest.raises(ValueError, match="points: row 1 .* stands for no data in files: make it NaN"):
            scene.lit(rows, direction=DOWN, nan=nan)
    with pytest.raises(ValueError, match="points: row 1 .* stands for no data"):
        scene.lit_by(rows, gnomon.Lights.directions([DOWN]))
    rows[2, :2] = 0.6 * number  # a place far out among others
    assert scene.lit(rows, direction=DOWN).tolist() == [False, True, True]


TAKERS = {
    "points": lambda scene, rows: scene.lit(rows, direction=DOWN),
    "points, nan='absent'": lambda scene, rows: scene.lit(rows, direction=DOWN, nan="absent"),
    "vertices": lambda scene, rows: gnomon.Scene(rows, [[0, 1, 2]]),
    "vertices, without faces": lambda scene, rows: gnomon.Scene(rows[None]),
    "positions": lambda scene, rows: scene.lit_by(np.zeros((1, 3)), gnomon.Lights.positions(rows)),
    "directions": lambda scene, rows: scene.lit_by(np.zeros((1, 3)), gnomon.Lights.directions(rows)),
    "normals": lambda scene, rows: scene.lit(np.zeros((3, 3)), direction=DOWN, side=gnomon.Side.normals(rows)),
    "observers": lambda scene, rows: scene.visible_from(rows, np.zeros((1, 3))),
    "observers, on a raster": lambda scene, rows: gnomon.viewshed(np.zeros((9, 9)), rows[:, :2], cell=1),
}


@pytest.mark.parametrize("number", [-9999, -99999, -999999, -32768, -32767, -(2**31), 1e20, -1e20])
@pytest.mark.parametrize("taker", TAKERS)
def test_a_coordinate_that_means_no_data(scene, taker, number):
    for axis in range(2 if "raster" in taker else 3):
        for real in (np.float32, np.float64):
            rows = np.array([[1, 2, 3], [2, 3, 4], [3, 4, 3]], real)
            rows[1, axis] = number
            said = f"{taker.split(',')[0]}: row 1 .* stands for no data in files: .* if it is a place"
            with pytest.raises(ValueError, match=said):
                TAKERS[taker](scene, rows)


def test_coordinates_among_their_like(scene):
    """Near others of their axis, across the origin, or on a wall that lies there, they are places."""
    ground = np.array([[-9999, -9999, 0], [9999, -9999, 0], [0, 9999, 0]], float)
    assert gnomon.Scene(ground, [[0, 1, 2]]).lit([[0.0, 0, -1]], direction=DOWN).tolist() == [False]
    wall = np.array([[-9999, -9998, 0], [-9999, -9990, 0], [-9999, -9990, 9]], float)
    assert len(gnomon.Scene(wall, [[0, 1, 2]])) == 1
    assert scene.lit([[-9999, 0, 0], [-9000, 0, 0]], direction=DOWN).tolist() == [True, True]


@pytest.mark.parametrize("real", [np.float32, np.float64])
def test_a_plate_wholly_at_a_number_of_no_data(real):
    """So does a mesh look that was made of a raster without data: it is refused, and moved a little it is a place."""
    plate = np.array([[0, 0, -9999], [9, 0, -9999], [9, 9, -9999]], real)
    with pytest.raises(ValueError, match="vertices: row 0 .* leave it out, or move it a little if it is a place"):
        gnomon.Scene(plate, [[0, 1, 2]])
    scene = gnomon.Scene(plate + real(1e-3), [[0, 1, 2]])
    assert scene.lit([[5, 4, -9998], [5, 4, -10001]], direction=DOWN).tolist() == [True, False]


@pytest.mark.parametrize("type", ["int32", "int64", "uint32", "uint64"])
def test_integers_that_nan_becomes(scene, type):
    limits = np.iinfo(type)
    for number in {limits.min, limits.max} - {0}:
        with pytest.raises(ValueError, match="points: row 1 .* stands for no data"):
            scene.lit(np.array([[0, 0, 0], [0, number, 0]], type), direction=DOWN)


def test_sixteen_bits_are_places(scene):
    """Quantized positions use all of them."""
    rows = np.array([[-32768, 32767, 0], [0, 0, 0]], "int16")
    assert scene.lit(rows, direction=DOWN).tolist() == [True, False]


def test_large_places_are_places(scene):
    points = np.float32([[0, 0, -1e37], [1e37, 0, 0], [-3e38, 0, 0]])
    assert scene.lit(points, direction=DOWN).tolist() == [False, True, True]


def test_integers():
    pandas = pytest.importorskip("pandas")
    vertices = ROOF.reshape(-1, 3)
    faces = np.arange(6).reshape(2, 3)
    for absent in (
        np.ma.MaskedArray(faces, [[0, 0, 0], [0, 1, 0]]),
        pandas.DataFrame(faces).astype("Int64").mask(np.array([[0, 0, 0], [0, 1, 0]], bool)),
        [[0, 1, 2], [3, None, 5]],
    ):
        with pytest.raises(ValueError, match="faces: row 1 is masked or has no value"):
            gnomon.Scene(vertices, absent)
    assert len(gnomon.Scene(vertices, pandas.DataFrame(faces).astype("Int64"))) == 2
    scene = gnomon.Scene(vertices, faces)
    receivers = np.ma.MaskedArray([0, 1], [False, True])
    at = np.array([[0.5, 0, 2], [0.5, 0, 0]])  # the second point lies under the roof, and on no triangle
    assert scene.lit(at, direction=DOWN, receivers=receivers).tolist() == [True, False]
    with pytest.raises(ValueError, match="receivers: row 1 is masked or has no value"):
        scene.lit(at, direction=DOWN, receivers=[0, None])
