# SPDX-License-Identifier: MIT
"""Units and coordinate reference systems, as PROJ knows them. A study computes in metres on a map."""

from __future__ import annotations

import functools
import warnings
from typing import Any

import numpy as np
import pyproj
from numpy.typing import NDArray

#: Names of units that files use beside PROJ's own.
OTHER_NAMES = {
    "metre": ("meter", "meters", "metres", "mtr"),
    "foot": ("feet", "international foot", "international feet"),
    "US survey foot": (
        "foot_us", "ft_us", "ftus", "us foot", "us feet", "us survey feet", "us_survey_foot", "foot (us survey)",
        "u.s. survey foot", "u.s. foot",
    ),
    "centimetre": ("centimeter", "centimeters", "centimetres"),
    "millimetre": ("millimeter", "millimeters", "millimetres"),
    "kilometre": ("kilometer", "kilometers", "kilometres"),
}  # fmt: skip


@functools.lru_cache(maxsize=1)
def _factors() -> dict[str, float]:
    units = pyproj.get_units_map(category="linear")
    result = {unit.proj_short_name.lower(): unit.conv_factor for unit in units.values() if unit.proj_short_name}
    result |= {name.lower(): unit.conv_factor for name, unit in units.items()}
    result |= {name: result[known.lower()] for known, names in OTHER_NAMES.items() for name in names}
    return result | dict.fromkeys(("dm", "decimeter", "decimetre"), 0.1)  # PROJ 9 has it for .01


def metres_of(unit: str) -> float | None:
    """The metres of a unit by its name, in any case; None for a name that is not known."""
    return _factors().get(" ".join(unit.lower().split()))


def horizontal(crs: Any) -> pyproj.CRS:
    """A CRS without its heights."""
    whole = pyproj.CRS.from_user_input(crs)
    return whole.sub_crs_list[0] if whole.is_compound else whole.to_2d()


def utm_at(crs: pyproj.CRS, x: float, y: float) -> int:
    """The EPSG code of the UTM zone, or of the polar map, at a place of a CRS; 32632 where the CRS does not say where
    on Earth that is."""
    try:
        longitude, latitude = pyproj.Transformer.from_crs(crs, "EPSG:4326", always_xy=True).transform(x, y)
    except pyproj.exceptions.ProjError:
        return 32632
    if not (np.isfinite(longitude) and abs(latitude) <= 90):
        return 32632
    if abs(latitude) > 84:
        return 32661 if latitude > 0 else 32761
    return (32600 if latitude >= 0 else 32700) + int((longitude + 180) % 360 // 6) + 1


#: Degrees beyond the area for which a CRS is defined, from where on its numbers are taken for those of another CRS.
BEYOND_AREA = 10.0


def require_in_area(crs: pyproj.CRS, x: float, y: float, longitude: float, latitude: float) -> None:
    """Raises ValueError where a place of a CRS lies far outside of the area for which it is defined: then x and y are
    numbers of another one, or stand in another order, and suns would be those of another place."""
    area = crs.area_of_use
    if area is None:
        return
    width = (area.east - area.west) % 360 or 360
    beyond = max((longitude - area.west + BEYOND_AREA) % 360 - 2 * BEYOND_AREA - width, 0)
    if not beyond and area.south - BEYOND_AREA <= latitude <= area.north + BEYOND_AREA:
        return
    west_or_south = [axis.name for axis in crs.axis_info[:2] if axis.direction in ("west", "south")]
    remedy = "give the CRS of these numbers, x eastwards first"
    if west_or_south and len(west_or_south) == len({axis.direction for axis in crs.axis_info[:2]}):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # of what a string of PROJ leaves out: names
            plain = " ".join(word for word in crs.to_proj4().split() if not word.startswith("+axis="))
        remedy = f"its numbers grow to the south and west; for those that grow to the east and north give crs={plain!r}"
    of_area = f"longitudes {area.west:.1f} to {area.east:.1f}, latitudes {area.south:.1f} to {area.north:.1f}"
    raise ValueError(
        f"crs: {crs.name} has the place ({x:.0f}, {y:.0f}) at longitude {longitude:.1f}, latitude {latitude:.1f}, and "
        f"is for {of_area}: {remedy}"
    )


def require_metres(name: str, crs: Any, x: float, y: float, option: str = "") -> None:
    """Raises ValueError for a CRS that is no map in metres. x, y: a place of it, and option: one of rio warp, for the
    remedy."""
    flat = horizontal(crs)
    command = f"rio warp IN.tif OUT.tif --dst-crs EPSG:{utm_at(flat, x, y)}{option}"
    warp = f"warp it to UTM or a national grid first ({command})"
    units = {axis.unit_name: axis.unit_conversion_factor for axis in flat.axis_info}
    if flat.is_geographic:
        raise ValueError(f"{name}: its coordinates are degrees ({flat.name}), not metres on a map: {warp}")
    if flat.is_geocentric:
        raise ValueError(f"{name}: its coordinates count from the Earth's centre ({flat.name}), not on a map: {warp}")
    if any(abs(factor - 1) > 1e-12 for factor in units.values()):
        raise ValueError(
            f"{name}: its coordinates are not metres on a map but {', '.join(units) or 'unknown'} ({flat.name}): {warp}"
            "; where its heights are not metres either, and OUT.tif no longer says so, give height_unit="
        )


def metres_of_height(crs: Any) -> float | None:
    """The metres of the vertical unit that a CRS declares; None if it has no heights. Raises ValueError for depths."""
    if crs is None:
        return None
    whole = pyproj.CRS.from_user_input(crs)
    if len(whole.axis_info) < 3:
        return None
    axis = whole.axis_info[2]
    if axis.direction == "down":
        raise ValueError(f"its third axis, {axis.name}, points down, and a study needs heights")
    return float(axis.unit_conversion_factor)


def require_crs_of_mesh(
    name: str, crs: str, triangles: NDArray[np.float64], of_study: str | None, is_moved: bool
) -> float:
    """The metres of the file's heights. Raises ValueError if its CRS is no map in metres, or puts its triangles (F, 3,
    3) elsewhere than the study's CRS does."""
    try:
        flat, metres = horizontal(crs), metres_of_height(crs)
    except (pyproj.exceptions.CRSError, ValueError) as error:
        raise ValueError(f"{name}: its reference system {crs!r}: {error}") from None
    is_metres = flat.is_projected and all(abs(axis.unit_conversion_factor - 1) < 1e-12 for axis in flat.axis_info)
    target = None if of_study is None else horizontal(of_study)
    if is_metres and (target is None or is_moved or not len(triangles) or _is_same(flat, target, triangles)):
        return 1.0 if metres is None else metres
    wanted = "a map in metres" if target is None else f"the study's, {target.name}"
    middle = triangles.reshape(-1, 3).mean(axis=0) if len(triangles) else np.zeros(3)
    code = utm_at(flat, *middle[:2]) if target is None else target.to_epsg()
    how = "" if flat.is_geographic or code is None else f" (cjio IN.city.json crs_reproject {code} save OUT.city.json)"
    if how and target is not None:
        how += f", or, if its numbers are of {target.name} already, name that (crs_assign in place of crs_reproject)"
    raise ValueError(f"{name}: its reference system, {flat.name}, is not {wanted}: reproject it first{how}")


def _is_same(one: pyproj.CRS, other: pyproj.CRS, triangles: NDArray[np.float64]) -> bool:
    """Whether two CRSs put the corners of the triangles' box at the same place, to 1 cm."""
    if one.equals(other, ignore_axis_order=True):
        return True
    corners = triangles.reshape(-1, 3)
    x, y = np.stack([corners.min(axis=0), corners.max(axis=0)]).T[:2]
    moved = pyproj.Transformer.from_crs(one, other, always_xy=True).transform(x, y)
    return bool(np.isfinite(moved).all() and np.abs(np.array(moved) - [x, y]).max() < 0.01)


def jacobian(projection: pyproj.Proj, longitude: float, latitude: float) -> NDArray[np.float64]:
    """(2, 2): how far on the map (x, y) a metre on the ground leads, its columns for one to true east and one to true
    north. For a conformal projection it is a turn by the convergence and a factor. It is the quotient of differences
    over 200 m on the ellipsoid; pyproj's factors of web Mercator are those of a sphere."""
    geod = projection.crs.get_geod()
    assert geod is not None
    columns = []
    for azimuth in (90.0, 0.0):
        ends = [projection(*geod.fwd(longitude, latitude, azimuth, d)[:2]) for d in (-100.0, 100.0)]
        columns.append((np.array(ends[1]) - np.array(ends[0])) / 200.0)
    result = np.stack(columns, axis=1)
    if not np.isfinite(result).all():
        raise ValueError(f"crs: {projection.crs.name} has no scale at longitude {longitude:g}, latitude {latitude:g}")
    return result
