# SPDX-License-Identifier: MIT
"""gnomon-study viewshed, and the page of docs with its picture."""

import json
import re
import shlex
from pathlib import Path

import gnomon
import numpy as np
import pytest
import rasterio
from gnomon.studies.command import main
from made import UTM, city, write_raster

PAGE = Path(__file__).parents[3] / "docs" / "viewshed.md"
EAST, NORTH = 512_012.5 + 25.0 * np.arange(40), 5_002_387.5 - 25.0 * np.arange(40)
PLACE = [512_400.0, 5_002_010.0]


@pytest.fixture
def raster(tmp_path):
    return write_raster(tmp_path / "dem.tif", city(40))


def run(*words):
    return main(["viewshed", *map(str, words)])


def test_one_observer_is_a_byte_a_cell(raster, tmp_path, capsys):
    out = tmp_path / "new" / "seen.tif"
    assert run(raster, "512400,5002010", out, "--outside", 300, "--height", 60, "--distance", 600) == 0
    found = gnomon.viewshed(city(40), PLACE, x=EAST, y=NORTH, outside=300, height=60, distance=600)
    with rasterio.open(out) as file:
        values = file.read(1)
        assert file.crs == rasterio.crs.CRS.from_string(UTM) and file.nodata == 128 and values.dtype == np.uint8
        assert tuple(file.transform)[:6] == (25.0, 0.0, 512_000.0, 0.0, -25.0, 5_002_400.0)
        record = json.loads(file.tags()["gnomon"])
    assert ((values == 255) == (found.counts == 1)).all() and ((values == 127) == (found.undecided == 1)).all()
    assert ((values == 128) == found.is_absent).all() and {*np.unique(values)} == {0, 127, 128, 255}
    assert json.loads(capsys.readouterr().out) == record and record["refraction"] == pytest.approx(1 / 7)
    assert record["seen"] == found.counts.sum() and record["undecided"] == found.undecided.sum()
    assert list(out.parent.iterdir()) == [out]


def test_observers_of_a_table(raster, tmp_path):
    table = tmp_path / "guards.csv"
    table.write_text("name,x,y,height\na,512400,5002010,3\nb,512600.5,5002100,9\n")
    assert run(raster, table, tmp_path / "counts.tif", "--quiet", "--refraction", "plane") == 0
    places = [PLACE, [512600.5, 5002100]]
    found = gnomon.viewshed(city(40), places, x=EAST, y=NORTH, height=[3, 9], refraction=None)
    with rasterio.open(tmp_path / "counts.tif") as file:
        counts, undecided = file.read(masked=True)
    assert (counts.mask == found.is_absent).all() and (counts.data == found.counts)[~found.is_absent].all()
    assert not undecided.any() and {*np.unique(found.counts)} == {0, 1, 2}


def test_heights_from_which_cells_are_seen(raster, tmp_path):
    assert run(raster, "512400,5002010", tmp_path / "masts.tif", "--quiet", "--what", "heights") == 0
    least = gnomon.ViewshedGrid(city(40), x=EAST, y=NORTH).least_heights(PLACE)
    with rasterio.open(tmp_path / "masts.tif") as file:
        values = file.read(1, masked=True)
    assert (values.mask == np.isnan(least)).all() and (values.filled(-1) == np.nan_to_num(least, nan=-1)).all()
    assert np.nanmax(least) > 10


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["1,2"], r"observers: row 0 \[1.0, 2.0\] does not stand on the raster"),
        (["nobody.csv"], "neither x,y, such as 691000,5334000, nor a file"),
        (["512400,5002010", "--height", "-1"], "height: must be at least a step"),
        (["512400,5002010", "--what", "heights", "--outside", "3"], "outside: is not for heights"),
        (["512400,5002010", "--device", "no such"], "no such"),
    ],
)
def test_wrong_words_are_named(raster, tmp_path, capsys, words, text):
    assert run(raster, words[0], tmp_path / "x.tif", *words[1:]) == 1
    assert re.search(text, capsys.readouterr().err) and not (tmp_path / "x.tif").exists()


def test_no_input_is_overwritten(raster, tmp_path, capsys):
    kept, table = Path(raster).read_bytes(), tmp_path / "guards.csv"
    table.write_text("x,y\n512400,5002010\n")
    assert run(raster, table, raster) == run(raster, table, table) == run(raster, table, tmp_path) == 1
    assert run(raster, table, tmp_path / "x.tif", "--quiet", "--folder", tmp_path / "kept") == 0
    for command in ("export", "picture"):
        assert main([command, str(tmp_path / "kept"), raster]) == 1
    assert capsys.readouterr().err.count("it is a file that this run reads") == 4
    assert Path(raster).read_bytes() == kept and table.read_text().startswith("x,y")


def test_a_map_in_degrees_and_a_missing_file_are_refused(tmp_path, capsys):
    degrees = write_raster(tmp_path / "degrees.tif", city(40), cell=0.001, west=8.0, north=47.0, crs="EPSG:4326")
    assert run(degrees, "8.01,46.99", tmp_path / "x.tif") == 1 and "are degrees" in capsys.readouterr().err
    assert run(tmp_path / "none.tif", "1,2", tmp_path / "x.tif") == 1 and "none.tif" in capsys.readouterr().err


def test_the_page_runs(tmp_path, monkeypatch, capsys):
    """The first block, the commands, then the other blocks; each is at most ten lines."""
    image = pytest.importorskip("PIL.Image")
    monkeypatch.chdir(tmp_path)
    text = PAGE.read_text()
    blocks = re.findall(r"```(\w+)\n(.*?)```", text, re.DOTALL)
    assert [kind for kind, _ in blocks] == ["python", "sh", "python", "python"]
    names = {"__name__": "page"}
    for kind, block in blocks:
        if kind == "sh":
            for line in block.splitlines():
                program, *words = shlex.split(line, comments=True)
                assert program == "gnomon-study" and main(words) == 0
            continue
        assert len(block.strip().splitlines()) <= 10
        exec(compile(block, str(PAGE), "exec"), names)
    assert re.search(r"\d\d% of the cells are seen, k = 0\.1429", capsys.readouterr().out)
    with rasterio.open("seen.tif") as seen, rasterio.open("masts.tif") as masts, rasterio.open("counts.tif") as counts:
        assert ((seen.read(1) == 255) == (masts.read(1) == 0)).all()
        assert {*np.unique(counts.read(1))} == {0, 1, 2, 3}
    with rasterio.open("past.tif") as past, rasterio.open("all.tif") as every:
        hidden = every.read(1).astype(int) - past.read(1)
        assert hidden.min() == 0 < hidden.max()  # the wall hides, and shows nothing new
    made, kept = (np.asarray(image.open(p).convert("L"), float) for p in ("viewshed.png", PAGE.parent / "viewshed.png"))
    assert made.shape == kept.shape and np.abs(made - kept).mean() < 4, "the page's picture is the one that it makes"
