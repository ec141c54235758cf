# SPDX-License-Identifier: MIT
"""The accessor of xarray: the answers of gnomon.viewshed() and gnomon.study(), whatever the array looks like."""

import gnomon
import gnomon.xarray  # noqa: F401
import numpy as np
import pytest
import xarray
from made import UTM, city, run, write_raster

EAST, NORTH = 512_012.5 + 25.0 * np.arange(40), 5_002_387.5 - 25.0 * np.arange(40)
PLACE = [512_400.0, 5_002_010.0]
DAY = {"start": "2026-06-20", "end": "2026-06-21", "step": "2h", "utc_offset": 1}


def dem_of(heights=None, dims=("y", "x"), crs=UTM):
    coords = {dims[0]: NORTH, dims[1]: EAST, "spatial_ref": ((), 0, {"crs_wkt": rasterio_wkt(crs)})}
    attrs = {"units": "m", "AREA_OR_POINT": "Area", "grid_mapping": "spatial_ref"}
    return xarray.DataArray(city(40) if heights is None else heights, coords, dims, attrs=attrs)


def rasterio_wkt(crs):
    import rasterio

    return rasterio.crs.CRS.from_string(crs).to_wkt()


@pytest.fixture(scope="module")
def expected():
    found = gnomon.viewshed(city(40), PLACE, x=EAST, y=NORTH, height=60, outside=300.0)
    assert found.counts.any() and found.undecided.any() and found.is_absent.any()
    return [np.where(found.is_absent, np.nan, one).astype(np.float32) for one in (found.counts, found.undecided)]


def same(found, expected):
    for name, values in zip(("seen", "undecided"), expected, strict=True):
        np.testing.assert_array_equal(found[name].values, values)


def test_a_viewshed_keeps_coordinates_and_attributes(expected):
    dem = dem_of()
    found = dem.gnomon.viewshed(PLACE, height=60, outside=300.0)
    same(found, expected)
    assert found.seen.dims == ("y", "x") and found.seen.coords.equals(dem.coords)
    assert found.seen.attrs["AREA_OR_POINT"] == "Area" and found.seen.attrs["grid_mapping"] == "spatial_ref"
    assert found.seen.attrs["units"] == "1" and found.seen.attrs["gnomon_refraction"] == "0.142857"


def test_any_order_and_any_names(expected):
    up = dem_of()[::-1]
    same(up.gnomon.viewshed(PLACE, height=60, outside=300.0)[{"y": slice(None, None, -1)}], expected)
    westwards = dem_of()[:, ::-1]
    same(westwards.gnomon.viewshed(PLACE, height=60, outside=300.0)[{"x": slice(None, None, -1)}], expected)
    odd = dem_of(dims=("hochwert", "rechtswert"))
    assert odd.gnomon.viewshed(PLACE, height=60, outside=300.0).seen.dims == ("hochwert", "rechtswert")
    same(odd.gnomon.viewshed(PLACE, height=60, outside=300.0), expected)
    turned = odd.transpose()
    found = turned.gnomon.viewshed(PLACE, height=60, outside=300.0, x_dim="rechtswert")
    assert found.seen.dims == ("rechtswert", "hochwert")
    same(found.transpose(), expected)
    same(dem_of().transpose().gnomon.viewshed(PLACE, height=60, outside=300.0).transpose("y", "x"), expected)
    with_band = dem_of().expand_dims(band=[1])
    same(with_band.gnomon.viewshed(PLACE, height=60, outside=300.0), expected)


def test_dask_is_lazy_and_keeps_chunks(expected):
    calls = []
    lazy = dem_of().chunk(y=16, x=10)
    lazy = lazy.copy(data=lazy.data.map_blocks(lambda a: calls.append(1) or a, meta=np.empty((0, 0))))
    found = lazy.gnomon.viewshed(PLACE, height=60, outside=300.0)
    hours = lazy.gnomon.sun_hours(**DAY)
    assert not calls and found.seen.chunks == lazy.chunks == hours.chunks
    same(found.compute(), expected)
    assert len(calls) >= 12


def test_absent_heights_of_every_kind(expected):
    whole = np.where(np.isnan(city(40)), -9999, city(40))
    declared = dem_of(whole).assign_attrs(_FillValue=-9999.0)
    found = declared.gnomon.viewshed(PLACE, height=60, outside=300.0)
    same(found, expected)
    assert "_FillValue" not in found.seen.attrs
    masked = dem_of().chunk(y=20)
    masked = masked.copy(data=masked.data.map_blocks(lambda a: np.ma.masked_invalid(a), meta=np.ma.empty((0, 0))))
    same(masked.gnomon.viewshed(PLACE, height=60, outside=300.0), expected)


@pytest.mark.parametrize("value, attrs", [
    (-70.0, {"valid_range": [-50.0, 9000.0]}), (-70.0, {"valid_min": -50.0}), (9999.0, {"valid_max": 9000.0}),
    (-7.0, {"nodatavals": (-7.0,)}), (-7.0, {"missing_value": [-7.0, -8.0]}),
])  # fmt: skip
def test_absent_heights_that_attributes_declare(value, attrs, expected):
    declared = dem_of(np.where(np.isnan(city(40)), value, city(40))).assign_attrs(attrs)
    found = declared.gnomon.viewshed(PLACE, height=60, outside=300.0)
    same(found, expected)
    assert not set(attrs) & set(found.seen.attrs)


@pytest.mark.parametrize("units", ["ft", "US survey foot", "mm", "degrees", "kg m-2", "cm"])
def test_heights_that_are_not_metres_are_refused_and_the_remedy_helps(units, expected):
    for ask in (lambda dem: dem.gnomon.viewshed(PLACE), lambda dem: dem.gnomon.sun_hours(**DAY)):
        with pytest.raises(ValueError, match="heights: attrs..units.. is .*, which is not metres: multiply"):
            ask(dem_of().assign_attrs(units=units))
    in_feet = (dem_of() / 0.3048).assign_attrs(units=units)
    same((in_feet * 0.3048).round(9).assign_attrs(units="m").gnomon.viewshed(PLACE, height=60, outside=300.0), expected)
    rain = dem_of().assign_attrs(units="m", standard_name="lwe_thickness_of_precipitation_amount")
    with pytest.raises(ValueError, match="standard_name'\\] is 'lwe_.*, which is none of heights: if they"):
        rain.gnomon.viewshed(PLACE)
    del rain.attrs["standard_name"]
    same(rain.gnomon.viewshed(PLACE, height=60, outside=300.0), expected)
    with pytest.raises(ValueError, match="are packed numbers .*scale_factor"):
        dem_of().assign_attrs(scale_factor=0.1).gnomon.viewshed(PLACE)


@pytest.mark.parametrize("dims, units", [(("lat", "lon"), None), (("latitude", "Longitude"), None),
                                         (("y", "x"), "degrees_east"), (("y", "x"), None)])  # fmt: skip
def test_degrees_without_a_crs_are_refused(dims, units):
    dem = xarray.DataArray(np.zeros((8, 8)), {dims[0]: np.arange(8) / 3600, dims[1]: np.arange(8) / 3600}, dims)
    if units:
        dem[dims[1]].attrs["units"] = units
    with pytest.raises(ValueError, match="(are|look like) degrees: put them on a map in metres first"):
        dem.gnomon.viewshed([0.001, 0.001])
    for dim in dims:
        dem[dim].attrs["units"] = "m"
    assert dem.gnomon.viewshed([0.001, 0.001]).seen.values.all()


def test_with_rioxarray(tmp_path, expected):
    rioxarray = pytest.importorskip("rioxarray")
    path = write_raster(tmp_path / "dem.tif", city(40))
    for masked in (True, False):
        dem = rioxarray.open_rasterio(path, masked=masked)
        found = dem.gnomon.viewshed(PLACE, height=60, outside=300.0)
        same(found, expected)
        assert found.seen.rio.crs == dem.rio.crs and found.seen.rio.transform() == dem.rio.transform()


def test_sun_hours_are_those_of_the_study(tmp_path):
    study = run(tmp_path / "study", raster=write_raster(tmp_path / "dem.tif", city(40)), **DAY)
    expected = study.dataset().sun_hours.values.astype(np.float32)
    hours = dem_of(city(40).astype(np.float32))[::-1].gnomon.sun_hours(**DAY)
    np.testing.assert_array_equal(hours.values[::-1], expected)
    assert hours.attrs["units"] == "h" and np.nanmax(expected) > 6
    bare = dem_of().drop_vars("spatial_ref").gnomon.sun_hours(crs=UTM, **DAY)
    assert bare.equals(dem_of().gnomon.sun_hours(**DAY).drop_vars("spatial_ref"))


def test_irradiation_is_that_of_the_study(tmp_path):
    pytest.importorskip("pyradiance")
    from weather_made import write_epw

    epw = write_epw(tmp_path / "a.epw", latitude=45.2, longitude=9.2, days=2)
    raster = write_raster(tmp_path / "dem.tif", city(40))
    data = run(tmp_path / "study", raster=raster, weather=str(epw), outside=300.0).dataset()
    dem = dem_of(city(40).astype(np.float32), dims=("hochwert", "rechtswert"))[::-1].transpose().chunk(rechtswert=16)
    masked = dem.copy(data=dem.data.map_blocks(lambda a: np.ma.masked_invalid(a), meta=np.ma.empty((0, 0))))
    found = masked.gnomon.irradiation(epw, x_dim="rechtswert", outside=300.0)
    assert list(found.data_vars) == ["irradiation", "direct", "diffuse"]
    for name, layer in found.data_vars.items():
        assert layer.chunks == dem.chunks and layer.dims == dem.dims and layer.coords.equals(dem.coords)
        assert layer.attrs["units"] == "kWh m-2" and layer.attrs["grid_mapping"] == "spatial_ref"
        undecided = data[f"undecided_{name}"].values
        assert name != "irradiation" or (undecided > 0).any()
        expected = np.where(undecided == 0, data[name].values, np.nan).astype(np.float32)
        np.testing.assert_array_equal(layer.values.T[::-1], expected)
    assert np.nanmax(found.irradiation.values) > 0.5


def test_irradiation_refuses_what_does_not_fit(tmp_path):
    pytest.importorskip("pyradiance")
    from weather_made import write_epw

    far = write_epw(tmp_path / "far.epw", days=1)
    with pytest.raises(ValueError, match=r"Made \(48.2, 16.4\) is [1-9]\d\d km from the site"):
        dem_of().gnomon.irradiation(far)
    with pytest.raises(ValueError, match="none.epw: there is no such file"):
        dem_of().gnomon.irradiation(tmp_path / "none.epw")
    with pytest.raises(ValueError, match="crs: the heights have no CRS"):
        dem_of().drop_vars("spatial_ref").gnomon.irradiation(far)


def test_wrong_arrays_are_named():
    with pytest.raises(ValueError, match="must have two"):
        xarray.DataArray(np.zeros((2, 3, 4))).gnomon.viewshed([0, 0])
    with pytest.raises(ValueError, match="has no coordinates"):
        xarray.DataArray(np.zeros((3, 4))).gnomon.viewshed([0, 0])
    with pytest.raises(ValueError, match="x_dim: 'z' is none of"):
        dem_of().gnomon.viewshed(PLACE, x_dim="z")
    with pytest.raises(ValueError, match="degrees"):
        dem_of(crs="EPSG:4326").gnomon.viewshed(PLACE)
    with pytest.raises(ValueError, match="crs: the heights have no CRS"):
        dem_of().drop_vars("spatial_ref").gnomon.sun_hours(**DAY)
    with pytest.raises(ValueError, match="crs: .*EPSG:99999"):
        dem_of().gnomon.sun_hours(crs="EPSG:99999", **DAY)
    undeclared = dem_of(np.where(np.isnan(city(40)), -9999, city(40)))
    for ask in (lambda: undeclared.gnomon.viewshed(PLACE), lambda: undeclared.gnomon.sun_hours(**DAY)):
        with pytest.raises(ValueError, match=r"is -9999, .*: say dem.attrs\['_FillValue'\] = -9999.0"):
            ask()


@pytest.mark.parametrize("of", ["viewshed", "sun_hours"])
def test_coordinates_that_are_no_grid_in_metres(of):
    dem = dem_of()

    def asked(given):
        accessor = given.gnomon
        at = float(dem.x[3]), float(dem.y[3])
        return accessor.viewshed(at).seen if of == "viewshed" else accessor.sun_hours(**DAY)

    for units in ("US_survey_foot", "ft", "km"):
        feet = dem.assign_coords(x=dem.x.assign_attrs(units=units))
        with pytest.raises(ValueError, match=f"heights: the coordinates 'x' are in '{units}', not metres: multiply"):
            asked(feet)
    metres = feet.assign_coords(x=(feet.x * 1.0).assign_attrs(units="m"))
    assert asked(metres).equals(asked(dem))
    uneven = dem.assign_coords(y=np.where(np.arange(dem.sizes["y"]) == 4, dem.y + 2, dem.y))
    with pytest.raises(ValueError, match=r"heights: the coordinates 'y' are not equally spaced: dem.interp\(y="):
        asked(uneven)
    with pytest.raises(ValueError, match="heights: the coordinates 'x' must be finite numbers, not datetime64"):
        asked(dem.assign_coords(x=np.arange(dem.sizes["x"]).astype("M8[D]")))


def test_meshes_stand_where_the_coordinates_say(tmp_path):
    """A plate of 20 m over the middle of one cell of 25 m, around noon."""
    x, y = EAST[7], NORTH[11]
    corners = [(x + i * 10, y + j * 10, 103) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    rows = "".join(f"v {a} {b} {c}\n" for a, b, c in corners)
    (tmp_path / "plate.obj").write_text(rows + "f 1 2 3 4\n")
    noon = dict(start="2026-06-20T12:00", end="2026-06-20T13:00", step="1h", utc_offset=1, min_elevation=45)
    hours = dem_of(np.full((40, 40), 100.0)).gnomon.sun_hours(**noon, meshes=str(tmp_path / "plate.obj"))
    assert np.argwhere(hours.values == 0).tolist() == [[11, 7]]


def test_a_grid_mapping_of_any_name(tmp_path):
    dem = dem_of(np.full((40, 40), 100.0)).rename(spatial_ref="utm_zone").assign_attrs(grid_mapping="utm_zone")
    hours = dem.gnomon.sun_hours(**DAY)
    assert (hours.values > 10).all()
    in_encoding = dem.drop_attrs()
    in_encoding["utm_zone"].attrs.update(dem["utm_zone"].attrs)
    in_encoding.encoding["grid_mapping"] = "utm_zone"
    assert in_encoding.gnomon.sun_hours(**DAY).equals(hours)


def test_numbers_that_are_no_heights():
    dem = dem_of(np.zeros((40, 40)))
    for of_another_type in (dem > 1, dem.astype(object), dem.astype("M8[s]")):
        for ask in (lambda d: d.gnomon.viewshed(PLACE), lambda d: d.gnomon.sun_hours(**DAY)):
            with pytest.raises(ValueError, match="heights: must be real numbers, not (bool|object|datetime64)"):
                ask(of_another_type)
    with pytest.raises(ValueError, match=r"'x' has no coordinates, the centres of .* dem.assign_coords\(x=...\)"):
        dem.drop_vars("x").gnomon.viewshed(PLACE)


def test_wide_cells_in_degrees_are_refused():
    """A quarter of a degree, by how steep the ground would be; x and y do not say what they are."""
    dem = xarray.DataArray(
        np.random.default_rng(3).uniform(0, 900, (20, 30)), dims=("y", "x"),
        coords={"y": 45 - 0.25 * np.arange(20), "x": 9 + 0.25 * np.arange(30)},
    )  # fmt: skip
    with pytest.raises(ValueError, match="look like degrees"):
        dem.gnomon.viewshed((9.25, 44.75))
    said = dem.assign_coords(x=dem.x.assign_attrs(units="m"), y=dem.y.assign_attrs(units="m"))
    assert said.gnomon.viewshed((9.25, 44.75)).seen.sizes == dem.sizes
