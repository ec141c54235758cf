# SPDX-License-Identifier: MIT
"""Studies: many suns over receivers and casters of any extent, by tiles, with a certificate for each lit answer.

    result = gnomon.study("town", raster="dsm.tif", start="2026-06-21", end="2026-06-22", step="10min")
    result.picture("town.png")
    result.export("sun_hours.tif")

docs/studies.md has a tutorial, the layout of the results, and the certificate. Needs pip install 'gnomon[study]'.
"""

from __future__ import annotations

import dataclasses
import os
import sys
from pathlib import Path
from typing import Any

from .export import export, picture
from .plan import Plan
from .record import digests, record_of
from .runner import Execution, StudyStoppedError, executor_of, run_study
from .settings import Settings, read_toml, settings_of
from .tasks import plan_in
from .verify import Verified, verify
from .viewshed import export_viewshed
from .viewshed_plan import ViewshedPlan

__all__ = [
    "Execution",
    "Settings",
    "Study",
    "StudyStoppedError",
    "Verified",
    "open_study",
    "read_toml",
    "run",
    "study",
    "verify",
]


def _forget_threads() -> None:
    """In a child of a fork: dask's threads, which the child has not, and would wait for when it reads a dataset."""
    if "dask.threaded" in sys.modules:
        sys.modules["dask.threaded"].default_pool = None  # type: ignore[attr-defined]


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget_threads)


class Study:
    """A study in its folder: what study() and open_study() return."""

    def __init__(self, plan: Plan | ViewshedPlan) -> None:
        self.plan = plan

    @property
    def folder(self) -> Path:
        return self.plan.folder

    @property
    def record(self) -> dict[str, Any]:
        """What was computed, by what, and the hash of every chunk: record.json, as it is now."""
        return record_of(self.plan)

    def dataset(self) -> Any:
        """The results as an xarray.Dataset, each read at its first use: xarray.open_zarr(folder / "results.zarr")."""
        import xarray

        return xarray.open_zarr(self.folder / "results.zarr", consolidated=False)

    def digests(self) -> dict[str, str]:
        """sha256 of each result, decoded: the same for any tiles, workers and devices."""
        return digests(self.plan)

    def export(self, path: str | os.PathLike[str], what: str | None = None) -> list[Path]:
        """Writes a result as GeoTIFF (COG), or as CSV for points; what="suns": the table of suns: export.export(). Of a
        viewshed: viewshed.export_viewshed()."""
        if isinstance(self.plan, ViewshedPlan):
            export_viewshed(self.plan, Path(path), what)
            return [Path(path)]
        return export(self.plan, Path(path), what)

    def picture(self, path: str | os.PathLike[str], what: str | None = None) -> Path:
        """Draws a map of a result with a legend."""
        if isinstance(self.plan, ViewshedPlan):
            raise ValueError(f"{self.folder}: holds a viewshed, which has no picture: export() makes a GeoTIFF of it")
        return picture(self.plan, Path(path), what)

    def verify(self, share: float = 0.05, device: str | None = None, seed: int | None = None) -> Verified:
        """Recomputes a random share of the tasks and compares bits."""
        return verify(self.folder, share, device, seed)

    def __reduce__(self) -> Any:
        return open_study, (self.folder,)  # of a copy, too: it lies in its folder

    def __repr__(self) -> str:
        record = self.record
        return (
            f"<gnomon.Study in {self.folder}: {record['tasks_done']:,} of {record['tasks']:,} tasks, "
            f"{record['decisions']:,} decisions, {record['undecided']:,} undecided>"
        )


def study(folder: str | os.PathLike[str], **arguments: Any) -> Study:
    """Runs a study, or goes on with the study in the folder, and returns it.

    folder: the study's; a missing folder is made.
    arguments: by name, the settings of gnomon.studies.Settings (raster=, start=, end=, step= and so on), and the fields
        of gnomon.studies.Execution (workers=, client=, device=, tiles=, restart=, check=, progress=).

    Raises ValueError with the setting's name, StudyStoppedError where the study cannot go on (a full disk, say): the
    same call then goes on from there.
    """
    if not isinstance(folder, str | os.PathLike):
        raise ValueError(f"folder: must be the name of a folder for the study, not {folder!r}")
    fields = {field.name for field in dataclasses.fields(Execution)}
    execution = Execution(**{name: value for name, value in arguments.items() if name in fields})
    settings = settings_of({name: value for name, value in arguments.items() if name not in fields})
    return run(Path(folder), settings, execution)


def run(folder: Path, settings: Settings, execution: Execution) -> Study:
    """study() with settings that are checked already."""
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"folder: {folder} is a file: name a folder for the study, which need not exist")
    with executor_of(execution) as executor:
        return Study(run_study(folder.absolute(), settings, execution, executor))


def open_study(folder: str | os.PathLike[str]) -> Study:
    """The study in a folder. Raises ValueError if there is none."""
    return Study(plan_in(Path(folder).absolute()))
