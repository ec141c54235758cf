# SPDX-License-Identifier: MIT
"""The record of a study: settings, versions, devices, counts, and the hash of every chunk."""

from __future__ import annotations

import importlib.metadata
import json
import platform
from typing import Any

import numpy as np
import rasterio

from .store import sha256_of, write_whole
from .tiled import TiledPlan

PACKAGES = ("gnomon", "numpy", "zarr", "dask", "rasterio", "pyproj", "pvlib", "trimesh")


def versions() -> dict[str, str]:
    result = {"python": platform.python_version(), "gdal": rasterio.__gdal_version__}
    for name in PACKAGES:
        try:
            result[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            result[name] = "not installed"
    return result


def record_of(plan: TiledPlan) -> dict[str, Any]:
    chunks: dict[str, Any] = {}
    devices: dict[str, int] = {}
    done = decisions = undecided = 0
    seconds = 0.0
    unread: set[int] = set()
    for tile, block in plan.tasks:
        facts = plan.store.done(tile, block, plan.hash)
        if facts is None:
            continue
        done += 1
        decisions += facts["decisions"]
        undecided += facts["undecided"]
        seconds += facts["seconds"]
        unread |= set(facts["unread"])
        device = f"{facts['device']} on {facts['host']}"
        devices[device] = devices.get(device, 0) + 1
        chunks |= {key: entry["data"] for key, entry in facts["chunks"].items()}
    for tile in range(len(plan.receivers)):
        facts = plan.store.done(tile, None, plan.hash)
        if facts is not None:
            chunks |= {key: entry["data"] for key, entry in facts["chunks"].items()}
    return {
        "settings": plan.facts["settings"],
        "plan": plan.hash,
        "versions": versions(),
        "tasks_done": done,
        "tasks": len(plan.tasks),
        "decisions": decisions,
        "undecided": undecided,
        "seconds_of_all_workers": round(seconds, 3),
        "tasks_of_devices": devices,
        **plan.own_record(sorted(unread)),
        "chunks": dict(sorted(chunks.items())),
    }


def write_record(plan: TiledPlan) -> dict[str, Any]:
    record = record_of(plan)
    write_whole(plan.folder / "record.json", json.dumps(record, indent=1))
    return record


def digests(plan: TiledPlan) -> dict[str, str]:
    """sha256 of each result, decoded, in raster order: it depends neither on tiles nor on compression."""
    result = {}
    for name in plan.results:
        array = plan.store.array(f"results.zarr/{name}")
        parts = []
        for index in np.ndindex(array.shape[: array.ndim - len(plan.receivers.shape)]):
            values = np.ascontiguousarray(array[index])
            parts.append(sha256_of(values.astype(values.dtype.newbyteorder("<"), copy=False).view(np.uint8).data))
        result[name] = sha256_of("".join(parts).encode())
    return result
