# SPDX-License-Identifier: MIT
"""One table of suns serves gnomon hours, whose scenes have y up, and studies, in which z is up."""

import gzip
import json
import math
from pathlib import Path

import gnomon
import numpy as np
import pyproj
import pytest
import trimesh
from gnomon.studies.settings import settings_of
from gnomon.studies.suns import suns_of
from gnomon.studies.tables import read_observers, read_points, read_suns, read_weights
from made import UTM, bits, run, write_raster
from meshes import box

# Made by hand: the same two suns; tests/command/suns_test.cpp has the other half.
TABLES = Path(__file__).parents[2] / "command"
OF_HOURS, OF_STUDY = TABLES / "suns_of_hours.csv", TABLES / "suns_of_study.csv"
TOWARDS = np.float32([[0.6, 0, 0.8], [-0.5, -0.75, 0.25]])  # z up


def suns(file, crs=None, box=(0, 0, 1, 1), **more):
    return suns_of(settings_of(dict(raster=__file__, directions=str(file)) | more), crs, box)


@pytest.mark.parametrize("file", [OF_HOURS, OF_STUDY], ids=["hours", "study"])
def test_a_table_of_either_program_has_the_same_suns(file):
    found = suns(file)
    assert found.towards.tolist() == [TOWARDS.tolist()]
    assert np.ldexp(found.weights.astype(float), found.exponent).tolist() == [0.5, 2]
    assert not np.signbit(found.towards[0, 0, 1]), "no minus zero"


def test_a_study_writes_the_table_that_it_reads(tmp_path):
    raster = write_raster(tmp_path / "dsm.tif", np.zeros((4, 4)))
    study = run(tmp_path / "s", raster=raster, directions=str(OF_HOURS))
    assert study.export(tmp_path / "suns.csv", what="suns") == [tmp_path / "suns.csv"]
    assert (tmp_path / "suns.csv").read_text() == OF_STUDY.read_text()
    with pytest.raises(ValueError, match="what: a table of suns is for one sun zone, and this study has 4"):
        run(tmp_path / "zones", raster=raster, directions=str(OF_HOURS), zone=50).export(tmp_path / "s.csv", "suns")


def test_the_suns_of_a_day_go_round(tmp_path):
    raster = write_raster(tmp_path / "dsm.tif", np.zeros((4, 4)))
    day = run(tmp_path / "day", raster=raster, start="2026-03-20", end="2026-03-21", step="30min", utc_offset=1)
    day.export(tmp_path / "day.csv", what="suns")
    towards = day.plan.suns.towards[0]
    is_up = np.isfinite(towards[:, 0])
    again = suns(tmp_path / "day.csv")
    assert (again.towards[0] == towards[is_up]).all() and 20 < is_up.sum() < 24
    assert np.ldexp(again.weights.astype(float), again.exponent).tolist() == [0.5] * int(is_up.sum())
    lines = (tmp_path / "day.csv").read_text().splitlines()
    assert lines[0] == "time,x,y,z,up,weight"
    assert [line.split(",")[0] for line in lines[1:]] == np.array(day.plan.suns.times)[is_up].tolist()


def test_a_mesh_with_y_up_gets_the_same_light(tmp_path):
    """A scene with y up, lit along x, y, z of the file of gnomon hours as they are; and a study of the same mesh."""
    triangles = np.concatenate([box(3, 2, 4, 5, 7), box(12, 9, 3, 2, 11)])
    corners = triangles.reshape(-1, 3)
    trimesh.Trimesh(corners, np.arange(len(corners)).reshape(-1, 3), process=False).export(tmp_path / "m.ply")
    points = np.float32(np.random.default_rng(8).random((600, 3)) * [20, 15, 12])
    rows = [line.split(",") for line in OF_HOURS.read_text().splitlines()]
    x, y, z = (rows[0].index(name) for name in "xyz")
    scene = gnomon.Scene(triangles.astype(np.float32), lattice=2**-10)
    expected = [scene.lit(points, direction=[float(row[i]) for i in (x, y, z)]) for row in rows[1:]]
    np.save(tmp_path / "p.npy", np.stack([points[:, 0], -points[:, 2], points[:, 1]], axis=1).astype(float))
    study = run(tmp_path / "s", meshes=str(tmp_path / "m.ply"), mesh_up="y", receivers="points",
                points=str(tmp_path / "p.npy"), directions=str(OF_HOURS), outputs=["bits"])  # fmt: skip
    assert (bits(study) == expected).all() and all(0.05 < lit.mean() < 0.99 for lit in expected)


def test_angles_count_from_true_north(tmp_path):
    """Without a CRS the map's north is true north; with one the meridian tells where it lies, 2.8 degrees away here."""
    file = tmp_path / "angles.csv"
    file.write_text("elevation,azimuth,note\n30,180,a\n-1,0,below\n0,0,below\n90,0,zenith\n")
    found = suns(file)
    expected = [[0, -math.cos(math.pi / 6), 0.5], [0, 0, 1]]
    assert np.allclose(found.towards[0], expected, atol=1e-7) and found.notes["suns_left_out"] == 2
    to_map = pyproj.Transformer.from_crs("EPSG:4326", UTM, always_xy=True)
    x, y = to_map.transform(12.9, 46.5)
    found = suns(file, UTM, (x, y, x, y), zone=100)
    longitude, latitude = pyproj.Transformer.from_crs(UTM, "EPSG:4326", always_xy=True).transform(
        *found.centre(tuple(found.zones[0]))
    )
    a, b = (np.array(to_map.transform(longitude, latitude + d)) for d in (1e-4, -1e-4))
    metres = pyproj.Geod(ellps="WGS84").inv(longitude, latitude + 1e-4, longitude, latitude - 1e-4)[2]
    south = (b - a) / metres  # a metre on the ground, on the map: 1.0007 m here
    x, y, z = found.towards[0, 0]
    assert np.allclose([x / z, y / z], south / math.tan(math.pi / 6), atol=2e-6) and abs(south[0]) > 0.04


def test_tables_of_all_kinds(tmp_path):
    file = tmp_path / "suns.csv"

    def read(text):
        file.write_text(text)
        return read_suns(str(file))

    table = read("0.1,0.25,-1\n\n# a comment\n0,0,-1\n")
    assert table.towards.tolist() == np.float32([[-0.1, -0.25, 1], [0, 0, 1]]).tolist()
    assert table.weights.tolist() == [1, 1] and read("0,0,-1,2.5\n").weights.tolist() == [2.5]
    table = read('weight, z ,note,"y",x\r\n-7,-3,"a, b",-2,-1\r\n')
    assert table.towards.tolist() == [[1, 2, 3]] and table.weights.tolist() == [-7]
    assert read("0,0,-1,0.1\n").weights.tolist() == [float(np.float32(0.1))]
    table = read("up,x,y,z\ny,1,-2,3\nz,1,2,-3\n")
    assert table.towards.tolist() == [[-1, 3, 2], [-1, -2, 3]]
    assert read("azimuth,elevation,x,y,z\n0,-1,0,0,1\n0,45,0,-1,-1\n").towards.tolist() == [[0, 1, 1]]
    np.save(tmp_path / "suns.npy", [[0, 0, -1, 3.0]])
    assert read_suns(str(tmp_path / "suns.npy")).weights.tolist() == [3]


@pytest.mark.parametrize(
    "text, sentence",
    [
        ("a,b,c\n1,2,3\n", ": a table of suns needs the columns x, y, z or azimuth, elevation; it has a, b, c"),
        ("", ": a table of suns needs the columns x, y, z or azimuth, elevation; it is empty"),
        ("x,y,z\n1,2\n", ", line 2 has 2 columns in place of 3"),
        ("1,2\n", ": must have 3 or 4 columns, or names for its 2"),
        ("# text\nx,y,z\n\n1,2,nan\n", ', line 4 has z = "nan", which is no finite number'),
        ("x,y,z\n1,2,-3x\n", ', line 2 has z = "-3x", which is no finite number'),
        ("x,y,z\n1,2,-3\n1,0,0\n", ", line 3 has x, y, z of light that does not travel downwards"),
        ("x,y,z,up\n1,2,-3,y\n", ", line 2 has x, y, z of light that does not travel downwards"),
        ("x,y,z,up\n1,2,-3,x\n", ', line 2 has up = "x", which is neither y nor z'),
        ("x,y,z\n1,2,-1e39\n", ', line 2 has z = "-1e39", which is beyond float32'),
        ("x,y,z,weight\n1,2,-3,1e39\n", ', line 2 has weight = "1e39", which is beyond float32'),
        ("azimuth,elevation\n10,91\n", ", line 2 has an elevation beyond 90 degrees"),
        ("azimuth,elevation\n-9999,9\n", ", line 2 has an azimuth beyond 360 degrees"),
        ("x,y,z\n", ": has no suns"),
        ("azimuth [gon],elevation [gon]\n100,50\n", ': the column "azimuth [gon]" must be in degrees'),
        ("azimuth,elevation (rad)\n1,1\n", ': the column "elevation (rad)" must be in degrees'),
        ("PK\x03\x04...", ": is a spreadsheet or a zip archive: save it as CSV, or unpack it (unzip)"),
    ],
)
def test_bad_tables_are_one_sentence(tmp_path, text, sentence):
    file = tmp_path / "suns.csv"
    file.write_text(text)
    with pytest.raises(ValueError) as error:
        suns(file)
    assert str(error.value) == f"{file}{sentence}"


#: Angles that may be radians. tests/command/suns_test.cpp has the same.
AS_SMALL_AS_RADIANS = ["1.57,0.2\n3.14,1.05\n-6.2832,-1.5708\n", "4.71,0.001\n", "0,1.6\n6.3,-1\n"]


@pytest.mark.parametrize("rows", AS_SMALL_AS_RADIANS)
def test_what_may_be_radians_must_say_that_it_is_degrees(tmp_path, rows):
    file = tmp_path / "suns.csv"
    file.write_text("azimuth,elevation\n" + rows)
    with pytest.raises(ValueError, match="suns.csv: its azimuths and elevations are as small as radians") as error:
        suns(file)
    heading = str(error.value).split("write ")[1].split(" above")[0].replace(" and ", ",")
    file.write_text(f"{heading}\n{rows}")
    angles = np.array([row.split(",") for row in rows.split()], float)
    assert read_suns(str(file)).elevation.tolist() == [elevation for _, elevation in angles.tolist() if elevation > 0]
    records = [("azimuth", "f8"), ("elevation", "f8")]
    np.save(tmp_path / "suns.npy", np.array(list(map(tuple, angles)), records))
    with pytest.raises(ValueError, match="suns.npy: its azimuths and elevations are as small as radians"):
        read_suns(str(tmp_path / "suns.npy"))
    np.save(tmp_path / "suns.npy", np.array(list(map(tuple, angles)), [(f"{n} [deg]", type) for n, type in records]))
    assert len(read_suns(str(tmp_path / "suns.npy")).azimuth)


@pytest.mark.parametrize("rows", ["90,0.5\n", "0,2\n", "0,-1\n", "1,1\n100,-20\n", "0,0\n"])
def test_degrees_are_not_taken_for_radians(tmp_path, rows):
    (tmp_path / "suns.csv").write_text("azimuth,elevation\n" + rows)
    read_suns(str(tmp_path / "suns.csv"))
    (tmp_path / "xyz.csv").write_text("azimuth,elevation,x,y,z\n1,1,0,0.1,-1\n")  # its angles decide nothing
    assert read_suns(str(tmp_path / "xyz.csv")).towards.tolist() == np.float32([[0, -0.1, 1]]).tolist()


def test_weights_and_points_are_tables_too(tmp_path):
    file = tmp_path / "table.csv"
    file.write_text("dni\n1\n2.5\n")
    assert read_weights(str(file), 2).tolist() == [1, 2.5]
    with pytest.raises(ValueError, match="has 2 weights, and must have 3, one per sun of start..end"):
        read_weights(str(file), 3)
    file.write_text("nz,z,nx,x,y,ny\n6,3,4,1,2,5\n0,3,0,1,2,0\n")
    with pytest.raises(ValueError, match="table.csv, line 3 has nx, ny, nz = 0, 0, 0, which is no side"):
        read_points(str(file))
    file.write_text("nz,z,nx,x,y,ny\n6,3,4,1,2,5\n")
    assert read_points(str(file)).tolist() == [[1, 2, 3, 4, 5, 6]]
    np.save(tmp_path / "table.npy", np.ones((2, 4)))
    with pytest.raises(ValueError, match="table.npy: must have 3 or 6 columns, or names for its 4"):
        read_points(str(tmp_path / "table.npy"))
    file.write_text("x,y,z\n1,2,10\n1,3,-999\n")
    with pytest.raises(ValueError, match="table.csv, line 3 has z = -999, which is no height but stands for no data"):
        read_points(str(file))
    file.write_text("x,y,z\n1,2,-999\n1,3,-998\n")
    assert len(read_points(str(file))) == 2
    np.save(tmp_path / "table.npy", [[1, 2, np.inf]])
    with pytest.raises(ValueError, match='table.npy, row 0 has z = "inf", which is no finite number'):
        read_points(str(tmp_path / "table.npy"))


MOVE, SAYS = "leave the row out, or move it a little if it is a place", "(which|of which one) stands for no data"


@pytest.mark.parametrize("number", [-9999, -999, -99.9, -32768, -99999, 1e20, -1e20, 9.96921e36, 3.4028235e38])
def test_numbers_that_stand_for_no_data(tmp_path, number):
    """Weights, points and observers, as text and as arrays."""
    file = tmp_path / "table.csv"
    for name, read, table, first, remedy in (
        ("weights", lambda f: read_weights(f, 3), "weight\n2\n-1\n{0}\n", 'weight = "', "write 0"),
        ("suns", read_suns, "x,y,z,weight\n0,0,-1,2\n0,0,-1,1\n0,1,-1,{0}\n", 'weight = "', "write 0"),
        ("points", read_points, "x,y,z\n0,0,2\n5e5,5e6,9\n{0},{0},5\n", 'x = "', MOVE),
        ("points", read_points, "x,y,z\n0,0,2\n5e5,5e6,9\n{0},5e6,5\n", 'x = "', MOVE),
        ("points", read_points, "x,y,z\n-5e5,-1e6,2\n-7e5,-2e6,9\n-7e5,{0},5\n", '(x = .*)?y = "', MOVE),
        ("observers", read_observers, "x,y\n0,0\n5e5,5e6\n{0},{0}\n", 'x = "', MOVE),
        ("observers", read_observers, "x,y\n4e5,5e6\n5e5,5e6\n5e5,{0}\n", '(x = .*)?y = "', MOVE),
    ):
        if name in ("points", "observers") and -9998 < number < 0:
            continue  # a place
        if name in ("points", "observers") and number > 1e30 and table.count("{0}") == 1:
            continue  # far, but a place
        file.write_text(table.format(number))
        with pytest.raises(ValueError, match=f"table.csv, line 4 has {first}.*, {SAYS}: {remedy}$"):
            read(str(file))
        rows = np.genfromtxt(file, delimiter=",", names=True)
        np.save(tmp_path / "table.npy", rows)
        with pytest.raises(ValueError, match=f"table.npy, row 2 has {first}.*, {SAYS}: {remedy}$"):
            read(str(tmp_path / "table.npy"))
        file.write_text(table.format(0))
        read(str(file))


def test_numbers_among_their_like_are_data(tmp_path):
    file = tmp_path / "table.csv"
    file.write_text("weight\n-9999\n-6000\n2\n")
    assert read_weights(str(file), 3).tolist() == [-9999, -6000, 2]
    file.write_text("x,y,z\n-9999,-9999,5\n-9998,-9999,5\n")
    assert len(read_points(str(file))) == 2
    file.write_text("x,y,z\n-9999,9999,5\n9999,-9999,5\n0,0,5\n")  # corners around the origin
    assert len(read_points(str(file))) == 3


@pytest.mark.parametrize("number", [9999, 99999, 999999])
def test_nines_above_all_weights(tmp_path, number):
    """As weather files write what is missing; among others as large it is a weight."""
    file = tmp_path / "table.csv"
    file.write_text(f"weight\n800\n{number}\n0\n")
    with pytest.raises(ValueError, match=f'table.csv, line 3 has weight = "{number}", which stands for no data'):
        read_weights(str(file), 3)
    file.write_text(f"weight\n{0.6 * number}\n{number}\n0\n")
    assert read_weights(str(file), 3)[1] == number


def test_weights_below_0_are_told(tmp_path):
    raster = write_raster(tmp_path / "dsm.tif", np.zeros((4, 4)))
    (tmp_path / "suns.csv").write_text("x,y,z,weight\n0,0,-1,3\n0,0.1,-1,-2\n")
    with pytest.warns(UserWarning, match="weights: 1 of 2 are below 0, and lower sums"):
        study = run(tmp_path / "s", raster=raster, directions=str(tmp_path / "suns.csv"), outputs=["weights"])
    assert (study.dataset().sum_of_weights.values == 1).all()


# tests/command/suns_test.cpp reads the same tables.
MADE_TABLES = json.loads((TABLES / "tables_of_points.json").read_text())


@pytest.mark.parametrize("case", MADE_TABLES["read"], ids=lambda case: case["name"])
def test_tables_as_people_have_them(tmp_path, case):
    file = tmp_path / "points.csv"
    file.write_text(case["text"], newline="", encoding="utf-8")
    assert read_points(str(file))[:, :3].tolist() == MADE_TABLES["points"]
    packed = tmp_path / "points.csv.gz"
    packed.write_bytes(gzip.compress(file.read_bytes()))
    assert read_points(str(packed))[:, :3].tolist() == MADE_TABLES["points"]


@pytest.mark.parametrize("case", MADE_TABLES["refused"], ids=lambda case: case["name"])
def test_tables_that_are_refused(tmp_path, case):
    file = tmp_path / "points.csv"
    file.write_text(case["text"], newline="", encoding="utf-8")
    with pytest.raises(ValueError) as error:
        read_points(str(file))
    said = str(error.value)
    why = case["why"].replace("x, y, z;", "x, y, z, and nx, ny, nz for the side that they face;")
    assert said.startswith(str(file)) and why in said


def test_utf_16_is_named(tmp_path):
    (tmp_path / "points.csv").write_text("x,y,z\n0,0,0\n", encoding="utf-16")
    with pytest.raises(ValueError, match="points.csv: is UTF-16 text: save it as UTF-8"):
        read_points(str(tmp_path / "points.csv"))


def test_a_table_in_latin_1(tmp_path):
    """Spreadsheets of western Europe write it; headings beside the three are of no account."""
    (tmp_path / "points.csv").write_bytes("Straße,x,y,z\nMärzgasse,1,2,3\n".encode("latin-1"))
    assert read_points(str(tmp_path / "points.csv")).tolist() == [[1, 2, 3]]
    (tmp_path / "points.csv").write_bytes("Straße,x,y\nMärzgasse,1,2\n".encode("latin-1"))
    with pytest.raises(ValueError, match="points.csv: points need .* it has straße, x, y"):
        read_points(str(tmp_path / "points.csv"))


def test_records_of_a_npy_file_go_by_their_names(tmp_path):
    file = str(tmp_path / "points.npy")
    np.save(file, np.array([(3, 9, 2, 1)], [("Z", "f8"), ("id", "i4"), ("y", "f4"), ("x", "f8")]))
    assert read_points(file).tolist() == [[1, 2, 3]]
    np.save(file, np.array([(3, 2)], [("z", "f8"), ("y", "f8")]))
    with pytest.raises(ValueError, match="points.npy: points need the columns x, y, z"):
        read_points(file)
    np.save(file, np.ones((1, 3), complex))
    with pytest.raises(ValueError, match="points.npy: holds complex128, not real numbers"):
        read_points(file)


@pytest.mark.parametrize("text", [
    "0\n1\n2\n", "dni\n0\n1\n2\n", "Direct normal [W/m2]\n0\n1\n2\n", "time,Weight\n10:00,0\n11:00,1\n12:00,2\n",
    "time,Weights\n10:00,0\n11:00,1\n12:00,2\n", '\ufeff"DNI"\r\n0\r\n1\r\n2\r\n', "weight;note\n0;a\n1;b\n2;c\n",
])  # fmt: skip
def test_weights_keep_their_hours(tmp_path, text):
    (tmp_path / "w.csv").write_text(text, newline="", encoding="utf-8")
    assert read_weights(str(tmp_path / "w.csv"), 3).tolist() == [0, 1, 2]


@pytest.mark.parametrize("heading", ["weight", "Weights", "WEIGHT [kWh]"])
def test_weights_of_suns_by_their_heading(tmp_path, heading):
    (tmp_path / "suns.csv").write_text(f"azimuth,elevation,{heading}\n170,-3,9\n180,45,2.5\n")
    table = read_suns(str(tmp_path / "suns.csv"))
    assert table.weights.tolist() == [2.5] and table.below_horizon == 1


#: Other headings of a table of suns, and those of them that the note names.
UNREAD = {
    "dni": '"dni"', "DNI [W/m2]": '"dni"', "ghi,dhi": '"ghi", "dhi"', "irradiance": '"irradiance"',
    "Gb (kW/m2)": '"gb"', "solar_energy_kwh": '"solar_energy_kwh"', "duration": '"duration"', "hours": '"hours"',
    "sun weight": '"sun weight"', "lit [W/m2]": '"lit"', "note": "", "zenith": "", "id,hour": "", "weight,dni": "",
    "temp_air": "",
}  # fmt: skip


@pytest.mark.parametrize("headings", UNREAD)
def test_weights_under_other_headings_are_told(tmp_path, headings):
    """The remedy makes them weights."""
    named, cells = UNREAD[headings], ",".join("25"[: headings.count(",") + 1])
    (tmp_path / "suns.csv").write_text(f"azimuth,elevation,{headings}\n180,45,{cells}\n")
    table = read_suns(str(tmp_path / "suns.csv"))
    assert table.weights.tolist() == [2.0 if headings.startswith("weight") else 1.0]
    told = f'{tmp_path}/suns.csv: {named}: not read, and every sun weighs 1: the heading "weight" in place of'
    assert table.note.startswith(told) if named else not table.note
    if named:
        with pytest.warns(UserWarning, match="not read, and every sun weighs 1"):
            suns(tmp_path / "suns.csv")
        column = named.split('"')[1]
        assert table.note.endswith(f'"{column}" makes it the weights')
        (tmp_path / "suns.csv").write_text(f"azimuth,elevation,weight\n180,45,{cells[0]}\n")
        assert read_suns(str(tmp_path / "suns.csv")).weights.tolist() == [2]
    records = np.zeros(1, [("azimuth", "f8"), ("elevation", "f8"), ("DNI", "f8")])
    records["elevation"] = 9
    np.save(tmp_path / "suns.npy", records)
    assert '"dni": not read' in read_suns(str(tmp_path / "suns.npy")).note


def test_a_side_needs_all_of_its_columns(tmp_path):
    for headings in ("x,y,z,nx,ny", "x,y,z,nz", "normal_x,x,y,z"):
        (tmp_path / "p.csv").write_text(f"{headings}\n" + ",".join("1" * (headings.count(",") + 1)) + "\n")
        with pytest.raises(ValueError, match="p.csv: has n.*, and lacks n.*: give all of them, or none"):
            read_points(str(tmp_path / "p.csv"))
    (tmp_path / "p.csv").write_text("normal_x,normal_y,normal_z,x,y,z\n0,0,1,4,5,6\n")
    assert read_points(str(tmp_path / "p.csv")).tolist() == [[4, 5, 6, 0, 0, 1]]
    np.save(tmp_path / "p.npy", np.zeros(2, [(name, "f8") for name in ("x", "y", "z", "nx")]))
    with pytest.raises(ValueError, match="p.npy: has nx, and lacks ny nz"):
        read_points(str(tmp_path / "p.npy"))


def test_a_polar_night_has_no_hours(tmp_path):
    """21 December in Longyearbyen: 0 hours everywhere, all of it known."""
    raster = write_raster(tmp_path / "r.tif", np.zeros((3, 4)), crs="EPSG:32633", west=513_700, north=8_681_000)
    study = run(tmp_path / "s", raster=raster, start="2026-12-21", end="2026-12-22", outputs=["hours", "bits"])
    values = study.dataset()
    assert (values.sun_hours.values == 0).all() and (values.undecided_hours.values == 0).all()
    assert not values.lit.values.any() and study.record["suns"]["suns_left_out"] == "24"
    study.export(tmp_path / "hours.tif")
    (tmp_path / "night.csv").write_text("azimuth,elevation,weight\n180,-4,2\n")
    by_table = run(tmp_path / "t", raster=raster, directions=str(tmp_path / "night.csv"), outputs=["weights"])
    assert (by_table.dataset().sum_of_weights.values == 0).all()


def test_a_point_without_a_height_is_no_place(tmp_path):
    (tmp_path / "points.csv").write_text("x,y,z\n0,0,0.5\n50,-1.5,-9999\n")
    with pytest.raises(ValueError, match="points.csv, line 3 has z = -9999, which is no height"):
        read_points(str(tmp_path / "points.csv"))
