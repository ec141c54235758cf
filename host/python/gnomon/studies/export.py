# SPDX-License-Identifier: MIT
"""Results as files that other programs open: GeoTIFF (COG), CSV, and a picture with a legend; the table of suns."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import rasterio
import rasterio.shutil
from numpy.typing import NDArray

from .energy import ENERGIES
from .plan import Plan
from .receivers import RasterReceivers
from .tables import suns_text

NO_HOURS = -9999.0
NO_BITS = -9999
TITLES = {"sun_hours": "hours of sun", "sum_of_weights": "sum of weights", "irradiation": "irradiation, kWh/m²",
          "direct": "direct irradiation, kWh/m²", "diffuse": "diffuse irradiation, kWh/m²"}  # fmt: skip
#: The arrays of the undecided parts of sums.
UNDECIDED = {"sun_hours": "undecided_hours", "sum_of_weights": "undecided_weights",
             **{name: f"undecided_{name}" for name in ENERGIES}}  # fmt: skip


def export(plan: Plan, path: Path, what: str | None = None) -> list[Path]:
    """Writes a result: `sun_hours`, `sum_of_weights`, `irradiation`, `direct`, `diffuse` or `lit`; None: the first that
    the study has; or `suns`. Raises ValueError.

    A raster's sums become a COG of two bands: the sum, nodata where a sun is undecided, and the undecided part. Its
    packed bits become, in the folder `path`, the Solar API's hourlyShade: 12 COGs of 24 bands of int32, bit d - 1 of
    band h for day d at hour h; nodata (-9999) where a bit is undecided. Points become a CSV file. The suns of a study
    with one sun zone become a CSV file (docs/studies.md), for gnomon hours or another study.
    """
    if what == "suns":
        return [_export_suns(plan, path)]
    names = [n for n in plan.results if not n.startswith("undecided")]
    name = what or next((n for n in names if n != "lit"), names[0])
    if name not in names:
        raise ValueError(f"what: {name!r} is not in this study, which has {', '.join(names)}")
    if not isinstance(plan.receivers, RasterReceivers):
        return [_export_points(plan, path, name)]
    if name == "lit":
        return _export_bits(plan, path)
    _require_ending(path, ".tif", ".tiff")
    dtype = plan.store.array(f"results.zarr/{name}").dtype
    with _Cog(plan, path, 2, str(dtype), NO_HOURS) as file:
        file.set_band_description(1, TITLES[name])
        file.set_band_description(2, f"{TITLES[name]}, undecided")
        for tile in range(len(plan.receivers)):
            slices = plan.receivers.slices(tile)
            sums, undecided = (plan.store.array(f"results.zarr/{n}")[slices] for n in (name, UNDECIDED[name]))
            is_known = ~np.isnan(sums) & (undecided == 0)
            file.write(np.where(is_known, sums, NO_HOURS).astype(dtype), 1, window=_window(slices))
            file.write(np.where(np.isnan(undecided), NO_HOURS, undecided).astype(dtype), 2, window=_window(slices))
    return [path]


def _require_ending(path: Path, *endings: str) -> None:
    """Raises ValueError for a name that promises another format than the one that is written."""
    if path.suffix.lower() not in endings:
        raise ValueError(f"{path}: this result is written as {endings[0]}: name it {path.with_suffix(endings[0]).name}")


def _window(slices: tuple[slice, ...]) -> Any:
    return rasterio.windows.Window.from_slices(*slices)


class _Cog:
    """A GeoTIFF that is written by windows, then copied to a COG, which appears whole."""

    def __init__(self, plan: Plan, path: Path, bands: int, dtype: str, nodata: float) -> None:
        assert isinstance(plan.receivers, RasterReceivers)
        mosaic = plan.receivers.mosaic
        path.parent.mkdir(parents=True, exist_ok=True)
        self._path = path
        self._folder = tempfile.TemporaryDirectory(dir=path.parent, prefix=".gnomon-")
        self._plain = Path(self._folder.name) / "plain.tif"
        self._file = rasterio.open(
            self._plain, "w", driver="GTiff", tiled=True, width=mosaic.columns, height=mosaic.rows, count=bands,
            dtype=dtype, nodata=nodata, crs=plan.settings.crs or mosaic.crs, BIGTIFF="IF_SAFER",
            transform=rasterio.Affine(mosaic.dx, 0, mosaic.west, 0, -mosaic.dy, mosaic.north),
        )  # fmt: skip

    def __enter__(self) -> Any:
        return self._file

    def __exit__(self, error: object, *_: object) -> None:
        self._file.close()
        if error is None:
            cog = Path(self._folder.name) / "cog.tif"
            rasterio.shutil.copy(self._plain, cog, driver="COG", compress="DEFLATE")
            os.replace(cog, self._path)
        self._folder.cleanup()


def _export_bits(plan: Plan, folder: Path) -> list[Path]:
    if not plan.suns.is_hourly:
        raise ValueError(
            "what: packed bits are exported for steps of one hour within one year; other bits stay in zarr"
        )
    lit, undecided = plan.store.array("results.zarr/lit"), plan.store.array("results.zarr/undecided")
    paths = []
    words_with_suns = {int(word) for block in plan.blocks for word in block}
    for month in range(12):
        path = folder / f"hourly_shade_{month + 1:02}.tif"
        with _Cog(plan, path, 24, "int32", NO_BITS) as file:
            for tile in range(len(plan.receivers)):
                slices = plan.receivers.slices(tile)
                is_valid = plan.receivers.tile(tile).is_valid.reshape(tuple(s.stop - s.start for s in slices))
                for hour in range(24):
                    word = 24 * month + hour
                    values = np.where(is_valid, 0, NO_BITS).astype(np.int32)
                    if word in words_with_suns:
                        bits = lit[(word, *slices)].astype(np.int32)
                        values = np.where(is_valid & (undecided[(word, *slices)] == 0), bits, np.int32(NO_BITS))
                    file.write(values, hour + 1, window=_window(slices))
        paths.append(path)
    return paths


def _export_points(plan: Plan, path: Path, name: str) -> Path:
    if name == "lit":
        raise ValueError("what: packed bits of points stay in zarr (xarray.open_zarr)")
    _require_ending(path, ".csv")
    columns = [plan.store.array(f"results.zarr/{n}")[:] for n in ("x", "y", "z", name)]
    undecided = plan.store.array(f"results.zarr/{UNDECIDED[name]}")[:]
    np.savetxt(path, np.stack([*columns, undecided], axis=1), delimiter=",", fmt="%.17g", comments="",
               header=f"x,y,z,{name},undecided")  # fmt: skip
    return path


def _export_suns(plan: Plan, path: Path) -> Path:
    _require_ending(path, ".csv")
    suns = plan.suns
    if len(suns.zones) != 1:
        raise ValueError(
            f"what: a table of suns is for one sun zone, and this study has {len(suns.zones)}: make the study with a "
            "larger zone="
        )
    is_up = np.isfinite(suns.towards[0, :, 0])
    if len(suns.is_sky):
        is_up &= ~suns.is_sky
    hours = suns.seconds / (3600.0 * suns.samples)
    weights = np.ldexp(suns.weights.astype(np.float64), suns.exponent) if suns.weights.any() else hours
    times = np.repeat(suns.times, suns.samples)[is_up].tolist() if suns.times else []
    path.write_text(suns_text(suns.towards[0, is_up], weights[is_up], times))
    return path


def _period(plan: Plan) -> str:
    """The time of a study's suns, for a title."""
    if plan.settings.weather is not None:
        return "by\n" + str(plan.suns.notes["weather"]).strip("'\"")
    return f"{plan.settings.start} to {plan.settings.end}" if plan.settings.start else "table of directions"


def _title(plan: Plan, name: str) -> str:
    """With what the squares in a map are where some zones have a sun more than others."""
    title = f"{TITLES[name]}, {_period(plan)}"
    counts = np.isfinite(plan.suns.towards[..., 0]).sum(axis=1)
    if (counts == counts[0]).all():
        return title
    side, least = plan.settings.zone / 1000, plan.settings.min_elevation
    return f"{title}\nits squares are sun zones of {side:g} km: a sun near {least:g} degrees is left out in some"


def picture(plan: Plan, path: Path, what: str | None = None, largest: int = 1200) -> Path:
    """A map of sums with a legend; grey where a sun is undecided, white where there is no receiver. A raster with more
    than `largest` cells on a side is drawn by every n-th cell."""
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    names = [n for n in plan.results if n in TITLES]
    name = what or next(iter(names), "")
    if name not in names:
        raise ValueError(f"what: a picture shows {' or '.join(TITLES)}; this study has {', '.join(plan.results)}")
    values, undecided = (plan.store.array(f"results.zarr/{n}") for n in (name, UNDECIDED[name]))
    figure = Figure(figsize=(8, 6.4), dpi=120, layout="constrained")
    axes = figure.subplots()
    if isinstance(plan.receivers, RasterReceivers):
        mosaic = plan.receivers.mosaic
        stride = max(1, -(-max(values.shape) // largest))
        shown: NDArray[Any] = values[::stride, ::stride]
        east, south = mosaic.west + mosaic.columns * mosaic.dx, mosaic.north - mosaic.rows * mosaic.dy
        extent = (mosaic.west, east, south, mosaic.north)
        drawn: Any = axes.imshow(shown, extent=extent, cmap="inferno", interpolation="nearest")
        grey = np.where(undecided[::stride, ::stride] > 0, 1.0, np.nan)
        if np.nansum(grey):
            axes.imshow(grey, extent=extent, cmap="Greys", vmin=0, vmax=2, interpolation="nearest")
            axes.legend(handles=[Patch(color="0.5", label="undecided")], loc="upper right")
    else:
        x, y = (plan.store.array(f"results.zarr/{n}")[:] for n in "xy")
        drawn = axes.scatter(x, y, c=values[:], s=2, cmap="inferno")
        axes.set_aspect("equal")
    axes.ticklabel_format(style="plain", useOffset=False)
    axes.tick_params(axis="x", rotation=20)
    axes.set_xlabel("east, m")
    axes.set_ylabel("north, m")
    axes.set_title(_title(plan, name), fontsize=10)
    figure.colorbar(drawn, ax=axes, label=TITLES[name])
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path)
    return path
