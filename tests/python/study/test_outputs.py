# SPDX-License-Identifier: MIT
"""What comes out: GeoTIFF, picture, record, the command line, and the page of docs with its picture."""

import copy
import json
import pickle
import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import rasterio
import xarray
from gnomon import studies
from gnomon.studies.command import main as command
from gnomon.studies.export import _title
from made import UTM, city, run, write_raster, write_suns

PAGE = Path(__file__).parents[3] / "docs" / "studies.md"


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    folder = tmp_path_factory.mktemp("outputs")
    raster = write_raster(folder / "dsm.tif", city(40))
    return run(folder / "study", raster=raster, start="2026-06-20", end="2026-06-22", step="1h", utc_offset=1, tile=24,
               caster_tile=16, outside=60.0)  # fmt: skip


def test_a_cog_of_hours(study):
    (path,) = study.export(study.folder.parent / "hours.tif")
    hours, undecided = study.dataset().sun_hours.values, study.dataset().undecided_hours.values
    assert np.nanmax(undecided) > 0 and (undecided == 0).any()
    with rasterio.open(path) as file:
        assert file.tags(ns="IMAGE_STRUCTURE")["LAYOUT"] == "COG" and file.crs == rasterio.crs.CRS.from_string(UTM)
        assert tuple(file.transform)[:6] == (25.0, 0.0, 512_000.0, 0.0, -25.0, 5_002_400.0)
        one, two = file.read()
        assert ((one == file.nodata) == (np.isnan(hours) | (undecided > 0))).all()
        assert (one[one != file.nodata] == hours[one != file.nodata]).all()
        assert (two == np.where(np.isnan(hours), file.nodata, undecided)).all()
    assert list(path.parent.glob(".gnomon-*")) == []


def test_a_name_of_another_format_is_refused(study):
    for what, name in ((None, "hours.png"), (None, "hours"), ("suns", "suns.tif")):
        path = study.folder.parent / name
        with pytest.raises(ValueError, match=rf"{name}: this result is written as \.(tif: .* hours.tif|csv: )"):
            study.export(path, what=what)
        assert not path.exists()


@pytest.mark.parametrize("travel", [copy.copy, copy.deepcopy, lambda study: pickle.loads(pickle.dumps(study))])
def test_a_study_travels_as_its_folder(study, travel):
    other = travel(study)
    assert other is not study and other.digests() == study.digests()


def test_packed_hours_as_the_solar_api_has_them(study):
    paths = study.export(study.folder.parent / "shade", what="lit")
    assert [p.name for p in paths][5] == "hourly_shade_06.tif" and len(paths) == 12
    lit, undecided = (study.plan.store.array(f"results.zarr/{n}")[:] for n in ("lit", "undecided"))
    there = np.isfinite(city(40))
    with rasterio.open(paths[5]) as file:
        bands = file.read()
        assert bands.shape[0] == 24 and bands.dtype == np.int32
        for hour in range(24):
            word = 5 * 24 + hour
            known = there & (undecided[word] == 0)
            assert (bands[hour] == np.where(known, lit[word].astype(np.int64), file.nodata)).all()
        assert {int(b) for b in np.unique(bands[12])} <= {-9999, 0, 1 << 19, 1 << 20, 3 << 19}, "days 20 and 21"
    assert rasterio.open(paths[0]).read(13)[there].any() == 0


def test_hours_are_the_bits(study):
    lit, undecided = (study.plan.store.array(f"results.zarr/{n}")[:] for n in ("lit", "undecided"))
    data = xarray.open_zarr(study.folder / "results.zarr", consolidated=False)
    assert (np.nan_to_num(data.sun_hours.values) == np.bitwise_count(lit).sum(axis=0)).all()
    assert (np.nan_to_num(data.undecided_hours.values) == np.bitwise_count(undecided).sum(axis=0)).all()
    assert data.sun_hours.dims == ("y", "x") and data.lit.dims == ("word", "y", "x")
    assert float(data.x[0]) == 512_012.5 and float(data.y[0]) == 5_002_387.5
    assert str(data.time.values[0]) == "2026-06-19T23:30:00.000000000", "in UTC"
    assert "ETRS89" in data.spatial_ref.attrs["crs_wkt"]


def test_the_record(study):
    record = json.loads((study.folder / "record.json").read_text())
    assert record["lattice"] == "2^-10 m" and record["tasks_done"] == record["tasks"] == 4 * len(study.plan.blocks)
    assert record["versions"]["pvlib"] and record["decisions"] > 10_000 and record["undecided"] > 0
    assert record["beyond_the_casters"] == "at most 60.0 m" and record["curvature"] == "off"
    assert sum(record["tasks_of_devices"].values()) == record["tasks"]
    lit = study.plan.store.array("results.zarr/lit")
    assert len([k for k in record["chunks"] if k.startswith("results.zarr/lit/")]) == 4 * sum(
        map(len, study.plan.blocks)
    )
    from gnomon.studies.store import sha256_of_array

    word = int(study.plan.blocks[0][0])
    assert record["chunks"][f"results.zarr/lit/c/{word}/0/1"] == sha256_of_array(lit[word, :24, 24:])


def test_the_picture(study):
    image = pytest.importorskip("PIL.Image")
    path = study.picture(study.folder.parent / "map.png")
    pixels = np.asarray(image.open(path).convert("RGB"))
    assert pixels.shape[0] > 500 and pixels.std() > 30
    assert ((pixels == 128).all(axis=2) | ((pixels[..., 0] == pixels[..., 1]) & (pixels[..., 0] > 90)
            & (pixels[..., 0] < 200) & (pixels[..., 1] == pixels[..., 2]))).sum() > 500, "grey: undecided"  # fmt: skip


def test_a_picture_says_where_its_squares_come_from(study, tmp_path):
    """On level ground of 80 km one sun of some zones stands below 3 degrees, and that of the others does not."""
    flat = write_raster(tmp_path / "flat.tif", np.zeros((16, 16)), cell=5000)
    day = dict(start="2026-12-20", end="2026-12-21", step="30min", utc_offset=1, outputs=["hours"])
    squares = run(tmp_path / "squares", raster=flat, **day)
    assert len(np.unique(squares.dataset().sun_hours.values)) == 2
    said = "its squares are sun zones of 10 km: a sun near 3 degrees is left out in some"
    assert _title(squares.plan, "sun_hours").endswith(f"2026-12-21\n{said}")
    assert said not in _title(study.plan, "sun_hours")


def test_the_command_line(study, tmp_path, capsys):
    write_raster(tmp_path / "dsm.tif", city(30))
    write_suns(tmp_path / "suns.csv", [(120, 10), (200, 30)])
    file = tmp_path / "own.toml"
    file.write_text('raster = "dsm.tif"\ndirections = "suns.csv"\ntile = 16\n[run]\nfolder = "here"\n')
    assert command(["run", str(file), "--tiles", "0:2", "--quiet"]) == 0
    assert command(["verify", str(tmp_path / "here"), "--share", "0"]) == 1
    assert "4 tasks are not done" in capsys.readouterr().out, "two of four tiles, and their sums"
    assert command(["run", str(file)]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["tasks_done"] == 4 and said["undecided"] == 0
    assert command(["verify", str(tmp_path / "here"), "--share", "1"]) == 0
    assert "4 tasks recomputed on <gnomon.Device" in capsys.readouterr().out
    assert command(["export", str(tmp_path / "here"), str(tmp_path / "sums.tif")]) == 0
    assert rasterio.open(tmp_path / "sums.tif").read(1).max() == 2
    assert command(["picture", str(tmp_path / "here"), str(tmp_path / "sums.png")]) == 0
    assert (tmp_path / "sums.png").exists()


@pytest.mark.parametrize(
    "arguments, text",
    [
        (["verify", "/nowhere"], "/nowhere: holds no study"),
        (["run", "/nowhere.toml"], "/nowhere.toml: there is no such file"),
        (["run", "/"], "gnomon-study: /: Is a directory"),
        (["export", "STUDY", "/proc/none/x.tif"], "gnomon-study: /proc/none: No such file or directory"),
        (["run", "FILE", "--tiles", "7"], "--tiles: '7' is not i:j"),
        (["export", "STUDY", "x.tif", "--what", "moon"], "what: 'moon' is not in this study, which has"),
        (["verify", "STUDY", "--share", "2"], "share: 2.0 is not between 0 and 1"),
        (["verify", "STUDY", "--device", "no such"], "no such"),
    ],
)
def test_wrong_commands_are_one_sentence(study, tmp_path, capsys, arguments, text):
    file = tmp_path / "own.toml"
    file.write_text(f'raster = "{study.plan.settings.raster[0]}"\nstart = 2026-06-20\nend = 2026-06-21\n')
    names = {"FILE": str(file), "STUDY": str(study.folder)}
    assert command([names.get(a, a) for a in arguments]) == 1
    said = capsys.readouterr()
    assert text in said.err and said.err.startswith("gnomon-study: ") and said.out == ""


def test_without_the_extra_there_is_one_clear_sentence():
    code = (
        "import sys; sys.modules['zarr'] = None; import gnomon\n"
        "from gnomon._study import main\n"
        "try: gnomon.study('x')\nexcept ImportError as e: print(e)\n"
        "print(main())"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    sentence = "gnomon.study needs zarr, which is not installed: pip install 'gnomon[study]'"
    assert done.stdout == f"{sentence}\n1\n" and done.stderr == f"gnomon-study: {sentence}\n"


def test_importing_gnomon_imports_none_of_it():
    code = "import sys, gnomon; print(sorted({'zarr', 'dask', 'rasterio', 'pandas'} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout == "[]\n"


def test_the_page_runs(tmp_path, monkeypatch, capsys):
    image = pytest.importorskip("PIL.Image")
    pytest.importorskip("pyradiance")
    monkeypatch.chdir(tmp_path)
    text = PAGE.read_text()
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert len(blocks) >= 3 and len(blocks[1].strip().splitlines()) <= 10
    names = {"__name__": "page"}
    for block in blocks:
        exec(compile(block, str(PAGE), "exec"), names)
    assert re.search(r"[5-9]\.\d hours of sun on average, 0 answers undecided", capsys.readouterr().out)
    for name, of_page in (("town.png", "studies.png"), ("roofs.png", "roofs.png")):
        made, kept = (np.asarray(image.open(p).convert("L"), float) for p in (name, PAGE.parent / of_page))
        assert made.shape == kept.shape and np.abs(made - kept).mean() < 4, f"{name}: the page shows what it makes"
    (toml,) = re.findall(r"```toml\n(.*?)```", text, re.DOTALL)
    Path("town.toml").write_text(toml)
    settings, of_run = studies.read_toml("town.toml")
    assert settings == names["town"].plan.settings and of_run == {"workers": 2}
    (lines,) = re.findall(r"```sh\n(.*?)```", text, re.DOTALL)
    for line in lines.replace(" --device 1:0", "").splitlines():  # a second device is not everywhere
        program, *words = shlex.split(line, comments=True)
        assert program == "gnomon-study" and command(words) == 0, line
