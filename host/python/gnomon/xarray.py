# SPDX-License-Identifier: MIT
"""The accessor `gnomon` of xarray.DataArray: importing this module registers it.

    import gnomon.xarray
    seen = dem.gnomon.viewshed((691_080, 5_334_940)).seen
    hours = dem.gnomon.sun_hours(start="2026-06-21", end="2026-06-22", utc_offset=1)
    energy = dem.gnomon.irradiation("vienna.epw").irradiation

dem: heights in metres on a map in metres, of two dimensions of any names (others must have length 1), equally spaced in
either direction. NaN and the values that the attributes declare are no data. Results keep coordinates, CRS and chunks,
and attributes that do not speak of heights; of a dask array they are lazy, and the array is then read as a whole.
"""

from __future__ import annotations

import functools
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from . import _arrays
from ._earth import EARTH_RADIUS
from ._study import NEEDS
from ._viewshed import REFRACTION, ViewshedGrid

#: Attributes of heights that do not hold for results.
_OF_HEIGHTS = ("units", "long_name", "standard_name", "_FillValue", "missing_value", "nodata", "nodatavals",
               "scale_factor", "add_offset", "valid_range", "valid_min", "valid_max", "actual_range",
               "STATISTICS_MINIMUM", "STATISTICS_MAXIMUM", "STATISTICS_MEAN", "STATISTICS_STDDEV",
               "STATISTICS_VALID_PERCENT")  # fmt: skip
#: Names of dimensions whose coordinates are degrees, if no attribute says another unit.
_DEGREES = ("lon", "longitude", "lat", "latitude")
_EASTWARDS = ("x", "lon", "longitude", "easting", "east", "projection_x_coordinate")

#: Takes heights (R, C), with NaN where there is no data, and gives layers (n, R, C).
_Layers = Callable[[NDArray[np.float64]], NDArray[np.float32]]


@xarray.register_dataarray_accessor("gnomon")
class GnomonAccessor:
    """Of a DataArray of heights: see this module."""

    def __init__(self, dem: xarray.DataArray) -> None:
        self._dem = dem

    def viewshed(
        self,
        observers: Any,
        *,
        height: Any = 2.0,
        target_height: Any = 0.0,
        distance: Any = None,
        outside: float | None = None,
        refraction: float | None = REFRACTION,
        radius: float = EARTH_RADIUS,
        x_dim: str | None = None,
    ) -> xarray.Dataset:
        """A Dataset of `seen` and `undecided`, the numbers of observers that see each cell, and that may see it;
        float32, NaN where there is no data. The arguments are those of gnomon.viewshed(). x_dim: the dimension that
        runs eastwards, if its name is not one of the usual ones, and it is not the last one."""
        dem, x, y = self._flat(x_dim)
        _require_metres(dem, x, y)
        are_metres = _crs_of(dem) is not None or all(dem.coords[name].attrs.get("units") for name in dem.dims)

        def layers(heights: NDArray[np.float64]) -> NDArray[np.float32]:
            grid = ViewshedGrid(heights, x=x, y=y, refraction=refraction, radius=radius, are_metres=are_metres)
            found = grid.viewshed(
                observers, height=height, target_height=target_height, distance=distance, outside=outside
            )
            both = np.stack([found.counts, found.undecided]).astype(np.float32)
            both[:, found.is_absent] = np.nan
            return both

        seen, undecided = self._results(dem, layers, 2)
        text = "plane" if refraction is None else f"{refraction:.6g}"
        made = {"units": "1", "gnomon_refraction": text}
        return xarray.Dataset(
            {
                "seen": seen.assign_attrs({**made, "long_name": "observers that see the cell"}),
                "undecided": undecided.assign_attrs({**made, "long_name": "observers that may see the cell"}),
            }
        )

    def sun_hours(self, *, x_dim: str | None = None, crs: Any = None, **settings: Any) -> xarray.DataArray:
        """Hours of sun, float32; NaN where there is no data, or an answer is undecided. settings: start=, end=, step=,
        utc_offset= and the others of gnomon.study() (docs/studies.md). crs: of the coordinates, if `dem` does not say
        it. Needs pip install 'gnomon[study]'."""
        (hours,) = self._studied({"sun_hours": "hours"}, x_dim, crs, settings)
        return hours.assign_attrs(units="h", long_name="hours of sun")

    def irradiation(
        self, weather: Any, *, x_dim: str | None = None, crs: Any = None, **settings: Any
    ) -> xarray.Dataset:
        """A Dataset of `irradiation`, the Sun's and the sky's on the slopes of the heights, and its parts `direct` and
        `diffuse`, in kWh/m2 over the hours of a weather file (its name); float32, NaN where there is no data, or an
        answer is undecided. settings and crs: as in sun_hours(). Needs pip install 'gnomon[study,weather]'."""
        names = {name: name for name in ("irradiation", "direct", "diffuse")}
        given = settings | {"weather": weather}
        layers = self._studied(names, x_dim, crs, given)
        texts = ("energy of Sun and sky", "energy of the Sun", "energy of the sky")
        return xarray.Dataset(
            {
                str(layer.name): layer.assign_attrs(units="kWh m-2", long_name=text)
                for layer, text in zip(layers, texts, strict=True)
            }
        )

    def _studied(
        self, outputs: dict[str, str], x_dim: str | None, crs: Any, settings: dict[str, Any]
    ) -> list[xarray.DataArray]:
        """The arrays that a study of these heights has for each of its outputs: names of arrays, and of outputs."""
        dem, x, y = self._flat(x_dim)
        known = crs if crs is not None else _crs_of(dem)
        if known is None:
            raise ValueError("crs: the heights have no CRS, which gives the place on the Earth: give crs=")
        _require_metres(dem, x, y, known)
        layers = functools.partial(_study_layers, x=x, y=y, crs=known, outputs=outputs, settings=settings)
        results = self._results(dem, layers, len(outputs))
        return [result.rename(name) for result, name in zip(results, outputs, strict=True)]

    def _flat(self, x_dim: str | None) -> tuple[xarray.DataArray, NDArray[np.float64], NDArray[np.float64]]:
        """The heights with dimensions northwards (or southwards) and eastwards; the cells' centres."""
        dem = self._dem.squeeze()
        if dem.ndim != 2:
            raise ValueError(f"heights: has the dimensions {dict(self._dem.sizes)}, and must have two above 1")
        if x_dim is None:
            named = [name for name in dem.dims if str(name).lower() in _EASTWARDS]
            x_dim = str(named[0]) if len(named) == 1 else str(dem.dims[1])
        if x_dim not in dem.dims:
            raise ValueError(f"x_dim: {x_dim!r} is none of the dimensions {', '.join(map(str, dem.dims))}")
        (y_dim,) = (name for name in dem.dims if name != x_dim)
        for name in (x_dim, y_dim):
            if name not in dem.coords:
                raise ValueError(
                    f"heights: the dimension {name!r} has no coordinates, the centres of the cells in metres: give "
                    f"them by dem.assign_coords({name}=...)"
                )
        dem = dem.transpose(y_dim, x_dim)
        _arrays.require_attributes_of_heights(dem)
        _arrays.require_real(np.empty(0, dem.dtype), "heights")
        return dem, _places_along(dem, x_dim), _places_along(dem, str(y_dim))

    def _results(self, dem: xarray.DataArray, layers: _Layers, count: int) -> list[xarray.DataArray]:
        """The layers that `layers` makes of the heights, as arrays like `dem`, in the caller's order of dimensions."""
        no_data = _arrays.declared_no_data(dem)
        lowest, highest = _valid_range(dem)

        def run(values: Any) -> NDArray[np.float32]:
            given = np.ma.asarray(values)
            is_there = np.isfinite(given.data) & ~np.ma.getmaskarray(given) & ~np.isin(given.data, no_data)
            is_there &= (given.data >= lowest) & (given.data <= highest)
            _arrays.require_heights(given.data, is_there, "dem.attrs['_FillValue'] = {}", len(no_data) > 0)
            return layers(np.where(is_there, given.data, np.nan))

        if dem.chunks is None:
            found = run(dem.data)
        else:
            import dask.array

            found = dask.array.map_blocks(
                run, dem.data.rechunk(-1), dtype=np.float32, new_axis=0, meta=np.empty((0, 0, 0), np.float32),
                chunks=((count,), *((n,) for n in dem.shape)),
            ).rechunk((count, *dem.chunks))  # fmt: skip
        attrs = {key: value for key, value in dem.attrs.items() if key not in _OF_HEIGHTS}
        order = [name for name in self._dem.dims if name in dem.dims]
        results = []
        for i in range(count):
            result = xarray.DataArray(found[i], dem.coords, dem.dims, attrs=attrs).transpose(*order)
            if "grid_mapping" in dem.encoding:
                result.encoding["grid_mapping"] = dem.encoding["grid_mapping"]
            results.append(result)
        return results


def _places_along(dem: xarray.DataArray, name: str) -> NDArray[np.float64]:
    """The cells' centres along a dimension, in metres or degrees. Raises ValueError."""
    given = dem.coords[name]
    if given.dtype.kind not in "iuf" or not np.isfinite(given.values).all():
        raise ValueError(f"heights: the coordinates {name!r} must be finite numbers, not {given.dtype}")
    places = given.values.astype(np.float64)
    step = (places[-1] - places[0]) / max(len(places) - 1, 1)
    if np.abs(places - (places[0] + step * np.arange(len(places)))).max() > 1e-3 * abs(step) or step == 0:
        raise ValueError(
            f"heights: the coordinates {name!r} are not equally spaced: dem.interp({name}=...) makes a grid of heights"
        )
    units = str(given.attrs.get("units", "")).strip()
    if (units.lower().split() or [""])[0] not in _arrays.METRES and not units.lower().startswith("degree"):
        raise ValueError(
            f"heights: the coordinates {name!r} are in {units!r}, not metres: multiply them by the metres of that "
            f"unit, as in dem.assign_coords({name}=(dem.{name} * 0.3048).assign_attrs(units='m'))"
        )
    return places


def _crs_of(dem: xarray.DataArray) -> Any:
    """The CRS that rioxarray, or a coordinate or attribute as it writes them, gives; None if there is none."""
    name = dem.encoding.get("grid_mapping", dem.attrs.get("grid_mapping", "spatial_ref"))
    if name in dem.coords:
        for key in ("crs_wkt", "spatial_ref"):
            if dem.coords[name].attrs.get(key):
                return dem.coords[name].attrs[key]
    return dem.attrs.get("crs")


def _valid_range(dem: xarray.DataArray) -> tuple[float, float]:
    """The lowest and the highest value that is data, as the conventions of netCDF have it."""
    low, high = dem.attrs.get("valid_range", (-np.inf, np.inf))
    return float(dem.attrs.get("valid_min", low)), float(dem.attrs.get("valid_max", high))


def _require_metres(dem: xarray.DataArray, x: NDArray[np.float64], y: NDArray[np.float64], crs: Any = None) -> None:
    known = crs if crs is not None else _crs_of(dem)
    if known is None:
        is_tiny = all(len(a) > 1 and abs(a[1] - a[0]) < 0.01 and abs(a).max() < m for a, m in ((x, 361), (y, 91)))
        for name in dem.dims:
            units = str(dem.coords[name].attrs.get("units", ""))
            is_likely = is_tiny or str(name).lower() in _DEGREES  # cells below a centimetre
            if units.lower().startswith("degree") or (not units and is_likely):
                how = "are" if units else "look like"
                raise ValueError(
                    f"heights: the coordinates {str(name)!r} {how} degrees: put them on a map in metres first, as in "
                    "dem.rio.write_crs('EPSG:4326').rio.reproject(dem.rio.estimate_utm_crs()); if they are metres, "
                    f"say so: dem.{name}.attrs['units'] = 'm'"
                )
        return
    try:
        import pyproj.exceptions

        from .studies.units import require_metres
    except ModuleNotFoundError as error:
        raise ImportError(NEEDS.format(error.name)) from None
    try:
        require_metres("heights", known, float(x.mean()), float(y.mean()))
    except pyproj.exceptions.CRSError as error:
        raise ValueError(f"crs: {error}") from None


def _study_layers(
    heights: NDArray[np.float64],
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    crs: Any,
    outputs: dict[str, str],
    settings: dict[str, Any],
) -> NDArray[np.float32]:
    """Runs a study of these heights in a folder of its own."""
    import rasterio

    from . import study

    turns = slice(None, None, -1 if y[-1] > y[0] else 1), slice(None, None, -1 if x[-1] < x[0] else 1)
    dx, dy = abs(x[-1] - x[0]) / (len(x) - 1), abs(y[-1] - y[0]) / (len(y) - 1)
    grid = rasterio.Affine(dx, 0, x.min() - dx / 2, 0, -dy, y.max() + dy / 2)
    with tempfile.TemporaryDirectory(prefix="gnomon-") as folder:
        raster = str(Path(folder) / "heights.tif")
        with rasterio.open(
            raster, "w", driver="GTiff", width=len(x), height=len(y), count=1, dtype="float64", nodata=np.nan, crs=crs,
            transform=grid,
        ) as file:  # fmt: skip
            file.write(heights[turns], 1)
        asked = {"outputs": list(outputs.values()), "progress": False} | settings
        data = study(Path(folder) / "study", raster=raster, **asked).dataset()
        layers = [
            np.where(data[f"undecided_{output}"].values == 0, data[name].values, np.nan)[turns]
            for name, output in outputs.items()
        ]
        return np.stack(layers).astype(np.float32)
