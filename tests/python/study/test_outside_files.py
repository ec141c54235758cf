# SPDX-License-Identifier: MIT
"""Files that nobody here made, in studies: those that come with packages of the tests. (docs/studies.md lists more.)"""

import warnings
from pathlib import Path

import gnomon
import numpy as np
import pytest
import rasterio
import rasterio.warp
from gnomon.studies import meshes


def ordered(triangles):
    """Triangles (F, 3, 3) as float32, from the corner that comes first on, and the triangles in order."""
    rows = np.float32(triangles)
    first = [min(range(3), key=lambda k: tuple(triangle[k])) for triangle in rows]
    rows = np.stack([np.roll(triangle, -k, axis=0) for triangle, k in zip(rows, first, strict=True)]).reshape(-1, 9)
    return rows[np.lexsort(rows.T[::-1])]


@pytest.mark.parametrize("name", ["airplane.ply", "ant.ply", "nut.ply", "sphere.ply"])
def test_meshes_have_the_triangles_that_vtk_reads(name):
    pyvista = pytest.importorskip("pyvista")
    file = Path(pyvista.examples.dir_path) / name
    mesh = meshes.load(str(file))
    vtk = pyvista.read(file)
    assert mesh.notes == () and vtk.is_all_triangles
    triangles = vtk.points[vtk.regular_faces]
    assert len(triangles) > 100 and np.array_equal(ordered(mesh.triangles), ordered(triangles))


def test_the_remedy_for_a_format_that_is_not_read_helps(tmp_path):
    """trimesh's reader of .vtk, which is meshio's, ends at this file of pyvista's."""
    pyvista = pytest.importorskip("pyvista")
    file = Path(pyvista.examples.dir_path) / "globe.vtk"
    with pytest.raises(meshes.UnreadableError, match="globe.vtk: cannot be read: .*; write it as .ply"):
        meshes.load(str(file))
    globe = pyvista.read(file)
    pyvista.PolyData(globe.points, globe.faces).save(tmp_path / "globe.ply")
    triangles = globe.points[globe.regular_faces]
    assert len(triangles) == 980
    assert np.array_equal(ordered(meshes.load(str(tmp_path / "globe.ply")).triangles), ordered(triangles))


def test_a_fault_in_tennessee(tmp_path):
    """The heights that matplotlib ships (SRTM's, of USGS) are a grid in degrees: the remedy that its error names helps.
    The sun of the afternoon lights the slopes that look to it; those behind the ridges are dark."""
    matplotlib = pytest.importorskip("matplotlib")
    data = np.load(Path(matplotlib.get_data_path()) / "sample_data/jacksboro_fault_dem.npz")
    heights = data["elevation"][:120, :120].astype("float32")
    place = rasterio.Affine(float(data["dx"]), 0, float(data["xmin"]), 0, -float(data["dy"]), float(data["ymax"]))
    there = dict(driver="GTiff", count=1, dtype="float32")
    with rasterio.open(tmp_path / "in.tif", "w", width=120, height=120, crs="EPSG:4326", transform=place, **there) as f:
        f.write(heights, 1)
    day = dict(start="2026-12-21T21:00", end="2026-12-21T22:00", step="1h", utc_offset=0)
    with pytest.raises(ValueError, match="degrees .*rio warp IN.tif OUT.tif --dst-crs EPSG:32616"):
        gnomon.study(tmp_path / "study", raster=tmp_path / "in.tif", **day)
    box = rasterio.transform.array_bounds(120, 120, place)
    grid, width, height = rasterio.warp.calculate_default_transform("EPSG:4326", "EPSG:32616", 120, 120, *box)
    out = np.full((height, width), np.nan, "float32")
    rasterio.warp.reproject(
        heights, out, src_transform=place, src_crs="EPSG:4326", dst_transform=grid, dst_crs="EPSG:32616",
        dst_nodata=np.nan, resampling=rasterio.warp.Resampling.bilinear,
    )  # fmt: skip
    there |= dict(width=width, height=height, crs="EPSG:32616", transform=grid)
    with rasterio.open(tmp_path / "out.tif", "w", **there) as f:
        f.write(out, 1)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        done = gnomon.study(tmp_path / "study", raster=tmp_path / "out.tif", **day)
    hours = done.dataset().sun_hours.values
    assert np.array_equal(np.isnan(hours), np.isnan(out)) and done.record["undecided"] == 0
    assert 0.01 < (hours[~np.isnan(hours)] == 0).mean() < 0.9
    _, slope_to_east = np.gradient(out, 1)
    facing_west, facing_east = (np.nanmean(hours[side]) for side in (slope_to_east > 20, slope_to_east < -20))
    assert facing_west > facing_east
