# SPDX-License-Identifier: MIT
"""Without the extra gnomon[study] these tests are skipped, loudly."""

import importlib.util
import sys
from pathlib import Path

NEEDED = ["dask", "distributed", "zarr", "rasterio", "pyproj", "pvlib", "xarray", "matplotlib", "trimesh", "tqdm"]
MISSING = [name for name in NEEDED if importlib.util.find_spec(name) is None]
collect_ignore_glob = ["test_*.py"] if MISSING else []
sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[1])]


def pytest_report_header() -> str:
    return f"SKIPPED: tests of studies, as {', '.join(MISSING)} cannot be imported" if MISSING else "studies: tested"
